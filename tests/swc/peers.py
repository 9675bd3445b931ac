#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Repaired SWC files before other readers: MorphIO, NeuroM and navis load each, with the same samples, radii and length.

peers.py FOLDER BROKEN    exit 1 when one of them does not, or when the file BROKEN, which needs repair, finds no fault
"""
import pathlib
import sys
import warnings

warnings.simplefilter("ignore")
import morphio
import navis
import neurom
import numpy

navis.set_pbars(hide=True)
navis.set_loggers("ERROR")
morphio.set_maximum_warnings(0)
option = morphio.Option.allow_unifurcated_section_change


def rows_of(path):
    """Our own reading of the plain columns: id, type, x, y, z, radius, parent."""
    lines = [line.split() for line in open(path) if not line.startswith("#")]
    return numpy.array([[float(word) for word in line] for line in lines])


def length_of(rows):
    """Cable of neurites: segments whose two ends are no soma."""
    place = {int(row[0]): row for row in rows}
    ends = [(row, place.get(int(row[6]))) for row in rows if row[1] != 1]
    return sum(float(numpy.linalg.norm(a[2:5] - b[2:5])) for a, b in ends if b is not None and b[1] != 1)


def morphio_reads(path, rows):
    cell = morphio.Morphology(str(path), option)
    neurites = rows[rows[:, 1] != 1]
    # A section repeats the last sample of the one before it.
    points = {tuple(numpy.float32([*p, d / 2])) for s in cell.iter() for p, d in zip(s.points, s.diameters)}
    wanted = {tuple(numpy.float32(row[2:6])) for row in neurites}
    near(sorted(points), sorted(wanted), "MorphIO's samples")
    soma = rows[rows[:, 1] == 1]
    near(cell.soma.points.reshape(-1, 3), soma[:, 2:5], "MorphIO's soma")
    near(cell.soma.diameters / 2, soma[:, 5], "MorphIO's soma radius")


def neurom_reads(path, rows):
    cell = neurom.core.Morphology(morphio.Morphology(str(path), option))
    length = sum(neurom.get("total_length_per_neurite", cell))
    near(length, length_of(rows), "NeuroM's length")


def navis_reads(path, rows):
    nodes = navis.read_swc(str(path)).nodes
    near(nodes[["x", "y", "z", "radius"]].to_numpy(), rows[:, 2:6], "navis' samples")
    near(nodes["parent_id"].to_numpy(), rows[:, 6], "navis' parents")


def near(got, wanted, what):
    got, wanted = numpy.asarray(got, float), numpy.asarray(wanted, float)
    if got.shape != wanted.shape:
        raise ValueError(f"{what}: expected shape {wanted.shape}, got {got.shape}")
    if got.size and not numpy.allclose(got, wanted, rtol=2e-6, atol=2e-6):
        raise ValueError(f"{what}: differ by {numpy.abs(got - wanted).max():g}")


readers = {"MorphIO": morphio_reads, "NeuroM": neurom_reads, "navis": navis_reads}


def faults(path):
    rows = rows_of(path)
    for name, reads in readers.items():
        try:
            reads(path, rows)
        except Exception as problem:
            yield f"{path.name}: {name}: {type(problem).__name__}: {problem}"


def main():
    files = sorted(pathlib.Path(sys.argv[1]).rglob("*.swc"))
    found = [fault for path in files for fault in faults(path)]
    print(*found, sep="\n")
    print(f"{len(files)} files before {', '.join(readers)}: {len(found)} failures")
    if not list(faults(pathlib.Path(sys.argv[2]))):
        print(f"{sys.argv[2]}: it needs repair, and no reader failed: the check finds nothing")
        return True
    return bool(found) or not files


sys.exit(main())
