# SPDX-License-Identifier: BSD-3-Clause
"""What the strict linters share: plain text, numbers, triangles as text PLY, gradient schemes.

Every complaint is ValueError("FILE:LINE: expected ..., got ..."); line 0 speaks of the file as a whole.

The descriptions that these readers follow, with the simulators that ask for each rule:

* Text PLY (MC/DC, Camino, MCMRSimulator): `ply`, `format ascii 1.0`; comments that hold none of the words vertex, face, nx, element,
  property, end_header (MC/DC goes through the header word by word) and are not empty (Camino takes the word after `comment`); `comment closed
  surface` is Camino's alone, and must be true; float or double x, y, z and no further property; `property list
  uchar int vertex_indices` (MCMRSimulator asks for that name); then one line of three numbers for each point and one line `3 i j k` for
  each triangle (Camino reads line by line), and nothing more. Corners exist and differ, no triangle is without area or there twice.
* STEJSKALTANNER schemes: `VERSION: STEJSKALTANNER`, then lines of seven numbers `gx gy gz |G| Delta delta TE` in T/m and s; the direction
  has length 1 in every row (DiSimPy and dmipy-sim refuse a zero direction or pulse, so b = 0 is |G| = 0 alone); delta > 0, Delta >= delta; TE is
  above Delta + delta, because MC/DC does not integrate its last step; one timing for the whole file, TE below 1 s.
"""

import math
import re

import numpy

NATURAL = re.compile(r"0|[1-9][0-9]*")
NUMBER = re.compile(r"[-+]?[0-9]+(\.[0-9]+)?([eE][-+]?[0-9]+)?")
HEADER_WORDS = {"vertex", "face", "nx", "element", "property", "end_header"}


def fault(where, expected, got):
    raise ValueError(f"{where[0]}:{where[1]}: expected {expected}, got {got}")


def lines_of(path, empty=False):
    """Lines of a plain ASCII file, each ended by \\n, without blanks at their ends."""
    if not path.is_file():
        fault((path, 0), "a file", "none")
    data = path.read_bytes()
    if not data:
        fault((path, 1), "a first line", "an empty file")
    if not data.endswith(b"\n"):
        fault((path, data.count(b"\n") + 1), "a line feed after the last line", "the end of the file")
    bad = re.search(rb"[^\n -~]", data)
    if bad:
        fault((path, data.count(b"\n", 0, bad.start()) + 1), "printable ASCII", f"byte 0x{bad[0][0]:02x}")
    lines = data.decode("ascii").split("\n")[:-1]
    if not empty:
        for number, line in enumerate(lines, 1):
            if not line.strip():
                fault((path, number), "a line with words", "an empty line")
    return lines


def natural(text, what, where, least=0):
    if not NATURAL.fullmatch(text) or int(text) < least:
        fault(where, f"{what}: a whole number from {least}", repr(text))
    return int(text)


def number(text, what, where):
    """A finite decimal number as C++ streams, Java, Python and MATLAB all read it."""
    if not NUMBER.fullmatch(text) or not math.isfinite(float(text)):
        fault(where, f"{what}: a finite decimal number", repr(text))
    return float(text)


def numbers(line, count, what, where):
    words = line.split()
    if len(words) != count:
        fault(where, f"{what}: {count} numbers", f"{len(words)}: {line[:60]!r}")
    return [number(word, what, where) for word in words]


def column(path, what):
    """A file of one number a line."""
    return [numbers(line, 1, what, (path, i))[0] for i, line in enumerate(lines_of(path), 1)]


def table(path, lines, first, columns, what):
    """Rows of numbers at once; only a table that is not one is looked at line by line."""
    for i, line in enumerate(lines, first):
        if line.count(" ") != columns - 1:
            numbers(line, columns, what, (path, i))
            fault((path, i), f"{what}: one space between numbers", repr(line[:60]))
    try:
        values = numpy.array(" ".join(lines).split(" "), float).reshape(-1, columns)
    except ValueError:
        values = numpy.full((1, 1), numpy.nan)
    if lines and not numpy.isfinite(values).all():
        for i, line in enumerate(lines, first):
            numbers(line, columns, what, (path, i))
    return values if lines else numpy.zeros((0, columns))


def ply_header(path, lines, form="ascii", says_closed=False):
    """Counts of points and triangles, and the number of header lines."""
    if lines[:2] != ["ply", f"format {form} 1.0"]:
        fault((path, 1), f"'ply' and 'format {form} 1.0'", lines[:2])
    if ("comment closed surface" in lines) != says_closed:
        fault((path, 2), f"{'a' if says_closed else 'no'} comment closed surface", "otherwise")
    wanted = [r"element vertex ([1-9]\d*)", r"property (?:float|double) x", r"property (?:float|double) y", r"property (?:float|double) z",
              r"element face ([1-9]\d*)", r"property list uchar int vertex_indices", r"end_header"]
    counts = []
    for i, line in enumerate(lines[2:], 3):
        words = line.split()
        if words[0] in ("comment", "obj_info"):
            if words[0] == "obj_info" or len(words) < 2 or HEADER_WORDS & set(words):
                fault((path, i), "a comment without the words that readers look for", repr(line))
            continue
        found = re.fullmatch(wanted[0], line)
        if not found:
            fault((path, i), f"a line like {wanted[0]!r}", repr(line))
        counts += map(int, found.groups())
        if not wanted.pop(0) or not wanted:
            return counts[0], counts[1], i
    fault((path, len(lines) + 1), "end_header", "the end of the file")


