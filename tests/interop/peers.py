#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files that export wrote, before programs that read them (trimesh, meshio, PyVista, nibabel, MorphIO, NeuroM, navis, NumPy) and before strict
readers of the formats that no program on PyPI reads (*_linter.py, each written from a description of its format without sight of the writer). Volumes, areas, places and counts must be those of the manifest, and checked_by.py must name who did.  peers.py BIN [DOCUMENT]"""
import itertools
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

import cactus_linter
import camino_linter
import caterpillar_linter
import checked_by
import linter_text
import mcdc_linter
import rms_linter
import script_linter
import spindoctor_linter
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
    """Formats whose programs are not on PyPI; each linter also refuses planted faults."""
    side = np.array(manifest["ply"]["box_hi_um"]) - manifest["ply"]["box_lo_um"]
    asked = np.repeat([0, 1, 2, 3, 5, 10, 15], [1] + [40] * 6)
    b, box, meshes, points = mcdc_linter.lint(work / "mcdc")
    expect(near(b, asked, 1e-6) and near(box, side, 1e-9) and all(len(points[where]) == 200 for where in ("intra", "extra")) and len(meshes) == len(manifest["mcdc"]["cells"]), "mcdc", "linter", f"b {b[:3]}, box {box}")
    b, box, _, face, initial = camino_linter.lint(work / "camino")
    expect(near(b, asked, 1e-6) and near(box, side, 1e-9) and len(face) > 1000 and initial == "uniform", "camino", "linter", f"b {b[:3]}, box {box}, {initial}")
    labels, seen = labelled(work), np.zeros(1)
    for where, share in (("intra", labels), ("extra", 1 - labels)):
        shares, box, b, volume = rms_linter.lint(work / "rms" / where)
        seen = seen + volume
        expect(near(box, side, 1e-6) and near(b, asked, 1e-6) and abs(shares[1] - share) < 0.02, "rms", "linter", f"{where}: labels {shares}, of the label image {labels}, box {box}")
    expect((seen == 1).all(), "rms", "linter", "every voxel has one water")
    for cell in manifest["spindoctor"]["cells"]:
        stem = next(f for f in cell["files"] if f.endswith(".node"))[:-5]
        volume = linter_text.volume_of(*spindoctor_linter.lint(work / "spindoctor", stem))
        expect(near(volume, cell["volume_um3"], 1e-6), "spindoctor", "linter", f"volume {volume}")
    meshes, repeats = script_linter.mcmr(work / "mcmr")
    expect(near(repeats, side, 1e-12), "mcmr", "linter", f"repeats {repeats}")
    for cell in manifest["mcmr"]["cells"]:
        volume = linter_text.volume_of(*meshes[cell["files"][0]])
        expect(near(volume, cell["volume_um3"], 1e-6), "mcmr", "linter", f"volume {volume}")
    _, face, box, radius, periodic = script_linter.dmipy_sim(work / "dmipy-sim")
    expect(periodic and near(box, side, 1e-9) and len(face) > 1000 and near(radius, manifest["dmipy-sim"]["feature_radius_um"], 1e-9), "dmipy-sim", "linter", f"box {box}, feature radius {radius}")
    b, _, _ = linter_text.scheme(work / "dmipy-sim/protocol.scheme", camino_linter.GAMMA)
    expect(near(b, asked, 1e-6), "dmipy-sim", "linter", f"b {b[:3]}")
    for where in ("intra", "extra"):
        kept = script_linter.disimpy(work / "disimpy", where)
        expect(near(kept["b"] * 1e-9, asked, 1e-9) and near(kept["side"] * 1e6, side, 1e-9) and kept["walkers"] == 200 and kept["periodic"] and (kept["pulse"], kept["separation"]) == (0.005, 0.02), "disimpy", "linter", f"{where}: b {kept['b'][:3]}, box {kept['side']}")
    strands(work, document, side)
    tables(work, document, side)
    plant(work)


def strands(work, document, side):
    """CACTUS lists before the linter: what fills the voxel is there, in strands as they are stored and at all their images."""
    length, listed = cactus_linter.lint(work / "cactus/strands.txt")
    rows = len((work / "cactus/strands.csv").read_text().splitlines()) - 1
    expect(length == side.max() and len(listed) == rows > 3, "cactus", "linter", f"side {length}, {len(listed)} strands of {rows}")
    scene = union.cones(document)
    pieces = [(a[:3] + side / 2, b[:3] + side / 2, a[3], b[3]) for strand in listed for a, b in zip(strand[:-1], strand[1:])]
    written = tuple(np.array(column) for column in zip(*pieces))
    share, inside = union.share_that_differs(union.images(scene, side), written, side)
    expect(share < 0.005 and inside > 5000, "cactus", "linter", f"{share:.4f} of the union volume differ")
    subprocess.run([bin_folder / "conceg-export", document, "--to", "cactus", "--whole=true", "--dir", work / "whole", "-q"], check=True)
    try:
        cactus_linter.lint(work / "whole/cactus/strands.txt")
        expect(False, "cactus", "linter", "strands out of reach of the voxel are not seen")
    except ValueError as seen:
        expect("meets the voxel" in str(seen), "cactus", "linter", f"strands as they are stored: {seen}")
    print(f"cactus: {len(listed)} strands, {100 * share:.2f} % of the union volume in the voxel differ ({inside} points)")


def tables(work, document, side):
    """CATERPillar tables of 9 and 10 columns before the linter; as spheres alone and read back they fill what the document does, as counted by points in the voxel."""
    scene = union.cones(document)
    thinner = (*scene[:2], 0.99 * scene[2], 0.99 * scene[3])
    for columns in (9, 10):
        for form, truth, other in ((f"c{columns}", union.images(scene, side), union.images(thinner, side)), (f"whole{columns}", scene, thinner)):
            folder = work / form / "caterpillar"
            subprocess.run([bin_folder / "conceg-export", document, "--to", "caterpillar", "--columns", str(columns), "--dir", work / form, "-q", f"--whole={'true' if 'whole' in form else 'false'}"], check=True)
            length, count = caterpillar_linter.lint(folder, columns)
            words = [line.split(" ") for line in (folder / "voxel.csv").read_text().splitlines()[1:]]
            spheres = np.array([word[-5:-2] + word[-1:] for word in words], float)
            axon = np.array([word[0] == "axon" for word in words])
            expect(length == side.max() and count == len(words) > 1000, "caterpillar", "linter", f"{form}: voxel {length}, {count} spheres")
            listed = [line.rsplit(",", 1) for line in (folder / "cells.csv").read_text().splitlines()[1:]]
            expect(sum(int(number) for _, number in listed) == count, "caterpillar", "linter", f"{form}: cells.csv lists other spheres")
            subprocess.run([bin_folder / "conceg-import", "caterpillar", folder / "voxel.csv", "-q", "-o", work / "back.cgx"], check=True)
            alone, inside = union.share_that_differs(truth, union.spheres(spheres), side)
            round_trip, _ = union.share_that_differs(truth, union.cones(work / "back.cgx"), side)
            fault, _ = union.share_that_differs(truth, other, side)
            expect(alone < 0.005 and round_trip < 0.005 and inside > 5000, "caterpillar", "our importer", f"{form}: {alone:.4f} of the union differ as spheres, {round_trip:.4f} after the round")
            expect(fault > 0.005, "caterpillar", "our importer", f"{form}: radii of 99 % look the same: {fault:.4f}")
            shares = {key: float(value) for key, value in (line.rsplit(" ", 1) for line in (folder / "voxel_growth_info.txt").read_text().splitlines())}
            for key, rows in (("Total icvf", spheres), ("Axon icvf", spheres[axon])):
                share = union.share(union.spheres(rows), side)
                expect(abs(shares[key] - share) < 4 * np.sqrt(share / 100000) + 1e-9, "caterpillar", "linter", f"{form}: {key} {shares[key]}, {share} by points")
            print(f"caterpillar, {form}: {100 * alone:.2f} % of the union volume differ as spheres, {100 * round_trip:.2f} % there and back, {100 * fault:.2f} % with radii of 99 % ({inside} points)")


def plant(work):
    """A fault in each format, which its linter must see."""
    stem = next((work / "spindoctor").glob("*.node")).stem
    surface = {ending: work / f"spindoctor/{stem}.{ending}" for ending in ("node", "poly", "stl")}
    doctor = lambda: spindoctor_linter.lint(work / "spindoctor", stem)  # noqa: E731
    cell = next(iter(sorted((work / "mcmr").glob("*.ply"))))
    listed = (work / "cactus/strands.txt").read_text().splitlines(keepends=True)
    rows = (work / "c9/caterpillar/voxel.csv").read_text().splitlines(keepends=True)
    # Rows in the middle of the longest branch, whose absence leaves a gap between spheres.
    branch = max((list(lines) for _, lines in itertools.groupby(rows, lambda row: row.split(" ")[:4])), key=len)
    gap = "".join(branch[len(branch) // 2:][:8])
    faults = (
        *(("mcdc", work / "mcdc" / name, old, new, lambda: mcdc_linter.lint(work / "mcdc")) for name, old, new in (
            ("intra.conf", "ply_scale 0.001", "ply_scale 1"), ("intra.conf", "<END>", "END"), ("intra.conf", "duration 0.026", "duration 26"), ("intra.conf", "num_process", "num_proces"),
            ("intra.conf", "walkers_intra", "walkers_extra"), ("extra.conf", "exp_prefix extra", "exp_prefix intra"), ("protocol.scheme", " 0.02 ", " 0.001 "), ("protocol.scheme", " 0.026", " 0.025"),
            ("walkers_intra_mm.txt", "0.0", "9.0"), (cell.name, "comment ", "comment nx "), (cell.name, "\n3 0 ", "\n3 1 "), (cell.name, "property double z\n", "property double z\nproperty uchar red\n"))),
        *(("disimpy", work / "disimpy" / name, old, new, lambda: script_linter.disimpy(work / "disimpy", "intra")) for name, old, new in (
            ("run.py", "periodic=True", "periodic=False"), ("run.py", "init_pos=start", "init_pos='intra'"), ("run.py", '"vertices_m.npy")', '"vertices_m.npy") * 1e6'), ("run.py", "pgse(0.005, 0.02", "pgse(5, 20"),
            ("run.py", "faces.npy\")", "faces.npy\")[:-1]"), ("run.py", "simulation(walkers", "simulation(walkers - 1"), ("protocol.txt", "0.99", "0.89"))),
        *(("camino", work / "camino" / name, old, new, lambda: camino_linter.lint(work / "camino")) for name, old, new in (
            ("run.sh", "-meshsep 2", "-meshsep 3"), ("run.sh", "-initial uniform", "-initial intra"), ("run.sh", "-plyfile", "-plyFile"), ("run.sh", " > signal.Bfloat", ""), ("mesh.ply", "comment ", "comment vertex "),
            ("mesh.ply", "comment ", "comment closed surface\ncomment "), ("protocol.scheme", "STEJSKALTANNER", "BVECTOR"))),
        *(("rms", work / "rms/intra" / name, old, new, lambda: rms_linter.lint(work / "rms/intra")) for name, old, new in (
            ("fiber.txt", "1 ", "2 "), ("fiber.txt", "1 ", ""), ("simParamInput.txt", "25000", "25001"), ("simParamInput.txt", "\n24\n", "\n23\n"), ("diffusivity.txt", "2.00000000\n", ""), ("T2.txt", "80.00000000", "0"),
            ("bvec.txt", "0.99", "0.89"), ("bval.txt", "1.00000000\n", ""))),
        *(("spindoctor", surface[ending], old, new, doctor) for ending, old, new in (
            ("poly", "\n3 ", "\n4 "), ("poly", "\n1 0 1\n", "\n1 0 0\n"), ("poly", "# Holes\n", ""), ("poly", "\n1\n1 ", "\n1\n1 1"), ("node", " 3 0 0", " 2 0 0"), ("node", "# number, x, y, z\n", ""), ("node", "\n1 ", "\n0 "),
            ("stl", "solid ", "sold "), ("stl", "vertex ", "vertex 1"))),
        *(("mcmr", work / "mcmr" / name, old, new, lambda: script_linter.mcmr(work / "mcmr")) for name, old, new in (
            ("geometry.jl", "repeats=[", "repeats=[0, "), ("geometry.jl", ".ply", ".pli"), (cell.name, "vertex_indices", "vertex_index"), (cell.name, "\n3 0 ", "\n3 1 "))),
        *(("dmipy-sim", work / "dmipy-sim/mesh.py", old, new, lambda: script_linter.dmipy_sim(work / "dmipy-sim")) for old, new in (
            ("scale=1e-6", "scale=1"), ("periodic=True", "periodic=False"), ("voxel_max=(2", "voxel_max=(3"), ("feature_radius=", "feature_radius=1e6 * "))),
        *(("cactus", work / "cactus/strands.txt", old, new, lambda: cactus_linter.lint(work / "cactus/strands.txt")) for old, new in (
            ("\n4\n", "\n5\n"), (listed[2], "3\n"), (listed[4], listed[3]), (listed[3], listed[5]), (listed[0], "0.028\n"), (listed[1], "1\n"), (listed[3], listed[3].replace(" ", "  ", 1)))),
        *(("caterpillar", work / "c9/caterpillar" / name, old, new, lambda: caterpillar_linter.lint(work / "c9/caterpillar", 9)) for name, old, new in (
            ("voxel.csv", " soma ", " branch "), ("voxel.csv", gap, ""), ("voxel.csv", "axon 0 axon 0 ", "axon 0 axon 1 "), ("voxel.csv", "axon 1 axon 0 ", "axon 1 axon 0 1000"),
            ("voxel_growth_info.txt", "Duration 0\n", ""), ("voxel_growth_info.txt", "Num_axons ", "Num_axons 1"), ("voxel_growth_info.txt", "Total icvf 0", "Total icvf 1"))))
    for form, path, old, new, lint in faults:
        text = path.read_text()
        path.write_text(text.replace(old, new, 1))
        try:
            lint()
            expect(text == path.read_text(), form, "linter", f"a planted fault in {path.name} was not seen ({old} for {new})")
            expect(False, form, "linter", f"{path.name}: nothing was planted or seen")
        except (ValueError, KeyError):
            expect(text != path.read_text(), form, "linter", f"{path.name} was refused before the fault")
        path.write_text(text)
    print(f"{len(faults)} planted faults")


def table():
    """checked_by.py, from which the column of spec/interop.md is written, says of each format who read it here, and of nobody else that they did."""
    said = checked_by.named(checked_by.WRITTEN, "interop.peers")
    return [f"{form}: checked_by.py says {sorted(said.get(form, set()))}, here {sorted(by.get(form, set()))}" for form in sorted({*said, *by}) if said.get(form, set()) != by.get(form, set())]


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
