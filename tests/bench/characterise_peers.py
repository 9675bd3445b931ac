# SPDX-License-Identifier: BSD-3-Clause
"""CPU time per cell of NeuroM's features and TMD's path-length barcodes, as JSON. usage: characterise_peers.py FILES

Imports are left out and loading is apart. A cell is loaded again for every run: both peers keep what they have once computed.
"""
import importlib.metadata
import json
import os
import statistics
import sys
import time
import warnings

warnings.simplefilter("ignore")
import morphio
import neurom
import numpy
from tmd import methods
from tmd.io import io as tmd_io

morphio.set_maximum_warnings(0)
option = morphio.Option.allow_unifurcated_section_change
sholl_step_um = 10.0
least_cpu_s, fewest_runs = 0.5, 2

# NeuroM's for what our tables hold; the hull is in volume_density.
of_cell = ["number_of_neurites", "number_of_sections", "number_of_bifurcations", "number_of_forking_points", "number_of_leaves", "total_length",
           "total_area", "total_volume", "max_radial_distance", "total_width", "total_height", "total_depth", "volume_density"]
of_sections = ["section_lengths", "section_end_distances", "section_tortuosity", "section_branch_orders", "section_strahler_orders",
               "section_path_distances", "section_radial_distances", "section_areas", "section_volumes", "section_taper_rates",
               "terminal_path_lengths", "local_bifurcation_angles", "remote_bifurcation_angles", "partition_asymmetry", "sibling_ratios",
               "diameter_power_relations"]


def repeat(prepare, work):
    """Times of work(prepare()), and of prepare() itself."""
    preparing, working = [], []
    while sum(working) < least_cpu_s or len(working) < fewest_runs:
        begin = time.process_time()
        prepared = prepare()
        middle = time.process_time()
        work(prepared)
        preparing.append(middle - begin), working.append(time.process_time() - middle)
    return times(preparing), times(working)


def times(seconds):
    return {"best_ms": round(1e3 * min(seconds), 4), "median_ms": round(1e3 * statistics.median(seconds), 4), "runs": len(seconds)}


def cell(path):
    def load():
        return neurom.core.Morphology(morphio.Morphology(path, option))

    def load_tmd():
        return tmd_io.load_neuron_from_morphio(morphio.Morphology(path, option))

    def features(morphology):
        for name in of_cell + of_sections:
            neurom.get(name, morphology)

    # Spheres until the farthest sample, as ours; the centre is given, for files without a soma.
    points = load().points[:, :3]
    center = points.mean(axis=0) if not len(load().soma.points) else load().soma.center
    radii = numpy.arange(sholl_step_um, numpy.linalg.norm(points - center, axis=1).max(), sholl_step_um)
    row = {"file": os.path.basename(path)}
    row["neurom_load"], row["neurom_features"] = repeat(load, features)
    _, row["neurom_sholl"] = repeat(load, lambda m: neurom.get("sholl_crossings", m, center=center, radii=radii))
    row["tmd_load"], row["tmd_barcode"] = repeat(load_tmd, lambda n: methods.get_ph_neuron(n, feature="path_distances"))
    row["tmd_bars"] = len(methods.get_ph_neuron(load_tmd(), feature="path_distances"))
    return row


versions = {name: importlib.metadata.version(name) for name in ("neurom", "morphio", "TMD", "numpy")}
peers, refused = [], []
for path in sys.argv[1:]:
    try:
        peers.append(cell(path))
    except morphio.RawDataError:
        refused.append(os.path.basename(path))
print(json.dumps({"versions": versions, "peers": peers, "refused_by_morphio": refused}))
