# SPDX-License-Identifier: BSD-3-Clause
"""A strict linter for surfaces as SpinDoctor takes them: NAME.node with NAME.poly, and NAME.stl.

Written from a description of the formats, from TetGen's manual and from SpinDoctor's own readers, without sight of our writer.

The description, as far as it is checked here:

* SpinDoctor reads a .node and .poly by the places of their lines, as it writes them itself: two comments, `points 3 0 0`, a comment, then
  `index x y z` for each point; in the .poly two comments, `0` (the points are in the .node), two comments, `facets 1`, a comment, then two lines per
  facet, `1 0 marker` and `3 i j k`; a comment, `0` (holes), a comment, the number of regions, and a line `index x y z compartment size` for
  each. TetGen, which it calls with -pq, reads both by words and drops comments (#): both readings are made here and have to agree.
* Points are counted from 1 without a gap. Facet markers are from 1 (the boundary), region markers from 1 (the compartment), and the point of a
  region lies inside of its surface. TetGen gives up on open or crossing facets: each edge is of two facets, once in each direction, and the normals point
  outward.
* An .stl for TetGen is text: it looks for `solid` and takes the three numbers after each `vertex`; a binary file is an error. Facets have three corners; corners that
  are equal number by number are one point, and the points are those of the .node.
* um.

What the description leaves open: crossing facets are not looked for here (TetGen does; -d), and the largest volume of a tetrahedron.
"""

import pathlib
import sys

import numpy

from linter_text import check_closed, double_areas, fault, left_through, lines_of, natural, number, numbers, table, volume_of


def by_place(path, lines, at, what):
    """A comment line, as the reader skips it unseen."""
    if not lines[at:] or not lines[at].lstrip().startswith("#"):
        fault((path, at + 1), f"a comment before {what}", repr(lines[at]) if lines[at:] else "the end of the file")


def need(path, lines, at, what):
    if at >= len(lines):
        fault((path, at + 1), what, "the end of the file")
    return lines[at], (path, at + 1)


def read_node(path):
    lines = lines_of(path)
    by_place(path, lines, 0, "the counts")
    by_place(path, lines, 1, "the counts")
    line, where = need(path, lines, 2, "points 3 0 0")
    count = natural(line.split()[0], "the number of points", where, 4)
    if line.split()[1:] != ["3", "0", "0"]:
        fault(where, "3 dimensions, no attribute, no marker", repr(line))
    by_place(path, lines, 3, "the points")
    if len(lines) != 4 + count:
        fault((path, len(lines)), f"{count} points", len(lines) - 4)
    rows = table(path, lines[4:], 5, 4, "index x y z")
    bad = numpy.flatnonzero(rows[:, 0] != numpy.arange(1, count + 1))
    if len(bad):
        fault((path, 5 + bad[0]), f"point {bad[0] + 1}", rows[bad[0], 0])
    return rows[:, 1:]


def read_poly(path, points):
    """Facets from 0, their markers and the regions (x, y, z, marker)."""
    lines = lines_of(path)
    for at in (0, 1, 3, 4, 6):
        by_place(path, lines, at, "its part")
    if need(path, lines, 2, "0")[0] != "0":
        fault((path, 3), "0, as the points are in the .node", repr(lines[2]))
    line, where = need(path, lines, 5, "facets 1")
    words = line.split()
    count = natural(words[0], "the number of facets", where, 4)
    if words[1:] != ["1"]:
        fault(where, "facets with markers: 1", repr(line))
    if len(lines) < 7 + 2 * count + 4:
        fault((path, len(lines) + 1), f"{count} facets, holes and regions", "the end of the file")
    heads = table(path, lines[7:7 + 2 * count:2], 8, 3, "1 0 marker")
    bad = numpy.flatnonzero((heads[:, 0] != 1) | (heads[:, 1] != 0) | (heads[:, 2] < 1))
    if len(bad):
        fault((path, 8 + 2 * bad[0]), "1 polygon, 0 holes, a marker from 1", repr(lines[7 + 2 * bad[0]]))
    rows = table(path, [line.strip() for line in lines[8:8 + 2 * count:2]], 9, 4, "3 i j k")
    bad = numpy.flatnonzero((rows[:, 0] != 3) | (rows[:, 1:] < 1).any(axis=1) | (rows[:, 1:] > points).any(axis=1) | (rows != numpy.floor(rows)).any(axis=1))
    if len(bad):
        fault((path, 9 + 2 * bad[0]), f"3 corners from 1 to {points}", repr(lines[8 + 2 * bad[0]]))
    at = 7 + 2 * count
    by_place(path, lines, at, "the holes")
    if lines[at + 1].strip() != "0":
        fault((path, at + 2), "no holes", repr(lines[at + 1]))
    by_place(path, lines, at + 2, "the regions")
    line, where = need(path, lines, at + 3, "regions")
    regions = []
    for k in range(natural(line.strip(), "the number of regions", where, 1)):
        line, where = need(path, lines, at + 4 + k, f"region {k + 1}")
        index, x, y, z, marker, size = numbers(line, 6, "index x y z compartment size", where)
        if index != k + 1 or marker < 1 or size == 0:
            fault(where, f"region {k + 1} with a compartment from 1 and a size", repr(line))
        regions.append((x, y, z, marker))
    if len(lines) != at + 4 + len(regions):
        fault((path, at + 5 + len(regions)), "the end of the file", repr(lines[at + 4 + len(regions)]))
    return rows[:, 1:].astype(numpy.int64) - 1, heads[:, 2], regions


