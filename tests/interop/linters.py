# SPDX-License-Identifier: BSD-3-Clause
"""Strict readers of formats whose programs are not on PyPI, by the descriptions of those programs: any departure raises Refused.

Each takes the folder that export wrote, its manifest, and returns what was found, for the caller to compare with the manifest.
"""
import json
import re
import shlex

import numpy as np


class Refused(Exception):
    pass


def need(good, what):
    if not good:
        raise Refused(what)


def numbers(line, count, where):
    words = line.split()
    need(len(words) == count, f"{where}: expected {count} values, got {len(words)}")
    try:
        values = [float(word) for word in words]
    except ValueError:
        raise Refused(f"{where}: no numbers: {line[:60]}") from None
    need(np.isfinite(values).all(), f"{where}: not finite: {line[:60]}")
    return values


def text_ply(path):
    """PLY as the strictest reader takes it (MC/DC): text; x y z and triangles without further properties; no bare key words in comments."""
    text = path.read_text()
    head, mark, body = text.partition("end_header\n")
    need(mark, f"{path.name}: no end_header")
    lines = head.splitlines()
    need(lines[:2] == ["ply", "format ascii 1.0"], f"{path.name}: expected text PLY, got {lines[:2]}")
    for line in lines:
        if line.startswith("comment"):
            need(not set(line.split()[1:]) & {"vertex", "face", "nx", "element", "end_header", "property"}, f"{path.name}: a key word in: {line}")
    rest = [line for line in lines[2:] if not line.startswith("comment")]
    wanted = [r"element vertex (\d+)", r"property (?:float|double) x", r"property (?:float|double) y", r"property (?:float|double) z", r"element face (\d+)", r"property list uchar u?int vertex_ind(?:ex|ices)"]
    need(len(rest) == len(wanted), f"{path.name}: expected {len(wanted)} lines of the header, got {rest}")
    found = [re.fullmatch(pattern, line) for pattern, line in zip(wanted, rest)]
    need(all(found), f"{path.name}: header {rest}")
    vertices, faces = int(found[0].group(1)), int(found[4].group(1))
    values = body.split()
    need(len(values) == 3 * vertices + 4 * faces, f"{path.name}: expected {3 * vertices + 4 * faces} values, got {len(values)}")
    vertex = np.array(values[: 3 * vertices], float).reshape(-1, 3)
    rows = np.array(values[3 * vertices:], np.int64).reshape(-1, 4)
    need((rows[:, 0] == 3).all(), f"{path.name}: faces that are no triangles")
    face = rows[:, 1:]
    need(len(face) == 0 or (face.min() >= 0 and face.max() < vertices), f"{path.name}: a corner that is not there")
    need(np.isfinite(vertex).all(), f"{path.name}: not finite")
    a, b, c = (vertex[face[:, k]] for k in range(3))
    need(len(face) == 0 or (np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0).all(), f"{path.name}: degenerate triangles")
    return vertex, face


