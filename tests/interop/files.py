#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files of other programs, by the programs alone: malformed ones are refused with file and line, one asymmetric point of each format
stands where it should, what goes round comes back, and a bundle of strands becomes disjoint meshes.  files.py BIN"""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import checked_by

bin_folder = pathlib.Path(sys.argv[1]).resolve()
failures, checks, went_round = [], 0, set()


def run(word, *words):
    return subprocess.run([str(bin_folder / f"conceg-{word}" if (bin_folder / f"conceg-{word}").exists() else bin_folder / "conceg"),
                           *([] if (bin_folder / f"conceg-{word}").exists() else [word]), *map(str, words)], capture_output=True, text=True)


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)


def must(*words):
    done = run(*words)
    expect(done.returncode == 0, f"{' '.join(map(str, words))}: exit {done.returncode}: {done.stderr.strip()[-300:]}")
    return done


b_head = "cell_type cell_id component component_id X Y Z inner_radius outer_radius\n"
a_head = "id_ax id_sph id_branch Type X Y Z Rin Rout P\n"
ply_head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
corners = "0 0 0\n1 0 0\n0 1 0\n"
wmg = '{"voxelSize": 10, "axons": [%s]}'
ellipsoids = '{"position": [0,0,-5], "myelinDiameter": %s, "axonDiameter": 1}, {"position": [0,0,5], "myelinDiameter": 2, "axonDiameter": 1}'

# Text, and the line that must be named (None: a path within the file).
malformed = {
    "cactus": [
        ("", 1), ("x\n1\n", 1), ("-3\n1\n2\n0 0 0 1\n1 0 0 1\n", 1), ("20\n", 2), ("20\n0\n", 2), ("20\n1.0\n2\n0 0 0 1\n1 0 0 1\n", 2), ("20\n1\n0\n", 3),
        ("20\n1\n3\n0 0 0 1\n1 0 0 1\n", 6), ("20\n2\n2\n0 0 0 1\n1 0 0 1\n", 6), ("20\n1\n2\n0 0 0 1\n1 0 0 1\n7\n", 6), ("20\n1\n2\n0 0 0 0\n1 0 0 1\n", 4),
        ("20\n1\n2\n0 0 0 -1\n1 0 0 1\n", 4), ("20\n1\n2\n0 nan 0 1\n1 0 0 1\n", 4), ("20\n1\n2\n0 0 0 1\n1e300 0 0 1\n", 5), ("20\n1\n2\n0 0 0 1\n1 0 zero 1\n", 5),
        ("0.02\n1\n2\n-10 0 0 0.5\n10 0 0 0.5\n", None), ("20\n1\n99999999999999999999\n", 3)],
    "caterpillar": [
        ("", 1), ("a b c\n", 1), (b_head.replace(" X", ""), 1), (b_head.strip() + " X\n", 1), (b_head, 1), (b_head + "axon 0 axon 0 1 1 1 1\n", 2), (b_head + "axon 0 axon 0 1 1 1 2 1\n", 2),
        (b_head + "axon 0 axon 0 1 1 1 0 1\n", 2), (b_head + "axon 0 axon 0 nan 1 1 1 1\n", 2), (b_head + "neuron 0 soma 0 1 1 1 1 1\n", 2), (b_head + "axon 0 spine 0 1 1 1 1 1\n", 2),
        (b_head + "glial_cell 0 branch 0 1 1 1 1 1\n", 2), (b_head + "axon 0 axon 0 1 1 1 1 1\naxon 1 axon 0 2 2 2 1 1\naxon 0 axon 0 3 3 3 1 1\n", 4),
        (b_head + "glial_cell 0 soma 0 1 1 1 1 1\nglial_cell 1 branch 0 1 1 1 1 1\n", 3), (b_head + "axon 0.5 axon 0 1 1 1 1 1\n", 2), (a_head + "0 0 -1 Soma 1 1 1 1 1 -1\n", 2),
        (b_head + "axon 0 axon 0 9000 9000 9000 1 1\n", None)],
    "fastpli": [
        ("", 1), ("\n\n\n", 3), ("1 2 3\n", 1), ("1 2 3 4 5\n", 1), ("1 2 3 0\n", 1), ("1 2 3 -1\n", 1), ("0 0 0 1\n1 2 nan 1\n", 2), ("0 0 0 1\n1 2 x 1\n", 2), ("0 0 0 1\n\n1 0 0 1\n", 2),
        ("0 0 0 1\n1 0 0 1\n\n5 5 5 1\n", 4), ("0 0 0 1\n1e9 0 0 1\n", 2), ("0 0 0 1\n1 0 0 inf\n", 2)],
    "nfg": [
        ("", 1), ("0 0 0\n", 1), ("0 0\n0 0 1\n", 1), ("0 0 0 1\n0 0 1\n", 1), ("0 0 0\n0 0 x\n", 2), ("0 0 0\n0 0 nan\n", 2), ("0 0 0\n0 0 inf\n", 2), ("0 0 0\n0 0 5000\n", 2), ("# no rows\n", 1),
        ("0,0,0\n", 1)],
    "wmg": [
        ("", 1), ("{", 1), ("[]", 1), ('{"axons": []}', 1), ('{"voxelSize": "x"}', 1), ('{\n"voxelSize": [1, 2]}', 2), ('{"voxelSize": -1}', 1), (wmg % "", 1), (wmg % "1", 1), (wmg % "{}", 1),
        (wmg % ('{"ellipsoids": [' + ellipsoids % "0" + "]}"), 1), (wmg % ('{"ellipsoids": [' + ellipsoids % "0.5" + "]}"), 1), (wmg % ('\n{"ellipsoids": [1]}'), 2),
        ('{"voxelSize": 10, "voxelSize": 11}', 1), ('{"voxelSize": 10, "cells": [{"position": [0,0,0], "shape": [1,0,0,0,1,0,0,0,0]}]}', 1)],
    "ply": [
        ("", 1), ("stl\n", 1), ("ply\nformat ascii 1.0\n", 3), (ply_head.replace("format ascii 1.0\n", "") + corners + "3 0 1 2\n", None), (ply_head.replace("ascii", "octal") + corners, 2),
        (ply_head.replace("float x", "half x") + corners, 4), (ply_head.replace("vertex 3", "vertex -3") + corners, 3), (ply_head.replace("vertex 3", "vertex 99999999999") + corners + "3 0 1 2\n", None),
        (ply_head + corners, 13), (ply_head + corners + "3 0 1 3\n", 13), (ply_head + corners + "2 0 1\n", 13), (ply_head + corners + "3 0 1 2\n3 0 1 2\n", 14),
        (ply_head + corners.replace("1 0 0", "1 nan 0") + "3 0 1 2\n", 11), (ply_head + corners.replace("1 0 0", "1 a 0") + "3 0 1 2\n", 11)],
    "network": [
        ("", 1), ("1 0 0 0\n", 1), ("1 0 0 0 0\n", 1), ("1 0 0 0 nan\n", 1), ("1 0 0 0 1\n1 1 0 0 1\n", 2), ("a 0 0 0 1\n", 1), ("-1 0 0 0 1\n", 1), ("# box_um 0 0 0 1 1\n1 0 0 0 1\n", 1),
        ("# box_um 0 0 0 0 1 1 periodic 0 0 0\n1 0 0 0 1\n", 1), ("1 0 0 1e9 1\n", 1), ("# box_um 0 0 0 1 1 1 periodic 0 2 0\n1 0 0 0 1\n", 1)],
}
names = {"cactus": "s.init", "caterpillar": "v.csv", "fastpli": "f.dat", "nfg": "strand_00-r0.001000.txt", "wmg": "w.json", "ply": "c.ply", "network": "nodes.txt"}


def refusals(work):
    for form, cases in malformed.items():
        expect(len(cases) >= 10, f"{form}: fewer than ten malformed files")
        for number, (text, line) in enumerate(cases):
            path = work / names[form]
            path.write_text(text)
            (work / "v_growth_info.txt").write_text("Voxel Size 20\n")
            (work / "edges.txt").write_text("")
            words = [path, work / "edges.txt"] if form == "network" else [path]
            done = run("import", form, *words, "-o", work / "refused.cgx")
            where = f"{form}[{number}]: exit {done.returncode}: {done.stderr.strip()[-200:]}"
            expect(done.returncode == 3 and path.name in done.stderr, f"expected exit 3 and the file's name: {where}")
            expect(line is None or f"{path.name}:{line}:" in done.stderr, f"expected line {line}: {where}")
            expect(not (work / "refused.cgx").exists(), f"something was written: {where}")
    (work / "nodes.txt").write_text("1 0 0 0 1\n2 1 0 0 1\n")
    for edges in ("1\n", "1 3\n", "1 1\n", "1 2\n2 1\n", "1 2 0 0 1\n"):
        (work / "edges.txt").write_text(edges)
        done = run("import", "network", work / "nodes.txt", work / "edges.txt", "-o", work / "refused.cgx")
        expect(done.returncode == 3 and "edges.txt:" in done.stderr, f"network edges {edges!r}: {done.returncode} {done.stderr}")
    for info in ("", "Voxel Size\n", "Voxel Size -3\n", "Small voxel min limits 0 0 0\n", "Small voxel min limits 0 0 0\nSmall voxel max limits 0 0 0\n"):
        (work / "v.csv").write_text(b_head + "axon 0 axon 0 1 2 3 0.5 0.5\n")
        (work / "v_growth_info.txt").write_text(info)
        done = run("import", "caterpillar", work / "v.csv", "-o", work / "refused.cgx")
        expect(done.returncode == 3 and "v_growth_info.txt:" in done.stderr, f"growth_info {info!r}: {done.returncode} {done.stderr}")
    for name in ("strand.txt", "strand-rx.txt", "strand-r15.txt", "strand-r0.txt"):
        (work / name).write_text("0 0 0\n0 0 1\n")
        done = run("import", "nfg", work / name, "-o", work / "refused.cgx")
        expect(done.returncode == 3 and name in done.stderr, f"nfg {name}: {done.returncode} {done.stderr}")
    expect(run("import", "nonsense", "x").returncode == 2, "an unknown format is a usage error")


def rows(text):
    return [[float(w) for w in line.split()] for line in text.splitlines() if re.match(r"^ *[-+0-9.]", line)]


def cactus_of(document, work, name="back"):
    must("export", document, "--to", "cactus", "--dir", work / name, "-q")
    return (work / name / "cactus/strands.txt").read_text()


def frames_and_rounds(work):
    """One asymmetric point (3, 4, 6) of the box [0, 20]^3, that is (-7, -6, -4) about its middle, in every format."""
    tail = [(5, 4, 6, 0.5), (8, 5, 6, 0.5), (12, 5, 7, 0.75)]
    corner = [(3, 4, 6, 0.5), *tail]
    centred = [(x - 10, y - 10, z - 10, r) for x, y, z, r in corner]
    strand = f"20\n1\n{len(corner)}\n" + "".join("%.17g %.17g %.17g %.17g \n" % row for row in centred)
    (work / "s.txt").write_text(strand)
    must("import", "cactus", work / "s.txt", "-o", work / "s.cgx")
    expect(run("validate", work / "s.cgx", "-q").returncode == 0, "an imported strand list is valid")
    expect(rows(cactus_of(work / "s.cgx", work)) == rows(strand), "strand list -> document -> strand list")
    went_round.add("cactus")
    must("export", work / "s.cgx", "--to", "caterpillar", "--dir", work / "cat", "-q")
    table = (work / "cat/caterpillar/voxel.csv").read_text().splitlines()
    expect(table[0] + "\n" == b_head and table[1] == "axon 0 axon 0 3 4 6 0.5 0.5", f"the first sphere of a table: {table[:2]}")
    must("import", "caterpillar", work / "cat/caterpillar/voxel.csv", "-o", work / "c.cgx")
    first = rows(cactus_of(work / "c.cgx", work, "cat_back"))[3]
    expect(first == [-7, -6, -4, 0.5], f"sphere table -> document -> strand list: {first}")

    six = [("axon", 0, "axon", 0, -1, 3, 4, 6, 0.4, 0.5), ("axon", 0, "axon", 0, -1, 3.1, 4, 6, 0.4, 0.5), ("glial_cell", 0, "soma", 0, -1, 10, 10, 10, 2, 2),
           ("glial_cell", 0, "branch", 1, 0, 12, 10, 10, 0.5, 0.5), ("glial_cell", 0, "branch", 1, 0, 12.2, 10, 10, 0.5, 0.5), ("glial_cell", 0, "soma", 0, -1, 16, 4, 4, 1, 1)]
    layouts = {
        "b": b_head + "".join(f"{t} {c} {k} {n} {x} {y} {z} {i} {o}\n" for t, c, k, n, p, x, y, z, i, o in six),
        "c": b_head.replace(" X", " parent_component_id X") + "".join(f"{t} {c} {k} {n} {p} {x} {y} {z} {i} {o}\n" for t, c, k, n, p, x, y, z, i, o in six),
        "a": a_head + "".join(f"{c} {s} {n} {({'axon': 'axon', 'soma': 'CellSoma', 'branch': 'Process'})[k]} {x} {y} {z} {i} {o} {s - 1 if s in (1, 4) else -1}\n"
                              for s, (t, c, k, n, p, x, y, z, i, o) in enumerate(six)),
    }
    layouts["d"] = layouts["b"].replace(b_head, "Cell_type Cell_ID Component Component_ID X Y Z Inner_radius Outer_radius\n")
    layouts["b2"] = layouts["b"] + "blood_vessel 0 blood_vessel 0 18 18 2 1 1\nblood_vessel 0 branch 1 18 17 2 1 1\n"
    (work / "growth_info.txt").write_text("Duration 1\nVoxel Size 20\nTotal icvf 0.5\n")
    seen = {}
    for name, text in layouts.items():
        (work / f"layout_{name}.csv").write_text(text)
        must("import", "caterpillar", work / f"layout_{name}.csv", "-o", work / "layout.cgx")
        seen[name] = (work / "layout.cgx").read_bytes()
        cells = (must("export", work / "layout.cgx", "--to", "cactus", "--dir", work / "layout", "-q"), json.loads((work / "layout/cactus/manifest.json").read_text())["cells"])[1]
        expect(len(cells) == (4 if name == "b2" else 3), f"layout {name}: two glial cells of one id stay two: {len(cells)}")
    (work / "myelin.csv").write_text(layouts["b"].replace("12 10 10 0.5 0.5", "12 10 10 0.3 0.5"))
    must("import", "caterpillar", work / "myelin.csv", "-o", work / "layout.cgx")
    done = run("export", work / "layout.cgx", "--to", "caterpillar", "--dir", work / "myelin")
    written = [line.split() for line in (work / "myelin/caterpillar/voxel.csv").read_text().splitlines()]
    expect(done.returncode == 0 and "inner radius" in done.stderr and written[1][-2:] == ["0.4", "0.5"] and all(row[-2] == row[-1] for row in written if row[0] == "glial_cell"),
           f"inner radii are of axons alone, and the rest is said: {done.stderr} {written[1]}")
    expect(seen["a"] == seen["b"] == seen["c"] == seen["d"], "four layouts of the same six spheres give one document")

    box = {"fastpli": None, "nfg": None, "wmg": -10, "cactus": -10}
    (work / "p.dat").write_text("".join("%g %g %g %g\n" % row for row in corner))
    (work / "strand_00-r0.000500.txt").write_text("".join("%.17g %.17g %.17g\n" % tuple(v / 1000 for v in row[:3]) for row in corner))
    (work / "w.json").write_text(json.dumps({"voxelSize": 20, "axons": [{"gRatio": 0.7, "ellipsoids": [
        {"position": row[:3], "shape": [1, 0, 0, 0, 1, 0, 0, 0, 1], "myelinDiameter": 2 * row[3], "axonDiameter": 1.4 * row[3]} for row in centred]}]}))
    for form, path, wanted in (("fastpli", "p.dat", corner), ("nfg", "strand_00-r0.000500.txt", [row[:3] + (0.5,) for row in corner]), ("wmg", "w.json", centred)):
        must("import", form, work / path, "-o", work / "f.cgx")
        must("export", work / "f.cgx", "--to", "swc", "--dir", work / f"swc_{form}", "-q")
        got = [[float(w) for w in line.split()[2:6]] for p in (work / f"swc_{form}/swc").glob("*.swc") for line in p.read_text().splitlines() if not line.startswith("#")]
        expect(len(got) == len(wanted) and all(abs(a - b) < 1e-6 for g, w in zip(got, wanted) for a, b in zip(g, w)), f"{form}: {got[:1]}, expected {wanted[:1]} ")

    nodes = "# box_um 0 0 0 20 20 20 periodic 1 0 1\n# id x y z rmax, um\n0 3 4 6 0.5\n1 5 4 6 0.25\n"
    (work / "nodes.txt").write_text(nodes), (work / "edges.txt").write_text("0 1 0 0 0\n0 1 -1 0 0\n0 0 0 0 1\n")
    must("import", "network", work / "nodes.txt", work / "edges.txt", "-o", work / "n.cgx")
    must("export", work / "n.cgx", "--to", "network", "--dir", work / "net", "-q")
    expect((work / "net/network/nodes.txt").read_text() == nodes, "nodes go round")
    expect(sorted((work / "net/network/edges.txt").read_text().splitlines()[1:]) == sorted(["0 1 0 0 0", "0 1 -1 0 0", "0 0 0 0 1"]), "edges go round, each once")
    went_round.add("network")

    (work / "two.swc").write_text("1 2 0 0 0 1 -1\n2 2 5 0 0 1 1\n3 2 0 9 0 1 -1\n4 2 5 9 0 1 3\n")
    for roots, count in (("one", 1), ("cells", 2)):
        must("import", "swc", work / "two.swc", f"--roots={roots}", "-o", work / "r.cgx", "-q")
        must("export", work / "r.cgx", "--to", "cactus", "--dir", work / f"roots_{roots}", "-q")
        expect(len(json.loads((work / f"roots_{roots}/cactus/manifest.json").read_text())["cells"]) == count, f"--roots={roots}: {count} cells")


    must("import", "swc", work / "two.swc", "--box-um", "30", "-o", work / "r.cgx", "-q")
    expect("30" in must("dump", "/domain@hi", work / "r.cgx").stdout and run("validate", work / "r.cgx", "-q").returncode == 0, "a given box of SWC")
    (work / "far.swc").write_text("1 2 90 90 90 1 -1\n2 2 95 90 90 1 1\n")
    refused = run("import", "swc", work / "far.swc", "--box-um", "30", "-o", work / "no.cgx")
    expect(refused.returncode == 3 and "far.swc" in refused.stderr, f"SWC outside of the given box: {refused.stderr}")
    must("export", work / "r.cgx", "--to", "swc", "--dir", work / "plus", "-q")
    refused = run("import", "swc", work / "plus/swc", "--box-um", "30", "-o", work / "no.cgx")
    expect(refused.returncode == 2 and "carry the box" in refused.stderr, f"a box for files that have one: {refused.stderr}")


def bundle(work):
    """Three strands, two of which overlap, become three closed and disjoint surfaces, checked by the mesh stage with exact predicates."""
    (work / "bundle.txt").write_text("12\n3\n4\n-6 -2 0 0.8 \n-2 -1.5 0 0.8 \n2 -1 -0.2 0.8 \n6 -1 0 0.8 \n5\n-6.0 -0.5 0.0 1.0\n-3.0 -0.2 -0.1 1.0\n0.0 0.2 0.0 1.0\n3.0 0.5 0.5 1.0\n6.0 0.3 1.0 1.0\n"
                                     "2\n-6 3 3 1.2\n6 4 3 1.2\n")
    must("import", "cactus", work / "bundle.txt", "-o", work / "b.cgx")
    must("relax", work / "b.cgx", "-q", "-o", work / "rel.cgx")
    must("mesh", work / "rel.cgx", "--h-um", "0.4", "-q", "-o", work / "mesh.cgx")
    expect("0" in must("dump", "/meshes@crossings", work / "mesh.cgx").stdout, "no crossings")
    must("export", work / "mesh.cgx", "--to", "ply", "--ascii", "--dir", work / "out", "-q")
    must("import", "ply", work / "out/ply/cell_0000_strand.ply", work / "out/ply/cell_0001_strand.ply", work / "out/ply/cell_0002_strand.ply", "--box-um", "12", "-o", work / "again.cgx")
    expect(run("validate", work / "again.cgx", "-q").returncode == 0, "imported surfaces are valid")
    must("export", work / "again.cgx", "--to", "ply", "--dir", work / "again", "-q")
    first, second = (json.loads((work / f"{d}/ply/manifest.json").read_text()) for d in ("out", "again"))
    expect(len(first["cells"]) == 3 and abs(first["volume_um3"] / second["volume_um3"] - 1) < 1e-6, "surfaces go round with their volume")
    for form in ("mcdc", "disimpy", "camino", "dmipy-sim", "mcmr", "spindoctor", "stl", "obj", "gltf", "rms", "nifti", "h5v1"):
        must("export", work / "mesh.cgx", "--to", form, "--dir", work / "all", "--walkers", "50", "-q")
        expect((work / "all" / form / "manifest.json").exists(), f"{form}: a manifest")


def many(work):
    """Files read by several threads: of two bad ones the first is named, and the document is the same for any number."""
    for bad in ((23, 7), ()):
        for k in range(40):
            (work / f"c{k:02d}.swc").write_text(f"1 2 {k} 0 0 1 -1\n2 2 {k} 5 0 {'nan' if k in bad else 1} 1\n" + "".join(f"{j} 2 {k} {j} {j} 1 {j - 1}\n" for j in range(3, 400)))
        seen = set()
        for threads in (1, 2, 8):
            done = run("import", "swc", work, "--threads", threads, "-q", "-o", work / "m.cgx")
            expect(done.returncode == (3 if bad else 0) and (not bad or "c07.swc:2: E_NONFINITE" in done.stderr), f"{threads} threads: exit {done.returncode}: {done.stderr[-300:]}")
            seen.add((done.stderr, b"" if bad else (work / "m.cgx").read_bytes()))
        expect(len(seen) == 1, f"the same for any number of threads, bad {bad}")


def accepted(work):
    """What each format becomes goes through relax, mesh, simulate and analyse; surfaces through the last two."""
    line = [(-4, 1, -2), (-1, 1.5, -2), (2, 1, -2.5), (5, 1, -2)]
    (work / "s.init").write_text("20\n2\n4\n" + "".join("%g %g %g 0.8\n" % p for p in line) + "4\n" + "".join("%g %g %g 0.8\n" % (x, y + 1, z) for x, y, z in line))
    (work / "v.csv").write_text(b_head + "".join(f"axon 0 axon 0 {x + 10:g} {y + 10:g} {z + 10:g} 0.6 0.8\n" for x, y, z in line) + "glial_cell 0 soma 0 9 4 9 1.5 1.5\n"
                                + "".join(f"glial_cell 0 branch 1 {9 + 0.5 * k:g} 4 9 0.5 0.5\n" for k in range(3, 8)))
    (work / "v_growth_info.txt").write_text("Voxel Size 20\n")
    (work / "strand_00-r0.000800.txt").write_text("".join("%.17g %.17g %.17g\n" % tuple(v / 1000 for v in p) for p in line))
    (work / "f.dat").write_text("".join("%g %g %g 0.8\n" % p for p in line))
    (work / "w.json").write_text(json.dumps({"voxelSize": 20, "axons": [{"gRatio": 0.7, "ellipsoids": [
        {"position": p, "shape": [1, 0, 0, 0, 1, 0, 0, 0, 1], "myelinDiameter": 1.6, "axonDiameter": 1.1} for p in line]}]}))
    (work / "c.swc").write_text("1 1 5 5 5 2 -1\n2 3 7.5 5 5 0.6 1\n3 3 9.5 5.5 5 0.5 2\n4 3 12.5 6 5 0.5 3\n5 3 9.5 9 5 0.5 3\n")
    files = {"cactus": "s.init", "caterpillar": "v.csv", "nfg": "strand_00-r0.000800.txt", "fastpli": "f.dat", "wmg": "w.json", "swc": "c.swc"}
    for form, name in files.items():
        must("import", form, work / name, "-q", "-o", work / "a.cgx")
        must("relax", work / "a.cgx", "-q", "-o", work / "b.cgx")
        must("mesh", work / "b.cgx", "--h-um", "0.4", "-q", "-o", work / f"{form}.cgx")
        finished(work, form)
    must("export", work / "cactus.cgx", "--to", "ply", "--dir", work, "-q")
    must("import", "ply", work / "ply", "--box-um", "20", "-q", "-o", work / "ply.cgx")
    finished(work, "ply")


def finished(work, form):
    """A signal that falls with b, and tables."""
    must("simulate", work / f"{form}.cgx", "--compartment", "intra", "--walkers", "200", "--delta-ms", "1", "--separation-ms", "3", "--b", "0,3", "--directions", "3", "--csv", work / form, "-q", "-o", work / "s.cgx")
    with open(work / form / "signals.csv") as file:
        signal = [float(row["signal"]) for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["compartment"] == "intra"]
    expect(len(signal) == 4 and signal[0] == 1 and all(0 < s < 0.999 for s in signal[1:]), f"{form}: a signal: {signal}")
    must("analyse", work / "s.cgx", "-q", "-o", work / "t.cgx")
    expect("/statistics" in must("info", work / "t.cgx").stdout and run("validate", work / "t.cgx", "-q").returncode == 0, f"{form}: valid after analyse")


def lists(work):
    """The tables of spec/interop.md name what the programs take."""
    text = (pathlib.Path(__file__).resolve().parents[2] / "spec/interop.md").read_text()
    read, written = (re.findall(r"^\| ([a-z0-9-]+) \|", part, re.M)[1:] for part in (text.split("<!-- read -->")[1].split("## ")[0], text.split("<!-- written -->")[1].split("## ")[0]))
    listed = json.loads(run("params", "export", "--json").stdout)
    listed = listed if isinstance(listed, list) else listed["parameters"]
    choices = next(row["choices"] for row in listed if row["name"] == "to").split("|")[1:]
    expect(written == choices, f"formats written: {written}, --to takes {choices}")
    expect(", ".join(read) in run("import", "nonsense", "x").stderr, f"formats read: {read}")


with tempfile.TemporaryDirectory() as folder:
    for part in (lists, refusals, frames_and_rounds, bundle, accepted, many):
        work = pathlib.Path(folder) / part.__name__
        work.mkdir()
        try:
            part(work)
        except (OSError, KeyError) as problem:
            failures.append(f"{part.__name__}: {problem}")
said = {form for form, who in checked_by.named(checked_by.WRITTEN, "interop.files").items() if "our importer" in who}
expect(said == went_round, f"checked_by.py says that our importer takes {sorted(said)}, here {sorted(went_round)}")
said = set(checked_by.named(checked_by.READ, "interop.files"))
expect(said == set(malformed), f"checked_by.py says that samples are read of {sorted(said)}, here {sorted(malformed)}")
for line in failures:
    print("FAILED:", line)
print(f"files of other programs: {sum(map(len, malformed.values())) + 14} malformed files, {checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