def words_of(path):
    """As TetGen reads: comments dropped, words between blanks."""
    return [word for line in path.read_text().splitlines() for word in line.split("#")[0].split()]


def check_words(folder, stem, vertex, face, regions):
    """TetGen finds the same by words as SpinDoctor does by lines."""
    node, poly = words_of(folder / f"{stem}.node"), words_of(folder / f"{stem}.poly")
    if len(node) != 4 + 4 * len(vertex) or int(node[0]) != len(vertex):
        fault((folder / f"{stem}.node", 0), f"{4 + 4 * len(vertex)} words", len(node))
    wanted = 1 + 2 + 7 * len(face) + 1 + 1 + 6 * len(regions)
    if len(poly) != wanted or poly[0] != "0" or int(poly[1]) != len(face):
        fault((folder / f"{stem}.poly", 0), f"{wanted} words", len(poly))


def read_stl(path):
    """Corners (n, 3, 3) of a text STL."""
    if path.is_file() and not path.read_bytes().startswith(b"solid "):
        fault((path, 1), "text that begins with 'solid '", repr(path.read_bytes()[:20]))
    lines = [line.strip() for line in lines_of(path)]
    if not lines[-1].startswith("endsolid") or (len(lines) - 2) % 7:
        fault((path, len(lines)), "facets of 7 lines and endsolid", repr(lines[-1]))
    form = ("facet normal ", "outer loop", "vertex ", "vertex ", "vertex ", "endloop", "endfacet")
    for i, line in enumerate(lines[1:-1], 2):
        word = form[(i - 2) % 7]
        if not (line.startswith(word) if word.endswith(" ") else line == word):
            fault((path, i), repr(word), repr(line))
    corners = [line.removeprefix("vertex ") for line in lines[1:-1] if line.startswith("vertex ")]
    return table(path, corners, 0, 3, "vertex x y z").reshape(-1, 3, 3)


def lint(folder, stem):
    """Check the files of one surface; return points (um) and triangles."""
    folder = pathlib.Path(folder)
    vertex = read_node(folder / f"{stem}.node")
    face, markers, regions = read_poly(folder / f"{stem}.poly", len(vertex))
    path = folder / f"{stem}.poly"
    bad = numpy.flatnonzero(double_areas(vertex, face) <= 0)
    if len(bad):
        fault((path, 9 + 2 * bad[0]), "a facet with an area", face[bad[0]] + 1)
    check_closed(path, vertex, face)
    if len(numpy.unique(markers)) != 1 or len(regions) != 1 or regions[0][3] != 1:
        fault((path, 0), "one boundary around one compartment", f"{numpy.unique(markers)} and {regions}")
    for along in numpy.array([[0.48, 0.6, 0.64], [-0.64, 0.48, -0.6]]):
        met = left_through(numpy.array(regions[0][:3]), vertex, face, along)
        if met is None or not met[1]:
            fault((path, 0), "the point of the region inside of the surface", regions[0][:3])
    check_words(folder, stem, vertex, face, regions)
    corners = read_stl(folder / f"{stem}.stl")
    if not numpy.array_equal(corners, vertex[face]):
        fault((folder / f"{stem}.stl", 0), f"the {len(face)} triangles of the .poly", f"{len(corners)}, or others")
    return vertex, face


if __name__ == "__main__":
    vertex, face = lint(sys.argv[1], sys.argv[2])
    print(f"{len(vertex)} points, {len(face)} triangles, {volume_of(vertex, face):.6g} um^3")
