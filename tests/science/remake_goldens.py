#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Golden figures against their producers, NeuroM and TMD, run again here: none of ours goes into them.

usage: remake_goldens.py [--regenerate] [--table FILE] SHARED

SHARED/goldens/morphology/goldens.json is compared with the peers of today, figure by figure, and never written. So is
stages/characterise/tests/default_dictionary.tsv, from the reconstructions of data/mouse-visual-cortex.csv in
SHARED/morphologies; it is written anew with --regenerate alone. Exit 1 when a figure differs.
"""
import argparse
import csv
import hashlib
import importlib.metadata
import json
import pathlib
import sys
import warnings

warnings.simplefilter("ignore")
import morphio
import neurom
import numpy
from neurom import NeuriteType
from neurom.features.bifurcation import local_bifurcation_angle
from tmd import methods
from tmd.io import io as tmd_io

root = pathlib.Path(__file__).resolve().parents[2]
morphio.set_maximum_warnings(0)
types = {"all": NeuriteType.all, "axon": NeuriteType.axon, "basal": NeuriteType.basal_dendrite, "apical": NeuriteType.apical_dendrite}
counted = ("neurites", "sections", "segments", "bifurcations", "forking_points", "leaves")
spread_of = ("section_lengths", "section_term_lengths", "section_bif_lengths", "section_branch_orders", "section_term_branch_orders",
             "section_tortuosity", "partition_asymmetry")
# The file has seven figures, of float32 coordinates; 1e-6 is for what should be 0.
relative, absolute = 1e-5, 1e-6


def load(path):
    return morphio.Morphology(str(path), morphio.Option.allow_unifurcated_section_change)


def spread(values):
    return {"n": len(values), "mean": numpy.mean(values), "std": numpy.std(values)} if len(values) else {"n": 0, "mean": None, "std": None}


def figures(cell, neurite_type):
    """Of one group, in the form of goldens.json."""
    def get(feature, **more):
        return neurom.get(feature, cell, neurite_type=neurite_type, **more)

    out = {f"number_of_{what}": numpy.sum(get(f"number_of_{what}")) for what in counted}
    out.update({f"total_{what}": sum(get(f"total_{what}_per_neurite")) for what in ("length", "area", "volume")})
    out.update({name: spread(get(name)) for name in spread_of})
    out["section_branch_orders"]["max"] = max(get("section_branch_orders"))
    out["tau"] = spread(1 / numpy.array(get("section_tortuosity")))
    for name in ("local", "remote"):
        out[f"{name}_bifurcation_angles_deg"] = spread(numpy.degrees(get(f"{name}_bifurcation_angles")))
    for name in ("section_path_distances", "terminal_path_lengths"):
        out[f"{name}_q"] = list(numpy.percentile(get(name), [0, 5, 25, 50, 75, 95, 100]))
    # From each tree's first sample, as asked of a tree; of a cell NeuroM takes the soma.
    own = [tree for tree in cell.neurites if neurite_type in (NeuriteType.all, tree.type)]
    out["max_radial_distance"] = max(neurom.get("max_radial_distance", tree) for tree in own)
    out["sholl_crossings_20_500_20"] = get("sholl_crossings", radii=range(20, 501, 20))
    out["section_strahler_orders_max"] = max(get("section_strahler_orders"))
    return out


def barcodes(morphology):
    trees = tmd_io.load_neuron_from_morphio(morphology).neurites
    return [sorted(methods.get_persistence_diagram(tree, feature="path_distances"), reverse=True) for tree in trees]


class Comparison:
    def __init__(self):
        self.count, self.largest, self.different = 0, 0.0, 0

    def figure(self, what, stored, now):
        self.count += 1
        difference = abs(stored - now)
        self.largest = max(self.largest, difference / max(abs(now), absolute / relative))
        if not difference <= relative * abs(now) + absolute:
            self.different += 1
            print(f"differs: {what}: stored {stored}, now {now}")

    def walk(self, what, stored, now):
        """What is stored must be there now; NeuroM has more."""
        if isinstance(stored, dict):
            for key, value in stored.items():
                self.walk(f"{what}: {key}", value, now[key])
        elif isinstance(stored, list):
            self.figure(f"{what}: number", len(stored), len(now))
            for k, (a, b) in enumerate(zip(stored, now)):
                self.walk(f"{what}: {k}", a, b)
        elif stored is not None or now is not None:  # neither: both say that there is nothing to take a mean of
            self.figure(what, numpy.nan if stored is None else stored, numpy.nan if now is None else now)


def check_goldens(folder):
    stored, result = json.load(open(folder / "goldens.json")), Comparison()
    for name, cell in stored["cells"].items():
        path = folder / cell["file"]
        if hashlib.sha256(path.read_bytes()).hexdigest() != cell["sha256"]:
            sys.exit(f"{path} is not the file that the figures are of")
        morphology = neurom.core.Morphology(load(path))
        for group, wanted in cell["groups"].items():
            result.walk(f"{name}: {group}", wanted, figures(morphology, types[group]))
        bars = [sorted(tree["bars"], reverse=True) for tree in cell["path_barcode"]["trees"]]
        result.walk(f"{name}: barcodes", sorted(bars), sorted(barcodes(load(path))))
    print(f"goldens.json, made by {versions(stored['versions'])}: {result.count} figures, {result.different} differ, largest {result.largest:.1e}")
    return result.different == 0 and result.count > 0


def versions(of):
    return ", ".join(f"{name} {of[name]}" for name in ("neurom", "morphio", "TMD") if name in of)


def beyond_soma(cell, radius_um):
    """Sections of all but axons with their order, 1 at the root. What ends inside a sphere that the table gives is soma."""
    order = {}
    for section in (s for tree in cell.neurites for s in tree.root_node.ipreorder()):
        before = order.get(section.parent.id, 0) if section.parent else 0
        far = numpy.linalg.norm(section.points[:, :3] - cell.soma.center, axis=1).max() >= radius_um
        order[section.id] = before + 1 if before or far else 0
        if order[section.id] and section.type != NeuriteType.axon:
            yield section, order[section.id]


def entries(shared):
    """Means of the cells' means of order and branch length, and of all local angles."""
    rows = csv.DictReader(line for line in open(root / "data/mouse-visual-cortex.csv") if not line.startswith("#"))
    cells = {}
    for row in rows:
        if row["file"].endswith(".swc"):
            cell = neurom.core.Morphology(load(shared / "morphologies" / row["file"]))
            sections = list(beyond_soma(cell, float(row["soma_radius_um"] or 0)))
            angles = [local_bifurcation_angle(s) for s, _ in sections if len(s.children) == 2]
            cells.setdefault(row["entry"], []).append(
                (numpy.mean([order for _, order in sections]), numpy.mean([s.length for s, _ in sections]), angles))
    for name, of in cells.items():
        angles = numpy.degrees(numpy.concatenate([angles for _, _, angles in of]))
        yield name, len(of), numpy.mean([order for order, _, _ in of]), numpy.mean([length for _, length, _ in of]), numpy.mean(angles)


