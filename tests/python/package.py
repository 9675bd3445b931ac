# SPDX-License-Identifier: BSD-3-Clause
"""Documents and substrates of the Python package beside h5py; its tables of functions and structures beside the headers; errors; lifetimes.

package.py SOURCE BUILD"""
import ctypes
import gc
import os
import pathlib
import re
import subprocess
import sys

import h5py
import numpy as np

import conceg
from common import build, end, expect, program, raises, small, source, temporary
from conceg import _library


def text_of(value):
    return value.decode() if isinstance(value, bytes) else value


def of_h5py(file, path):
    name, _, attribute = path.partition("@")
    value = file[name or "/"].attrs[attribute] if attribute else file[name][()]
    if isinstance(value, np.ndarray) and value.dtype.kind in "OS":
        return np.array([text_of(item) for item in value.ravel()], dtype=np.str_).reshape(value.shape)
    return text_of(value)


def names_of_h5py(file):
    found = set()

    def visit(name, item):
        found.update({f"/{name}"} if isinstance(item, h5py.Dataset) else ())
        found.update(f"/{name}@{key}" for key in item.attrs)

    file.visititems(visit)
    found.update(f"/@{key}" for key in file.attrs)
    return found


def differences(document, path):
    """Paths whose values, types or units are not those of h5py."""
    wrong = []
    with h5py.File(path, "r") as file:
        for name in document.paths():
            ours, theirs, info = document[name], of_h5py(file, name), document.describe(name)
            same = np.shape(ours) == np.shape(theirs) == info.shape and np.array_equal(ours, theirs)
            if info.dtype != "text":
                same = same and np.asarray(ours).dtype == np.asarray(theirs).dtype == np.dtype(info.dtype)
            if "@" not in name:
                same = same and info.unit == text_of(file[name].attrs.get("unit", ""))
            if not same:
                wrong.append(name)
    return wrong


def interface():
    """Argument counts, sizes, member names and status values are those of the headers and of spec/symbols.tsv."""
    header = "\n".join(path.read_text() for path in sorted((source / "libconceg/include/conceg").glob("*.h")))
    header = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
    for name, (_, arguments) in {**_library.CORE, **_library.QUERY}.items():
        found = re.search(rf"\b{name}\(([^;{{]*?)\)\s*(?:CONCEG_NODISCARD|CONCEG_PRINTF\([^)]*\))?;", header, re.S)
        expect(found is not None, f"{name} is in no header")
        words = found.group(1).strip() if found else ""
        count = 0 if words in ("", "void") else words.count(",") + 1
        expect(count == len(arguments), f"{name}: {count} arguments in the header, {len(arguments)} here")
    rows = [line.split("\t") for line in (source / "spec/symbols.tsv").read_text().splitlines() if not line.startswith("#")]
    sizes = {row[1]: int(row[2]) for row in rows if row[0] == "struct"}
    values = {row[1]: int(row[2]) for row in rows if row[0] == "constant" and re.fullmatch(r"-?\d+", row[2])}
    views = (("conceg_array", _library.Array), ("conceg_problem", _library.ProblemView), ("conceg_cell_view", _library.CellView), ("conceg_skeleton_view", _library.SkeletonView),
             ("conceg_mesh_view", _library.MeshView), ("conceg_volumes_view", _library.VolumesView))
    for name, view in views:
        expect(ctypes.sizeof(view) == sizes[name], f"{name}: {sizes[name]} bytes, {ctypes.sizeof(view)} here")
        body = re.search(rf"typedef struct {name} \{{(.*?)\}} {name};", header, re.S).group(1)
        members = [re.sub(r"\[.*?\]|\*|\s", "", word.split()[-1]) for line in body.split(";") for word in line.split(",") if word.strip()]
        expect(members == [field[0] for field in view._fields_], f"{name}: {members}")
    expect({f"CONCEG_{status.name}": int(status) for status in conceg.Status} == {name: value for name, value in values.items() if re.match(r"CONCEG_(OK|E_\w+)$", name)}, "status values")


