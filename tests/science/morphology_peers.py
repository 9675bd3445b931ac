# SPDX-License-Identifier: BSD-3-Clause
"""`conceg characterise` on real cells against TMD's path-length barcodes and NeuroM's features, both run here.

usage: morphology_peers.py "OPTIONS OF CHARACTERISE" FILES      exit 1 when a figure differs by more than its tolerance
"""
import csv
import importlib.metadata
import logging
import pathlib
import re
import subprocess
import sys
import tempfile
import warnings

warnings.simplefilter("ignore")
logging.disable()  # NeuroM tells of a flat cell's hull in a page of text
import h5py
import morphio
import neurom
import numpy
from neurom import NeuriteType
from tmd import methods
from tmd.io import io as tmd_io

morphio.set_maximum_warnings(0)
option = morphio.Option.allow_unifurcated_section_change
types = {"all": NeuriteType.all, "axon": NeuriteType.axon, "basal": NeuriteType.basal_dendrite, "apical": NeuriteType.apical_dendrite}

# Both peers take coordinates as float32 from MorphIO: 2e-3 um for a bar or a section, whose own size does not count.
# `relative` is for lengths, areas and volumes of a whole group, `ratio` for what has no unit.
tolerance = {"count": 0.0, "relative": 1e-5, "ratio": 1e-5, "degree": 0.02, "bar_um": 2e-3, "section_um": 2e-3}
largest, compared, failures = dict.fromkeys(tolerance, 0.0), dict.fromkeys(tolerance, 0), []


def compare(what, kind, ours, theirs):
    ours, theirs = (numpy.atleast_1d(numpy.asarray(side, float)) for side in (ours, theirs))
    compared[kind] += len(theirs)
    if ours.shape != theirs.shape:
        failures.append(f"{what}: {len(ours)} values, theirs {len(theirs)}")
        return
    difference = numpy.abs(ours - theirs)
    if kind == "relative":
        difference /= numpy.maximum(numpy.abs(theirs), 1e-300)  # 0 must meet 0
    worst = float(difference.max(initial=0.0))
    largest[kind] = max(largest[kind], worst)
    if not worst <= tolerance[kind]:
        k = int(difference.argmax())
        failures.append(f"{what}: ours {ours[k]}, theirs {theirs[k]}")


def barcodes(trees):
    """Each tree's bars as rows of death and birth, in an order of their own; the trees likewise."""
    trees = [sorted(tuple(bar) for bar in tree) for tree in trees]
    return sorted(trees, key=lambda tree: (len(tree), tree[-1]))


def check_barcodes(name, path, document):
    with h5py.File(document) as file:
        death, birth = file["dictionary/bar_death"][()], file["dictionary/bar_birth"][()]
        offset = file["dictionary/tree_bar_offset"][()]
    ours = barcodes([zip(death[a:b], birth[a:b]) for a, b in zip(offset, offset[1:])])
    cell = tmd_io.load_neuron_from_morphio(morphio.Morphology(path, option))
    theirs = barcodes([methods.get_persistence_diagram(tree, feature="path_distances") for tree in cell.neurites])
    compare(f"{name}: bars of each tree", "count", [len(tree) for tree in ours], [len(tree) for tree in theirs])
    flat_ours, flat_theirs = ([end for tree in side for bar in tree for end in bar] for side in (ours, theirs))
    compare(f"{name}: barcode", "bar_um", flat_ours, flat_theirs)


def spread(row, column, kind, values):
    """Mean and deviation; both sides say 0 where there is nothing to take a mean of."""
    yield column, kind, row[column], numpy.mean(values) if len(values) else 0.0
    yield f"{column}_sd", kind, row[f"{column}_sd"], numpy.std(values) if len(values) else 0.0


