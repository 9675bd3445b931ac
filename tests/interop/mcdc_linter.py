# SPDX-License-Identifier: BSD-3-Clause
"""A strict linter for what the MC/DC Simulator reads: *.conf with the meshes, schemes and walkers that they name.

Written from a description of the formats and from the program's own reader (6d043d6), without sight of our writer.

The description, as far as it is checked here:

* A .conf is words between blanks; the last is `<END>`. Keys are matched by edit distance, so a misspelt one hits another: keys are spelt as
  documented, each is there once, and nothing unknown is.
* N, T, duration, diffusivity, exp_prefix, scheme_file, scale_from_stu, write_txt or write_bin and ini_walkers_file are there. With
  scale_from_stu 1 the diffusivity is in m^2/s and the duration in s; the duration is not below the echo time of the scheme.
* Each `<obstacle>` holds `ply FILE` and `ply_scale 0.001` (um to mm) and is closed. Both walls of a cell would be hit twice if it were
  named twice: no file is.
* One `<voxels>` block, min and max in mm, min = 0, closed; the program keeps coordinates of a periodic voxel between them.
* A walkers' file is lines of `x y z` in mm, strictly inside of the voxel, read again from the start when there are more walkers.
* PLY: linter_text.ply; outward normals (a hit from the wrong side makes the walker be sent again, for ever), edges from 1e-3 um. Edges that
  differ by more than a factor of sqrt(1000) within a triangle are warned about and taken; irregular() counts them. The program does not wrap triangles: those that cross a face of the voxel are there on the
  opposite face too, and rays of walkers `intra` leave through the first triangle along its normal, those of `extra` against it.
* Two configurations that write under one exp_prefix overwrite each other; folders of the prefix exist.

What the description leaves open: how thin triangles at the faces may be, and `permeability`, which is taken in [0, 1].
"""

import pathlib
import sys

import numpy

from linter_text import edge_lengths, fault, lines_of, left_through, natural, number, numbers, ply, scheme

GAMMA = 267.51525e6
COUNTS = {"N": 1, "T": 100, "num_process": 1, "seed": 0}
NUMBERS = ("duration", "diffusivity", "permeability")
FLAGS = ("scale_from_stu", "write_txt", "write_bin", "write_traj_file")
FILES = ("scheme_file", "ini_walkers_file", "exp_prefix")
NEEDED = ("N", "T", "duration", "diffusivity", "exp_prefix", "scheme_file", "scale_from_stu", "ini_walkers_file", "num_process")


def read_conf(path):
    """Values by key, the files of the obstacles, and the far corner of the voxel in um."""
    words = [(word, (path, i)) for i, line in enumerate(lines_of(path), 1) for word in line.split()]
    values, obstacles, box = {}, [], None
    end = (path, words[-1][1][1])

    def take(count):
        taken = [words.pop(0) if words else ("", end) for _ in range(count)]
        if not taken[-1][0]:
            fault(end, f"{count} more words", "the end of the file")
        return taken

    while words:
        key, where = words.pop(0)
        if key == "<END>":
            if words:
                fault(words[0][1], "nothing after <END>", repr(words[0][0]))
            return values, obstacles, box
        if key == "<obstacle>":
            (ply_key, _), (name, at), (scale_key, _), (scale, _), (close, _) = take(5)
            if (ply_key, scale_key, close) != ("ply", "ply_scale", "</obstacle>") or number(scale, "ply_scale", at) != 0.001:
                fault(at, "ply FILE ply_scale 0.001 </obstacle>", " ".join((ply_key, name, scale_key, scale, close)))
            if name in obstacles:
                fault(at, "each mesh once", name)
            obstacles.append(name)
        elif key == "<voxels>":
            taken = take(7)
            corners = [number(word, "a corner in mm", at) for word, at in taken[:6]]
            if box is not None or taken[6][0] != "</voxels>" or corners[:3] != [0, 0, 0] or min(corners[3:]) <= 0:
                fault(where, "one <voxels> 0 0 0 and a corner above </voxels>", corners)
            box = numpy.array(corners[3:]) * 1e3
        else:
            (value, at), = take(1)
            if key in values:
                fault(where, f"{key} once", "it again")
            if key in COUNTS:
                values[key] = natural(value, key, at, COUNTS[key])
            elif key in NUMBERS:
                values[key] = number(value, key, at)
            elif key in FLAGS:
                if value not in ("0", "1"):
                    fault(at, f"{key} 0 or 1", repr(value))
                values[key] = value == "1"
            elif key in FILES:
                values[key] = value
            else:
                fault(where, "a key of the program", repr(key))
    fault(end, "<END>", "the end of the file")


def check_values(path, values, echo_s):
    for key in NEEDED:
        if key not in values:
            fault((path, 0), f"{key}", "none")
    if not values["scale_from_stu"] or not 1e-10 < values["diffusivity"] < 1e-8:
        fault((path, 0), "scale_from_stu 1 and a diffusivity in m^2/s", f"{values['scale_from_stu']:d} and {values['diffusivity']:g}")
    if not (values.get("write_txt") or values.get("write_bin")):
        fault((path, 0), "write_txt 1 or write_bin 1", "no output")
    if not echo_s <= values["duration"] < 1:
        fault((path, 0), f"a duration in s from the echo time {echo_s:g}", f"{values['duration']:g}")
    if not 0 <= values.get("permeability", 0) <= 1:
        fault((path, 0), "a permeability from 0 to 1", values["permeability"])
    if not (path.parent / values["exp_prefix"]).parent.is_dir():
        fault((path, 0), "a folder to write into", values["exp_prefix"])


