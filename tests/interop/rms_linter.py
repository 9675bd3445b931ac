# SPDX-License-Identifier: BSD-3-Clause
"""A strict linter for the text files of RMS, the Realistic Monte Carlo Simulations of voxels.

Written from a description of the formats and from the program's own set-up script and reader, without sight of our writer.

The description, as far as it is checked here:

* The program reads files of fixed names in the folder that it runs in. `simParamInput.txt` has nine lines: time step (ms), steps, particles,
  rows of the b table, compartments n, voxel (um), and the three sizes of the label array.
* `fiber.txt` holds as many labels between blanks as the sizes say, x slowest. A label is an index into the arrays of the n compartments, so
  it is below n; n is at most 3. Label 0 is closed: no walker starts in it or enters it. Two labels above 0 exchange freely (the probability of a
  crossing is sqrt(D2/D1), at most 1), so a wall between two waters needs label 0 on one side.
* `diffusivity.txt` (um^2/ms) and `T2.txt` (ms) have a line per compartment, 0 among them; all are above 0 (the program divides by T2).
* `bval.txt` (ms/um^2) one number a line, `bvec.txt` three lines a row, x y z of a unit vector (a row of zeros for none is refused: b = 0
  asks for no other direction); at most 2000 rows.
* A step sqrt(6 D dt) is shorter than a voxel. The signal is stored 1000 times, every steps/1000: steps are a multiple of 1000, so none are lost.
* Numbers are whole where the program reads a whole number.

What the description leaves open: the largest array, and how many walkers are enough. Versions of the program that read PGSE timings take further files.
"""

import pathlib
import sys

import numpy

from linter_text import column, fault, lines_of, natural, number

FILES = ("simParamInput.txt", "fiber.txt", "diffusivity.txt", "T2.txt", "bval.txt", "bvec.txt")


def lint(folder):
    """Check one set of files; return ({label: share}, box (um), b (ms/um^2), labels as an array)."""
    folder = pathlib.Path(folder)
    path = folder / FILES[0]
    lines = lines_of(path)
    if len(lines) != 9:
        fault((path, len(lines)), "9 lines", len(lines))
    step, voxel = number(lines[0], "time step", (path, 1)), number(lines[5], "voxel", (path, 6))
    steps, walkers, rows, compartments, *shape = (natural(lines[i], "a count", (path, i + 1), 1) for i in (1, 2, 3, 4, 6, 7, 8))
    if not 0 < step < 1 or not 0 < voxel < 100:
        fault((path, 1), "a time step in ms and a voxel in um", f"{step:g} and {voxel:g}")
    if steps % 1000:
        fault((path, 2), "a multiple of 1000 steps", steps)
    if not 2 <= compartments <= 3 or rows > 2000:
        fault((path, 5), "2 or 3 compartments and up to 2000 rows", f"{compartments} and {rows}")

    path = folder / "fiber.txt"
    words = [word for line in lines_of(path) for word in line.split()]
    if len(words) != numpy.prod(shape):
        fault((path, 1), f"{numpy.prod(shape)} labels", len(words))
    labels = sorted(set(words))
    for label in labels:
        if natural(label, "a label", (path, 1)) >= compartments:
            fault((path, 1), f"labels below {compartments}, an entry of the tables for each", label)
    volume = numpy.array(words, int).reshape(shape)
    if not (volume > 0).any():
        fault((path, 1), "a label above 0, for walkers to start in", labels)

    diffusivity, relaxation = column(folder / "diffusivity.txt", "a diffusivity"), column(folder / "T2.txt", "T2")
    for name, values in (("diffusivity.txt", diffusivity), ("T2.txt", relaxation)):
        if len(values) != compartments or min(values) <= 0:
            fault((folder / name, len(values)), f"{compartments} values above 0", values)
    if max(diffusivity) > 10 or (6 * max(diffusivity) * step) ** 0.5 >= voxel:
        fault((folder / "diffusivity.txt", 1), f"um^2/ms, and steps shorter than a voxel of {voxel:g} um", diffusivity)
    b, vector = column(folder / "bval.txt", "b"), numpy.array(column(folder / "bvec.txt", "a component"))
    if len(b) != rows or min(b) < 0 or max(b) > 200:
        fault((folder / "bval.txt", len(b)), f"{rows} values in ms/um^2", f"{len(b)} from {min(b):g} to {max(b):g}")
    if len(vector) != 3 * rows:
        fault((folder / "bvec.txt", len(vector)), f"{3 * rows} lines", len(vector))
    length = numpy.linalg.norm(vector.reshape(-1, 3), axis=1)
    if numpy.abs(length - 1).max() > 1e-5:
        fault((folder / "bvec.txt", 3 * int(numpy.abs(length - 1).argmax()) + 1), "a vector of length 1", length[numpy.abs(length - 1).argmax()])
    return {int(label): words.count(label) / len(words) for label in labels}, numpy.array(shape) * voxel, numpy.array(b), volume


if __name__ == "__main__":
    shares, box, b, _ = lint(sys.argv[1])
    print(f"box {box} um, shares of the labels {shares}, {len(b)} rows")
