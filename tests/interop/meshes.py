#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The meshes before others: trimesh, meshio and PyVista find each cell closed, wound alike and of our volume; DiSimPy's loader
takes the box; a strict reading of MC/DC's rules finds nothing, and finds each defect planted in a copy.  meshes.py BIN"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import meshio
import numpy as np
import pyvista
import trimesh

bin_folder = pathlib.Path(sys.argv[1]).resolve()
recipe = pathlib.Path(__file__).resolve().parent.parent / "pipe/small.yaml"
failures, checks = [], 0


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)


def same_volume(a, b):
    return abs(a - b) <= 1e-5 * b


def closed_and_alike(mesh):
    return mesh.is_watertight and mesh.is_winding_consistent and mesh.is_volume


def planted(path, change):
    """A copy of an ASCII or binary PLY, written by trimesh after `change` of its faces."""
    mesh = trimesh.load(path, process=False)
    return trimesh.Trimesh(mesh.vertices, change(np.array(mesh.faces)), process=False)


def single_cells(work, document):
    with h5py.File(document) as file:
        cells, volumes, genus = (file[f"meshes/{name}"][...] for name in ("cell", "volume", "genus"))
        faces = np.diff(file["meshes/face_offset"][...])
    for row, cell in enumerate(cells):
        path = next((work / "ply").glob(f"*{cell:04d}*.ply"))
        mesh = trimesh.load(path, process=False)
        expect(closed_and_alike(mesh) and mesh.body_count == 1, f"trimesh: cell {cell}: one closed body, wound alike")
        expect(same_volume(mesh.volume, volumes[row]), f"trimesh: cell {cell}: volume {mesh.volume}, expected {volumes[row]}")
        expect(mesh.euler_number == 2 - 2 * genus[row], f"trimesh: cell {cell}: Euler number {mesh.euler_number}, genus {genus[row]}")
        expect(len(mesh.faces) == faces[row], f"trimesh: cell {cell}: {len(mesh.faces)} faces, expected {faces[row]}")
        read = meshio.read(path)
        again = trimesh.Trimesh(read.points, read.cells_dict["triangle"], process=False)
        expect(set(read.cells_dict) == {"triangle"} and closed_and_alike(again) and same_volume(again.volume, volumes[row]), f"meshio: cell {cell}: {again.volume}")
        for form in (path, next((work / "stl").glob(f"*{cell:04d}*.stl"))):
            seen = pyvista.read(form)
            if form.suffix == ".stl":
                seen = seen.clean(tolerance=0.0)
            expect(seen.is_all_triangles and seen.n_open_edges == 0 and seen.is_manifold, f"PyVista: {form.name}: {seen.n_open_edges} open edges")
            expect(same_volume(seen.volume, volumes[row]), f"PyVista: {form.name}: volume {seen.volume}, expected {volumes[row]}")
    # What these readers call sound, they do not call of every mesh.
    hole, turned = planted(path, lambda f: f[1:]), planted(path, lambda f: np.vstack([f[:1, ::-1], f[1:]]))
    expect(not hole.is_watertight and pyvista.wrap(hole).n_open_edges == 3, "a hole is seen")
    expect(not turned.is_winding_consistent, "a turned face is seen")
    return len(cells)


def disimpy_loads(work, box):
    import warnings

    warnings.simplefilter("ignore")
    if not hasattr(np, "product"):
        np.product = np.prod  # the release calls it by the name that NumPy 2 dropped
    from disimpy import substrates

    vertices, faces = np.load(work / "disimpy/vertices_m.npy"), np.load(work / "disimpy/faces.npy").astype(int)
    start = np.load(work / "disimpy/positions_intra_m.npy")
    loaded = substrates.mesh(vertices, faces, periodic=True, init_pos=start, n_sv=np.array([12] * 3), quiet=True)
    expect(np.allclose(loaded.voxel_size * 1e6, box, rtol=1e-12), f"DiSimPy: voxel of {loaded.voxel_size * 1e6} um, expected {box}")
    expect(np.array_equal(loaded.vertices, vertices), "DiSimPy: moves no vertex")
    expect(np.array_equal(np.unique(loaded.triangle_indices), np.arange(len(faces))), "DiSimPy: every triangle lies in a subvoxel")
    unpinned = substrates.mesh(vertices[np.unique(faces)] * 0.9, np.zeros((1, 3), int), periodic=True, n_sv=np.array([1] * 3), quiet=True)
    expect(not np.allclose(unpinned.voxel_size * 1e6, box, rtol=1e-3), "DiSimPy: another voxel would be seen")
    return len(faces)


# ---- MC/DC: what its reader takes, written down ----