def document(path, folder):
    with conceg.open(path) as cube:
        with h5py.File(path, "r") as file:
            theirs = names_of_h5py(file)
        ours = set(cube.paths())
        # @unit is given by describe(), and the root's attributes are the format's own.
        missing = {name for name in theirs - ours if not name.endswith("@unit") and not name.startswith("/@")}
        expect(not missing and len(ours) > 100, f"paths that h5py has and we have not: {sorted(missing)[:5]}")
        expect(differences(cube, path) == [], f"not as by h5py: {differences(cube, path)[:5]}")
        expect(list(cube) == cube.paths() and "/cells/soma" in cube and "/cells/nothing" not in cube and 7 not in cube, "iteration and membership")
        expect(cube.validate() == [], f"a valid document: {cube.validate()[:1]}")
        expect(cube.to_bytes() == path.read_bytes(), "the canonical image is the file")
        expect(conceg.Document.from_bytes(path.read_bytes()).digest() == cube.digest() != cube.digest("/cells"), "digests")

        # Written values come back; the comparison with h5py sees that they are others.
        changed = conceg.open(path)
        radius = changed["/skeleton/radius"]
        radius[0] *= 1.5
        changed["/skeleton/radius"] = radius
        expect(differences(changed, path) == ["/skeleton/radius"], f"a planted change: {differences(changed, path)}")
        changed.write("/x_test/values", np.arange(6, dtype=np.int64).reshape(2, 3), unit="um")
        changed["/x_test/names"] = ["a", "µm"]
        changed["/x_test@scalar"] = 2.5
        changed.save(folder / "changed.cgx")
        expect(differences(conceg.open(folder / "changed.cgx"), folder / "changed.cgx") == [], "what was written is what h5py reads")
        again = conceg.open(folder / "changed.cgx")
        expect(again["/x_test/values"].tolist() == [[0, 1, 2], [3, 4, 5]] and again.describe("/x_test/values").unit == "um", "values and unit")
        expect(again["/x_test/names"].tolist() == ["a", "µm"] and again["/x_test@scalar"] == 2.5, "texts and scalars")
        del again["/x_test"]
        expect(not any("x_test" in name for name in again), "a group goes")
        again["/cells/radius"] = -again["/cells/radius"]
        problems = again.validate()
        by_program = subprocess.run([program, "validate", "-"], input=again.to_bytes(), capture_output=True)
        lines = [line for line in by_program.stdout.decode().splitlines() if re.match(r"^(error|warning)?:? ?CGX-", line) or "CGX-" in line]
        expect(any(p.is_error and "/cells/radius" in p.path for p in problems) and len(problems) == len(lines), f"broken rules: {problems[:2]}, by the program: {lines[:2]}")


