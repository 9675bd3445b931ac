#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files that export wrote, before programs that read them (trimesh, meshio, PyVista, nibabel, MorphIO, NeuroM, navis, NumPy) and before strict
readers of the formats that no program on PyPI reads (linters.py). Volumes, areas, places and counts must be those of the manifest, and the
column "checked by" of spec/interop.md must name who did.  peers.py BIN [DOCUMENT]"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import meshio
import morphio
import nibabel
import navis
import neurom
import numpy as np
import pyvista
import trimesh

import linters
import union

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


def labelled(work):
    """Share of the voxels of the label image that are of a cell."""
    return float((np.asanyarray(nibabel.load(work / "nifti/labels.nii").dataobj) > 0).mean())


def drawn(work, manifest):
    """VTK files in PyVista."""
    surfaces = pyvista.read(work / "vtk/surfaces.vtm").combine().extract_surface(algorithm="dataset_surface")
    expect(near(surfaces.volume, manifest["vtk"]["volume_um3"], 1e-5), "vtk", "PyVista", f"volume {surfaces.volume}")
    lines = pyvista.read(work / "vtk/skeletons.vtp")
    somas = sum(cell["soma_radius_um"] > 0 for cell in manifest["vtk"]["cells"])
    expect(lines.n_lines > somas and lines.n_verts == somas and (lines.point_data["radius"] > 0).all(), "vtk", "PyVista", f"{lines.n_lines} lines, {lines.n_verts} somas")
    volume = pyvista.read(work / "vtk/volume.vti")
    label = next(volume[name] for name in volume.array_names if "label" in name)
    expect(abs((label > 0).mean() - labelled(work)) < 1e-9, "vtk", "PyVista", f"labelled {(label > 0).mean()}, {labelled(work)}")
    for cell in manifest["ply"]["cells"]:
        mesh = pyvista.read(work / "ply" / cell["files"][0])
        expect(near(mesh.volume, cell["volume_um3"], 1e-4) and near(mesh.area, cell["area_um2"], 1e-4), "ply", "PyVista", f"volume {mesh.volume}")


def measured(work, manifest):
    """Cells in navis and NeuroM: SWC and h5v1 hold the same cable, that of the file's own rows."""
    for cell in manifest["swc"]["cells"]:
        swc, h5 = work / "swc" / cell["files"][0], work / "h5v1" / manifest["h5v1"]["cells"][cell["cell"]]["files"][0]
        rows = {int(w[0]): (np.array(w[2:5], float), int(w[6]), int(w[1])) for w in (line.split() for line in swc.read_text().splitlines() if not line.startswith("#"))}
        cable = sum(np.linalg.norm(at - rows[parent][0]) for at, parent, _ in rows.values() if parent > 0)
        read = navis.read_swc(str(swc))
        expect(read.n_nodes == len(rows) and near(read.cable_length, cable, 1e-4), "swc", "navis", f"{read.n_nodes} nodes, {read.cable_length} of {cable} um")
        # Branches alone: what joins them to the soma is of no neurite.
        neurites = sum(np.linalg.norm(at - rows[parent][0]) for at, parent, kind in rows.values() if parent > 0 and rows[parent][2] != 1)
        for path, form in ((swc, "swc"), (h5, "h5v1")):
            length = neurom.get("total_length", neurom.load_morphology(str(path)))
            expect(near(length, neurites, 1e-3), form, "NeuroM", f"{length} of {neurites} um")