def ply(path, pins=0, says_closed=False):
    """Points (n, 3) and triangles (m, 3) of a text PLY; `pins` of its last points belong to no triangle, all others to at least one."""
    lines = lines_of(path)
    points, faces, head = ply_header(path, lines, says_closed=says_closed)
    if len(lines) != head + points + faces:
        fault((path, len(lines)), f"{head + points + faces} lines by the counts of the header", len(lines))
    vertex = table(path, lines[head:head + points], head + 1, 3, "a point")
    rows = table(path, lines[head + points:], head + points + 1, 4, "a triangle")
    first = head + points + 1
    bad = numpy.flatnonzero((rows[:, 0] != 3) | (rows != numpy.floor(rows)).any(axis=1) | (rows[:, 1:] < 0).any(axis=1) | (rows[:, 1:] >= points).any(axis=1))
    if len(bad):
        fault((path, first + bad[0]), f"'3 i j k' with corners below {points}", repr(lines[first + bad[0] - 1]))
    face = rows[:, 1:].astype(numpy.int64)
    corners = numpy.sort(face, axis=1)
    bad = numpy.flatnonzero((corners[:, 0] == corners[:, 1]) | (corners[:, 1] == corners[:, 2]) | (double_areas(vertex, face) <= 0))
    if len(bad):
        fault((path, first + bad[0]), "a triangle with an area", repr(lines[first + bad[0] - 1]))
    _, at, count = numpy.unique(corners, axis=0, return_index=True, return_counts=True)
    if (count > 1).any():
        fault((path, first + at[count > 1].min()), "each triangle once", "one with the same corners")
    used = numpy.zeros(points, bool)
    used[face] = True
    if not used[:points - pins].all() or used[points - pins:].any():
        at = numpy.flatnonzero(used != (numpy.arange(points) < points - pins))[0]
        fault((path, head + 1 + at), f"points of triangles, and {pins} at the end that are of none", f"point {at} {'of a' if used[at] else 'without'} triangle")
    return vertex, face


def binary_ply(path):
    """Points and triangles of a little-endian PLY of doubles."""
    data = path.read_bytes() if path.is_file() else fault((path, 0), "a file", "none")
    head, mark, body = data.partition(b"end_header\n")
    lines = (head + mark).decode("ascii", "replace").split("\n")[:-1]
    points, faces, _ = ply_header(path, lines, "binary_little_endian")
    if len(body) != 24 * points + 13 * faces or b"float" in head:
        fault((path, len(lines)), f"{24 * points + 13 * faces} bytes of doubles and triangles", len(body))
    vertex = numpy.frombuffer(body, "<f8", 3 * points).reshape(-1, 3)
    rows = numpy.frombuffer(body, numpy.dtype([("count", "u1"), ("corner", "<i4", 3)]), faces, 24 * points)
    face = rows["corner"].astype(numpy.int64)
    if (rows["count"] != 3).any() or face.min() < 0 or face.max() >= points or not numpy.isfinite(vertex).all() or (double_areas(vertex, face) <= 0).any():
        fault((path, 0), f"triangles with an area, of finite points below {points}", "others")
    return vertex, face


def double_areas(vertex, face):
    a, b, c = (vertex[face[:, k]] for k in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1)


def volume_of(vertex, face):
    """Of closed triangles wound outward."""
    a, b, c = (vertex[face[:, k]] for k in range(3))
    return numpy.einsum("ij,ij->", a, numpy.cross(b, c)) / 6


def edges_of(face):
    return numpy.concatenate([face[:, [0, 1]], face[:, [1, 2]], face[:, [2, 0]]])


def edge_lengths(vertex, face):
    """Of each triangle, the shortest first: (3, m)."""
    a, b, c = (vertex[face[:, k]] for k in range(3))
    return numpy.sort(numpy.linalg.norm(numpy.stack([b - a, c - b, a - c]), axis=2), axis=0)


