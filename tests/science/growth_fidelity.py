# SPDX-License-Identifier: BSD-3-Clause
"""One cell of each dictionary entry alone in a roomy box: what grew, read back from SWC files, against what was drawn.

usage: growth_fidelity.py BIN SOURCE [ENTRY...]

BIN holds the programs, SOURCE is the checkout. The barcode is recomputed by `conceg characterise` from the files of
`conceg export`, not read from grow's books. Without entries all of the default dictionary are grown.
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

STEP_UM = 2.0  # the longest edge that growth takes (max_edge_um)
failures = []


def check(what, passed, detail):
    if not passed:
        failures.append(f"{what}: {detail}")


def recipe(entry, cell_class, box_um, grow):
    return f"""conceg: 1
seed: 1
domain:
  size_um: [{box_um}, {box_um}, {box_um}]
  periodic: [true, true, true]
  pia: [0, 0, 1]
dictionary: default
density_per_um3: {1.0 / box_um ** 3:.6e}
types:
  - {{name: cell, class: {cell_class}, entry: {entry}, fraction: 1}}
grow: {{{grow}}}
"""


class Cell:
    """A grown cell: its bars in the document, and as characterise finds them in its SWC file."""

    def __init__(self, programs, folder, entry, cell_class, box_um, grow):
        def run(*words):
            subprocess.run([programs / words[0], *words[1:]], cwd=folder, check=True)

        (folder / "cell.yaml").write_text(recipe(entry, cell_class, box_um, grow))
        run("conceg", "run", "cell.yaml", "--until", "grow", "-q", "-o", "cell.cgx")
        run("conceg-export", "cell.cgx", "--to", "swc", "--dir", folder / "files", "-q")
        files = sorted((folder / "files" / "swc").glob("*.swc"))
        run("conceg-characterise", *files, "--twig_length_um", "0", "--tree_length_um", "0.001", "--axons",
            "--axon_gap_um", "0", "--metrics", "none", "-q", "-o", "found.cgx")
        with h5py.File(folder / "cell.cgx") as document:
            bars = document["bars"]
            self.neurite = bars["neurite"][()]
            self.start, self.end = bars["asked_start"][()], bars["asked_end"][()]
            self.achieved = bars["achieved_start"][()]
            self.angle, self.root = bars["angle"][()], bars["parent"][()] < 0
            self.state = bars["state"][()]
            self.cable = self.measure(document["skeleton"])
        with h5py.File(folder / "found.cgx") as document:
            found = document["dictionary"]
            self.birth, self.death = found["bar_birth"][()], found["bar_death"][()]
            self.found_angle, self.found_root = found["bar_angle"][()], found["bar_parent"][()] < 0

    def measure(self, skeleton):
        position, parent = skeleton["position"][()], skeleton["parent"][()]
        rows = np.flatnonzero(parent >= 0)
        self.leaves = len(parent) - len(np.unique(parent[rows]))
        return np.linalg.norm(position[rows] - position[parent[rows]], axis=1).sum()

    def bars_apart_um(self):
        """Largest difference of an end or a start, bars sorted by their ends (which are all different)."""
        if len(self.birth) != len(self.start):
            return np.inf
        drawn, found = np.argsort(self.end), np.argsort(self.death)
        return max(np.abs(self.end[drawn] - self.death[found]).max(), np.abs(self.start[drawn] - self.birth[found]).max())

    def angles_apart_deg(self):
        """Mean, and mean of the sizes, of the found local fork angle minus the drawn one, bars matched by their ends."""
        drawn, found = np.argsort(self.end), np.argsort(self.death)
        fork = ~self.root[drawn] & ~self.found_root[found]
        difference = np.degrees(self.found_angle[found] - self.angle[drawn])[fork]
        return (difference.mean(), np.abs(difference).mean()) if len(difference) else (0.0, 0.0)


def judge(entry, early, exact):
    length = early.cable / (early.end - early.start).sum()
    bias = (early.achieved - early.start)[~early.root].mean() if (~early.root).any() else 0.0
    apart = exact.bars_apart_um()
    matched = len(exact.birth) == len(exact.start)
    angle, angle_size = exact.angles_apart_deg() if matched else (np.nan, np.nan)
    print(f"{entry:22s} {len(early.start):5d} {early.leaves:6d} {len(exact.birth):6d} {length:7.3f} {bias:7.2f} {apart:7.2f} "
          f"{angle:7.2f} {angle_size:7.2f}", flush=True)
    check(entry, (early.state == 1).all(), f"{(early.state != 1).sum()} bars do not reach their end")
    check(entry, early.leaves == len(early.start), f"{len(early.start)} bars, {early.leaves} leaves")
    check(entry, 0.97 <= length <= 1.03, f"total length is {length:.3f} of what was asked")
    check(entry, abs(bias) <= 1.0, f"bars start {bias:.2f} um off on average")
    check(entry, apart <= STEP_UM, f"a recomputed bar is {apart:.2f} um off, more than one step")
    check(entry, abs(angle) <= 3.0, f"local fork angles are {angle:.1f} degrees off on average")


def main():
    programs, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    with h5py.File(source / "data" / "mouse-visual-cortex.cgx") as document:
        names = [name.decode() for name in document["dictionary/entry_name"][()]]
        classes = dict(zip(names, (name.decode() for name in document["dictionary/entry_class"][()])))
    print("entry                   bars leaves  found  length   start barcode   angle  |angle|")
    print("                                                   ratio      um      um     deg      deg")
    for entry in sys.argv[3:] or names:
        box_um = 50 if classes[entry] in ("astrocyte", "microglia") else 70
        with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
            early = Cell(programs, pathlib.Path(one), entry, classes[entry], box_um, "")
            # Forks where they are asked: with the default hazard they come 0.8 um early on average, by design.
            exact = Cell(programs, pathlib.Path(two), entry, classes[entry], box_um, "lambda_per_um: 20")
            judge(entry, early, exact)
    for failure in failures:
        print("FAILED", failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
