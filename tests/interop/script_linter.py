# SPDX-License-Identifier: BSD-3-Clause
"""Strict linters for three simulators that are driven by a script: DiSimPy (Python), dmipy-sim (Python), MCMRSimulator.jl (Julia).

Written from descriptions of their interfaces and file formats, without sight of our writer. The Python scripts are run before a stand-in for the simulator that
takes nothing but what the descriptions allow, and keeps what it is given.

The descriptions, as far as they are checked here:

* DiSimPy: `substrates.mesh(vertices (V, 3) float64, faces (F, 3) int, periodic, init_pos (N, 3) float64, n_sv (3,) int)`, `gradients.pgse(delta, Delta, n_t,
  bvals, bvecs)`, `simulations.simulation(n_walkers, D, gradient, dt, substrate, seed)`, all in SI units. The voxel is the bounding box of all points, its lower
  corner 0; two points at the end that no face uses pin it. A cut surface breaks the parity that seeding by the program relies on, so init_pos is given, one
  row per walker, strictly inside of the box. bvecs have length 1 (a zero one raises) and are never (-1, 0, 0) (raises).
* dmipy-sim: `Mesh.from_ply(path, scale, periodic, voxel_min, voxel_max, feature_radius)`: the PLY (any that trimesh reads; here binary) in um with scale 1e-6,
  the box explicit and in m, cut surfaces stitched at its faces; feature_radius in m (its sub-step is a sixth of it).
* MCMRSimulator.jl: `load_mesh(file; repeats=[x, y, z])` per cell (without repeats where nothing is periodic), um; text PLY with `vertex_indices` (linter_text.ply), closed and outward; the program
  repeats them whole.

What the descriptions leave open: n_sv, the number of time steps, the values of further keywords, and whether MCMRSimulator lets a cell be longer than its repeats.
"""

import contextlib
import io
import pathlib
import re
import runpy
import sys
import types

import numpy

from linter_text import binary_ply, check_closed, check_cut, fault, lines_of, ply


class Kept(dict):
    """What a script has handed over; `refuse` names the script."""

    def __init__(self, path):
        super().__init__()
        self.path = path

    def need(self, good, expected, got):
        if not good:
            fault((self.path, 0), expected, got)


@contextlib.contextmanager
def stand_in(modules, arguments):
    """Modules of that name are these, and sys.argv is that, while a script runs."""
    before, argv = {name: sys.modules.get(name) for name in modules}, sys.argv
    sys.modules.update(modules)
    sys.argv = arguments
    try:
        yield
    finally:
        sys.argv = argv
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module


def package(name, **members):
    module = types.ModuleType(name)
    for key, value in members.items():
        setattr(module, key, value)
    return module