def check_closed(path, vertex, face):
    """Every edge is passed once in each direction, and every piece holds a positive volume: outward normals, no hole."""
    edges = edges_of(face)
    size = len(vertex)
    there, back = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
    ways, count = numpy.unique(there, return_counts=True)
    if (count > 1).any():
        fault((path, 0), "each edge once in each direction", f"edge {divmod(int(ways[count > 1][0]), size)} twice in one")
    open_edges = numpy.setdiff1d(there, back)
    if len(open_edges):
        fault((path, 0), "a closed surface", f"{len(open_edges)} open edges, the first {divmod(int(open_edges[0]), size)}")
    piece = pieces(size, edges)[face[:, 0]]
    for name in numpy.unique(piece):
        volume = volume_of(vertex, face[piece == name])
        if volume <= 0:
            fault((path, 0), "normals that point outward", f"volume {volume:g} of a piece")


def pieces(size, edges):
    """The least point of the connected piece of each point."""
    label = numpy.arange(size)
    while True:
        least = label.copy()
        numpy.minimum.at(least, edges[:, 0], label[edges[:, 1]])
        numpy.minimum.at(least, edges[:, 1], label[edges[:, 0]])
        least = least[least]
        if (least == label).all():
            return label
        label = least


def check_cut(path, vertex, face, side):
    """Triangles fill [0, side]^3 (three sides); their open edges lie exactly in its faces, and those of opposite faces are the same."""
    low, high = vertex[face].min(axis=(0, 1)), vertex[face].max(axis=(0, 1))
    if (low < 0).any() or (high > side).any():
        fault((path, 0), f"triangles in [0, {side}]", f"{low} to {high}")
    edges = edges_of(face)
    size = len(vertex)
    there, back = edges[:, 0] * size + edges[:, 1], edges[:, 1] * size + edges[:, 0]
    ways, count = numpy.unique(there, return_counts=True)
    if (count > 1).any():
        fault((path, 0), "each edge once in each direction", f"edge {divmod(int(ways[count > 1][0]), size)} twice in one")
    ends = vertex[edges[~numpy.isin(there, back)]]
    inside = numpy.ones(len(ends), bool)
    for axis in range(3):
        at = {level: numpy.flatnonzero((ends[:, :, axis] == value).all(axis=1)) for level, value in (("low", 0), ("high", side[axis]))}
        for rows in at.values():
            inside[rows] = False
        across = [k for k in range(3) if k != axis]
        low, high = ({tuple(sorted(map(tuple, edge))) for edge in ends[rows][:, :, across].tolist()} for rows in at.values())
        if low != high:
            fault((path, 0), f"the same rims in both faces of axis {axis}", f"{len(low)} and {len(high)} edges, {len(low ^ high)} of them in one alone")
    if inside.any():
        fault((path, 0), "open edges in the faces of the box alone", f"{inside.sum()} elsewhere, the first {ends[inside][0].tolist()}")


def left_through(point, vertex, face, along):
    """Of the ray from a point: the distance to the first triangle, and whether its normal points along; None if there is none."""
    a, b, c = (vertex[face[:, k]] for k in range(3))
    across = numpy.cross(along, c - a)
    det = numpy.einsum("ij,ij->i", b - a, across)
    with numpy.errstate(all="ignore"):
        u = numpy.einsum("ij,ij->i", point - a, across) / det
        q = numpy.cross(point - a, b - a)
        v, t = q @ along / det, numpy.einsum("ij,ij->i", q, c - a) / det
        hit = numpy.flatnonzero((det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0))
    if not len(hit):
        return None
    first = hit[numpy.argmin(t[hit])]
    return t[first], bool(numpy.cross(b[first] - a[first], c[first] - a[first]) @ along > 0)


def scheme(path, gamma):
    """b of each row in ms/um^2 by the consumer's gamma (rad/s/T), directions, and the echo time in s."""
    lines = lines_of(path)
    if lines[0] != "VERSION: STEJSKALTANNER":
        fault((path, 1), "'VERSION: STEJSKALTANNER'", repr(lines[0]))
    if len(lines) < 2:
        fault((path, 2), "a row", "the end of the file")
    b, directions, timings = [], [], set()
    for i, line in enumerate(lines[1:], 2):
        where = (path, i)
        x, y, z, strength, separation, pulse, echo = numbers(line, 7, "gx gy gz G Delta delta TE", where)
        if abs(math.hypot(x, y, z) - 1) > 1e-6:
            fault(where, "a direction of length 1", math.hypot(x, y, z))
        if not 0 <= strength < 10:
            fault(where, "a gradient in T/m from 0 (below 10)", strength)
        if not 0 < pulse <= separation:
            fault(where, "0 < delta <= Delta", f"{pulse:g} and {separation:g}")
        if not separation + pulse < echo < 1:
            fault(where, f"an echo in s after Delta + delta = {separation + pulse:g}", f"{echo:g}")
        timings.add((separation, pulse, echo))
        directions.append((x, y, z))
        b.append((gamma * strength * pulse) ** 2 * (separation - pulse / 3) * 1e-9)
    if len(timings) != 1:
        fault((path, 2), "one timing for all rows", f"{len(timings)}")
    return numpy.array(b), numpy.array(directions), timings.pop()[2]