header_words = {"vertex", "face", "nx", "end_header", "element"}
one_value = {"N", "T", "duration", "diffusivity", "exp_prefix", "scheme_file", "scale_from_stu", "write_txt", "write_bin", "write_traj_file", "ini_walkers_file", "num_process", "seed"}


def lint_ply(path):
    """Text PLY: header tokens, x y z alone, rows of `3 i j k`, nothing after; triangles that its collision test can use."""
    data = path.read_bytes()
    if not data.isascii():
        return "not ASCII"
    head, end, body = data.decode().partition("end_header\n")
    lines = head.splitlines()
    if not end or lines[:2] != ["ply", "format ascii 1.0"]:
        return "not a text PLY"
    if any(header_words & set(line.split()[1:]) for line in lines if line.startswith("comment")):
        return "a comment holds a word that the reader acts on"
    wanted = r"element vertex (\d+)\nproperty (?:float|double) x\nproperty (?:float|double) y\nproperty (?:float|double) z\nelement face (\d+)\nproperty list uchar u?int vertex_ind(?:ex|ices)$"
    match = re.fullmatch(wanted, "\n".join(line for line in lines[2:] if not line.startswith("comment")))
    if not match:
        return "elements or properties other than x y z and triangles"
    points, count = int(match[1]), int(match[2])
    tokens = body.split()
    if len(tokens) != 3 * points + 4 * count:
        return f"{len(tokens)} numbers, expected {3 * points + 4 * count}"
    try:
        vertex = np.array(tokens[: 3 * points], float).reshape(-1, 3)
        rows = np.array(tokens[3 * points :], np.int64).reshape(-1, 4)
    except ValueError:
        return "not a number"
    if not np.isfinite(vertex).all() or (rows[:, 0] != 3).any() or (rows[:, 1:] < 0).any() or (rows[:, 1:] >= points).any():
        return "a face that is no triangle of its points"
    a, b, c = (vertex[rows[:, k]] for k in (1, 2, 3))
    edges = np.stack([np.linalg.norm(b - a, axis=1), np.linalg.norm(c - b, axis=1), np.linalg.norm(a - c, axis=1)])
    if count and (edges.min() < 1e-4 or np.linalg.norm(np.cross(b - a, c - a), axis=1).min() < 1e-8):  # 0.1 nm; 1e-14 mm2
        return "a triangle that its collision test cannot use"
    return None


def lint_conf(path):
    """Keys spelt exactly (its own reader guesses), tags closed, one scale per PLY, a voxel, walkers strictly inside, <END> last."""
    lines = path.read_text().splitlines()
    if not lines or lines[-1] != "<END>":
        return "does not end with <END>"
    values, plies, inside, voxel = {}, [], None, []
    for line in lines[:-1]:
        words = line.split()
        if inside is None and re.fullmatch(r"<(obstacle|voxels)>", line):
            inside, expected = line[1:-1], ["ply", "ply_scale"]
        elif inside is not None and line == f"</{inside}>":
            if inside == "obstacle" and expected:
                return f"an obstacle without {expected[0]}"
            inside = None
        elif inside == "obstacle":
            if not expected or words[0] != expected.pop(0) or len(words) != 2:
                return f"in an obstacle: {line}"
            if words[0] == "ply":
                plies.append(words[1])
            elif float(words[1]) != 0.001:
                return "um need ply_scale 0.001"
        elif inside == "voxels":
            voxel.append([float(w) for w in words])
        elif len(words) != 2 or words[0] not in one_value or words[0] in values:
            return f"unknown or repeated key: {line}"
        else:
            values[words[0]] = words[1]
    if inside or set(values) != one_value or not plies:
        return "an open tag, or a key that is missing"
    if len(voxel) != 2 or not (np.array(voxel[0]) < voxel[1]).all():
        return "no voxel"
    start = np.loadtxt(path.parent / values["ini_walkers_file"], ndmin=2)
    if start.shape[1] != 3 or not ((start > voxel[0]) & (start < voxel[1])).all():
        return "walkers on or outside of the voxel"
    scheme = (path.parent / values["scheme_file"]).read_text().splitlines()
    if scheme[0] != "VERSION: STEJSKALTANNER" or any(len(row.split()) != 7 for row in scheme[1:]):
        return "not a scheme of 7 columns"
    if abs(float(values["T"]) * 1e-6 - float(values["duration"])) > 1e-9:
        return "steps of another length than 1 us"
    return next((f"{ply}: {flaw}" for ply in plies for flaw in [lint_ply(path.parent / ply)] if flaw), None)


def swap(text, old, new, count=1):
    assert old in text, old
    return text.replace(old, new, count)