def disimpy(folder, where):
    """Run run.py for `where` (intra, extra); return what the stand-in kept: vertices, faces, start (m), b (s/m^2), directions, and the signal's rows."""
    folder = pathlib.Path(folder)
    path = folder / "run.py"
    kept = Kept(path)

    def mesh(vertices, faces, periodic, padding=None, init_pos="uniform", n_sv=None, quiet=False):
        kept.need(vertices.dtype == numpy.float64 and vertices.ndim == 2 and vertices.shape[1] == 3 and numpy.isfinite(vertices).all(), "finite float64 points (V, 3)", vertices.dtype)
        kept.need(numpy.issubdtype(faces.dtype, numpy.integer) and faces.ndim == 2 and faces.shape[1] == 3, "whole faces (F, 3)", faces.dtype)
        kept.need(isinstance(periodic, bool) and padding is None, "a mesh, periodic or not, without padding", (periodic, padding))
        kept.need(faces.min() >= 0 and faces.max() < len(vertices), f"corners below {len(vertices)}", faces.max())
        side = vertices.max(axis=0)
        kept.need((vertices.min(axis=0) == 0).all() and 1e-6 < side.min() and side.max() < 1e-2, "a box in m that begins at 0", (vertices.min(axis=0), side))
        used = numpy.zeros(len(vertices), bool)
        used[faces] = True
        kept.need(used[:-2].all() and not used[-2:].any() and (vertices[-2:] == [[0, 0, 0], side]).all(), "two points at the end that pin the box", vertices[-2:])
        check_cut(path, vertices, faces, side)
        if not periodic:  # the program puts walls around the box
            check_closed(path, vertices, faces)
        kept.need(isinstance(init_pos, numpy.ndarray) and init_pos.dtype == numpy.float64 and init_pos.ndim == 2 and init_pos.shape[1] == 3, "places of the walkers (N, 3)", init_pos)
        outside = numpy.flatnonzero(((init_pos <= 0) | (init_pos >= side)).any(axis=1))
        kept.need(not len(outside), "walkers strictly inside of the box", init_pos[outside[:1]])
        kept.need(numpy.shape(n_sv) == (3,) and numpy.issubdtype(numpy.asarray(n_sv).dtype, numpy.integer) and numpy.min(n_sv) >= 1, "n_sv of three whole numbers", n_sv)
        kept.update(vertices=vertices, faces=faces, start=init_pos, side=side, periodic=periodic)
        return kept

    def pgse(delta, DELTA, n_t, bvals, bvecs):
        kept.need(0 < delta <= DELTA < 1 and isinstance(n_t, int) and n_t > 100, "0 < delta <= Delta in s and whole steps", (delta, DELTA, n_t))
        kept.need(bvals.ndim == 1 and bvecs.shape == (len(bvals), 3), "bvals (n,) and bvecs (n, 3)", (bvals.shape, bvecs.shape))
        kept.need((bvals >= 0).all() and 1e8 < bvals.max() < 1e12, "b in s/m^2", bvals.max())
        kept.need(numpy.abs(numpy.linalg.norm(bvecs, axis=1) - 1).max() < 1e-6, "directions of length 1", bvecs[numpy.abs(numpy.linalg.norm(bvecs, axis=1) - 1).argmax()])
        kept.need(numpy.abs(bvecs - [-1, 0, 0]).max(axis=1).min() > 1e-6, "no direction (-1, 0, 0)", "one")
        kept.update(b=bvals, directions=bvecs, pulse=delta, separation=DELTA)
        return kept, (delta + DELTA) / (n_t - 1)

    def simulation(n_walkers, diffusivity, gradient, dt, substrate, seed=123, **_):
        kept.need(gradient is kept and substrate is kept and 0 < dt < 1e-3, "gradient, dt and substrate of this script", dt)
        kept.need(n_walkers == len(kept["start"]), f"{len(kept['start'])} walkers, a place for each", n_walkers)
        kept.need(1e-10 < diffusivity < 1e-8, "a diffusivity in m^2/s", diffusivity)
        kept["walkers"] = n_walkers
        return numpy.linspace(n_walkers, 0, len(kept["b"]))

    parts = {"substrates": package("disimpy.substrates", mesh=mesh), "gradients": package("disimpy.gradients", pgse=pgse), "simulations": package("disimpy.simulations", simulation=simulation)}
    modules = {"disimpy": package("disimpy", __path__=[], **parts), **{f"disimpy.{name}": module for name, module in parts.items()}}
    before = set(folder.iterdir())
    with stand_in(modules, [str(path), where]), contextlib.redirect_stdout(io.StringIO()):
        runpy.run_path(str(path), run_name="__main__")
    kept.need("walkers" in kept, "a simulation", "none")
    written = set(folder.iterdir()) - before
    kept.need([p.name for p in written] == [f"signal_{where}.txt"], f"signal_{where}.txt written", sorted(p.name for p in written))
    rows = numpy.loadtxt(folder / f"signal_{where}.txt", ndmin=2)
    (folder / f"signal_{where}.txt").unlink()
    expected = numpy.linspace(1, 0, len(kept["b"]))
    kept.need(rows.shape == (len(expected), 5) and numpy.allclose(rows[:, 4], expected) and numpy.allclose(rows[:, 0] * 1e6, kept["b"]), "rows of b (s/mm^2), direction and signal", rows.shape)
    return kept