def check_dictionary(shared, table, regenerate):
    now = list(entries(shared))
    if regenerate:
        made = {name: importlib.metadata.version(name) for name in ("neurom", "morphio")}
        lines = [f"# Made by {versions(made)} from the reconstructions without axons, else as they are: tests/science/remake_goldens.py --regenerate",
                 "# entry\tcells\torder\tbranch_um\tlocal_angle_degree"]
        lines += [f"{name}\t{count}\t{order:.6f}\t{length:.6f}\t{angle:.6f}" for name, count, order, length, angle in now]
        table.write_text("\n".join(lines) + "\n")
    lines, result = table.read_text().splitlines(), Comparison()
    stored = {line.split("\t")[0]: [float(word) for word in line.split("\t")[1:]] for line in lines if not line.startswith("#")}
    result.walk(table.name, stored, {name: values for name, *values in now})
    result.figure(f"{table.name}: entries", len(stored), len(now))
    print(f"{table.name}: {result.count} figures, {result.different} differ, largest {result.largest:.1e}")
    return result.different == 0


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("shared", type=pathlib.Path)
parser.add_argument("--table", type=pathlib.Path, default=root / "stages/characterise/tests/default_dictionary.tsv")
parser.add_argument("--regenerate", action="store_true", help="write the committed table anew")
arguments = parser.parse_args()
good = check_goldens(arguments.shared / "goldens/morphology")
sys.exit(not (check_dictionary(arguments.shared, arguments.table, arguments.regenerate) and good))
