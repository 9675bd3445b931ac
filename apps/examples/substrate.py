#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A meshed document from Python, twice: through libconceg with ctypes, and as the HDF5 file that it is with h5py.

    substrate.py FILE [--lib FOLDER]

FOLDER holds libconceg.so and libconceg_query.so; without it the loader looks. Asserts that both ways give the same, and
that each soma's centre lies in its own cell. Without h5py (and numpy, which it needs) the first way alone is shown.
"""
import argparse
import ctypes as c
import pathlib

try:
    import h5py
    import numpy
except ImportError:
    h5py = None


class CellView(c.Structure):
    """conceg_cell_view; `size` first, so that a newer library fills no more than this."""

    _fields_ = [("size", c.c_uint32), ("type", c.c_uint32), ("id", c.c_uint64), ("type_name", c.c_char_p),
                ("class_name", c.c_char_p), ("soma", c.c_double * 3), ("soma_radius", c.c_double)]


class MeshView(c.Structure):
    """The first members of conceg_mesh_view: a view may end early."""

    _fields_ = [("size", c.c_uint32), ("cell", c.c_uint32), ("vertex_count", c.c_uint64), ("face_count", c.c_uint64),
                ("vertex", c.POINTER(c.c_double)), ("face", c.POINTER(c.c_uint32)), ("compartment", c.POINTER(c.c_uint8)),
                ("volume", c.c_double), ("area", c.c_double)]


class Hit(c.Structure):
    """conceg_hit"""

    _fields_ = [("distance", c.c_double), ("normal", c.c_double * 3), ("cell", c.c_int64), ("face", c.c_uint64),
                ("compartment", c.c_uint8), ("reserved", c.c_uint8 * 7)]


def load(folder):
    """Both libraries, with the types of the functions that are used: a wrong type is a crash, not an exception."""
    prefix = str(pathlib.Path(folder).resolve()) + "/" if folder else ""
    core, query = c.CDLL(prefix + "libconceg.so"), c.CDLL(prefix + "libconceg_query.so")
    p, u64 = c.c_void_p, c.c_uint64
    for library, name, result, arguments in (
        (core, "conceg_ctx_new", p, []),
        (core, "conceg_ctx_free", None, [p]),
        (core, "conceg_ctx_error", c.c_char_p, [p]),
        (core, "conceg_status_text", c.c_char_p, [c.c_int]),
        (core, "conceg_substrate_open_file", c.c_int, [p, c.c_char_p, c.POINTER(p)]),
        (core, "conceg_substrate_free", None, [p]),
        (core, "conceg_substrate_box", None, [p, c.POINTER(c.c_double), c.POINTER(c.c_double), c.POINTER(c.c_uint8)]),
        (core, "conceg_substrate_cells", u64, [p]),
        (core, "conceg_substrate_cell", c.c_int, [p, u64, c.POINTER(CellView)]),
        (core, "conceg_substrate_meshes", u64, [p]),
        (core, "conceg_substrate_mesh", c.c_int, [p, u64, c.POINTER(MeshView)]),
        (query, "conceg_query_new", c.c_int, [p, p, c.POINTER(p)]),
        (query, "conceg_query_free", None, [p]),
        (query, "conceg_query_locate", c.c_int, [p, u64, c.POINTER(c.c_double), c.POINTER(c.c_int64), c.POINTER(c.c_uint8)]),
        (query, "conceg_query_intersect", c.c_int,
         [p, u64, c.POINTER(c.c_double), c.POINTER(c.c_double), c.POINTER(c.c_double), c.POINTER(Hit)]),
    ):
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return core, query


class Substrate:
    """An open substrate and its query; pointers of views stay valid until close()."""

    def __init__(self, path, folder=None):
        self.core, self.library = load(folder)
        self.ctx = self.core.conceg_ctx_new()
        self.handle, self.query = c.c_void_p(), c.c_void_p()
        self.check(self.core.conceg_substrate_open_file(self.ctx, str(path).encode(), c.byref(self.handle)))
        self.check(self.library.conceg_query_new(self.ctx, self.handle, c.byref(self.query)))

    def check(self, status):
        if status:
            detail = self.core.conceg_ctx_error(self.ctx) or self.core.conceg_status_text(status)
            raise SystemExit(f"substrate.py: {detail.decode()}")

    def close(self):
        self.library.conceg_query_free(self.query)
        self.core.conceg_substrate_free(self.handle)
        self.core.conceg_ctx_free(self.ctx)

    def box(self):
        lo, hi, periodic = (c.c_double * 3)(), (c.c_double * 3)(), (c.c_uint8 * 3)()
        self.core.conceg_substrate_box(self.handle, lo, hi, periodic)
        return list(lo), list(hi), list(periodic)

    def cells(self):
        for i in range(self.core.conceg_substrate_cells(self.handle)):
            view = CellView(size=c.sizeof(CellView))
            self.check(self.core.conceg_substrate_cell(self.handle, i, c.byref(view)))
            yield view

    def meshes(self):
        for i in range(self.core.conceg_substrate_meshes(self.handle)):
            view = MeshView(size=c.sizeof(MeshView))
            self.check(self.core.conceg_substrate_mesh(self.handle, i, c.byref(view)))
            yield view

    def locate(self, points):
        """Cell index (-1 = extracellular) and compartment code of each of a list of points."""
        flat = (c.c_double * (3 * len(points)))(*(x for point in points for x in point))
        cell, compartment = (c.c_int64 * len(points))(), (c.c_uint8 * len(points))()
        self.check(self.library.conceg_query_locate(self.query, len(points), flat, cell, compartment))
        return list(cell), list(compartment)

    def first_hit(self, origin, direction, length):
        hit = Hit()
        self.check(self.library.conceg_query_intersect(self.query, 1, (c.c_double * 3)(*origin), (c.c_double * 3)(*direction),
                                                       c.byref(c.c_double(length)), c.byref(hit)))
        return hit


def compare(substrate, path):
    """The same document by h5py; returns how many values were compared."""
    compared = 0

    def same(got, expected):
        nonlocal compared
        got, expected = numpy.asarray(got), numpy.asarray(expected)
        assert got.shape == expected.shape and (got == expected).all(), (got, expected)
        compared += got.size

    with h5py.File(path, "r") as file:
        lo, hi, periodic = substrate.box()
        same(lo, file["domain"].attrs["lo"])
        same(hi, file["domain"].attrs["hi"])
        same(periodic, file["domain"].attrs["periodic"])
        cells = list(substrate.cells())
        same([cell.id for cell in cells], file["cells/id"])
        same([cell.type for cell in cells], file["cells/type"])
        same([list(cell.soma) for cell in cells], file["cells/soma"])
        names = [name.decode() if isinstance(name, bytes) else name for name in file["types/name"]]
        assert [cell.type_name.decode() for cell in cells] == [names[cell.type] for cell in cells]
        vertex, face = file["meshes/vertex_offset"][()], file["meshes/face_offset"][()]
        for i, mesh in enumerate(substrate.meshes()):
            rows, faces = slice(vertex[i], vertex[i + 1]), slice(face[i], face[i + 1])
            same(numpy.ctypeslib.as_array(mesh.vertex, (mesh.vertex_count, 3)), file["meshes/vertex"][rows])
            same(numpy.ctypeslib.as_array(mesh.face, (mesh.face_count, 3)), file["meshes/face"][faces])
            same(numpy.ctypeslib.as_array(mesh.compartment, (mesh.face_count,)), file["meshes/compartment"][faces])
            same(mesh.volume, file["meshes/volume"][i])
            same(mesh.cell, file["meshes/cell"][i])
    return compared


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--lib", help="folder of the libraries")
    options = parser.parse_args()
    substrate = Substrate(options.file, options.lib)
    cells = list(substrate.cells())
    meshed = {mesh.cell for mesh in substrate.meshes()}
    with_soma = [i for i, cell in enumerate(cells) if cell.soma_radius > 0 and i in meshed]
    located, _ = substrate.locate([cells[i].soma for i in with_soma])
    assert located == with_soma, (located, with_soma)
    print(f"cells {len(cells)}, somas located in their own cells {len(located)}")
    for i in with_soma[:3]:
        hit = substrate.first_hit(cells[i].soma, (0, 0, 1), 100.0)
        assert hit.cell == i, (hit.cell, i)
        print(f"cell {cells[i].id}: {cells[i].type_name.decode()}, surface {hit.distance:.3f} um above the soma's centre")
    if h5py:
        print(f"values equal by ctypes and h5py {compare(substrate, options.file)}")
    else:
        print("h5py is not here: the file was not read a second time")
    substrate.close()


if __name__ == "__main__":
    main()