def dmipy_sim(folder):
    """Run mesh.py; return points (um), triangles, the box (um), the feature radius (um) and whether the box is periodic."""
    folder = pathlib.Path(folder)
    path = folder / "mesh.py"
    kept = Kept(path)

    class Mesh:
        @staticmethod
        def from_ply(file, scale, periodic, voxel_min, voxel_max, feature_radius, permeability=0, intra=None, extra=None):
            kept.update(file=pathlib.Path(file), scale=scale, periodic=periodic, low=numpy.array(voxel_min), side=numpy.array(voxel_max), radius=feature_radius)
            return kept

    with stand_in({"dmipy_sim": package("dmipy_sim", Mesh=Mesh)}, [str(path)]):
        members = runpy.run_path(str(path), run_name="mesh")
        kept.need(callable(members.get("mesh")), "a function mesh()", sorted(members))
        kept.need(members["mesh"]() is kept and members["mesh"](permeability=1e-5) is kept, "mesh() to return the mesh", "another")
    kept.need(kept["scale"] == 1e-6 and isinstance(kept["periodic"], bool), "um (scale 1e-6), and a periodic box or not", (kept["scale"], kept["periodic"]))
    kept.need((kept["low"] == 0).all() and 1e-6 < kept["side"].min() and kept["side"].max() < 1e-2, "a box in m that begins at 0", (kept["low"], kept["side"]))
    kept.need(kept["file"].parent.resolve() == folder.resolve(), f"a mesh in {folder}", kept["file"])
    kept.need(1e-9 < kept["radius"] < kept["side"].min() / 2, "a feature radius in m", kept["radius"])
    vertex, face = binary_ply(kept["file"])
    side = kept["side"] * 1e6
    check_cut(kept["file"], vertex, face, numpy.round(side, 9))
    if not kept["periodic"]:
        check_closed(kept["file"], vertex, face)
    return vertex, face, side, kept["radius"] * 1e6, kept["periodic"]


def mcmr(folder):
    """Read geometry.jl; return {file: (points, triangles)} and the repeats (um), None without."""
    folder = pathlib.Path(folder)
    path = folder / "geometry.jl"
    text = "\n".join(line for line in lines_of(path, empty=True) if not line.lstrip().startswith("#"))
    form = re.fullmatch(r'\s*using MCMRSimulator\s+files = \[\s*((?:"[^"\\$]+",\s*)+)\]\s+geometry = \[load_mesh\(joinpath\(@__DIR__, file\)(?:; repeats=\[([^\]]+)\])?\) for file in files\]\s*', text)
    if not form:
        fault((path, 1), "using MCMRSimulator, files = [...] and geometry = [load_mesh(joinpath(@__DIR__, file); repeats=[x, y, z]) for file in files]", repr(text[:80]))
    repeats = numpy.array([float(word) for word in form[2].split(",")]) if form[2] else None
    if form[2] and (repeats.shape != (3,) or repeats.min() < 1):
        fault((path, 1), "three repeats in um", form[2])
    names = re.findall(r'"([^"]+)"', form[1])
    if len(set(names)) != len(names) or set(names) != {p.name for p in folder.glob("*.ply")}:
        fault((path, 1), "each mesh of the folder once", names)
    meshes = {}
    for name in names:
        meshes[name] = ply(folder / name)
        check_closed(folder / name, *meshes[name])
    return meshes, repeats


if __name__ == "__main__":
    for folder in map(pathlib.Path, sys.argv[1:]):
        print(folder, {"disimpy": lambda f: [disimpy(f, w)["walkers"] for w in ("intra", "extra")], "dmipy-sim": lambda f: dmipy_sim(f)[2:], "mcmr": lambda f: len(mcmr(f)[0])}[folder.name](folder))
