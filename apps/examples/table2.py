#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's Table 2 beside fits of conceg: for each layer the truth of the geometry and what SANDI makes of the signal.

    table2.py LAYER3 LAYER4 LAYER5 [--kernel gpd|exact] [--neurite free|held] [--errors]
    table2.py --run FOLDER [--side-um 60] [--walkers 100000] [--margin-um 0]

--run makes all of it in FOLDER first: the blocks of apps/recipes/layer3.yaml and its fellows (layer3.cgx and so on, unless they are there),
their signals (after a kill the same command goes on with the walkers that are finished), and the fits, with their tables in folders layer3, layer4 and layer5. Else each folder holds the tables that `conceg fit --csv
FOLDER` wrote for a block of that layer; - stands for a layer without fits. Of several fits to a signal the first one of the kernel, with the
neurites' diffusivity free or held, is shown. Needs nothing but Python."""
import argparse
import csv
import pathlib
import subprocess
import sys

recipes = pathlib.Path(__file__).resolve().parents[1] / "recipes"

# f_soma % and R um of the intracellular fit; f_neurite, f_soma, f_extracellular % and R of the full one: truth, SANDI.
paper = {
    3: {"intra": [(25, 28), (7.0, 7.8)], "all": [(52, 64), (17, 20), (31, 16), (7.0, 7.7)]},
    4: {"intra": [(41, 46), (7.2, 7.8)], "all": [(42, 57), (28, 31), (30, 13), (7.2, 8.2)]},
    5: {"intra": [(26, 24), (6.9, 7.7)], "all": [(50, 63), (18, 19), (33, 18), (6.9, 8.0)]},
}
columns = {
    "intra": [("f_soma %", "f_soma", 100), ("R_soma um", "radius_um", 1)],
    "all": [("f_neurite %", "f_neurite", 100), ("f_soma %", "f_soma", 100), ("f_extra %", "f_extracellular", 100), ("R_soma um", "radius_um", 1)],
}


def rows_of(path):
    if not path.is_file():
        sys.exit(f"error: {path}: expected a table of conceg fit --csv, got no such file")
    with open(path, newline="") as table:
        return list(csv.DictReader(table))


def truth_of(folder):
    """By name; empty where the fit knew no geometry."""
    path = folder / "sandi_truth.csv"
    return {row["name"]: float(row["value"]) for row in rows_of(path)} if path.is_file() else {}


def chosen(rows, signal, kernel, neurite):
    """The row of the fit to show, or None."""
    for row in rows:
        free = "neurite_diffusivity" in row["fitted"].split()
        if row["signal"] == signal and row["kernel"] == kernel and free == (neurite == "free"):
            return row
    return None


def true_value(name, signal, truth):
    if name == "radius_um":
        return truth.get("radius_mean")
    if signal == "intra":
        return truth.get("soma_share_of_cells")
    return truth.get(name)


def cells_of(layer, signal, row, truth, errors):
    out = []
    for (_, name, scale), (true, sandi) in zip(columns[signal], paper[layer][signal]):
        digits = 0 if scale == 100 else 1
        ours = "-" if row is None else f"{scale * float(row[name]):.{digits + 1}f}"
        if row is not None and errors:
            error = "radius_error_um" if name == "radius_um" else name + "_error"
            ours += f" +- {scale * float(row[error]):.{digits + 1}f}"
        value = true_value(name, signal, truth)
        known = "-" if value is None else f"{scale * value:.{digits + 1}f}"
        out.append(f"{true:.{digits}f} -> {sandi:.{digits}f} | {known} -> {ours}")
    return out


def print_table(signal, lines, asked):
    print(f"\n{'Intracellular signal, reduced SANDI' if signal == 'intra' else 'Full signal, full SANDI'}: truth -> SANDI, the paper's | ours ({asked})")
    heads = ["layer"] + [name for name, _, _ in columns[signal]]
    widths = [max(len(cell) for cell in column) for column in zip(heads, *lines)]
    for line in [heads] + lines:
        print("  " + "   ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


def conceg(program, *words):
    print("+", "conceg", *words, file=sys.stderr)
    if subprocess.run([program, *map(str, words)]).returncode:
        sys.exit(f"error: conceg {words[0]}: expected it to succeed")


def run_layer(layer, folder, asked):
    """Block, signal and fits of one layer; the folder of its tables."""
    recipe, block, tables = folder / f"layer{layer}.yaml", folder / f"layer{layer}.cgx", folder / f"layer{layer}"
    text = (recipes / recipe.name).read_text()
    sizes = "size_um: [100, 100, 100]"
    if text.count(sizes) != 1:
        sys.exit(f"error: {recipes / recipe.name}: expected one line {sizes}")
    recipe.write_text(text.replace(sizes, "size_um: [{0:g}, {0:g}, {0:g}]".format(asked.side_um)))
    if not block.exists():
        conceg(asked.conceg, "run", recipe, "--until", "mesh", "-q", "-o", block)
    simulated, fitted, checkpoint = folder / "simulated.cgx", folder / "fitted.cgx", folder / f"layer{layer}.checkpoint"
    conceg(asked.conceg, "simulate", block, "--walkers", asked.walkers, "--margin_um", asked.margin_um, "--checkpoint", checkpoint, "--csv", tables, "-o", simulated)
    conceg(asked.conceg, "fit", simulated, "--variants=true", "-q", "--csv", tables, "-o", fitted)
    for path in (simulated, fitted, checkpoint):
        path.unlink(missing_ok=True)
    return tables


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="*", metavar="LAYER")
    parser.add_argument("--run", type=pathlib.Path, metavar="FOLDER", help="make blocks, signals and fits here first")
    parser.add_argument("--side-um", type=float, default=60, help="of the blocks of --run")
    parser.add_argument("--walkers", type=int, default=100000, help="of --run, in each block")
    parser.add_argument("--margin-um", type=float, default=0, help="of --run: walkers begin at least so far inside the block; the paper's 10")
    parser.add_argument("--conceg", default="conceg", help="the program that --run starts")
    parser.add_argument("--errors", action="store_true", help="show the standard errors of our fits")
    parser.add_argument("--kernel", choices=["gpd", "exact"], default="gpd")
    parser.add_argument("--neurite", choices=["free", "held"], default="free")
    asked = parser.parse_args()
    if len(asked.folder) != (0 if asked.run else 3):
        parser.error("expected three folders, or --run FOLDER")
    if asked.run:
        asked.run.mkdir(parents=True, exist_ok=True)
        asked.folder = [run_layer(layer, asked.run, asked) for layer in (3, 4, 5)]
    lines = {"intra": [], "all": []}
    notes = []
    for layer, name in zip((3, 4, 5), asked.folder):
        folder = pathlib.Path(name)
        rows, truth = ([], {}) if name == "-" else (rows_of(folder / "sandi.csv"), truth_of(folder))
        for signal in lines:
            row = chosen(rows, signal, asked.kernel, asked.neurite)
            lines[signal].append([str(layer)] + cells_of(layer, signal, row, truth, asked.errors))
            if row is not None and row["at_bound"]:
                notes.append(f"layer {layer}, {signal}: at a bound: {row['at_bound']}")
        if truth:
            notes.append(f"layer {layer}: true radii: mean {truth['radius_mean']:.2f}, volume-weighted {truth['radius_volume_weighted']:.2f}, effective {truth['radius_effective']:.2f} um")
    for signal in lines:
        print_table(signal, lines[signal], f"{asked.kernel}, D_in {asked.neurite}")
    print()
    for note in notes:
        print(note)


main()