def substrate(path):
    with h5py.File(path, "r") as file:
        tissue = conceg.Substrate.open(path)
        box, cells = tissue.box, tissue.cells
        expect(np.array_equal(box.lo, file["domain"].attrs["lo"]) and np.array_equal(box.hi, file["domain"].attrs["hi"]) and np.array_equal(box.periodic, file["domain"].attrs["periodic"]), "box")
        expect([cell.id for cell in cells] == list(file["cells/id"]) and [cell.type for cell in cells] == list(file["cells/type"]), "ids and types")
        expect(np.array_equal([cell.soma for cell in cells], file["cells/soma"]) and np.array_equal([cell.soma_radius for cell in cells], file["cells/radius"]), "somas")
        expect([cell.type_name for cell in cells] == [text_of(file["types/name"][cell.type]) for cell in cells], "names of types")
        expect([cell.class_name for cell in cells] == [text_of(file["types/class"][cell.type]) for cell in cells] and "Cell 0" in repr(cells[0]), "classes")
        expect(tissue.cell_with_id(cells[1].id).index == 1, "a cell by its id")
        start = file["skeleton/cell_offset"][()]
        for cell in cells:
            rows, skeleton = slice(start[cell.index], start[cell.index + 1]), cell.skeleton
            for name in conceg.Skeleton._fields:
                expect(np.array_equal(getattr(skeleton, name), file[f"skeleton/{name}"][rows]), f"cell {cell.index}: {name}")
            drawn = skeleton.to_pyvista()
            roots = int((skeleton.parent < 0).sum())
            expect(drawn.n_cells == len(skeleton.radius) - roots and np.array_equal(drawn.point_data["radius"], skeleton.radius), f"cell {cell.index}: lines for PyVista")
        vertex, face = file["meshes/vertex_offset"][()], file["meshes/face_offset"][()]
        for i, mesh in enumerate(tissue.meshes):
            at, of = slice(vertex[i], vertex[i + 1]), slice(face[i], face[i + 1])
            expect(np.array_equal(mesh.vertex, file["meshes/vertex"][at]), f"mesh {i}: vertices")
            for name in ("face", "compartment", "component", "section"):
                expect(np.array_equal(getattr(mesh, name), file[f"meshes/{name}"][of]), f"mesh {i}: {name}")
            for name in ("cell", "volume", "area", "genus", "min_gap", "closed"):
                expect(getattr(mesh, name) == file[f"meshes/{name}"][i], f"mesh {i}: {name}")
            expect(mesh.form == text_of(file["meshes/form"][i]) and np.array_equal(mesh.origin, file["meshes/origin"][i]) and mesh.first_face == face[i], f"mesh {i}: form, origin, first face")
            solid, drawn = mesh.to_trimesh(), mesh.to_pyvista()
            expect(solid.is_watertight and abs(solid.volume / mesh.volume - 1) < 1e-9 and abs(solid.area / mesh.area - 1) < 1e-9, f"mesh {i}: trimesh {solid.volume}, {mesh.volume}")
            expect(abs(drawn.volume / mesh.volume - 1) < 1e-5 and abs(drawn.area / mesh.area - 1) < 1e-5 and drawn.is_manifold, f"mesh {i}: PyVista {drawn.volume}, {mesh.volume}")
            expect(np.array_equal(drawn.cell_data["compartment"], mesh.compartment) and np.array_equal(solid.face_attributes["compartment"], mesh.compartment), f"mesh {i}: compartments")
        expect(len(tissue.to_pyvista()) == len(tissue.meshes) and [mesh.cell for mesh in cells[2].meshes] == [2], "surfaces of all and of a cell")
        volumes = tissue.volumes
        expect(np.array_equal(volumes.label.ravel(), file["volumes/label"][()].ravel()) and np.array_equal(volumes.distance.ravel(), file["volumes/distance"][()].ravel()), "labels and distances")
        expect(np.array_equal(volumes.leaf_origin, file["volumes/leaf_origin"]) and np.array_equal(volumes.shape, file["volumes"].attrs["shape"]) and np.array_equal(volumes.spacing, file["volumes"].attrs["spacing"]), "leaves and grid")

    # Just below a face is its cell, just above it is not; the sides are those of the winding, not of the library.
    mesh = tissue.meshes[0]
    corner = mesh.vertex[mesh.face[:: len(mesh.face) // 500]]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    points, normal = corner.mean(axis=1), normal / np.linalg.norm(normal, axis=1)[:, None]
    below, code = tissue.locate(points - 1e-5 * normal)
    above, none = tissue.locate(points + 1e-5 * normal)
    expect((below == 0).all() and (above == -1).all() and len(points) >= 500, f"{(below == 0).sum()} of {len(points)} points below faces, {(above == -1).sum()} above")
    expect((none == 0).all() and (code > 0).all() and set(code) <= set(mesh.compartment) and tissue.compartment_name(1) == "soma", "compartments of points")
    moved, _ = tissue.locate(points - 1e-5 * normal + (box.hi - box.lo) * [1, -2, 0])
    expect(np.array_equal(moved, below), "periodic images")
    hits = tissue.intersect([one.soma for one in cells], [[0, 0, 1]] * len(cells), 100.0)
    expect(np.array_equal(hits.cell, [0, 1, 2]) and (hits.distance > 0.8 * np.array([one.soma_radius for one in cells])).all() and np.allclose(np.linalg.norm(hits.normal, axis=1), 1), "rays leave their somas")
    expect(np.isinf(tissue.intersect(cells[0].soma, [0, 0, 1], 0.1).distance).all(), "nothing within 0.1 um")
    raises("E_USAGE", "shape (n, 3)", tissue.locate, [[1, 2]])
    raises("E_USAGE", "3 directions", tissue.intersect, [[0, 0, 0]] * 3, [[0, 0, 1]] * 2, 1)
    raises("E_RANGE", "", tissue.intersect, [0, 0, 0], [0, 0, 2], 1)
    raises("E_RANGE", "", tissue.cell, 99)
    raises("E_MISSING", "", tissue.cell_with_id, 1 << 40)
    raises("E_RANGE", "no compartment", tissue.compartment_name, 250)


def lifetimes(path):
    """Arrays outlive what they came from, and cannot be written through."""
    tissue = conceg.Substrate.open(path)
    vertex, skeleton = tissue.meshes[1].vertex, tissue.cells[1].skeleton
    before = vertex.copy(), skeleton.position.copy()
    tissue.locate([[1, 1, 1]])
    del tissue
    for _ in range(15):
        gc.collect()
        conceg.Substrate.open(path)  # memory that was freed would be handed out again
    expect(np.array_equal(vertex, before[0]) and np.array_equal(skeleton.position, before[1]), "views outlive the substrate")
    try:
        vertex[0] = 0
        expect(False, "a view could be written")
    except ValueError:
        expect(True, "")
    memory = []
    for _ in range(3):
        for _ in range(10):
            conceg.Substrate.open(path).locate([[1, 1, 1]])
        gc.collect()
        memory.append(int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path("/proc/self/status").read_text()).group(1)))
    expect(memory[2] - memory[1] < 10 * path.stat().st_size / 1024 / 4, f"memory comes back: {memory} KiB after 10 openings each")
    copy = conceg.open(path)
    soma = copy["/cells/soma"]
    copy.close()
    copy.close()
    expect(soma.shape == (3, 3), "copies outlive the document")
    for use in (lambda: copy["/cells/soma"], copy.paths, copy.substrate, copy.to_bytes, lambda: "/cells" in copy):
        raises("E_USAGE", "closed", use)


