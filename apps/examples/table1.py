#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's Table 1 beside cells of conceg: synthetic cells against real cells that they were not grown from, by cross-validation.

    table1.py --run FOLDER --root CELLS [--folds 0,1,2,3,4] [--entries L4_pyramidal,astrocyte] [--cells 10]

For each fold: its donors are held back (validation-F.csv), the others are characterised (synthesis-F.csv, so that nothing of a dictionary
comes from a donor held back), a box of cortical density is grown from them and relaxed, and `conceg analyse --structure` holds its cells
against the donors held back. The last step pools the folds, prints the table and writes it to FOLDER/table1 (structure*.csv, structure.txt,
structure.svg). What is in FOLDER already is not made again. CELLS is the folder of the reconstructions that data/mouse-visual-cortex.csv
names. Needs nothing but Python."""
import argparse
import csv
import pathlib
import shutil
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parents[2]
density_per_um3 = 1.28e-4  # of the paper's column
# Those of the paper's table, and layer 2/3 with upper layer 4, which has enough donors to be judged.
wanted = ["L23_pyramidal", "L23_pyramidal_pooled", "L23_interneuron", "L4_pyramidal", "L4_interneuron", "L5_pyramidal", "L5_interneuron",
          "L6_pyramidal", "L6_interneuron", "astrocyte"]
radius_scale = {"pyramidal": 2, "interneuron": 2, "astrocyte": 1.6}  # as apps/recipes/cube.yaml
made_of_barcodes = "astrocyte"  # no reconstruction: its folds share their barcodes, so none is held back


def stop(line):
    sys.exit(f"error: {line}")


def table_of(path):
    """Header and rows of the entries' table; comments are left out."""
    if not path.is_file():
        stop(f"{path}: expected a table of characterise, got no such file")
    with open(path, newline="") as lines:
        reader = csv.DictReader(line for line in lines if not line.startswith("#"))
        rows = list(reader)
        for column in ("file", "entry", "class", "fold", "donor_id"):
            if column not in (reader.fieldnames or []):
                stop(f"{path}: expected a column {column}, got {reader.fieldnames}")
        return reader.fieldnames, rows


def fold_of(row):
    return int(row["fold"] or 0)