def volume_of(vertex, face):
    a, b, c = (vertex[face[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def scheme(path, gamma):
    """STEJSKALTANNER: b of each row in ms/um2, by the consumer's gamma in rad/s/T."""
    lines = path.read_text().splitlines()
    need(lines and lines[0] == "VERSION: STEJSKALTANNER", f"{path.name}: header {lines[:1]}")
    b = []
    for number, line in enumerate(lines[1:], 2):
        x, y, z, strength, separation, pulse, echo = numbers(line, 7, f"{path.name}:{number}")
        need(abs(x * x + y * y + z * z - 1) < 1e-6, f"{path.name}:{number}: no unit vector")
        need(strength >= 0 and 0 < pulse <= separation, f"{path.name}:{number}: pulses")
        need(echo >= separation + pulse, f"{path.name}:{number}: the echo comes before the end of the second pulse")
        b.append((gamma * strength * pulse) ** 2 * (separation - pulse / 3) * 1e-9)
    need(b, f"{path.name}: no rows")
    return np.array(b)


def mcdc(folder):
    """Configurations with all that they name; returns b, the box in um, volumes by file, starting points in um."""
    box = points = None
    files = {}
    for where in ("intra", "extra"):
        conf = folder / f"{where}.conf"
        words = conf.read_text().split()
        need(words[-1] == "<END>", f"{conf.name}: the last word is {words[-1]}")
        keys = {"N", "T", "duration", "diffusivity", "exp_prefix", "scheme_file", "scale_from_stu", "write_txt", "write_bin", "write_traj_file", "ini_walkers_file", "num_process", "seed", "ply", "ply_scale"}
        values, listed, at = {}, [], 0
        while words[at] != "<END>":
            word = words[at]
            if word == "<obstacle>":
                need(words[at + 1] == "ply" and words[at + 3:at + 6] == ["ply_scale", "0.001", "</obstacle>"], f"{conf.name}: {words[at:at + 6]}")
                listed.append(words[at + 2])
                at += 6
            elif word == "<voxels>":
                corners = [float(v) for v in words[at + 1:at + 7]]
                need(words[at + 7] == "</voxels>" and corners[:3] == [0, 0, 0] and min(corners[3:]) > 0, f"{conf.name}: {words[at:at + 8]}")
                box = np.array(corners[3:]) * 1e3
                at += 8
            else:
                need(word in keys and word not in values, f"{conf.name}: unknown or repeated key {word}")
                values[word] = words[at + 1]
                at += 2
        need(values["scale_from_stu"] == "1" and 1e-10 < float(values["diffusivity"]) < 1e-8, f"{conf.name}: units {values}")
        lines = (folder / values["scheme_file"]).read_text().splitlines()[1:]
        need(float(values["duration"]) >= max(float(line.split()[6]) for line in lines) - 1e-12, f"{conf.name}: ends before the echo")
        need(int(values["T"]) >= 100 and 1 <= int(values["num_process"]), f"{conf.name}: steps")
        rows = [numbers(line, 3, f"{values['ini_walkers_file']}:{i}") for i, line in enumerate((folder / values["ini_walkers_file"]).read_text().splitlines(), 1)]
        here = np.array(rows) * 1e3
        need(int(values["N"]) <= len(here) and (here > 0).all() and (here < box).all(), f"{values['ini_walkers_file']}: not strictly inside of the voxel")
        if where == "intra":
            points = here
        for name in listed:
            if name not in files:
                files[name] = text_ply(folder / name)
    return scheme(folder / "protocol.scheme", 267.51525e6), box, files, points


def camino(folder):
    """run.sh with its mesh in metres, whose bounds are -meshsep; returns b and the box in um."""
    command = next(line for line in (folder / "run.sh").read_text().splitlines() if line.startswith("datasynth "))
    words = shlex.split(command.split(">")[0])[1:]
    count = {"-meshsep": 3}
    options, at = {}, 0
    while at < len(words):
        need(words[at].startswith("-"), f"run.sh: {words[at]}")
        n = count.get(words[at], 1)
        options[words[at]] = words[at + 1:at + 1 + n]
        at += 1 + n
    known = {"-walkers", "-tmax", "-p", "-geometry", "-plyfile", "-meshsep", "-initial", "-diffusivity", "-schemefile", "-voxels", "-seed"}
    need(set(options) == known, f"run.sh: options {sorted(set(options) ^ known)}")
    need(options["-geometry"] == ["ply"] and options["-initial"][0] in ("uniform", "intra", "extra") and 1e-10 < float(options["-diffusivity"][0]) < 1e-8, f"run.sh: {options}")
    vertex, face = text_ply(folder / options["-plyfile"][0])
    side = np.array(options["-meshsep"], float)
    need(np.abs(np.ptp(vertex, axis=0) - side).max() < 1e-12 and np.abs(vertex.min(axis=0)).max() < 1e-15, "run.sh: the bounds of the mesh are not -meshsep")
    need(side.max() < 1e-2, "run.sh: lengths in metres")
    return scheme(folder / options["-schemefile"][0], 267.5987e6), side * 1e6, len(face)


def rms(folder):
    """Label volume, x slowest, and the files of its parameters; returns the shares of the labels and the box in um."""
    setting = [numbers(line, 1, "simParamInput.txt")[0] for line in (folder / "simParamInput.txt").read_text().split("\n")[:-1]]
    need(len(setting) == 9, f"simParamInput.txt: expected 9 lines, got {len(setting)}")
    step, steps, walkers, directions, labels, voxel, *shape = setting
    need(all(v == int(v) and v > 0 for v in (steps, walkers, directions, labels, *shape)) and directions <= 2000 and labels <= 3, f"simParamInput.txt: {setting}")
    need(np.sqrt(6 * 2 * step) < voxel, "simParamInput.txt: a step is longer than a voxel")
    fibre = (folder / "fiber.txt").read_text().split()
    need(len(fibre) == int(np.prod(shape)) and set(fibre) <= {str(i) for i in range(int(labels) + 1)}, "fiber.txt: count or labels")
    for name in ("diffusivity.txt", "T2.txt"):
        values = [numbers(line, 1, name)[0] for line in (folder / name).read_text().splitlines()]
        need(len(values) == labels and min(values) > 0, f"{name}: {values}")
    b = np.array([numbers(line, 1, "bval.txt")[0] for line in (folder / "bval.txt").read_text().splitlines()])
    vector = np.array([numbers(line, 1, "bvec.txt")[0] for line in (folder / "bvec.txt").read_text().splitlines()])
    need(len(b) == directions and len(vector) == 3 * directions and np.abs(np.linalg.norm(vector.reshape(-1, 3), axis=1) - 1).max() < 1e-5, "bval.txt, bvec.txt: counts or lengths")
    return {int(label): fibre.count(label) / len(fibre) for label in set(fibre)}, np.array(shape) * voxel, b


def tetgen(folder, stem):
    """A .node and a .poly of TetGen's manual; returns points and triangles."""
    lines = [line.split("#")[0] for line in (folder / f"{stem}.node").read_text().splitlines()]
    lines = [line for line in lines if line.strip()]
    count, dimension, attributes, markers = (int(v) for v in numbers(lines[0], 4, f"{stem}.node:1"))
    need((dimension, attributes, markers) == (3, 0, 0) and len(lines) == count + 1, f"{stem}.node: {lines[0]}, {len(lines) - 1} rows")
    rows = np.array([numbers(line, 4, f"{stem}.node") for line in lines[1:]])
    first = int(rows[0, 0])
    need(first in (0, 1) and (rows[:, 0] == np.arange(first, first + count)).all(), f"{stem}.node: numbers")
    words = iter(" ".join(line.split("#")[0] for line in (folder / f"{stem}.poly").read_text().splitlines()).split())
    take = lambda n: [int(next(words)) for _ in range(n)]
    try:
        need(take(4) == [0, 3, 0, 0], f"{stem}.poly: the points are in the .node file")
        facets, marks = take(2)
        need(marks == 0, f"{stem}.poly: markers")
        face = []
        for _ in range(facets):
            need(take(1) == [1], f"{stem}.poly: a facet of one polygon")
            need(take(1) == [3], f"{stem}.poly: a triangle")
            face.append(take(3))
        need(take(1) == [0], f"{stem}.poly: no holes")
        regions = [next(words, None)]
        need(regions == [None] or regions == ["0"], f"{stem}.poly: regions {regions}")
        need(next(words, None) is None, f"{stem}.poly: more than the format has")
    except StopIteration:
        raise Refused(f"{stem}.poly: ends early") from None
    face = np.array(face) - first
    need(face.min() >= 0 and face.max() < count, f"{stem}.poly: a point that is not there")
    edges = np.sort(np.concatenate([face[:, [0, 1]], face[:, [1, 2]], face[:, [2, 0]]]), axis=1)
    need((np.unique(edges, axis=0, return_counts=True)[1] == 2).all(), f"{stem}.poly: an edge that is not of two facets")
    return rows[:, 1:], face


def cactus(path):
    """A strand list as CACTUS' Python reads it: line by line, counts as whole numbers; at least 4 points for its mesher."""
    lines = path.read_text().splitlines()
    side, count = numbers(lines[0], 1, f"{path.name}:1")[0], lines[1].strip()
    need(re.fullmatch(r"\d+", count), f"{path.name}:2: {count}")
    strands, at = [], 2
    for strand in range(int(count)):
        need(at < len(lines) and re.fullmatch(r"\d+", lines[at].strip()), f"{path.name}:{at + 1}: the number of points of strand {strand}")
        points = int(lines[at])
        need(points >= 4 and at + points < len(lines) + 1, f"{path.name}:{at + 1}: {points} points")
        rows = np.array([numbers(line, 4, f"{path.name}:{at + 2 + i}") for i, line in enumerate(lines[at + 1:at + 1 + points])])
        need(len(rows) == points and (rows[:, 3] > 0).all(), f"{path.name}: strand {strand}")
        strands.append(rows)
        at += 1 + points
    need(at == len(lines), f"{path.name}:{at + 1}: more than the counts say")
    return side, strands


def caterpillar(folder, columns):
    """A sphere table with its growth_info; returns the voxel's sides and the spheres (x y z r)."""
    head = "cell_type cell_id component component_id parent_component_id X Y Z inner_radius outer_radius".split()
    if columns == 9:
        head.remove("parent_component_id")
    lines = (folder / "voxel.csv").read_text().splitlines()
    need(lines[0].split(" ") == head, f"voxel.csv:1: {lines[0]}")
    parts = {"axon": {"axon"}, "glial_cell": {"soma", "branch"}, "blood_vessel": {"blood_vessel", "branch"}}
    spheres, began, before = [], set(), None
    for number, line in enumerate(lines[1:], 2):
        row = dict(zip(head, line.split(" ")))
        need(len(line.split(" ")) == columns and row["component"] in parts.get(row["cell_type"], ()), f"voxel.csv:{number}: {line}")
        key = (row["cell_type"], int(row["cell_id"]))
        need(key in began or row["component"] != "branch", f"voxel.csv:{number}: a branch before its soma")
        need(key not in began or key == before, f"voxel.csv:{number}: the rows of a cell are apart")
        began.add(key)
        before = key
        x, y, z, inner, outer = numbers(" ".join(row[name] for name in ("X", "Y", "Z", "inner_radius", "outer_radius")), 5, f"voxel.csv:{number}")
        need(0 < inner <= outer, f"voxel.csv:{number}: radii {inner} {outer}")
        spheres.append((x, y, z, outer))
    info = {line.rsplit(" ", 1)[0]: line.rsplit(" ", 1)[1] for line in (folder / "voxel_growth_info.txt").read_text().splitlines()}
    return float(info["Voxel Size"]), np.array(spheres)


def manifest(folder):
    return json.loads((folder / "manifest.json").read_text())
