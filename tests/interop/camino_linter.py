# SPDX-License-Identifier: BSD-3-Clause
"""A strict linter for a Camino datasynth run on a mesh: a shell script with one `datasynth` command, the PLY and the scheme that it names.

Written from a description of the formats and from the program's own readers of options and PLY, without sight of our writer.

The description, as far as it is checked here:

* Options are words; an unknown one or a wrong value is only warned about, so all are known here, each once, with values that are parsed:
  -walkers -tmax -voxels -seed whole, -p in [0, 1], -geometry ply, -plyfile FILE.ply, -meshsep Lx Ly Lz and -diffusivity in m and m^2/s,
  -initial uniform|intra|extra, -schemefile FILE. Results (big-endian float32) go to standard output, which is sent into a file.
* PLY: linter_text.ply, lengths in m. The box is that of the *triangles* (points without a triangle are dropped while reading), grown on
  both sides alike to -meshsep; parts beyond are ignored. So in each axis the triangles either reach from 0 to L exactly, or stay within and are cut nowhere.
* The box is periodic and its boundary is passed freely: open edges lie in faces of the box, and those of opposite faces are the same.
* `-initial intra` or `extra` ask whether a point lies inside: never, unless the header of the PLY has the comment `closed surface`; then by the
  hits of a ray along y with the triangles of one box, which is "only well-defined for closed surfaces". So the comment is there with a
  surface without open edges, and with open edges `uniform` alone is right.
* At most 500 000 triangles (the largest that its author writes of).
* Scheme: STEJSKALTANNER (linter_text.scheme), with the gyromagnetic ratio of AMICO, 267.5987e6 rad/s/T.

What the description leaves open: how -tmax should follow from the scheme (the step is the scheme's duration by -tmax); 1000 is asked for.
"""

import pathlib
import shlex
import sys

import numpy

from linter_text import check_closed, check_cut, edges_of, fault, lines_of, natural, number, ply, scheme

GAMMA = 267.5987e6
OPTIONS = {"-walkers": 1, "-tmax": 1, "-p": 1, "-geometry": 1, "-plyfile": 1, "-meshsep": 3, "-initial": 1, "-diffusivity": 1, "-schemefile": 1, "-voxels": 1, "-seed": 1}


def read_command(path):
    """{option: values} of the datasynth command."""
    commands = [(i, line) for i, line in enumerate(lines_of(path), 1) if line.split()[0] == "datasynth"]
    if lines_of(path)[0] != "#!/bin/sh" or len(commands) != 1:
        fault((path, 1), "#!/bin/sh and one datasynth command", f"{len(commands)}")
    where = (path, commands[0][0])
    words = shlex.split(commands[0][1])
    if len(words) < 3 or words[-2] != ">" or not words[-1].endswith(".Bfloat"):
        fault(where, "results into a file: > NAME.Bfloat", " ".join(words[-2:]))
    words, options = words[1:-2], {}
    while words:
        option = words.pop(0)
        if option not in OPTIONS or option in options:
            fault(where, "options of datasynth, each once", option)
        options[option], words = words[:OPTIONS[option]], words[OPTIONS[option]:]
        if len(options[option]) != OPTIONS[option]:
            fault(where, f"{OPTIONS[option]} values of {option}", options[option])
    for option in OPTIONS:
        if option not in options:
            fault(where, option, "none")
    return options, where


def lint(folder):
    """Check run.sh of a folder; return b (ms/um^2), the box (um), points (m), triangles and the word after -initial."""
    folder = pathlib.Path(folder)
    options, where = read_command(folder / "run.sh")
    one = {option: values[0] for option, values in options.items()}
    for option, least in (("-walkers", 1), ("-tmax", 1000), ("-voxels", 1), ("-seed", 0)):
        natural(one[option], option, where, least)
    if one["-voxels"] != "1" or one["-geometry"] != "ply" or one["-initial"] not in ("uniform", "intra", "extra"):
        fault(where, "one voxel, -geometry ply, -initial uniform, intra or extra", [one[o] for o in ("-voxels", "-geometry", "-initial")])
    if not 0 <= number(one["-p"], "-p", where) <= 1 or not 1e-10 < number(one["-diffusivity"], "-diffusivity", where) < 1e-8:
        fault(where, "a probability, and a diffusivity in m^2/s", f"{one['-p']} and {one['-diffusivity']}")
    if not one["-plyfile"].endswith(".ply"):
        fault(where, "-plyfile NAME.ply", one["-plyfile"])
    side = numpy.array([number(word, "-meshsep", where) for word in options["-meshsep"]])
    if side.min() <= 0 or side.max() > 1e-2:
        fault(where, "sides in m", side)
    path = folder / one["-plyfile"]
    pins = 2 if ends_with_corners(path, side) else 0
    vertex, face = ply(path, pins, says_closed=one["-initial"] != "uniform")
    if len(face) > 500000:
        fault((path, 0), "up to 500000 triangles", len(face))
    low, high = vertex[face].min(axis=(0, 1)), vertex[face].max(axis=(0, 1))
    for axis in range(3):
        if not (low[axis] == 0 and high[axis] == side[axis]) and not (low[axis] > 0 and high[axis] < side[axis]):
            fault((path, 0), f"triangles from 0 to {side[axis]} of axis {axis}, or within", f"{low[axis]} to {high[axis]}")
    check_cut(path, vertex, face, side)
    edges = edges_of(face)
    if len(numpy.unique(numpy.sort(edges, axis=1), axis=0)) * 2 == len(edges):
        check_closed(path, vertex, face)
    elif one["-initial"] != "uniform":
        fault(where, "-initial uniform, as the surface is open where it is cut", one["-initial"])
    b, _, _ = scheme(folder / one["-schemefile"], GAMMA)
    return b, side * 1e6, vertex, face, one["-initial"]


def ends_with_corners(path, side):
    """Whether the last two points are the corners of the box: they do no harm, and other programs take them for it."""
    lines = lines_of(path)
    at = next((i for i, line in enumerate(lines) if line == "end_header"), 0)
    count = next((int(line.split()[2]) for line in lines[:at] if line.startswith("element vertex ")), 0)
    return count > 2 and [[float(w) for w in line.split()] for line in lines[at + count - 1:at + count + 1]] == [[0, 0, 0], side.tolist()]


if __name__ == "__main__":
    b, box, vertex, face, initial = lint(sys.argv[1])
    print(f"box {box} um, {len(face)} triangles, {len(b)} rows, walkers {initial}")