def read_walkers(path, box):
    lines = lines_of(path)
    points = numpy.array([numbers(line, 3, "x y z", (path, i)) for i, line in enumerate(lines, 1)]) * 1e3
    outside = numpy.flatnonzero(((points <= 0) | (points >= box)).any(axis=1))
    if len(outside):
        fault((path, outside[0] + 1), f"a point strictly inside of the voxel of {box} um", points[outside[0]])
    if len(points) > 10 and numpy.ptp(points, axis=0).min() < 1e-3 * box.max():
        fault((path, 1), "points in mm all over the voxel", f"they span {numpy.ptp(points, axis=0)} um")
    return points


def check_images(folder, triangles, box):
    """A triangle through a face of the voxel has its image at the opposite face."""
    for axis in range(3):
        across = [k for k in range(3) if k != axis]
        low, high = triangles[:, :, axis].min(axis=1), triangles[:, :, axis].max(axis=1)
        through = {at: triangles[(low < at - 1e-6) & (high > at + 1e-6)] for at in (0.0, box[axis])}
        for here, there in ((0.0, box[axis]), (box[axis], 0.0)):
            rows = through[here]
            row, low, high = numpy.arange(len(rows)), rows[:, :, axis].argmin(axis=1), rows[:, :, axis].argmax(axis=1)
            share = (here - rows[row, low, axis]) / (rows[row, high, axis] - rows[row, low, axis])
            met = rows[row, low][:, across] + share[:, None] * (rows[row, high] - rows[row, low])[:, across]
            centres = rows[((met > 1e-6) & (met < box[across] - 1e-6)).all(axis=1)].mean(axis=1)
            centres[:, axis] += there - here
            images = through[there].mean(axis=1)
            for centre in centres:
                if not len(images) or numpy.abs(images - centre).max(axis=1).min() > 1e-5:
                    fault((folder, 0), f"the image of every triangle through a face of axis {axis}", f"none about {centre}")


def check_sides(path, points, vertex, face, box, inside):
    """The first triangle of a ray within the voxel is passed outward from inside, inward from outside."""
    along, seen = numpy.array([0.48, 0.6, 0.64]), 0
    for i, point in enumerate(points[:60], 1):
        met = left_through(point, vertex, face, along)
        if met is None or (point + met[0] * along > box).any():
            continue
        seen += 1
        if met[1] != inside:
            fault((path, i), f"a point {'inside' if inside else 'outside'} of the cells", f"{point} um")
    return seen


def irregular(meshes):
    """Triangles that the program warns about as highly irregular, and all."""
    lengths = [edge_lengths(vertex, face) for vertex, face in meshes.values()]
    return sum(int((length[2] ** 2 > 1000 * length[0] ** 2).sum()) for length in lengths), sum(length.shape[1] for length in lengths)


def lint(folder):
    """Check every *.conf of a folder; return b (ms/um^2), the box (um), {file: (points, triangles)}, and points {conf: (n, 3) um}."""
    folder = pathlib.Path(folder)
    confs = sorted(folder.glob("*.conf"))
    if not confs:
        fault((folder, 0), "a .conf", "none")
    meshes, points, prefixes, b, box = {}, {}, set(), None, None
    for path in confs:
        values, obstacles, here = read_conf(path)
        if not obstacles or here is None:
            fault((path, 0), "an obstacle and a voxel", f"{len(obstacles)} and {here}")
        b, _, echo = scheme(folder / values.get("scheme_file", "?"), GAMMA)
        check_values(path, values, echo)
        if values["exp_prefix"] in prefixes:
            fault((path, 0), "an exp_prefix of its own", values["exp_prefix"])
        prefixes.add(values["exp_prefix"])
        if box is not None and ((here != box).any() or set(obstacles) != set(meshes)):
            fault((path, 0), "the voxel and the meshes of the other configurations", f"{here} and {len(obstacles)}")
        box = here
        for name in obstacles:
            if name not in meshes:
                meshes[name] = ply(folder / name)
                shortest = edge_lengths(*meshes[name])[0]
                if shortest.min() < 1e-3:
                    fault((folder / name, 0), "edges from 1e-3 um", f"{shortest.min():g} in triangle {shortest.argmin()}")
        points[path.stem] = read_walkers(folder / values["ini_walkers_file"], box)
    counts = numpy.cumsum([0] + [len(vertex) for vertex, _ in meshes.values()])
    vertex = numpy.concatenate([vertex for vertex, _ in meshes.values()])
    face = numpy.concatenate([face + first for first, (_, face) in zip(counts, meshes.values())])
    check_images(folder, vertex[face], box)
    for path in confs:
        check_sides(folder / read_conf(path)[0]["ini_walkers_file"], points[path.stem], vertex, face, box, "intra" in path.stem)
    return b, box, meshes, points


if __name__ == "__main__":
    b, box, meshes, points = lint(sys.argv[1])
    print(f"voxel {box} um, {len(meshes)} meshes, {irregular(meshes)[0]} highly irregular triangles, {len(b)} rows, {', '.join(f'{len(p)} {name}' for name, p in points.items())} walkers")