def linted(work, document, manifest):
    """Formats whose programs are not on PyPI; each linter also refuses a planted fault."""
    side = np.array(manifest["ply"]["box_hi_um"]) - manifest["ply"]["box_lo_um"]
    asked = np.repeat([0, 1, 2, 3, 5, 10, 15], [1] + [40] * 6)
    b, box, files, points = linters.mcdc(work / "mcdc")
    expect(near(b, asked, 1e-6) and near(box, side, 1e-9) and len(points) == 200 and len(files) == len(manifest["mcdc"]["cells"]), "mcdc", "linter", f"b {b[:3]}, box {box}")
    b, box, faces = linters.camino(work / "camino")
    expect(near(b, asked, 1e-6) and near(box, side, 1e-9) and faces > 1000, "camino", "linter", f"b {b[:3]}, box {box}")
    shares, box, b = linters.rms(work / "rms")
    labels = labelled(work)
    expect(near(box, side, 1e-6) and near(b, asked, 1e-6) and abs(shares[1] - labels) < 0.02, "rms", "linter", f"labels {shares}, of the label image {labels}, box {box}")
    for cell in manifest["spindoctor"]["cells"]:
        stem = next(f for f in cell["files"] if f.endswith(".node"))[:-5]
        volume = linters.volume_of(*linters.tetgen(work / "spindoctor", stem))
        expect(near(volume, cell["volume_um3"], 1e-6), "spindoctor", "linter", f"volume {volume}")
    for cell in manifest["mcmr"]["cells"]:
        volume = linters.volume_of(*linters.text_ply(work / "mcmr" / cell["files"][0]))
        expect(near(volume, cell["volume_um3"], 1e-6), "mcmr", "linter", f"volume {volume}")
    length, strands = linters.cactus(work / "cactus/strands.txt")
    listed = len((work / "cactus/strands.csv").read_text().splitlines()) - 1
    expect(length == side.max() and len(strands) == listed > 3, "cactus", "linter", f"side {length}, {len(strands)} strands of {listed}")
    for columns in (9, 10):
        subprocess.run([bin_folder / "conceg-export", document, "--to", "caterpillar", "--columns", str(columns), "--dir", work / f"c{columns}", "-q"], check=True)
        length, spheres = linters.caterpillar(work / f"c{columns}/caterpillar", columns)
        expect(length == side.max() and len(spheres) > 1000, "caterpillar", "linter", f"voxel {length}, {len(spheres)} spheres")
        subprocess.run([bin_folder / "conceg-import", "caterpillar", work / f"c{columns}/caterpillar/voxel.csv", "-q", "-o", work / "back.cgx"], check=True)
        scene = union.cones(document)
        alone, inside = union.share_that_differs(scene, union.spheres(spheres), side)
        round_trip, _ = union.share_that_differs(scene, union.cones(work / "back.cgx"), side)
        thinner, _ = union.share_that_differs(scene, (*scene[:2], 0.99 * scene[2], 0.99 * scene[3]), side)
        expect(alone < 0.005 and round_trip < 0.005 and inside > 5000, "caterpillar", "our importer", f"{alone:.4f} of the union differ as spheres, {round_trip:.4f} after the round")
        expect(thinner > 0.005, "caterpillar", "our importer", f"radii of 99 % look the same: {thinner:.4f}")
        print(f"caterpillar, {columns} columns: {100 * alone:.2f} % of the union volume differ as spheres, {100 * round_trip:.2f} % there and back, {100 * thinner:.2f} % with radii of 99 % ({inside} points)")
    plant(work)


def plant(work):
    """A fault in each format, which its linter must see."""
    node, poly = (next((work / "spindoctor").glob(f"*.{ending}")) for ending in ("node", "poly"))
    faults = (
        ("mcdc", work / "mcdc/intra.conf", "ply_scale 0.001", "ply_scale 1", lambda: linters.mcdc(work / "mcdc")),
        ("mcdc", work / "mcdc/protocol.scheme", "0.02 ", "0.001 ", lambda: linters.mcdc(work / "mcdc")),
        ("mcdc", work / "mcdc/walkers_intra_mm.txt", "0.0", "9.0", lambda: linters.mcdc(work / "mcdc")),
        ("camino", work / "camino/run.sh", "-meshsep 2", "-meshsep 3", lambda: linters.camino(work / "camino")),
        ("camino", work / "camino/mesh.ply", "comment ", "comment vertex ", lambda: linters.camino(work / "camino")),
        ("rms", work / "rms/fiber.txt", "1 ", "7 ", lambda: linters.rms(work / "rms")),
        ("spindoctor", poly, "\n3 ", "\n4 ", lambda: linters.tetgen(work / "spindoctor", poly.stem)),
        ("spindoctor", node, " 3 0 0", " 2 0 0", lambda: linters.tetgen(work / "spindoctor", node.stem)),
        ("cactus", work / "cactus/strands.txt", "\n4\n", "\n5\n", lambda: linters.cactus(work / "cactus/strands.txt")),
        ("caterpillar", work / "c9/caterpillar/voxel.csv", " soma ", " branch ", lambda: linters.caterpillar(work / "c9/caterpillar", 9)))
    for form, path, old, new, lint in faults:
        text = path.read_text()
        path.write_text(text.replace(old, new, 1))
        try:
            lint()
            expect(text == path.read_text(), form, "linter", f"a planted fault in {path.name} was not seen ({old} for {new})")
            expect(False, form, "linter", f"{path.name}: nothing was planted or seen")
        except (linters.Refused, ValueError, KeyError):
            expect(text != path.read_text(), form, "linter", f"{path.name} was refused before the fault")
        path.write_text(text)


