#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""fastpli's .h5 as h5py writes them: a file of the same fibres as a .dat gives the same document, one asymmetric point stands where it should, and
malformed files are refused with their name and the path within.  bundles.py BIN"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

bin_folder = pathlib.Path(sys.argv[1]).resolve()
failures, checks = [], 0
fibres = {"0": {"0": [(3, 4, 6, 0.5), (5, 4, 6, 0.5), (8, 5, 6, 0.5)], "1": [(3, 9, 6, 0.25), (5, 9, 7, 0.75)]}, "1": {"0": [(1, 1, 2, 0.5), (2, 1, 9, 0.5)]}}


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)


def save(path, bundles, **how):
    with h5py.File(path, "w") as file:
        for bundle, group in bundles.items():
            here = file.create_group(bundle)
            for name, rows in group.items():
                here.create_dataset(name, data=np.array(rows, how.get("dtype", float)), **{k: v for k, v in how.items() if k != "dtype"})


def read(path, out):
    return subprocess.run([bin_folder / "conceg-import", "fastpli", path, "-q", "-o", out], capture_output=True, text=True)


def arrays(path):
    with h5py.File(path) as file:
        return {name: file[name][()] for name in ("skeleton/position", "skeleton/radius", "skeleton/parent", "skeleton/cell_offset", "cells/type", "cells/soma")}


def same_as_text(work):
    text = "\n\n\n".join("\n\n".join("\n".join("%g %g %g %g" % row for row in rows) for rows in group.values()) for group in fibres.values())
    (work / "f.dat").write_text(text + "\n")
    done = read(work / "f.dat", work / "text.cgx")
    expect(done.returncode == 0, f".dat: {done.stderr}")
    wanted = arrays(work / "text.cgx")
    for name, how in (("plain", {}), ("packed", {"compression": "gzip", "shuffle": True, "dtype": "f4"}), ("big", {"dtype": ">f8"}), ("whole", {"dtype": "f8", "maxshape": (None, 4)})):
        save(work / "f.h5", fibres, **how)
        done = read(work / "f.h5", work / "h5.cgx")
        expect(done.returncode == 0, f"{name}: {done.stderr}")
        found = arrays(work / "h5.cgx")
        expect(all(np.array_equal(wanted[key], found[key]) for key in wanted), f"{name}: another document than of the .dat")
        expect(found["skeleton/position"][0].tolist() == [3, 4, 6] and found["skeleton/radius"][0] == 0.5, f"{name}: the first point {found['skeleton/position'][0]}")
    many = {str(b): {str(f): fibres["0"]["0"] for f in range(11)} for b in range(2)}
    many["1"]["10"] = [(7, 7, 7, 1), (8, 7, 7, 1)]
    save(work / "f.h5", many)
    read(work / "f.h5", work / "h5.cgx")
    expect(arrays(work / "h5.cgx")["skeleton/position"][-1].tolist() == [8, 7, 7], "fibre 10 comes after fibre 9")


def malformed(work):
    good = fibres["0"]["0"]
    cases = {
        "no groups": ({}, None), "an empty group": ({"0": {}}, None), "a name that is no number": ({"zero": {"0": good}}, "/"), "a fibre's name": ({"0": {"first": good}}, "/0"),
        "one row": ({"0": {"0": good[:1]}}, "/0/0"), "no rows": ({"0": {"0": np.zeros((0, 4))}}, "/0/0"), "three columns": ({"0": {"0": [row[:3] for row in good]}}, "/0/0"),
        "five columns": ({"0": {"0": [row + (1,) for row in good]}}, "/0/0"), "one axis": ({"0": {"0": np.zeros(8)}}, "/0/0"), "r = 0": ({"0": {"0": [good[0], good[1][:3] + (0,)]}}, "/0/0[1]"),
        "r < 0": ({"0": {"0": [good[0][:3] + (-1,), good[1]]}}, "/0/0[0]"), "NaN": ({"0": {"0": good, "1": [good[0], (np.nan, 0, 0, 1)]}}, "/0/1[1]"), "infinite": ({"0": {"0": [good[0], (np.inf, 0, 0, 1)]}}, "/0/0[1]"),
        "another unit": ({"0": {"0": [good[0], (1e9, 0, 0, 1)]}}, "/0/0[1]"), "text": ({"0": {"0": np.array([[b"a"] * 4] * 2)}}, "/0/0")}
    for name, (bundles, where) in cases.items():
        with h5py.File(work / "bad.h5", "w") as file:
            for bundle, group in bundles.items():
                here = file.create_group(bundle)
                for fibre, rows in group.items():
                    here.create_dataset(fibre, data=np.array(rows))
        refused(work, name, where)
    for name, how in (("elements of 1 MB", {"dtype": "V1000000"}), ("chunks of 2 GB", {"dtype": "f8", "chunks": (1 << 26, 4), "maxshape": (None, 4)})):
        with h5py.File(work / "bad.h5", "w") as file:
            file.create_group("0").create_dataset("0", shape=(2, 4), **how)
        refused(work, name, "/0/0")
    save(work / "bad.h5", fibres)
    whole = (work / "bad.h5").read_bytes()
    for name, data in (("cut short", whole[:700]), ("empty", b""), ("text", b"0 0 0 1\n1 0 0 1\n")):
        (work / "bad.h5").write_bytes(data)
        refused(work, name, None)
    with h5py.File(work / "bad.h5", "w") as file:
        file.create_dataset("0", data=np.array(good))
    refused(work, "a dataset where a bundle should be", "/0")
    return len(cases) + 6


def refused(work, name, where):
    done = read(work / "bad.h5", work / "refused.cgx")
    expect(done.returncode == 3 and "bad.h5" in done.stderr, f"{name}: exit {done.returncode}: {done.stderr.strip()}")
    expect(where is None or f"bad.h5: {where}" in done.stderr, f"{name}: expected {where}: {done.stderr.strip()}")
    expect(not (work / "refused.cgx").exists(), f"{name}: something was written")


with tempfile.TemporaryDirectory() as folder:
    same_as_text(pathlib.Path(folder))
    bad = malformed(pathlib.Path(folder))
for line in failures:
    print("FAILED:", line)
print(f"fibre bundles of h5py: {bad} malformed files, {checks} checks, {len(failures)} failures")
sys.exit(bool(failures))
