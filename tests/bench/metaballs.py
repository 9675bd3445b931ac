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


def images_near(low, high):
    """Elements of all periodic images within a box, with the lift they were moved by."""
    for lift in np.ndindex(5, 5, 5):
        shift = (np.array(lift) - 2) * side
        moved = rows[:, 1:4] + shift
        inside = ((moved > low) & (moved < high)).all(axis=1)
        yield rows[inside, 0].astype(int), moved[inside], rows[inside, 4], (np.array(lift) == 2).all()


def negatives(cell, own):
    """Elements of other cells and images that touch an element of this one, by a grid of 3 um."""
    boxes = collections.defaultdict(list)
    for i, p in enumerate(own):
        boxes[tuple((p[:3] // 3).astype(int))].append(i)
    for of, at, radius, home in images_near(own[:, :3].min(axis=0) - 3, own[:, :3].max(axis=0) + 3):
        for c, p, r in zip(of, at, radius):
            if c == cell and home:
                continue
            key = (p // 3).astype(int)
            near = [i for d in np.ndindex(3, 3, 3) for i in boxes.get(tuple(key + np.array(d) - 1), ())]
            if near and (np.linalg.norm(own[near, :3] - p, axis=1) < own[near, 3] + r + reach).any():
                yield p, r


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
for cell in np.unique(rows[:, 0].astype(int)):
    if time.monotonic() - begun > limit:
        left_out += 1
        continue
    own, negative = mesh_of(cell)
    elements, done = elements + own + negative, done + 1
    print(f"cell {cell}: {own} elements, {negative} negative, {time.monotonic() - begun:.1f} s", file=sys.stderr, flush=True)
print(json.dumps({"blender": bpy.app.version_string, "cells": done, "cells_left_out": left_out, "elements": elements,
                  "wall_s": round(time.monotonic() - begun, 2), "cpu_s": round(time.process_time(), 2)}))