def features(row, sections, one_soma_sample, get):
    """Of one group of a cell: what, how it is compared, ours, NeuroM's. `get` calls NeuroM for the group."""
    yield "stems", "count", row["stems"], get("number_of_neurites")
    for ours, theirs in (("sections", "sections"), ("forks", "forking_points"), ("bifurcations", "bifurcations"), ("tips", "leaves")):
        yield ours, "count", row[ours], get(f"number_of_{theirs}")
    orders = get("section_branch_orders")
    yield "order_largest", "count", row["order_largest"], max(orders) + 1
    yield "order_from_0", "ratio", row["order_from_0"], numpy.mean(orders)
    yield "strahler_largest", "count", row["strahler_largest"], max(get("section_strahler_orders"))
    for name in ("length", "area", "volume"):
        yield name, "relative", row[name], sum(get(f"total_{name}_per_neurite"))
    for axis, name in zip("xyz", ("width", "height", "depth")):
        yield f"extent_{axis}", "relative", row[f"extent_{axis}"], get(f"total_{name}")
    density = get("volume_density")  # not a number for a flat cell, whose hull is 0 with us
    yield "hull_volume", "relative", row["hull_volume"], row["volume"] / density if density == density else 0.0
    yield "path_largest", "relative", row["path_largest"], max(get("section_path_distances"))
    yield from spread(row, "section_length", "relative", get("section_lengths"))
    yield from spread(row, "tip_path", "relative", get("terminal_path_lengths"))
    yield from spread(row, "straightness", "ratio", 1 / numpy.array(get("section_tortuosity")))
    yield from spread(row, "taper", "ratio", numpy.array(get("section_taper_rates")) / 2)  # theirs is of the diameter
    yield from spread(row, "asymmetry", "ratio", get("partition_asymmetry"))
    for name in ("local_angle", "remote_angle"):
        degrees = {key: numpy.degrees(row[key]) for key in (name, f"{name}_sd")}
        yield from spread(degrees, name, "degree", numpy.degrees(get(f"{name[:-6]}_bifurcation_angles")))
    ratios = [s["sibling_ratio"] for s in sections if s["sibling_ratio"] >= 0]
    yield "sibling ratio of each fork", "ratio", sorted(ratios), sorted(r for r in get("sibling_ratios") if r == r)  # 0 / 0 is none
    for ours, theirs in (("length", "lengths"), ("chord", "end_distances"), ("path_distance", "path_distances")):
        yield f"{ours} of each section", "section_um", sorted(s[ours] for s in sections), sorted(get(f"section_{theirs}"))
    if one_soma_sample:  # of several each reader makes a centre of its own
        yield "radial distance of each section", "section_um", sorted(s["radial_distance"] for s in sections), sorted(get("section_radial_distances"))


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def rows_of(path):
    """Rows of a table, the unit at the end of a column's name left out."""
    return [{re.sub("_(um|um2|um3|rad)$", "", key): number(value) for key, value in row.items()} for row in csv.DictReader(open(path))]


def check_features(name, path, folder):
    cell = neurom.core.Morphology(morphio.Morphology(path, option))
    one_soma_sample = len(cell.soma.points) == 1
    sections, sholl = rows_of(folder / "section_metrics.csv"), rows_of(folder / "sholl.csv")
    for row in rows_of(folder / "cell_metrics.csv"):
        def get(feature, **more):
            return neurom.get(feature, cell, neurite_type=types[row["neurite"]], **more)

        group = row["neurite"]
        own = [s for s in sections if group in ("all", s["neurite"])]
        for what, kind, ours, theirs in features(row, own, one_soma_sample, get):
            compare(f"{name}: {group}: {what}", kind, ours, theirs)
        if one_soma_sample:
            spheres = [s for s in sholl if s["neurite"] == group][1::4]  # every fourth: NeuroM takes its time
            compare(f"{name}: {group}: crossings", "count", [s["crossings"] for s in spheres],
                    get("sholl_crossings", radii=[s["radius"] for s in spheres]))


def main():
    options, files = sys.argv[1].split(), sys.argv[2:]
    for path in files:
        with tempfile.TemporaryDirectory() as folder:
            scratch, name = pathlib.Path(folder), pathlib.Path(path).stem
            subprocess.run(["conceg", "characterise", path, *options, "--csv", scratch, "-o", scratch / "cell.cgx", "-q"], check=True)
            check_barcodes(name, path, scratch / "cell.cgx")
            check_features(name, path, scratch)
    tmd_version, neurom_version = map(importlib.metadata.version, ("TMD", "neurom"))
    for failure in failures:
        print(f"differs: {failure}")
    print(f"{len(files)} cells before TMD {tmd_version}: {compared['bar_um'] // 2} bars, largest difference {largest['bar_um']:.1e} um")
    print(f"{len(files)} cells before NeuroM {neurom_version}: {compared['count']} counts differ by {largest['count']:.0f}, largest difference of "
          f"{compared['relative']} lengths, areas and volumes {largest['relative']:.1e}, {compared['ratio']} ratios {largest['ratio']:.1e}, "
          f"{compared['degree']} angles {largest['degree']:.1e} degree, {compared['section_um']} figures of sections {largest['section_um']:.1e} um")
    return bool(failures) or not files


sys.exit(main())
