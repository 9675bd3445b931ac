#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Controlled perturbation: what neuron loss, shorter dendrites, more glia and another extracellular space do to the signal and to SANDI.

    perturb.py FOLDER [--recipe cube.yaml] [--walkers 20000] [--only NAME=FACTOR ...] [--svg FILE]

For each level of each factor of the recipe's `perturb` (spec/cli.md, R14) a substrate with the same seed is made, simulated and fitted, in
FOLDER/NAME-FACTOR. What is there already is not made again, so that a sweep can be made in pieces (--only glia=2). Then the table: geometry,
signals and SANDI of each level, and the difference of each to the unperturbed substrate, all in FOLDER/perturbation.csv.

Walkers of a pair begin at the same places, with the same random numbers: the difference of two signals is the mean over walkers of the difference of
what each of them saw, and its error that mean's. Errors of SANDI's differences add in squares, as if the two fits were independent.
Needs Python with h5py and numpy; --svg matplotlib."""
import argparse
import csv
import pathlib
import subprocess
import sys

import h5py
import numpy as np

recipes = pathlib.Path(__file__).resolve().parents[1] / "recipes"
levels = ["none=1", "neurons=0.8", "neurons=0.6", "neurons=0.4", "dendrites=0.8", "dendrites=0.6", "dendrites=0.4", "glia=2", "glia=3", "ecs=0.9", "ecs=1.1", "ecs=1.2"]
shells = [1, 3, 5, 10]
geometry = {"icvf": "cells' share of the box", "soma_share": "somas' share of the cells"}
fitted = {"f_soma": "f_soma", "f_neurite": "f_neurite", "f_ec": "f_extracellular", "R_soma_um": "radius_um"}


def conceg(program, *words):
    print("+ conceg", *words, file=sys.stderr, flush=True)
    if subprocess.run([program, *map(str, words)]).returncode:
        sys.exit(f"error: conceg {words[0]}: expected it to succeed")


def make(level, asked):
    """Substrate, signals and fits of one level, where they are not there yet; the folder of its tables."""
    name, factor = level.split("=")
    folder = asked.folder / level.replace("=", "-")
    block, simulated, done = folder / "block.cgx", folder / "simulated.cgx", folder / "sandi.csv"
    if done.is_file():
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    factors = [] if name == "none" else ["--set", f"perturb.{name}={factor}"]
    if not block.is_file():
        conceg(asked.conceg, "run", asked.recipe, "--until", "mesh", *factors, *asked.set, "--progress=none", "-o", block)
    if not simulated.is_file():
        conceg(asked.conceg, "simulate", block, "--walkers", asked.walkers, "--csv", folder, "-q", "-o", simulated)
    conceg(asked.conceg, "fit", simulated, "--variants=true", "-q", "--csv", folder, "-o", folder / "fitted.cgx")
    (folder / "fitted.cgx").unlink()
    return folder


def rows_of(path):
    with open(path, newline="") as table:
        return list(csv.DictReader(table))


def seen_by(document):
    """Starts of the walkers, and what each saw: cos of its phase, averaged over the directions of each shell of `shells`."""
    with h5py.File(document, "r") as file:
        start, vector = file["walkers/position"][:], file["walkers/vector"][:]
        b, coefficient = file["protocol/b"][:], file["protocol/coefficient"][:]
    seen = []
    for shell in shells:
        of_shell = coefficient[np.abs(b - shell) < 1e-6]
        if not len(of_shell):
            sys.exit(f"error: {document}: expected measurements at b = {shell} ms/um2, got none")
        seen.append(np.cos(np.einsum("ohk,whk->wo", of_shell, vector)).mean(axis=1))
    return start, np.array(seen)


def measure(folder, asked):
    """Value and error of every column of one level, and its walkers."""
    truth = {row["name"]: float(row["value"]) for row in rows_of(folder / "sandi_truth.csv")}
    out = {"icvf": (1 - truth["f_extracellular"], 0.0), "soma_share": (truth["soma_share_of_cells"], 0.0)}
    start, seen = seen_by(folder / "simulated.cgx")
    for shell, values in zip(shells, seen):
        out[f"S(b={shell})"] = (values.mean(), values.std(ddof=1) / np.sqrt(len(values)))
    for row in rows_of(folder / "sandi.csv"):
        free = "neurite_diffusivity" in row["fitted"].split()
        if row["signal"] == "all" and row["kernel"] == asked.kernel and free == (asked.neurite == "free"):
            for name, column in fitted.items():
                error = "radius_error_um" if column == "radius_um" else column + "_error"
                out[name] = (float(row[column]), float(row[error]))
    if "f_soma" not in out:
        sys.exit(f"error: {folder}/sandi.csv: expected a fit of the whole signal by {asked.kernel} spheres with D_in {asked.neurite}")
    return out, (start, seen)


def difference(name, here, base, walkers, base_walkers):
    """To the unperturbed level, with its error."""
    change = here[name][0] - base[name][0]
    if name.startswith("S("):
        (start, seen), (base_start, base_seen) = walkers, base_walkers
        if np.array_equal(start, base_start):
            i = [f"S(b={shell})" for shell in shells].index(name)
            each = seen[i] - base_seen[i]
            return change, each.std(ddof=1) / np.sqrt(len(each))
    return change, np.hypot(here[name][1], base[name][1])


def table_of(asked):
    base, base_walkers = measure(asked.folder / "none-1", asked)
    rows = []
    for level in asked.only or levels:
        folder = asked.folder / level.replace("=", "-")
        if not (folder / "sandi.csv").is_file():
            continue
        here, walkers = measure(folder, asked)
        row = {"factor": level.split("=")[0], "level": level.split("=")[1], "walkers": len(walkers[0])}
        for name in here:
            change, error = difference(name, here, base, walkers, base_walkers)
            row |= {name: here[name][0], f"{name}_error": here[name][1], f"{name}_change": change, f"{name}_change_error": error}
        rows.append(row)
    return rows


def print_table(rows, names, suffix, digits):
    heads = ["factor", "level"] + names
    lines = [[row["factor"], row["level"]] + [f"{row[n + suffix]:.{digits}f}" + (f" +- {row[n + suffix + '_error']:.{digits}f}" if row[n + suffix + "_error"] else "") for n in names] for row in rows]
    widths = [max(len(cell) for cell in column) for column in zip(heads, *lines)]
    for line in [heads] + lines:
        print("  " + "   ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


def draw(rows, path):
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"svg.hashsalt": "conceg", "svg.fonttype": "none", "font.size": 8})
    panels = [("icvf", "cells' share of the box"), ("soma_share", "somas' share of the cells")] + [(f"S(b={shell})", f"S/S0 at b = {shell} ms/um2") for shell in shells]
    panels += [("f_soma", "SANDI f_soma"), ("f_neurite", "SANDI f_neurite"), ("f_ec", "SANDI f_ec"), ("R_soma_um", "SANDI R_soma, um")]
    figure, axes = plt.subplots(2, 5, figsize=(13, 5.2), layout="constrained")
    colours = {"neurons": "#0072b2", "dendrites": "#d55e00", "glia": "#009e73", "ecs": "#cc79a7"}
    for axis, (name, title) in zip(axes.flat, panels):
        for factor, colour in colours.items():
            points = sorted([(1.0, 0.0, 0.0)] + [(float(r["level"]), r[f"{name}_change"], r[f"{name}_change_error"]) for r in rows if r["factor"] == factor])
            axis.errorbar(*np.array(points).T[:2], yerr=np.array(points).T[2], color=colour, marker="o", markersize=3, linewidth=1, capsize=2, label=factor)
        axis.axhline(0, color="0.7", linewidth=0.6, zorder=0)
        axis.set_title(title, fontsize=8)
        axis.set_xscale("log", base=2)
        axis.xaxis.set_major_formatter("{x:g}")
    figure.supxlabel("factor", fontsize=8)
    figure.supylabel("change to the unperturbed pair", fontsize=8)
    axes.flat[0].legend(fontsize=7, frameon=False)
    figure.savefig(path, format="svg", metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--recipe", type=pathlib.Path, default=recipes / "cube.yaml", help="periodic along all axes, with a radius for SANDI to find (default: cube.yaml)")
    parser.add_argument("--walkers", type=int, default=20000, help="of each substrate")
    parser.add_argument("--only", nargs="+", metavar="NAME=FACTOR", help="these levels (none=1 is the unperturbed one)")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="another value of the recipe, in all substrates")
    parser.add_argument("--svg", type=pathlib.Path, help="draw the changes")
    parser.add_argument("--conceg", default="conceg", help="the program that makes them")
    parser.add_argument("--kernel", choices=["gpd", "exact"], default="exact", help="of SANDI's spheres")
    parser.add_argument("--neurite", choices=["free", "held"], default="held", help="SANDI's diffusivity in neurites")
    asked = parser.parse_args()
    asked.set = [word for value in asked.set for word in ("--set", value)]
    for level in asked.only or levels:
        name, equals, factor = level.partition("=")
        if name not in ("none", "neurons", "dendrites", "glia", "ecs") or not equals:
            parser.error(f"--only {level}: expected none=1, or neurons, dendrites, glia or ecs = a factor")
    for level in dict.fromkeys(["none=1", *(asked.only or levels)]):
        make(level, asked)
    rows = table_of(asked)
    names = [*geometry, *(f"S(b={shell})" for shell in shells), *fitted]
    with open(asked.folder / "perturbation.csv", "w", newline="") as table:
        writer = csv.DictWriter(table, rows[0].keys())
        writer.writeheader()
        writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    print("values")
    print_table(rows, names, "", 3)
    print("changes to the unperturbed pair")
    print_table([row for row in rows if row["factor"] != "none"], names, "_change", 3)
    if asked.svg:
        draw(rows, asked.svg)


main()
