#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The walker beside exact values as a table in SVG: golden_table.py TESTS SVG [--seed N --walkers N --factor N]

TESTS holds test_simulate_goldens and test_simulate_physics, which are run and whose lines are read. Each field has the mean of
the walkers, and its z score: the difference from the exact value over the standard error."""
import argparse
import html
import pathlib
import re
import subprocess

b_values = ["0.5", "1", "2", "3", "5", "8", "10", "12", "15"]
width, row_height, first = 90, 22, 150


def lines_of(program, *words):
    run = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    return run.stdout.splitlines()


def golden_rows(lines):
    """(name, [(mean, z)], p) of each pore."""
    out = []
    for line in lines:
        found = re.findall(r"(-?\d\.\d+)\([^)]*\) ([+-]\d+\.\d+)", line)
        if len(found) == len(b_values):
            out.append((line[:14].strip(), found, re.search(r"p (\d\.\d+)$", line)[1]))
    return out


def physics_rows(lines):
    """(what, mean, expected, z)."""
    pattern = re.compile(r"^  (.*?) +(-?\d+\.\d+) \(.*\), expected (-?\d+\.\d+), z ([+-]\d+\.\d+)$")
    return [match.groups() for match in map(pattern.match, lines) if match]


def colour(z):
    size = min(1.0, abs(float(z)) / 4.5)
    warm = (255, int(255 - 110 * size), int(255 - 150 * size))
    cold = (int(255 - 150 * size), int(255 - 90 * size), 255)
    return "rgb(%d,%d,%d)" % (warm if float(z) > 0 else cold)


class Sheet:
    def __init__(self):
        self.parts, self.y = [], 10

    def text(self, x, words, weight="normal", size=11):
        self.parts.append(f'<text x="{x}" y="{self.y + 15}" font-size="{size}" font-weight="{weight}">{html.escape(words)}</text>')

    def field(self, x, words, z, wide=width):
        self.parts.append(f'<rect x="{x}" y="{self.y}" width="{wide - 2}" height="{row_height - 2}" fill="{colour(z)}"/>')
        self.text(x + 4, words)

    def end_row(self):
        self.y += row_height

    def svg(self):
        wide, high = first + 10 * width + 20, self.y + 10
        return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}" height="{high}" viewBox="0 0 {wide} {high}" font-family="sans-serif">\n'
                f'<rect width="{wide}" height="{high}" fill="white"/>\n' + "\n".join(self.parts) + "\n</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tests", type=pathlib.Path)
    parser.add_argument("svg", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--walkers", type=int, default=1500)
    parser.add_argument("--factor", type=int, default=1)
    options = parser.parse_args()
    goldens = lines_of(options.tests / "test_simulate_goldens", options.seed, options.walkers)
    physics = lines_of(options.tests / "test_simulate_physics", options.seed, options.factor)
    sheet = Sheet()
    sheet.text(10, "Closed pores, Delta 20, delta 5 ms: walkers' signal, z against the matrix method; b in ms/um2", "bold", 12)
    sheet.end_row()
    for k, b in enumerate(b_values):
        sheet.text(first + k * width + 4, "b " + b, "bold")
    sheet.text(first + 9 * width + 4, "p (chi2)", "bold")
    sheet.end_row()
    for name, fields, p in golden_rows(goldens):
        sheet.text(10, name)
        for k, (mean, z) in enumerate(fields):
            sheet.field(first + k * width, f"{float(mean):.4f}  {z}", z)
        sheet.text(first + 9 * width + 4, p)
        sheet.end_row()
    sheet.text(10, goldens[-1] if goldens[-1].startswith("seed") else next(l for l in reversed(goldens) if l.startswith("seed")))
    sheet.end_row(), sheet.end_row()
    sheet.text(10, "Laws: walkers' mean, exact value, z", "bold", 12)
    sheet.end_row()
    rows = physics_rows(physics)
    half = (len(rows) + 1) // 2
    top = sheet.y
    for i, (what, mean, expected, z) in enumerate(rows):
        if i == half:
            sheet.y = top
        x = 10 if i < half else 10 + first // 2 + 5 * width
        sheet.text(x, what)
        sheet.field(x + 280, f"{float(mean):.5g} / {float(expected):.5g}  {z}", z, 190)
        sheet.end_row()
    sheet.y = top + half * row_height
    sheet.text(10, next(l for l in reversed(physics) if l.startswith("seed")))
    sheet.end_row()
    temporary = options.svg.with_suffix(".tmp")
    temporary.write_text(sheet.svg())
    temporary.replace(options.svg)


if __name__ == "__main__":
    main()
