# SPDX-License-Identifier: BSD-3-Clause
"""The unions of two sets of round cones, such as the skeletons and somas of two documents, by points."""
import h5py
import numpy as np
from scipy.spatial import cKDTree


def cones(path):
    """Ends and radii of all segments; a root is joined to its soma's centre; somas are segments of length 0."""
    with h5py.File(path, "r") as file:
        offset, position, radius, parent = (file[f"skeleton/{name}"][()] for name in ("cell_offset", "position", "radius", "parent"))
        soma, soma_radius = file["cells/soma"][()], file["cells/radius"][()].astype(float)
        lo = file["domain"].attrs["lo"]
    radius = radius.astype(float)
    cell = np.repeat(np.arange(len(soma)), np.diff(offset).astype(np.int64))
    up = np.where(parent >= 0, parent + offset[cell].astype(np.int64), 0)
    root, joined = parent < 0, soma_radius[cell] > 0
    start = np.where((root & joined)[:, None], soma[cell], np.where(root[:, None], position, position[up]))
    first = np.where(root, radius, radius[up])
    somas = soma_radius > 0
    return (np.concatenate([start, soma[somas]]) - lo, np.concatenate([position, soma[somas]]) - lo, np.concatenate([first, soma_radius[somas]]), np.concatenate([radius, soma_radius[somas]]))


def spheres(rows):
    """The same of spheres alone (x y z r)."""
    return rows[:, :3], rows[:, :3], rows[:, 3], rows[:, 3]


def inside(points, pieces):
    """Which points lie in a cone: the least of |p - c(t)| - r(t) along it is below 0."""
    a, b, r0, r1 = pieces
    tree = cKDTree(points)
    found = np.zeros(len(points), bool)
    reach = np.linalg.norm(b - a, axis=1) / 2 + np.maximum(r0, r1)
    for near, p, q, s, e in zip(tree.query_ball_point((a + b) / 2, reach), a, b, r0, r1):
        near = [i for i in near if not found[i]]
        if not near:
            continue
        v, d = points[near] - p, q - p
        length = np.linalg.norm(d)
        t = np.zeros(len(near))
        if length > 0:
            x, slope = v @ d / length, (e - s) / length
            if abs(slope) < 1:
                y = np.sqrt(np.maximum(0, (v * v).sum(axis=1) - x * x))
                t = np.clip((x + slope * y / np.sqrt(1 - slope * slope)) / length, 0, 1)
            else:
                t[:] = slope > 0
        found[near] = np.linalg.norm(v - t[:, None] * d, axis=1) < s + t * (e - s)
    return found


def share_that_differs(one, other, side, count=100000):
    """Points in one union and not in the other, over the points in the first; and these."""
    points = np.random.default_rng(1).random((count, 3)) * side
    a, b = inside(points, one), inside(points, other)
    return (a != b).sum() / a.sum(), int(a.sum())