def drop_last(text):
    return text.rstrip("\n").rsplit("\n", 1)[0] + "\n"


plants_ply = {
    "binary": lambda t: swap(t, "format ascii 1.0", "format binary_little_endian 1.0"),
    "normals": lambda t: swap(t, "property double z\n", "property double z\nproperty double nx\n"),
    "colours": lambda t: swap(t, "property double z\n", "property double z\nproperty uchar red\n"),
    "comment": lambda t: swap(t, "format ascii 1.0\n", "format ascii 1.0\ncomment one vertex each\n"),
    "quad": lambda t: drop_last(t) + "4 0 1 2 3\n",
    "index": lambda t: drop_last(t) + "3 0 1 99999999\n",
    "flat face": lambda t: drop_last(t) + "3 0 1 1\n",
    "lost row": drop_last,
    "trailing": lambda t: t + "7\n",
    "word": lambda t: drop_last(t) + "3 0 1 x\n",
}
plants_conf = {
    "no end": lambda t: swap(t, "<END>", ""),
    "open tag": lambda t: swap(t, "</obstacle>\n", ""),
    "no scale": lambda t: swap(t, "ply_scale 0.001\n", ""),
    "scale": lambda t: swap(t, "ply_scale 0.001", "ply_scale 0.01"),
    "misspelt": lambda t: swap(t, "ini_walkers_file", "ini_walker_file"),
    "twice": lambda t: swap(t, "seed ", "seed 1\nseed "),
    "voxel": lambda t: swap(t, "<voxels>\n0.0 0.0 0.0", "<voxels>\n0.005 0.005 0.005"),
    "steps": lambda t: re.sub(r"\nT (\d+)", r"\nT 1\1", t, count=1),
    "file": lambda t: swap(t, "ply_scale 0.001\n</obstacle>", "ply_scale 0.001\n</obstacle>\n<obstacle>\nply bad.ply\nply_scale 0.001\n</obstacle>"),
}


def conf_names(path):
    return {line.split()[1] for line in path.read_text().splitlines() if line.startswith("ply ")}


def mcdc_rules(work):
    folder, copy = work / "mcdc", work / "planted"
    for conf in ("intra.conf", "extra.conf"):
        flaw = lint_conf(folder / conf)
        expect(flaw is None, f"MC/DC: {conf}: {flaw}")
    flaw = lint_ply(folder / "all_cells.ply")
    expect(flaw is None, f"MC/DC: all_cells.ply: {flaw}")
    shutil.copytree(folder, copy)
    cell = next(path for path in copy.glob("*.ply") if path.name in conf_names(copy / "intra.conf"))
    text, conf = cell.read_text(), (copy / "intra.conf").read_text()
    (copy / "bad.ply").write_text(drop_last(text))
    for name, change in plants_conf.items():
        (copy / "intra.conf").write_text(change(conf))
        expect(lint_conf(copy / "intra.conf") is not None, f"MC/DC: a configuration with a defect passes: {name}")
    for name, change in plants_ply.items():
        cell.write_text(change(text))
        expect(lint_ply(cell) is not None, f"MC/DC: a PLY with a defect passes: {name}")
    return len(list(folder.glob("*.ply")))


def main(work):
    document = work / "cube.cgx"
    subprocess.run([bin_folder / "conceg", "run", recipe, "--until", "mesh", "--set", "mesh.h_um=0.5", "-q", "-o", document], check=True)
    for form in ("ply", "stl", "vtk", "mcdc", "disimpy"):
        subprocess.run([bin_folder / "conceg-export", document, "--to", form, "--dir", work, "--walkers", "200", "-q"], check=True)
    with h5py.File(document) as file:
        box = file["domain"].attrs["hi"] - file["domain"].attrs["lo"]
        total = file["meshes/volume"][...].sum()
    cells = single_cells(work, document)
    together = [pyvista.read(path) for path in sorted((work / "vtk").rglob("*.vtp"))]
    meshes = [mesh for mesh in together if mesh.n_cells and mesh.is_all_triangles]
    expect(meshes and same_volume(sum(mesh.volume for mesh in meshes), total), f"PyVista: volume of the .vtp {sum(m.volume for m in meshes)}, expected {total}")
    faces = disimpy_loads(work, box)
    files = mcdc_rules(work)
    print(f"meshes before others: {cells} cells by trimesh, meshio and PyVista, {faces} triangles by DiSimPy's loader, {files} PLY files by MC/DC's rules")


os.environ.setdefault("NUMBA_DISABLE_CUDA", "1")
with tempfile.TemporaryDirectory() as folder:
    main(pathlib.Path(folder))
for line in failures:
    print("FAILED:", line)
print(f"{checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
