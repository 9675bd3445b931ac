#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Turns ArchNGV's tns_distributions.json into the comma-separated numbers that conceg-characterise reads.

    python3 data/astrocyte-barcodes.py tns_distributions.json > data/astrocyte-barcodes.csv

Kept: birth and death of every bar (um of path, three decimals), numbers of trees, soma radius, and the statistics of
trunk and tip diameters and sibling ratios. Left out: the angle terms, which depend on the frame of cells that are not here.
"""
import json
import sys

PROCESSES = {"basal": "perisynaptic", "axon": "perivascular"}


def numbers(process, key, data):
    trees = data[key]["num_trees"]
    if "norm" in trees:
        mean, sd = trees["norm"]["mean"], trees["norm"]["std"]
        low, high = mean - 2 * sd, mean + 2 * sd
    else:
        bins, weights = trees["data"]["bins"], trees["data"]["weights"]
        total = sum(weights)
        mean = sum(b * w for b, w in zip(bins, weights)) / total
        sd = (sum((b - mean) ** 2 * w for b, w in zip(bins, weights)) / total) ** 0.5
        low, high = min(bins), max(bins)
    for item, value in (("trees_mean", mean), ("trees_sd", sd), ("trees_low", low), ("trees_high", high)):
        yield f"number,{process},{item},{value:.6g},"
    for name, source in (("trunk", "trunk_diameters"), ("tip", "terminal_diameters"), ("sibling", "sibling_ratios")):
        params = data["diameter"][source][key]["params"]
        for item, field in (("loc", "loc"), ("scale", "scale"), ("shape", "a"), ("low", "min"), ("high", "max")):
            if field in params:
                yield f"number,{process},{name}_{item},{params[field]:.6g},"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        data = json.load(file)
    print("# SPDX-License-Identifier: Apache-2.0")
    print("# Astrocyte barcodes and diameter statistics from BlueBrain/ArchNGV (Apache-2.0), made by astrocyte-barcodes.py; see SOURCES.md.")
    print("record,process,item,first,second")
    soma = data["soma"]["size"]["norm"]
    print(f"number,soma,radius_mean,{soma['mean']:.6g},")
    print(f"number,soma,radius_sd,{soma['std']:.6g},")
    for key, process in PROCESSES.items():
        for line in numbers(process, key, data):
            print(line)
        for index, diagram in enumerate(data[key]["persistence_diagram"]):
            for death, birth, *_ in diagram:
                if death - birth >= 5e-4:
                    print(f"bar,{process},{index},{birth:.3f},{death:.3f}")


main()
