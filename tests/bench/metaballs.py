# SPDX-License-Identifier: BSD-3-Clause
"""The paper's way of meshing, inside Blender: each cell a family of metaballs, elements of other cells near it negative; turned into a
mesh by Blender's own polygoniser.  blender -b --factory-startup --python metaballs.py -- BALLS OUT_FOLDER STEP_UM SECONDS

Writes cell_<row>.bin (bench_mesh_peers reads them) and prints a JSON line; cells not begun after SECONDS are left out and counted."""
import collections
import json
import pathlib
import struct
import sys
import time

import bpy
import numpy as np

balls_path, out, step, limit = sys.argv[sys.argv.index("--") + 1 :]
out, step, limit = pathlib.Path(out), float(step), float(limit)
side, *rows = [list(map(float, line.split())) for line in open(balls_path)]
rows, side = np.array(rows), np.array(side)
# A lone element of Blender's default stiffness 2 at threshold 0.6 shows 0.575 of its radius; in a chain half a radius apart the fields
# add up to (4 R / r) (32 / 35) (1 - r^2 / R^2)^3.5, which is the threshold at R = 1.46 r.
threshold, lone, chain = 0.6, 1 / 0.575, 1.46
reach = 0.2  # um beyond touching at which elements of others are taken as negative


# All elements wrapped into the box, sorted by cells of a grid that is wider than any two touching neurites.
count = np.maximum(1, (side // 2.5).astype(int))
wrapped = rows[:, 1:4] % side
keys = np.ravel_multi_index(np.minimum((wrapped / side * count).astype(int), count - 1).T, count)
order = np.argsort(keys, kind="stable")
first = np.searchsorted(keys[order], np.arange(count.prod() + 1))
somas = np.flatnonzero(rows[:, 4] > 1.0)


def near(p):
    """Rows of elements in the grid's 27 cells about a point, and those too thick for the grid."""
    at = np.minimum((p % side / side * count).astype(int), count - 1)
    cells = {int(np.ravel_multi_index((at + np.array(d) - 1) % count, count)) for d in np.ndindex(3, 3, 3)}
    return np.concatenate([order[first[c] : first[c + 1]] for c in sorted(cells)] + [somas])


def negatives(cell, own):
    """Elements of other cells and of its own images that come close to an element of this one."""
    found = {}
    for p, r in zip(own[:, :3], own[:, 3]):
        candidates = near(p)
        off = rows[candidates, 1:4] - p
        off -= side * np.round(off / side)
        close = np.linalg.norm(off, axis=1) < r + rows[candidates, 4] + reach
        moved = np.abs(p + off - rows[candidates, 1:4]).max(axis=1) > 1e-6
        for i, at in zip(candidates[close & (moved | (rows[candidates, 0] != cell))], (p + off)[close & (moved | (rows[candidates, 0] != cell))]):
            found[(int(i), *np.round(at, 3))] = (at, rows[i, 4])
    return found.values()


def mesh_of(cell):
    own = rows[rows[:, 0] == cell][:, 1:]
    meta = bpy.data.metaballs.new(f"family{cell}")
    meta.resolution, meta.render_resolution, meta.threshold = step, step, threshold
    thing = bpy.data.objects.new(f"family{cell}", meta)
    bpy.context.scene.collection.objects.link(thing)
    for index, (x, y, z, r) in enumerate(own):
        element = meta.elements.new()
        element.co, element.radius = (x, y, z), r * (lone if index == 0 else chain)
    count = 0
    for p, r in negatives(cell, own):
        element = meta.elements.new()
        element.co, element.radius, element.use_negative, count = p, r * chain, True, count + 1
    graph = bpy.context.evaluated_depsgraph_get()
    made = thing.evaluated_get(graph).to_mesh()
    made.calc_loop_triangles()
    vertex = np.empty(3 * len(made.vertices), np.float32)
    face = np.empty(3 * len(made.loop_triangles), np.int32)
    made.vertices.foreach_get("co", vertex)
    made.loop_triangles.foreach_get("vertices", face)
    with open(out / f"cell_{cell}.bin", "wb") as file:
        file.write(struct.pack("<QQ", len(vertex) // 3, len(face) // 3) + vertex.tobytes() + face.astype(np.uint32).tobytes())
    bpy.data.objects.remove(thing)
    bpy.data.metaballs.remove(meta)
    return len(own), count


begun, elements, done, left_out = time.monotonic(), 0, 0, 0
sizes = collections.Counter(rows[:, 0].astype(int).tolist())
for cell in sorted(sizes, key=lambda c: (sizes[c], c)):  # small ones first: most cells are made before the time is over
    if time.monotonic() - begun > limit:
        left_out += 1
        continue
    own, negative = mesh_of(cell)
    elements, done = elements + own + negative, done + 1
    print(f"cell {cell}: {own} elements, {negative} negative, {time.monotonic() - begun:.1f} s", file=sys.stderr, flush=True)
print(json.dumps({"blender": bpy.app.version_string, "cells": done, "cells_left_out": left_out, "elements": elements,
                  "wall_s": round(time.monotonic() - begun, 2), "cpu_s": round(time.process_time(), 2)}))
