# SPDX-License-Identifier: BSD-3-Clause
"""Straightness per type against the dictionary, and how many bars reached their end, measured again with h5py.

usage: growth_types.py FILE.cgx [--within X] [--done-at-least X] [--mean-within LOW HIGH]

Straightness: end-to-end over path per branch of 2 um and more, resampled at 1 um. Types with fewer than 600 branches are
printed, and held to nothing: their standard error is too large.
"""
import argparse
import sys

import h5py
import numpy as np

ENOUGH = 600


def text(dataset):
    return [value.decode() if isinstance(value, bytes) else value for value in dataset[()]]


def straightness(line):
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    if along[-1] < 2.0:
        return None
    at = np.append(np.arange(0.0, along[-1], 1.0), along[-1])
    sampled = np.stack([np.interp(at, along, line[:, axis]) for axis in range(3)], axis=1)
    return np.linalg.norm(line[-1] - line[0]) / np.linalg.norm(np.diff(sampled, axis=0), axis=1).sum()


def plain_straightness(line):
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    return np.linalg.norm(line[-1] - line[0]) / length if length >= 2.0 else np.nan


def branches(position, parent):
    children = np.bincount(parent[parent >= 0], minlength=len(parent))
    child = np.full(len(parent), -1)
    child[parent[parent >= 0]] = np.flatnonzero(parent >= 0)  # of use where there is one child only
    for point in range(len(parent)):
        if parent[point] >= 0 and children[parent[point]] == 1:
            continue
        run = [parent[point]] if parent[point] >= 0 else []
        run.append(point)
        while children[run[-1]] == 1:
            run.append(child[run[-1]])
        yield position[run]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("file")
    arguments.add_argument("--within", type=float)
    arguments.add_argument("--done-at-least", type=float)
    arguments.add_argument("--mean-within", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of end-to-end over path of all branches, not resampled")
    options = arguments.parse_args()
    failed = 0
    with h5py.File(options.file) as document:
        entries = dict(zip(text(document["dictionary/entry_name"]), document["dictionary/entry_straightness"][()]))
        offset, position = document["skeleton/cell_offset"][()].astype(int), document["skeleton/position"][()]
        parent, cell_type = document["skeleton/parent"][()], document["cells/type"][()]
        names, asked = text(document["types/name"]), [entries[entry] for entry in text(document["types/entry"])]
        bars = document["bars"]
        done = np.abs(bars["achieved_end"][()] - bars["asked_end"][()]) < 1e-3
    found = {name: [] for name in names}
    for cell, kind in enumerate(cell_type):
        rows = slice(offset[cell], offset[cell + 1])
        values = (straightness(line) for line in branches(position[rows], parent[rows]))
        found[names[kind]] += [value for value in values if value is not None]
    for name, want in zip(names, asked):
        values = np.array(found[name])
        if len(values) < 2:
            continue
        apart, error = values.mean() - want, values.std() / np.sqrt(len(values))
        print(f"{name:20s} {len(values):6d} branches: asked {want:.3f}, got {values.mean():.4f} +- {error:.4f}, apart {apart:+.4f}")
        if options.within is not None and len(values) >= ENOUGH and abs(apart) + error > options.within:
            print(f"FAILED {name}: |difference| + 1 SE = {abs(apart) + error:.4f} > {options.within}")
            failed = 1
    if options.mean_within is not None:
        plain = np.concatenate([[plain_straightness(line) for line in branches(position[rows], parent[rows])] for rows in map(slice, offset[:-1], offset[1:])])
        mean = np.nanmean(plain)
        print(f"all types: straightness {mean:.4f}, {np.isfinite(plain).sum()} branches")
        if not options.mean_within[0] <= mean <= options.mean_within[1]:
            print(f"FAILED it is not within {options.mean_within[0]} and {options.mean_within[1]}")
            failed = 1
    print(f"bars that reach their end: {done.mean():.4f} of {len(done)}")
    if options.done_at_least is not None and done.mean() < options.done_at_least:
        print(f"FAILED fewer than {options.done_at_least} of the bars reach their end")
        failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
