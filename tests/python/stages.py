# SPDX-License-Identifier: BSD-3-Clause
"""Stages from Python: the bytes of the programs, progress, cancelling, tables, errors.  stages.py SOURCE BUILD"""
import logging
import os
import pathlib
import signal
import threading
import time

import numpy as np

import conceg
from common import end, expect, raises, small, source, temporary

recipe = source / "tests/pipe/small.yaml"


def same_bytes(work):
    """Stage by stage and by the recipe: the bytes of `conceg run`; the progress is told of."""
    grown, told = small(work, until="grow", name="grown.cgx"), []
    document = conceg.run_stage("place", recipe=recipe, progress=lambda *event: told.append(event))
    for kind in ("triangulate", "grow"):
        document = document.run(kind, threads=1, progress=lambda *event: told.append(event))
    document.save(work / "stages.cgx")
    expect((work / "stages.cgx").read_bytes() == grown.read_bytes(), "stages one by one")
    whats = [what for what, _, _ in told]
    expect("run place" in whats and "run grow" in whats and ("grow" in whats or "nodes" in whats), f"phases and progress: {sorted(set(whats))}")
    expect(all(isinstance(done, int) and isinstance(total, int) and (total == 0 or 0 <= done <= total) for _, done, total in told), "counts")
    whole = conceg.run_recipe(recipe.read_text(), until="grow")
    expect(whole.to_bytes() == grown.read_bytes(), "a recipe as text")
    other = conceg.run_recipe(recipe, until="grow", seed=2, settings={"domain.size_um": [24, 24, 24]})
    expect(other["/domain@hi"].tolist() == [24, 24, 24] and other["/provenance/seed"][0] == 2, "settings and seed")
    return conceg.open(grown)


def stages(work, grown):
    relaxed = grown.run("relax", iterations=20)
    expect("iterations: 20" in relaxed["/recipe"] and relaxed["/provenance/stage"].tolist()[-1] == "relax", "a parameter of a stage")
    # A document that was changed is what the stage sees.
    thin = conceg.open(work / "grown.cgx")
    thin["/skeleton/radius"] = thin["/skeleton/radius"] * np.float32(0.5)
    thin["/skeleton/target_radius"] = thin["/skeleton/target_radius"] * np.float32(0.5)
    measured = [document.run("analyse") for document in (grown, thin)]
    table = next(name for name in measured[0].tables() if "cell" in name)
    volume = [document.table(table) for document in measured]
    column = next(name for name in volume[0].columns if "volume" in name or "radius" in name or "area" in name)
    expect(volume[1][column].sum() < volume[0][column].sum(), f"{table}.{column}: the change arrives")
    mesh = relaxed.run("mesh", h_um=0.6)
    simulated = mesh.run("simulate", walkers=50, threads=1)
    signals, powder = simulated.signals(), simulated.powder()
    shape = simulated["/signals/signal"].shape
    expect(len(signals) == shape[0] * shape[1] and signals["signal"].iloc[shape[1]] == simulated["/signals/signal"][1, 0] and signals["standard_error"].iloc[-1] == simulated["/signals/standard_error"][-1, -1], "signals as rows")
    expect(len(powder) == simulated["/signals/powder"].size and powder["signal"].iloc[-1] == simulated["/signals/powder"][-1, -1], "means over directions")
    # The table is one that `conceg import signal` reads.
    signals.to_csv(work / "signals.csv", index=False)
    back = conceg.import_files("signal", work / "signals.csv")
    expect(np.allclose(back["/signals/signal"], simulated["/signals/signal"], atol=1e-12) and np.allclose(back["/protocol/b"], simulated["/protocol/b"]), "signals.csv goes back")
    mesh.export("ply", work / "files")
    mesh.export("cactus", work / "files")
    expect(len(list((work / "files/ply").glob("*.ply"))) == 4, "files of another program")
    mesh.report(work / "report.html", size_mb=1)
    expect("/meshes/vertex" in (work / "report.html").read_text(), "the page of a report")
    strands = conceg.import_files("cactus", [work / "files/cactus/strands.txt"])
    expect(len(strands["/cells/id"]) == len((work / "files/cactus/strands.csv").read_text().splitlines()) - 1, "strands come back")
    rows = {row["name"]: row for row in conceg.parameters("mesh")}
    expect(rows["h_um"]["unit"] == "um", f"parameters: {sorted(rows)[:4]}")


def cancelling(grown):
    def told(what, done, total):
        return what == "grow" or what.startswith("run")

    raises("E_CANCELLED", "cancel", conceg.run_recipe, recipe, progress=told)

    class Mine(Exception):
        pass

    def broken(what, done, total):
        raise Mine(what)

    try:
        conceg.run_recipe(recipe, progress=broken)
        expect(False, "the callback's exception was swallowed")
    except Mine:
        expect(True, "")
    # An interrupt (Ctrl-C, a notebook's stop) ends the program and goes on to the caller.
    threading.Timer(1.0, signal.pthread_kill, (threading.main_thread().ident, signal.SIGINT)).start()
    began = time.monotonic()
    try:
        conceg.run_recipe(recipe, until="grow", settings={"domain.size_um": [48, 48, 48]})
        expect(False, "the interrupt did not arrive")
    except KeyboardInterrupt:
        expect(time.monotonic() - began < 60, f"an interrupt ends the run: {time.monotonic() - began} s")
    children = [stat.read_text().rsplit(")", 1)[1].split()[1] for stat in pathlib.Path("/proc").glob("[0-9]*/stat") if stat.exists()]
    expect(str(os.getpid()) not in children, "no program is left")


def errors(work, grown):
    raises("E_PARAM", "frobnicate", grown.run, "relax", frobnicate=1)
    raises("E_PARAM", "iterations", grown.run, "relax", iterations=-3)
    raises("E_PARAM", "nonsense", conceg.run_stage, "nonsense", grown)
    raises("E_FORMAT", "meshes", grown.run, "simulate")
    raises("E_IO", "missing", conceg.import_files, "cactus", work / "missing.txt")
    (work / "bad.txt").write_text("20\n1\n2\n0 0 0 1\n1 0 0 -1\n")
    raises("E_FORMAT", "bad.txt:5:", conceg.import_files, "cactus", work / "bad.txt")
    raises("E_FORMAT", "recipe.yaml:", conceg.run_recipe, "conceg: 1\n  broken: [\n")
    raises("E_MISSING", "nonsense", conceg.parameters, "nonsense")
    closed = conceg.open(work / "grown.cgx")
    closed.close()
    raises("E_USAGE", "closed", closed.run, "relax")
    # Warnings of the programs go to the logger.
    seen = []
    handler = logging.Handler()
    handler.emit = lambda record: seen.append((record.levelname, record.getMessage()))
    logging.getLogger("conceg").addHandler(handler)
    (work / "plain.swc").write_text("1 1 0 0 0 5 -1\n2 3 6 0 0 0.5 1\n3 3 9 0 0 0.5 2\n")
    conceg.import_files("swc", work / "plain.swc", radius_min_um=0.75)
    expect(any(level == "WARNING" and "raised" in line for level, line in seen), f"warnings: {seen}")
    bars = conceg.import_files("swc", work / "plain.swc", progress=True)
    expect(bars["/cells/radius"].tolist() == [5.0], "with bars")


with temporary() as name:
    folder = pathlib.Path(name)
    first = same_bytes(folder)
    stages(folder, first)
    cancelling(first)
    errors(folder, first)
end("stages in Python")