def table():
    """spec/interop.md says of each format who read it here, and of nobody else that they did."""
    text = (pathlib.Path(__file__).resolve().parents[2] / "spec/interop.md").read_text().split("<!-- written -->")[1].split("## ")[0]
    rows = {cells[1].strip(): cells[-2] for cells in (line.split("|") for line in text.splitlines() if line.startswith("| ")) if cells[1].strip() != "format"}
    peers = {"trimesh", "meshio", "PyVista", "nibabel", "MorphIO", "NeuroM", "navis", "NumPy", "linter", "our importer"}
    wrong = []
    for form, checked in rows.items():
        said = {name for name in peers - {"our importer"} if re.search(rf"\b{name}\b", checked)}
        if said != by.get(form, set()) - {"our importer"}:
            wrong.append(f"{form}: the table says {sorted(said)}, here {sorted(by.get(form, set()))}")
    return wrong


def main(work):
    document = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else work / "cube.cgx"
    if not document.exists():
        subprocess.run([bin_folder / "conceg", "run", recipe, "--until", "mesh", "--set", "mesh.h_um=0.6", "-q", "-o", document], check=True)
    for form in "vtk ply swc cactus caterpillar rms mcdc disimpy camino dmipy-sim mcmr stl obj gltf nifti h5v1 spindoctor".split():
        subprocess.run([bin_folder / "conceg-export", document, "--to", form, "--dir", work, "--walkers", "200", "-q"], check=True)
    manifest = {p.parent.name: json.loads(p.read_text()) for p in work.glob("*/manifest.json")}
    linted(work, document, manifest)
    drawn(work, manifest)
    measured(work, manifest)
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
        rows = [line.split() for line in (work / "swc" / manifest["swc"]["cells"][cell["cell"]]["files"][0]).read_text().splitlines() if not line.startswith("#")]
        own = {tuple(np.float32([*p, d])) for s in swc.iter() for p, d in zip(s.points, s.diameters)}
        kept = {tuple(np.float32([*map(float, w[2:5]), 2 * float(w[5])])) for w in rows if w[1] != "1"}
        expect(len(kept - own) == 0, "swc", "MorphIO", f"{len(kept - own)} of {len(kept)} samples are not there")
        other = {tuple(np.float32([*p, d])) for s in h5.iter() for p, d in zip(s.points, s.diameters)}
        expect(near(sorted(own), sorted(other)[: len(own)] if len(own) == len(other) else [[np.inf] * 4] * len(own), 1e-4), "h5v1", "MorphIO", f"{len(own)} and {len(other)} points")
        expect(near(h5.soma.center, cell["soma_um"], 1e-4), "h5v1", "MorphIO", f"soma at {h5.soma.center}")


with tempfile.TemporaryDirectory() as folder:
    main(pathlib.Path(folder))
failures += table()
for line in failures:
    print("FAILED:", line)
for form in sorted(by):
    print(f"read by others: {form}: {', '.join(sorted(by[form]))}")
print(f"exported files before others: {checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
