#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The real programs, where a user has them, on what export writes: MC/DC gives the signal that `conceg simulate` gives, CACTUS reads our strand
lists and we read its.  programs.py BIN

CONCEG_MCDC     the program MC-DC_Simulator (6d043d6)
CONCEG_CACTUS   a checkout of CACTUS (ee81f86); its own Python reads and writes the lists (needs NumPy)
"""
import csv
import importlib.util
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


programs = [(name, os.environ.get(f"CONCEG_{name.upper()}"), check) for name, check in (("mcdc", mcdc), ("cactus", cactus))]
if not any(path for _, path, _ in programs):
    print("SKIPPED: neither CONCEG_MCDC (a program) nor CONCEG_CACTUS (a checkout) is set: the real programs were not tried")
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
