# SPDX-License-Identifier: BSD-3-Clause
"""A strict linter for CACTUS strand lists (.init, .partial, optimized_final.txt).

Written from a description of the format and from the program's own readers (ee81f86, quick-mesh and growth), without sight of our writer.

The description, as far as it is checked here:

* Line 1 the side L of the voxel in um, line 2 the number of strands; per strand a line with its number of points, then that many lines
  `x y z r`. The program's Python reads line by line and counts with int(); its C++ takes words. No comments, nothing after the last point.
* The voxel is [-L/2, L/2]^3; r > 0 in um. The mesher (`quick-mesh`) wants four points at least, turns a circle into the direction of each
  segment and the mean of two at each point: neighbours are apart, and a strand does not turn back on itself.
* Nothing is periodic. `quick-mesh` draws strands wherever they lie. Growth fills [-L/2 - 5, L/2 + 5]^3 and clears what lies outside; a strand
  that does not reach into it ends as an empty mesh. So every strand meets that cube, and of a periodic substrate the images that do are there.

What the description leaves open: points outside of the voxel may lie anywhere; a strand may have any number of points above three (the program's own have
up to 1300).
"""

import pathlib
import sys

import numpy

from linter_text import fault, lines_of, natural, number, table

MARGIN_UM = 5.0


def check_strand(path, first, points):
    """Points of one strand, whose first is in line `first`."""
    bad = numpy.flatnonzero(points[:, 3] <= 0)
    if len(bad):
        fault((path, first + bad[0]), "a radius above 0", points[bad[0], 3])
    steps = numpy.diff(points[:, :3], axis=0)
    length = numpy.linalg.norm(steps, axis=1)
    bad = numpy.flatnonzero(length == 0)
    if len(bad):
        fault((path, first + bad[0] + 1), "a point apart from the one before", points[bad[0] + 1, :3])
    unit = steps / length[:, None]
    bad = numpy.flatnonzero(numpy.linalg.norm(unit[1:] + unit[:-1], axis=1) < 1e-6)
    if len(bad):
        fault((path, first + bad[0] + 1), "a strand that does not turn back", points[bad[0] + 1, :3])


def reaches(points, half):
    """Whether a chain of balls meets the cube [-half, half]^3: segments are sampled a tenth of a radius apart."""
    near = numpy.abs(points[:, :3]).max(axis=1) - points[:, 3] < half
    if near.any():
        return True
    for a, b in zip(points[:-1], points[1:]):
        count = int(numpy.ceil(10 * numpy.linalg.norm(b[:3] - a[:3]) / min(a[3], b[3]))) + 1
        balls = a + (b - a) * numpy.linspace(0, 1, count)[:, None]
        if (numpy.abs(balls[:, :3]).max(axis=1) - balls[:, 3] < half).any():
            return True
    return False


def lint(path):
    """Check a list; return the side (um) and the strands, (n, 4) each."""
    path = pathlib.Path(path)
    lines = lines_of(path)
    side = number(lines[0], "the side of the voxel", (path, 1))
    if not 0 < side < 1e5:
        fault((path, 1), "a side in um", side)
    if len(lines) < 2:
        fault((path, 2), "the number of strands", "the end of the file")
    count, at, strands = natural(lines[1], "the number of strands", (path, 2), 1), 2, []
    for strand in range(count):
        if at >= len(lines):
            fault((path, at + 1), f"strand {strand} of {count}", "the end of the file")
        points = natural(lines[at], f"the number of points of strand {strand}", (path, at + 1), 4)
        if at + 1 + points > len(lines):
            fault((path, len(lines) + 1), f"{points} points of strand {strand}", "the end of the file")
        rows = table(path, lines[at + 1:at + 1 + points], at + 2, 4, "x y z r")
        check_strand(path, at + 2, rows)
        if not reaches(rows, side / 2 + MARGIN_UM):
            fault((path, at + 2), f"a strand that meets the voxel of {side:g} um with {MARGIN_UM:g} um around", f"strand {strand} does not")
        strands.append(rows)
        at += 1 + points
    if at != len(lines):
        fault((path, at + 1), "the end of the file after the last strand", repr(lines[at]))
    return side, strands


if __name__ == "__main__":
    side, strands = lint(sys.argv[1])
    print(f"voxel of {side:g} um, {len(strands)} strands, {sum(map(len, strands))} points")
