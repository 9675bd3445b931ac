#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The meshes before others: trimesh, meshio and PyVista find each cell closed, wound alike and of our volume; tiles, cut forms and the
surface of the extracellular space are closed, of the volume they must have, and bit for bit alike on opposite sides; levels of detail keep the
volume; DiSimPy's loader takes the box; MC/DC's rules (mcdc_linter.py) and the least triangle it can use hold, and defects planted in a copy are seen.  meshes.py BIN"""
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import linter_text
import mcdc_linter
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
        cells = cells[file["meshes/lod"][...] == 0]
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


def rim(mesh, axis, value):
    """Edges of one face in a side, by their ends' other two coordinates, bit for bit."""
    edges = np.sort(mesh.edges, axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    ends = mesh.vertices[unique[count == 1]]
    ends = np.delete(ends[(ends[:, :, axis] == value).all(axis=1)], axis, axis=2)
    return sorted(tuple(sorted(map(tuple, edge))) for edge in ends.tolist())


def side(mesh, axis, value):
    """Triangles that lie in a side, likewise."""
    corners = mesh.triangles[(mesh.triangles[:, :, axis] == value).all(axis=1)]
    return sorted(tuple(sorted(map(tuple, t))) for t in np.delete(corners, axis, axis=2).tolist())


def alike(mesh, box, of):
    pairs = [(of(mesh, axis, 0.0), of(mesh, axis, box[axis])) for axis in range(3)]
    return all(low == high and low for low, high in pairs)


def forms(export, work, document, box, icvf, cells):
    """Tiles and cut forms, of all cells in one file; volumes against /meshes@icvf."""
    tiles = (2, 1, 2)
    tiled_box, count = box * tiles, int(np.prod(tiles))

    def read(name, *words):
        export(document, "--to", "ply", "--dir", work / name, *words)
        path = work / name / "ply" / ("extracellular.ply" if "extracellular" in words else "all_cells.ply")
        return trimesh.load(path, process=False)

    grid = ("--tiles", "x".join(map(str, tiles)))
    closed, many = read("closed"), read("many", *grid)
    expect(closed_and_alike(many) and same_volume(many.volume, count * closed.volume), f"tiles: volume {many.volume}, expected {count} x {closed.volume}")
    expect(many.body_count == count * cells, f"tiles: {many.body_count} bodies, expected {count} x {cells}")
    expect(np.array_equal(np.unique(many.vertices[:, 1]), np.unique(closed.vertices[:, 1])), "tiles: no point moves where there is one")
    capped, capped_many = read("capped", "--form", "capped"), read("capped_many", "--form", "capped", *grid)
    for name, mesh, number, sides in (("capped", capped, 1, box), ("tiled capped", capped_many, count, tiled_box)):
        expect(closed_and_alike(mesh) and same_volume(mesh.volume, number * icvf * box.prod()), f"{name}: volume {mesh.volume / box.prod()} boxes, icvf {icvf}")
        expect(np.array_equal(mesh.bounds, [np.zeros(3), sides]), f"{name}: in {mesh.bounds}")
        expect(alike(mesh, sides, side), f"{name}: lids on opposite sides are the same bit for bit")
    expect(len(capped_many.faces) < count * len(capped.faces), "tiled capped: no lids between tiles")
    opened = read("opened", "--form", "open", *grid)
    expect(alike(opened, tiled_box, rim), "tiled open: rims on opposite sides are the same bit for bit")
    expect(not rim(opened, 0, box[0]), "tiled open: nothing is cut between tiles")
    faces = []
    for name, words, number, sides in (("extracellular", (), 1, box), ("tiled extracellular", grid, count, tiled_box)):
        mesh = read(name, "--form", "extracellular", *words)
        expect(closed_and_alike(mesh) and same_volume(mesh.volume, number * (1 - icvf) * box.prod()), f"{name}: volume {mesh.volume / box.prod()} boxes, 1 - icvf {1 - icvf}")
        expect(np.array_equal(mesh.bounds, [np.zeros(3), sides]), f"{name}: in {mesh.bounds}")
        expect(alike(mesh, sides, side), f"{name}: opposite sides are the same bit for bit")
        lids = capped if number == 1 else capped_many
        areas = [trimesh.triangles.area(m.triangles[(m.triangles[:, :, 0] == 0).all(axis=1)]).sum() for m in (mesh, lids)]
        expect(same_volume(sum(areas), sides[1] * sides[2]), f"{name}: it and the cells' lids cover a side: {areas}, {sides[1] * sides[2]}")
        faces.append(len(mesh.faces))
    # The other formats hold the same surface.
    for form, file in (("stl", "extracellular.stl"), ("obj", "extracellular.obj"), ("gltf", "extracellular.glb")):
        export(document, "--to", form, "--form", "extracellular", "--dir", work / "other")
        mesh = trimesh.load(work / "other" / form / file, force="mesh")
        expect(len(mesh.faces) == faces[0] and same_volume(mesh.volume, (1 - icvf) * box.prod()), f"{file}: {len(mesh.faces)} faces, volume {mesh.volume}")
    export(document, "--to", "vtk", "--form", "extracellular", "--dir", work / "other")
    seen = pyvista.read(work / "other/vtk/extracellular.vtp")
    expect(seen.n_open_edges == 0 and same_volume(seen.volume, (1 - icvf) * box.prod()), f"extracellular.vtp: {seen.n_open_edges} open edges, volume {seen.volume}")
    labels = set(np.unique(seen.cell_data["compartment"]).tolist())
    expect({0, 1} <= labels <= {0, 1, 2, 3, 4, 7}, f"extracellular.vtp: compartments {labels}")
    return faces


def levels(export, work, document, total):
    """Coarser levels: closed, of the same volume, lighter."""
    faces = []
    for level in (0, 1, 2):
        export(document, "--to", "ply", "--level", level, "--dir", work / f"level{level}")
        meshes = [trimesh.load(path, process=False) for path in sorted((work / f"level{level}/ply").glob("cell*.ply"))]
        expect(all(closed_and_alike(m) and m.body_count == 1 for m in meshes), f"level {level}: closed bodies, wound alike")
        volume = sum(m.volume for m in meshes)
        expect(abs(volume - total) < 1e-4 * total, f"level {level}: volume {volume}, expected {total}")
        faces.append(sum(len(m.faces) for m in meshes))
    expect(faces[1] < 0.7 * faces[0] and faces[2] < 0.25 * faces[0], f"levels: {faces} faces")
    return faces


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

def mcdc_rules(work):
    """What mcdc_linter.py asks of its files, that its collision test can use the triangles, and that defects are seen."""
    few, all_triangles = mcdc_linter.irregular(mcdc_linter.lint(work / "mcdc")[2])
    expect(few <= 1e-4 * all_triangles, f"MC/DC: {few} of {all_triangles} triangles are highly irregular")
    print(f"MC/DC would warn about {few} of {all_triangles} triangles")
    files = sorted((work / "mcdc").glob("*.ply"))
    for path in files:
        vertex, face = linter_text.ply(path)
        a, b, c = (vertex[face[:, k]] for k in range(3))
        shortest = min(np.linalg.norm(b - a, axis=1).min(), np.linalg.norm(c - b, axis=1).min(), np.linalg.norm(a - c, axis=1).min())
        least = np.linalg.norm(np.cross(b - a, c - a), axis=1).min()
        expect(shortest > 1e-4 and least > 1e-8, f"MC/DC: {path.name}: edges of {shortest} um, determinants of {least} um2")  # 0.1 nm, 1e-14 mm2
    text, copy = files[-1].read_text(), work / "planted.ply"
    for name, change in plants_ply.items():
        copy.write_text(change(text))
        try:
            linter_text.ply(copy)
            expect(False, f"MC/DC: a PLY with a defect passes: {name}")
        except ValueError:
            expect(True, name)
    return len(files)


def main(work):
    document = work / "cube.cgx"
    subprocess.run([bin_folder / "conceg", "run", recipe, "--until", "mesh", "--set", "mesh.h_um=0.5", "--set", "mesh.levels=2", "-q", "-o", document], check=True)

    def export(*words):
        subprocess.run([bin_folder / "conceg-export", *map(str, words), "-q"], check=True)

    for form in ("ply", "stl", "vtk", "mcdc", "disimpy"):
        export(document, "--to", form, "--dir", work, "--walkers", "200")
    with h5py.File(document) as file:
        icvf = file["meshes"].attrs["icvf"]
        box = file["domain"].attrs["hi"] - file["domain"].attrs["lo"]
        total = file["meshes/volume"][...][file["meshes/lod"][...] == 0].sum()
    cells = single_cells(work, document)
    together = [pyvista.read(path) for path in sorted((work / "vtk").rglob("*.vtp"))]
    meshes = [mesh for mesh in together if mesh.n_cells and mesh.is_all_triangles]
    expect(meshes and same_volume(sum(mesh.volume for mesh in meshes), total), f"PyVista: volume of the .vtp {sum(m.volume for m in meshes)}, expected {total}")
    space = forms(export, work, document, box, icvf, cells)
    lighter = levels(export, work, document, total)
    faces = disimpy_loads(work, box)
    files = mcdc_rules(work)
    print(f"meshes before others: {cells} cells by trimesh, meshio and PyVista, {faces} triangles by DiSimPy's loader, {files} PLY files by MC/DC's rules; extracellular surfaces of {space[0]} and, of four tiles, {space[1]} triangles; levels of detail of {lighter} triangles")


os.environ.setdefault("NUMBA_DISABLE_CUDA", "1")
with tempfile.TemporaryDirectory() as folder:
    main(pathlib.Path(folder))
for line in failures:
    print("FAILED:", line)
print(f"{checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