def write_table(path, columns, rows):
    with open(path, "w", newline="") as out:
        writer = csv.DictWriter(out, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def split(rows, fold):
    """Rows of the donors that may be grown from, and of those held back."""
    donors = [row for row in rows if row["file"]]
    held_back = [row for row in donors if row["entry"] != made_of_barcodes and fold_of(row) == fold]
    grown_from = [row for row in donors if row not in held_back]
    both = {row["donor_id"] for row in grown_from} & {row["donor_id"] for row in held_back}
    if both:
        stop(f"fold {fold}: expected donors on one side alone, got {' '.join(sorted(both))} in other folds too")
    return grown_from, held_back


def recipe(dictionary, classes, cells, seed):
    side = (cells * len(classes) / density_per_um3) ** (1 / 3)
    types = "\n".join(f"  - {{name: {entry}, class: {kind}, entry: {entry}, fraction: {1 / len(classes):.17g}, radius_scale: {radius_scale[kind]}}}"
                      for entry, kind in classes.items())
    return f"""conceg: 1
seed: {seed}
domain:
  size_um: [{side:.3f}, {side:.3f}, {side:.3f}]
  periodic: [true, true, true]
  pia: [0, 0, 1]
dictionary: {dictionary}
density_per_um3: {density_per_um3:g}
types:
{types}
"""


class Runner:
    def __init__(self, asked):
        self.asked, self.folder = asked, asked.run
        self.columns, rows = table_of(asked.table)
        missing = [entry for entry in asked.entries if not any(row["entry"] == entry and row["file"] for row in rows)]
        if missing:
            stop(f"{asked.table}: expected donors of {' '.join(missing)}, got none")
        self.rows = [row for row in rows if row["entry"] in asked.entries]

    def conceg(self, *words):
        print("+ conceg", *words, file=sys.stderr)
        if subprocess.run([self.asked.conceg, *map(str, words)]).returncode:
            stop(f"conceg {words[0]}: expected it to succeed")

    def make(self, name, step):
        """The file, made whole or not at all."""
        path = self.folder / name
        if not path.exists():
            part = path.with_name("part-" + name)
            step(part)
            part.rename(path)
        return path

    def characterise(self, kind, fold, rows):
        table = self.folder / f"{kind}-{fold}.csv"
        write_table(table, self.columns, rows)
        sources = ["--sources", self.asked.sources] if self.asked.sources.is_file() else []
        metrics = ["--metrics", "none"] if kind == "synthesis" else []
        return self.make(f"{kind}-{fold}.cgx", lambda part: self.conceg("characterise", "--table", table, "--root", self.asked.root, *sources, *metrics, "-q", "-o", part))

    def grow(self, fold, dictionary, rows):
        classes = {entry: next(row["class"] for row in rows if row["entry"] == entry) for entry in self.asked.entries if any(row["entry"] == entry for row in rows)}
        path = self.folder / f"recipe-{fold}.yaml"
        path.write_text(recipe(dictionary, classes, self.asked.cells, self.asked.seed + fold))
        return self.make(f"grown-{fold}.cgx", lambda part: self.conceg("run", path, "--until", "relax", "-q", "-o", part))

    def fold(self, fold):
        """Analysed cells of one fold, and its real ones."""
        grown_from, held_back = split(self.rows, fold)
        if not held_back:
            stop(f"fold {fold}: expected donors to hold back, got none; the folds are those of {self.asked.table}")
        real = self.characterise("validation", fold, held_back)
        analysed = self.folder / f"analysed-{fold}.cgx"
        if not analysed.exists():
            grown = self.grow(fold, self.characterise("synthesis", fold, grown_from), grown_from)
            self.make(analysed.name, lambda part: self.analyse(grown, part, real))
            grown.unlink()
        return analysed, real

    def analyse(self, document, out, real, pool=(), folder=None):
        words = ["--structure", real]
        if pool:
            words += ["--structure_pool", ",".join(map(str, pool))]
        if folder:
            words += ["--structure_dir", folder]
        self.conceg("analyse", document, *words, "--points", 0, "--field_step_um", 4, "-q", "-o", out)


def words_of(text):
    return [word for word in text.split(",") if word]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", type=pathlib.Path, metavar="FOLDER", required=True, help="where everything is made")
    parser.add_argument("--root", type=pathlib.Path, metavar="CELLS", required=True, help="folder of the reconstructions")
    parser.add_argument("--table", type=pathlib.Path, default=root / "data/mouse-visual-cortex.csv", help="which reconstruction is of which entry and fold")
    parser.add_argument("--sources", type=pathlib.Path, default=root / "data/mouse-visual-cortex-sources.csv", help="where they come from")
    parser.add_argument("--folds", type=lambda text: [int(word) for word in words_of(text)], default=[0, 1, 2, 3, 4])
    parser.add_argument("--entries", type=words_of, default=wanted, help="a box of each fold holds cells of all of them, equally many")
    parser.add_argument("--cells", type=int, default=10, help="of each entry in each fold")
    parser.add_argument("--seed", type=int, default=1, help="of fold 0; the others count on")
    parser.add_argument("--conceg", default="conceg", help="the program to start")
    asked = parser.parse_args()
    if not asked.folds or not asked.entries or asked.cells < 1:
        parser.error("expected a fold, an entry and a cell at least")
    asked.run.mkdir(parents=True, exist_ok=True)
    barcodes = asked.table.parent / "astrocyte-barcodes.csv"
    if barcodes.is_file():  # the tables of a fold lie here, and name it
        shutil.copy(barcodes, asked.run)
    runner = Runner(asked)
    made = [runner.fold(fold) for fold in asked.folds]
    (first, real), others = made[0], [analysed for analysed, _ in made[1:]]  # sets are numbered in this order
    runner.analyse(first, asked.run / "table1.cgx", real, others, asked.run / "table1")
    print((asked.run / "table1/structure.txt").read_text(), end="")


main()
