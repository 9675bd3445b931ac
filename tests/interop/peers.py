#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files that export wrote, before programs that read them: trimesh, meshio, nibabel, MorphIO, NumPy. Volumes, areas, places and counts
must be those of the manifest.  peers.py BIN [DOCUMENT]"""
import json
import pathlib
import subprocess
import sys
import tempfile

import meshio
import morphio
import nibabel
import numpy as np
import trimesh

bin_folder = pathlib.Path(sys.argv[1]).resolve()
recipe = pathlib.Path(__file__).resolve().parent.parent / "pipe/small.yaml"
failures, checks, by = [], 0, {}


def expect(good, form, whom, what):
    global checks
    checks += 1
    by.setdefault(form, set()).add(whom)
    if not good:
        failures.append(f"{form}: {whom}: {what}")


def near(a, b, share):
    return bool(np.allclose(a, b, rtol=share, atol=share))


def main(work):
    document = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else work / "cube.cgx"
    if not document.exists():
        subprocess.run([bin_folder / "conceg", "run", recipe, "--until", "mesh", "--set", "mesh.h_um=0.6", "-q", "-o", document], check=True)
    for form in "ply swc mcdc disimpy camino dmipy-sim mcmr stl obj gltf nifti h5v1 spindoctor".split():
        subprocess.run([bin_folder / "conceg-export", document, "--to", form, "--dir", work, "--walkers", "200", "-q"], check=True)
    manifest = {p.parent.name: json.loads(p.read_text()) for p in work.glob("*/manifest.json")}
    lo, hi = np.array(manifest["ply"]["box_lo_um"]), np.array(manifest["ply"]["box_hi_um"])
    volume = {c["cell"]: c["volume_um3"] for c in manifest["ply"]["cells"]}
    for form, whom in (("ply", "trimesh"), ("stl", "trimesh"), ("mcmr", "trimesh"), ("spindoctor", "trimesh"), ("ply", "meshio"), ("mcmr", "meshio")):
        for cell in manifest[form]["cells"]:
            path = work / form / next(f for f in cell["files"] if f.endswith((".ply", ".stl")))
            if whom == "trimesh":
                mesh = trimesh.load(path, process=path.suffix == ".stl")
            else:
                read = meshio.read(path)
                mesh = trimesh.Trimesh(read.points, read.cells_dict["triangle"], process=False)
            expect(near(mesh.volume, volume[cell["cell"]], 1e-4), form, whom, f"volume {mesh.volume}, expected {volume[cell['cell']]}")
            if path.suffix == ".ply":
                expect(mesh.is_watertight and mesh.is_winding_consistent, form, whom, "closed and wound alike")
    joined = trimesh.load(work / "obj/cells.obj", process=False, force="mesh")
    expect(near(joined.volume, sum(volume.values()), 1e-6), "obj", "trimesh", f"volume {joined.volume}")
    scene = trimesh.load(work / "gltf/cells.glb")
    turned = scene.to_geometry() if hasattr(scene, "to_geometry") else scene.dump(concatenate=True)
    expect(near(turned.volume, sum(volume.values()), 1e-4), "gltf", "trimesh", f"volume {turned.volume}")
    expect(near(turned.bounds, [[joined.bounds[0][0], joined.bounds[0][2], -joined.bounds[1][1]], [joined.bounds[1][0], joined.bounds[1][2], -joined.bounds[0][1]]], 1e-3), "gltf", "trimesh", "+z is up")

    # Cut surfaces fill the box and its bounds are the box.
    vertices, faces = np.load(work / "disimpy/vertices_m.npy"), np.load(work / "disimpy/faces.npy")
    expect(near(np.ptp(vertices, axis=0) * 1e6, hi - lo, 1e-12) and near(vertices.min(axis=0), 0, 1e-18), "disimpy", "NumPy", "the bounds are the box in metres")
    expect(vertices.dtype == np.float64 and faces.max() < len(vertices) - 2, "disimpy", "NumPy", "types, and two corners that no face uses")
    inside = np.load(work / "disimpy/positions_intra_m.npy")
    expect(inside.shape == (200, 3) and (inside > 0).all() and (inside < (hi - lo) * 1e-6).all(), "disimpy", "NumPy", "starting points lie in the box")
    # The first face that a ray from an intracellular point meets is left from inside: its normal points along.
    tiled, ray = trimesh.load(work / "mcdc/all_cells.ply", process=False), np.array([0.8, 0.6, 0.0])
    a, b, c = (tiled.triangles[:, k] for k in range(3))
    across = np.cross(ray, c - a)
    det = np.einsum("ij,ij->i", b - a, across)
    left = []
    for point in np.loadtxt(work / "mcdc/walkers_intra_mm.txt")[:40] * 1e3:
        with np.errstate(all="ignore"):
            u = np.einsum("ij,ij->i", point - a, across) / det
            q = np.cross(point - a, b - a)
            v, t = q @ ray / det, np.einsum("ij,ij->i", q, c - a) / det
            hit = np.flatnonzero(np.isfinite(t) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0))
        if len(hit):
            left.append(tiled.face_normals[hit[np.argmin(t[hit])]] @ ray > 0)
    expect(len(left) > 20 and all(left), "mcdc", "trimesh", f"{sum(left)} of {len(left)} rays leave their cell through the first face")
    camino = meshio.read(work / "camino/mesh.ply")
    expect(near(np.ptp(camino.points, axis=0) * 1e6, hi - lo, 1e-6), "camino", "meshio", "the bounds are the box in metres")
    dmipy = trimesh.load(work / "dmipy-sim/mesh.ply", process=False)
    expect((dmipy.bounds[0] >= -1e-9).all() and (dmipy.bounds[1] <= hi - lo + 1e-9).all(), "dmipy-sim", "trimesh", "within the box")

    fraction = {}
    for name in ("labels", "fraction"):
        image = nibabel.load(work / f"nifti/{name}.nii")
        data = np.asanyarray(image.dataobj)
        corner = image.affine @ [-0.5, -0.5, -0.5, 1]
        expect(near(corner[:3] * 1e3, lo, 1e-3) and near(np.array(data.shape) * image.header.get_zooms() * 1e3, hi - lo, 1e-3), "nifti", "nibabel", f"{name}: place {corner}")
        fraction[name] = (data > 0).mean() if name == "labels" else data.mean()
    expect(abs(fraction["labels"] - fraction["fraction"]) < 0.01, "nifti", "nibabel", f"fractions of cells {fraction}")

    for cell in manifest["h5v1"]["cells"]:
        swc = morphio.Morphology(str(work / "swc" / next(f for f in manifest["swc"]["cells"][cell["cell"]]["files"])), morphio.Option.allow_unifurcated_section_change)
        h5 = morphio.Morphology(str(work / "h5v1" / cell["files"][0]))
        own = {tuple(np.float32([*p, d])) for s in swc.iter() for p, d in zip(s.points, s.diameters)}
        other = {tuple(np.float32([*p, d])) for s in h5.iter() for p, d in zip(s.points, s.diameters)}
        expect(near(sorted(own), sorted(other)[: len(own)] if len(own) == len(other) else [[np.inf] * 4] * len(own), 1e-4), "h5v1", "MorphIO", f"{len(own)} and {len(other)} points")
        expect(near(h5.soma.center, cell["soma_um"], 1e-4), "h5v1", "MorphIO", f"soma at {h5.soma.center}")


with tempfile.TemporaryDirectory() as folder:
    main(pathlib.Path(folder))
for line in failures:
    print("FAILED:", line)
for form in sorted(by):
    print(f"read by others: {form}: {', '.join(sorted(by[form]))}")
print(f"exported files before others: {checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