def errors(path, folder):
    raises("E_IO", "missing.cgx", conceg.open, folder / "missing.cgx")
    (folder / "text.cgx").write_text("no HDF5\n")
    raises("E_FORMAT", "text.cgx", conceg.open, folder / "text.cgx")
    (folder / "empty.cgx").write_bytes(b"")
    raises("E_FORMAT", "empty.cgx", conceg.open, folder / "empty.cgx")
    (folder / "cut.cgx").write_bytes(path.read_bytes()[:200000])
    raises("E_FORMAT", "cut.cgx", conceg.open, folder / "cut.cgx")
    raises("E_FORMAT", "", conceg.Document.from_bytes, b"nothing")
    cube = conceg.open(path)
    raises("E_MISSING", "/cells/nothing", lambda: cube["/cells/nothing"])
    raises("E_MISSING", "/cells/nothing", cube.__delitem__, "/cells/nothing")
    raises("E_MISSING", "there are", cube.table, "nothing")
    raises("E_PARAM", "complex128", cube.write, "/x_test/a", np.array([1j]))
    raises("E_PARAM", "4 dimensions", cube.write, "/x_test/a", np.zeros((1, 1, 1, 1, 1)))
    raises("E_PARAM", "", cube.write, "no path", 1.0)
    raises("E_IO", "no/such", cube.save, folder / "no/such/file.cgx")
    del cube["/domain"]
    raises("E_MISSING", "domain", cube.substrate)
    expect(conceg.Document().paths("/cells") == [], "an empty document")
    for value, pattern in (("/nonexistent/libconceg.so", "E_MISSING"), (str(build / "lib"), "3")):
        done = subprocess.run([sys.executable, "-c", f"import conceg; print(len(conceg.open({str(path)!r})['/cells/id']))"], env={**os.environ, "CONCEG_LIBRARY": value}, capture_output=True, text=True)
        expect(pattern in (done.stderr if pattern.startswith("E") else done.stdout) and (done.returncode != 0) == pattern.startswith("E"), f"CONCEG_LIBRARY={value}: {done.stderr[-200:]}")
    expect(conceg.library_version() == re.search(r'VERSION_TEXT "([\d.]+)"', (source / "libconceg/include/conceg/base.h").read_text()).group(1), "version")


with temporary() as name:
    work = pathlib.Path(name)
    cube = small(work, "mesh.h_um=0.6")
    interface()
    document(cube, work)
    substrate(cube)
    lifetimes(cube)
    errors(cube, work)
end("documents and substrates in Python")
