#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The real programs, where a user has them, on what export writes: MC/DC gives the signal that `conceg simulate` gives, CACTUS reads our strand
lists and we read its.  programs.py BIN

CONCEG_MCDC     the program MC-DC_Simulator (6d043d6)
CONCEG_CACTUS   a checkout of CACTUS (ee81f86); its own Python reads and writes the lists (needs NumPy), and its quick-mesh makes tubes of them where
                CONCEG_CACTUS_PYTHON, else this Python, has openmesh and what else it imports
CONCEG_TETGEN   the program tetgen (1.5.0), which SpinDoctor calls
"""
import csv
import importlib.util
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import types

bin_folder = pathlib.Path(sys.argv[1]).resolve()
strands = "12\n4\n2\n-6 -3 -3 0.9\n6 -2.5 -3 0.9\n3\n-6 3 -3 1.1\n0 3.4 -3 1.3\n6 3 -2.8 1.1\n2\n-6 -2.2 2.6 1.2\n6 -2.1 2.8 1.2\n2\n-6 2.6 3 0.8\n6 2.4 2.9 0.8\n"
failures, checks = [], 0
walkers, reference = 2000, 20000


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)


def run(word, *words):
    subprocess.run([bin_folder / f"conceg-{word}", *map(str, words), "-q"], check=True)


def signals(path):
    """(b, direction) -> signal and standard error of the intracellular water."""
    with open(path) as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["compartment"] == "intra"]
    return [(float(row["signal"]), float(row["standard_error"])) for row in rows]


def mcdc(program, work):
    """All rows of the protocol within 3 standard errors, and as many walkers back as were sent."""
    pulses = ["--pulse-ms", "1", "--separation-ms", "3"]
    run("export", work / "bundle.cgx", "--to", "mcdc", "--dir", work, "--walkers", walkers, "--b-values-ms-per-um2", "0 0.5 1 3", "--directions", "4", *pulses)
    done = subprocess.run([program, "--conf", "intra.conf"], cwd=work / "mcdc", capture_output=True, text=True)
    result = work / "mcdc/intra_DWI.txt"
    if not result.exists():
        return expect(False, f"MC/DC wrote no signal: {done.stdout[-500:]} {done.stderr[-500:]}")
    theirs = [float(line) / walkers for line in result.read_text().split()]
    run("simulate", work / "bundle.cgx", "--compartment", "intra", "--walkers", reference, "--protocol", work / "mcdc/protocol.scheme", "--csv", work / "csv", "-o", work / "simulated.cgx")
    ours = signals(work / "csv/signals.csv")
    expect(len(ours) == len(theirs) == 13, f"{len(theirs)} rows of MC/DC, {len(ours)} of ours")
    expect(theirs[0] == 1, f"all {walkers} walkers come back: {theirs[0]}")
    largest = 0.0
    for row, (s, (signal, error)) in enumerate(zip(theirs, ours)):
        error *= math.sqrt(1 + reference / walkers)
        largest = max(largest, abs(s - signal) / error if error > 0 else 0)
        expect(abs(s - signal) <= 3 * error + 1e-9, f"row {row}: MC/DC {s:.4f}, ours {signal:.4f}, standard error of the difference {error:.4f}")
    # Strands of half the width would be seen.
    (work / "thin.txt").write_text("\n".join(" ".join([*w[:3], str(float(w[3]) / 2)]) if len(w) == 4 else " ".join(w) for w in (line.split() for line in strands.splitlines())) + "\n")
    document(work / "thin.txt", work / "thin.cgx", 0.25)
    run("simulate", work / "thin.cgx", "--compartment", "intra", "--walkers", reference, "--protocol", work / "mcdc/protocol.scheme", "--csv", work / "thin", "-o", work / "simulated.cgx")
    apart = max(abs(s - signal) / (error * math.sqrt(1 + reference / walkers)) for s, (signal, error) in zip(theirs[1:], signals(work / "thin/signals.csv")[1:]))
    expect(apart > 3, f"thin strands look the same: {apart:.1f} standard errors")
    print(f"MC/DC: 13 rows, {walkers} walkers there and {reference} here: largest difference {largest:.2f} standard errors; of strands half as wide {apart:.1f}")


def document(path, out, h):
    run("import", "cactus", path, "-o", f"{out}.strands")
    run("mesh", f"{out}.strands", "--h-um", h, "-o", out)


def cactus_lists(checkout):
    """read_write_strands.py of the checkout; what it imports for other ends is replaced by empty modules."""
    for name in ("icecream", "sparse", "rich", "rich.progress", "rich.console", "matplotlib", "matplotlib.pyplot", "cactus1_substrate", "cactus1_substrate.core", "cactus1_substrate.core.wavy_radii"):
        module = sys.modules.setdefault(name, types.ModuleType(name))
        for word in ("ic", "print", "track", "Console", "wavy_radii", "pyplot"):
            setattr(module, word, print)
    spec = importlib.util.spec_from_file_location("lists", pathlib.Path(checkout) / "src/cactus1_substrate/core/read_write_strands.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def cactus(checkout, work):
    """Their reader on our list, our reader on their list: the same points."""
    theirs = cactus_lists(checkout)
    run("export", work / "bundle.cgx.strands", "--to", "cactus", "--dir", work)
    found, side = theirs.read_generic_list(str(work / "cactus/strands.txt"))
    words = iter(strands.split())
    expect(side == float(next(words)) and len(found) == int(next(words)), f"CACTUS reads a box of {side} um and {len(found)} strands")
    for cell in found:
        points = [[float(next(words)) for _ in range(4)] for _ in range(int(next(words)))]
        expect(len(cell) == len(points) and all(abs(a - b) < 1e-6 for p, q in zip(cell, points) for a, b in zip(p, q)), f"CACTUS reads {cell}, expected {points}")
    theirs.write_strand_list_with_box(found, str(work / "theirs.txt"), box_size=side)
    run("import", "cactus", work / "theirs.txt", "-o", work / "theirs.cgx")
    run("export", work / "theirs.cgx", "--to", "cactus", "--dir", work / "again")
    expect((work / "again/cactus/strands.txt").read_bytes() == (work / "cactus/strands.txt").read_bytes(), "their list gives our list again")
    print(f"CACTUS: {len(found)} strands read by its Python, written by it, and read by us: the same")
    quick_mesh(checkout, work)


def quick_mesh(checkout, work):
    """Its mesher takes strands of our cells, at all their images in the voxel: eight points for each of theirs, capped tubes."""
    python = os.environ.get("CONCEG_CACTUS_PYTHON", sys.executable)
    script = ("import argparse, sys; sys.path.insert(0, sys.argv[1]); from cactus1_substrate.tools import quick_mesh as q; "
              "q.main(argparse.Namespace(file=sys.argv[2], file_out=sys.argv[3], g_ratio=1.0, strand_id=None, decimate=0.0))")
    recipe = pathlib.Path(__file__).resolve().parent.parent / "pipe/small.yaml"
    subprocess.run([bin_folder / "conceg", "run", recipe, "--until", "grow", "-q", "-o", work / "cells.cgx"], check=True)
    run("export", work / "cells.cgx", "--to", "cactus", "--dir", work)
    words = (work / "cactus/strands.txt").read_text().splitlines()
    points = [int(line) for line in words[2:] if len(line.split()) == 1]
    done = subprocess.run([python, "-c", script, pathlib.Path(checkout) / "src", work / "cactus/strands.txt", work / "tubes.ply"], capture_output=True, text=True, env={**os.environ, "MPLBACKEND": "Agg"})
    if "ModuleNotFoundError" in done.stderr:
        return print(f"CACTUS: quick-mesh was not tried: {done.stderr.strip().splitlines()[-1]}")
    expect(done.returncode == 0 and (work / "tubes.ply").exists(), f"quick-mesh: exit {done.returncode}: {done.stderr[-300:]}")
    head = {line.split()[1]: int(line.split()[2]) for line in (work / "tubes.ply").read_text().splitlines()[:12] if line.startswith("element")}
    expect(len(points) == int(words[1]) > 6 and head["vertex"] == 8 * sum(points) and head["face"] == sum(16 * n - 4 for n in points), f"quick-mesh: {head} of {len(points)} strands with {sum(points)} points")
    print(f"CACTUS: quick-mesh made {head['face']} faces of {len(points)} strands")


def tetgen(program, work):
    """Both forms of each surface are filled with tetrahedra, as SpinDoctor calls the program; the region's mark is on all of them, their volume is the cell's."""
    run("export", work / "bundle.cgx", "--to", "spindoctor", "--dir", work)
    cells = json.loads((work / "spindoctor/manifest.json").read_text())["cells"]
    for cell in cells:
        stem = next(name for name in cell["files"] if name.endswith(".poly"))[:-5]
        for ending in ("poly", "stl"):
            done = subprocess.run([program, "-pqA", f"{stem}.{ending}"], cwd=work / "spindoctor", capture_output=True, text=True)
            results = [work / f"spindoctor/{stem}.1.{part}" for part in ("node", "ele")]
            expect(done.returncode == 0 and all(path.exists() for path in results), f"TetGen, {stem}.{ending}: exit {done.returncode}: {done.stdout[-300:]}")
            if not all(path.exists() for path in results):
                continue
            nodes, elements = ([[float(word) for word in line.split()] for line in path.read_text().splitlines()[1:] if not line.startswith("#")] for path in results)
            place = {int(row[0]): row[1:4] for row in nodes}
            volume = sum(abs(determinant(*(place[int(corner)] for corner in row[1:5]))) / 6 for row in elements)
            expect(abs(volume / cell["volume_um3"] - 1) < 1e-5, f"TetGen, {stem}.{ending}: {volume} of {cell['volume_um3']} um3")
            expect(ending == "stl" or all(row[5] == 1 for row in elements), f"TetGen, {stem}: tetrahedra outside of region 1")
            for path in results:
                path.unlink()
    print(f"TetGen: {len(cells)} cells as .poly and .stl, filled to their volume")


def determinant(a, b, c, d):
    (x, y, z), (p, q, r), (s, t, u) = ([e - f for e, f in zip(corner, a)] for corner in (b, c, d))
    return x * (q * u - r * t) - y * (p * u - r * s) + z * (p * t - q * s)


programs = [(name, os.environ.get(f"CONCEG_{name.upper()}"), check) for name, check in (("mcdc", mcdc), ("cactus", cactus), ("tetgen", tetgen))]
if not any(path for _, path, _ in programs):
    print("SKIPPED: none of CONCEG_MCDC (a program), CONCEG_CACTUS (a checkout) and CONCEG_TETGEN (a program) is set: the real programs were not tried")
    sys.exit(77)
for name, path, check in programs:
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "strands.txt").write_text(strands)
        document(pathlib.Path(folder) / "strands.txt", pathlib.Path(folder) / "bundle.cgx", 0.5)
        if path:
            check(path, pathlib.Path(folder))
        else:
            print(f"CONCEG_{name.upper()} is not set: not tried")
for line in failures:
    print("FAILED:", line)
print(f"real programs: {checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
