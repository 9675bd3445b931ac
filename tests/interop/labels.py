#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Volumes of labels as NumPy writes them: every type, order and packing gives the same document, which holds each voxel where it stands; files that
are cut off, that lie or that hold something else are refused with their name, and nothing is written.  labels.py BIN"""
import io
import pathlib
import struct
import subprocess
import sys
import tempfile
import zipfile

import h5py
import numpy as np

bin_folder = pathlib.Path(sys.argv[1]).resolve()
failures, checks = [], 0
rng = np.random.default_rng(1)
# 11 x 9 x 20 voxels: several leaves, none of them full; one leaf without a label.
labels = rng.choice([0, 3, 7, 200], size=(11, 9, 20)).astype("u1")
labels[8:, 8:, :8] = 0
voxel = (0.016, 0.02, 0.04)


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)


def read(path, out, *options):
    return subprocess.run([bin_folder / "conceg-import", "labels", path, "--voxel-um", ",".join(map(str, voxel)), *options, "-q", "-o", out], capture_output=True, text=True)


def grid(path):
    """Ids of /cells at every voxel."""
    with h5py.File(path) as file:
        volumes = file["volumes"]
        out = np.zeros(volumes.attrs["shape"], np.uint64)
        ids = np.concatenate([[0], file["cells/id"][()]]).astype(np.uint64)
        for leaf, values in zip(volumes["leaf_origin"][()], volumes["label"][()]):
            x, y, z = leaf
            block = ids[values.reshape(8, 8, 8)]
            part = out[x:x + 8, y:y + 8, z:z + 8]
            part[...] = block[:part.shape[0], :part.shape[1], :part.shape[2]]
        return out, file["domain"].attrs["hi"][()], file["domain"].attrs["periodic"][()], file["cells/soma"][()], ids[1:], len(volumes["leaf_origin"])


def npy(array, version=None):
    out = io.BytesIO()
    np.lib.format.write_array(out, array, version=version)
    return out.getvalue()


def every_form(work):
    forms = {}
    for kind in ("u1", "<u2", ">u2", "<u4", ">u4", "<u8", ">u8", "<i2", "<i4", "<i8"):
        forms[f"C {kind}"] = (npy(labels.astype(kind)), ".npy")
    forms["Fortran"] = (npy(np.asfortranarray(labels)), ".npy")
    forms["version 2"], forms["version 3"] = (npy(labels, (2, 0)), ".npy"), (npy(labels, (3, 0)), ".npy")
    for name, save in (("stored", np.savez), ("deflated", np.savez_compressed)):
        out = io.BytesIO()
        save(out, other=np.zeros(3), labels=labels.astype("u8"))
        forms[name] = (out.getvalue(), ".npz")
        out = io.BytesIO()
        save(out, anything=np.asfortranarray(labels))
        forms[f"{name}, one array"] = (out.getvalue(), ".npz")
    first = None
    for name, (content, ending) in forms.items():
        path = work / f"labels{ending}"
        path.write_bytes(content)
        done = read(path, work / "l.cgx")
        expect(done.returncode == 0, f"{name}: {done.stderr}")
        found, hi, periodic, soma, ids, leaves = grid(work / "l.cgx")
        expect(np.array_equal(found, labels), f"{name}: other labels")
        content = (work / "l.cgx").read_bytes()
        first = first or content
        expect(content == first, f"{name}: another document")
    expect(ids.tolist() == [3, 7, 200], f"ids {ids}")
    expect(np.allclose(hi, np.array(labels.shape) * voxel) and not periodic.any(), f"box {hi} {periodic}")
    expect(leaves == 11, f"{leaves} leaves: the one without a label is left out")
    middle = [(np.argwhere(labels == 7).mean(0) + 0.5) * voxel]
    expect(np.allclose(soma[1], middle), f"middle of label 7 {soma[1]}, expected {middle}")
    done = subprocess.run([bin_folder / "conceg", "validate", work / "l.cgx"], capture_output=True, text=True)
    expect(done.returncode == 0, f"validate: {done.stdout}{done.stderr}")


def options(work):
    np.save(work / "l.npy", np.ascontiguousarray(labels.transpose(2, 1, 0)))
    read(work / "l.npy", work / "l.cgx", "--axes", "zyx")
    expect(np.array_equal(grid(work / "l.cgx")[0], labels), "--axes zyx")
    np.savez(work / "two.npz", one=labels, two=labels + 1)
    read(work / "two.npz", work / "l.cgx", "--array", "two")
    expect(np.array_equal(grid(work / "l.cgx")[0], labels + 1), "--array two")
    np.save(work / "l.npy", labels[:, :, 3])
    read(work / "l.npy", work / "l.cgx")
    expect(np.array_equal(grid(work / "l.cgx")[0][:, :, 0], labels[:, :, 3]), "a section on two axes")
    # The nearest label: centres of voxels of 0.04 um over those of 0.016 x 0.02 x 0.04 um.
    np.save(work / "l.npy", labels)
    read(work / "l.npy", work / "l.cgx", "--resample-um", "0.04")
    at = [np.floor((np.arange(int(n * h / 0.04 + 1e-9)) + 0.5) * 0.04 / h).astype(int) for n, h in zip(labels.shape, voxel)]
    expect(np.array_equal(grid(work / "l.cgx")[0], labels[np.ix_(*at)]), "--resample-um")


def refused(work):
    good, packed = npy(labels.astype("<u2")), io.BytesIO()
    np.savez_compressed(packed, labels=labels)
    packed, objects = packed.getvalue(), io.BytesIO()
    np.lib.format.write_array(objects, np.array([[1, "a"]], object), allow_pickle=True)
    header = lambda text: b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text
    wrong_crc = bytearray(packed)
    wrong_crc[packed.rindex(b"PK\x01\x02") + 16] ^= 1
    encrypted = bytearray(packed)
    encrypted[packed.rindex(b"PK\x01\x02") + 8] |= 1
    far = bytearray(packed)
    far[-6:-2] = struct.pack("<I", 2**31)
    lied = bytearray(packed)  # the size of what is unpacked
    lied[packed.rindex(b"PK\x01\x02") + 24:packed.rindex(b"PK\x01\x02") + 28] = struct.pack("<I", 10)
    with zipfile.ZipFile(work / "bz.zip", "w", zipfile.ZIP_BZIP2) as file:
        file.writestr("labels.npy", good)
    cases = {
        "empty": (b"", ""), "text": (b"1 2 3\n4 5 6\n", "expected a file of NumPy"), "cut header": (good[:40], "cut off"), "cut values": (good[:-1], "cut off"),
        "longer": (good + b"x", "longer"), "lying shape": (good.replace(b"(11, 9, 20)", b"(99, 9, 20)"), "cut off"), "huge shape": (header(b"{'descr': '<u2', 'fortran_order': False, 'shape': (1000000000, 1000000000, 1000000000)}"), "2^60"),
        "larger": (header(b"{'descr': '<u2', 'fortran_order': False, 'shape': (99999999999999999999, 1)}"), "2^30"), "no voxels": (npy(np.zeros((3, 0, 4), "u1")), "no voxels"),
        "objects": (objects.getvalue(), "whole numbers"), "floats": (npy(labels.astype("f4")), "whole numbers"), "records": (npy(np.zeros((2, 2), [("a", "u1")])), "record"),
        "one axis": (npy(labels.ravel()), "two or three axes"), "four axes": (npy(labels[None]), "two or three axes"), "negative": (npy(labels.astype("i4") - 1), "negative"),
        "no labels": (npy(labels * 0), "labels above 0"), "version 9": (good[:6] + b"\x09" + good[7:], "format 1, 2 or 3"), "no shape": (header(b"{'descr': '<u2', 'fortran_order': False}"), "expected descr"),
        "unknown key": (header(b"{'descr': '<u2', 'x': 1}"), "unknown key"), "cut zip": (packed[:-30], "cut off or damaged"), "half a zip": (packed[:100], "cut off or damaged"),
        "wrong sum": (bytes(wrong_crc), "cut off or damaged"), "encrypted": (bytes(encrypted), "encrypted"), "far list": (bytes(far), "cut off or damaged"),
        "size that lies": (bytes(lied), "cut off or damaged"), "bzip2": ((work / "bz.zip").read_bytes(), "stored or deflated"),
    }
    for name, (content, message) in cases.items():
        path, out = work / "bad.npz", work / "none.cgx"
        path.write_bytes(content)
        done = read(path, out)
        expect(done.returncode == 3, f"{name}: exit {done.returncode}, expected 3: {done.stderr}")
        expect("bad.npz" in done.stderr and message in done.stderr, f"{name}: {done.stderr}")
        expect(not out.exists(), f"{name}: something was written")
    np.savez(work / "two.npz", one=labels, two=labels)
    expect("one.npy, two.npy" in read(work / "two.npz", out).stderr, "the arrays of a file are listed")
    for size in ("", "0", "-1", "a", "1,2", "1,2,3,4", "1,,3", "nan", "1e9"):
        done = subprocess.run([bin_folder / "conceg-import", "labels", work / "two.npz", f"--voxel-um={size}", "--array=one", "-o", out], capture_output=True, text=True)
        expect(done.returncode == 2 and "voxel_um" in done.stderr, f"--voxel-um={size}: exit {done.returncode}: {done.stderr}")
    done = read(work / "two.npz", out, "--array=one", "--resample-um=5")
    expect(done.returncode != 0 and "resample_um" in done.stderr, f"voxels wider than the box: {done.stderr}")


with tempfile.TemporaryDirectory() as folder:
    for test in (every_form, options, refused):
        test(pathlib.Path(folder))
for failure in failures:
    print("FAILED:", failure)
print(f"{checks} checks, {len(failures)} failed")
sys.exit(bool(failures))
