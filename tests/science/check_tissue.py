# SPDX-License-Identifier: BSD-3-Clause
"""Reads a finished document with h5py alone, a reader that is not ours, and measures again what it claims.

usage: check_tissue.py FILE.cgx [--icvf-at-least X]
"""
import argparse
import sys

import h5py
import numpy as np

failures = []
checks = 0


def check(what, passed, detail=""):
    global checks
    checks += 1
    if not passed:
        failures.append(what)
    print(f"{'ok    ' if passed else 'FAILED'} {what} {detail}")


def text(dataset):
    return [value.decode() if isinstance(value, bytes) else value for value in dataset[()]]


def surfaces(document):
    meshes = document["meshes"]
    vertex, face = meshes["vertex"][()], meshes["face"][()].astype(np.int64)
    vertices, faces = meshes["vertex_offset"][()], meshes["face_offset"][()]
    for k in range(len(vertices) - 1):
        yield k, vertex[vertices[k]:vertices[k + 1]], face[faces[k]:faces[k + 1]]


def check_meshes(document):
    total = 0.0
    asked = document["meshes/volume"][()]
    origin = document["meshes/origin"][()]
    for k, v, f in surfaces(document):
        directed = np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])
        key = directed[:, 0] * len(v) + directed[:, 1]
        reverse = directed[:, 1] * len(v) + directed[:, 0]
        once = len(np.unique(key)) == len(key)
        check(f"surface {k}: each directed edge once, with its reverse", once and np.array_equal(np.sort(key), np.sort(reverse)))
        check(f"surface {k}: every vertex is used", len(np.unique(f)) == len(v))
        a, b, c = (v[f[:, i]] - origin[k] for i in range(3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        check(f"surface {k}: outward, volume as written", volume > 0 and abs(volume - asked[k]) < 1e-6 * volume, f"{volume:.1f} um3")
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        check(f"surface {k}: no degenerate triangle", area.min() > 0, f"smallest {area.min():.2e} um2")
        f32 = (v - origin[k]).astype(np.float32).astype(np.float64)
        check(f"surface {k}: vertices are float32 offsets from the origin", np.array_equal(f32 + origin[k], v))
        total += volume
    side = document["domain"].attrs["hi"] - document["domain"].attrs["lo"]
    icvf = total / np.prod(side)
    check("ICVF as written", abs(icvf - document["meshes"].attrs["icvf"]) < 1e-6, f"{icvf:.4f}")
    check("no crossing was found, and pairs were looked at",
          document["meshes"].attrs["crossings"] == 0 and document["meshes"].attrs["pairs_checked"] > 0,
          f"{document['meshes'].attrs['pairs_checked']} pairs")
    check("one surface for each cell", np.array_equal(np.sort(document["meshes/cell"][()]), np.arange(len(document["cells/id"]))))
    return icvf


def check_bars(document):
    bars = document["bars"]
    state = bars["state"][()]
    asked = bars["asked_end"][()] - bars["asked_start"][()]
    achieved = bars["achieved_end"][()] - bars["achieved_start"][()]
    check("every bar has a final state", (state != 0).all(), f"done {np.mean(state == 1):.3f}, short {np.mean(state == 2):.3f}, "
          f"lost {np.mean(state == 3):.3f}, handed on {np.mean(state == 4):.3f}")
    done = state == 1
    check("bars that are done end where asked", np.abs(bars["achieved_end"][()] - bars["asked_end"][()])[done].max() < 1e-3, "(1 nm)")
    print(f"       cable achieved / asked: {achieved[achieved > 0].sum() / asked.sum():.3f}")


def check_apical(document):
    classes = np.array(text(document["types/class"]))[document["cells/type"][()]]
    soma = document["cells/soma"][()]
    offset = document["skeleton/cell_offset"][()]
    position, kind, parent = (document["skeleton/" + name][()] for name in ("position", "kind", "parent"))
    up = []
    for i in np.flatnonzero(classes == "pyramidal"):
        rows = slice(offset[i], offset[i + 1])
        tips = np.ones(offset[i + 1] - offset[i], bool)
        tips[parent[rows][parent[rows] >= 0]] = False
        apical = tips & (kind[rows] == 4)
        if apical.any():
            up.append(position[rows][apical, 2].mean() > soma[i, 2])
    check("apical tips lie on the pia side for >= 90 % of the pyramidal cells", len(up) > 0 and np.mean(up) >= 0.9, f"{np.sum(up)} of {len(up)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file")
    parser.add_argument("--icvf-at-least", type=float, default=0.0)
    options = parser.parse_args()
    with h5py.File(options.file, "r") as document:
        check("format and version", document.attrs["format"] in (b"conceg-interchange", "conceg-interchange") and document.attrs["version"][0] == 1)
        icvf = check_meshes(document)
        check("the tissue is dense enough", icvf >= options.icvf_at_least, f"{icvf:.4f} >= {options.icvf_at_least}")
        check_bars(document)
        check_apical(document)
    print(f"{checks} checks, {len(failures)} failed")
    sys.exit(1 if failures else 0)


main()
