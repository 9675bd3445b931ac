# SPDX-License-Identifier: BSD-3-Clause
"""A substrate in memory: box, cells, skeletons, meshes, volumes, and which cell a point is in. Lengths in um.

Arrays are read-only views of the library's memory. They keep the substrate alive, so that they never go stale.
"""
import ctypes as c
import os
import typing
import weakref

import numpy as np
import numpy.typing as npt

from . import _library as lib

if typing.TYPE_CHECKING:
    import pyvista
    import trimesh

Floats = npt.NDArray[np.float64]
_HIT = np.dtype([("distance", "f8"), ("normal", "f8", 3), ("cell", "i8"), ("face", "u8"), ("compartment", "u1"), ("reserved", "u1", 7)])


class _Memory:
    """conceg_substrate and its context, freed when nothing refers to them any more."""

    def __init__(self, pointer: c.c_void_p) -> None:
        self.context = lib.Context()
        self.pointer = pointer
        self.query: typing.List[c.c_void_p] = []  # conceg_query, once somebody asked
        # At the end of the process the system takes the memory back: arrays may be in use until then.
        weakref.finalize(self, _Memory._free, self.context, pointer, self.query).atexit = False

    @staticmethod
    def _free(context: lib.Context, pointer: c.c_void_p, query: typing.List[c.c_void_p]) -> None:
        for made in query:
            lib.query().conceg_query_free(made)
        context.library.conceg_substrate_free(pointer)
        context.free()


class _Borrowed:
    """Memory of the library for NumPy, which keeps this object and with it the owner."""

    def __init__(self, address: int, shape: typing.Tuple[int, ...], kind: str, owner: object) -> None:
        self.__array_interface__ = {"data": (address, True), "shape": shape, "typestr": kind, "version": 3}
        self.owner = owner


def _view(address: typing.Optional[int], shape: typing.Tuple[int, ...], kind: str, owner: object) -> typing.Any:
    if not address:
        return None if shape[0] else np.empty(shape, kind)
    return np.asarray(_Borrowed(address, shape, kind, owner))


class Box(typing.NamedTuple):
    """Corners in um, and which axes repeat."""

    lo: Floats
    hi: Floats
    periodic: npt.NDArray[np.bool_]


class Skeleton(typing.NamedTuple):
    """Points of a cell's branches, parents first; positions are unwrapped."""

    position: Floats  # (points, 3)
    radius: npt.NDArray[np.float32]
    parent: npt.NDArray[np.int64]  # an earlier row, -1 = soma
    kind: npt.NDArray[np.uint8]  # SWC code
    target_radius: npt.NDArray[np.float32]
    branch: typing.Optional[npt.NDArray[np.uint32]]

    def to_pyvista(self) -> "pyvista.PolyData":
        """Line segments with radius, kind and branch at the points."""
        import pyvista

        row = np.flatnonzero(self.parent >= 0)
        lines = np.column_stack([np.full(len(row), 2), self.parent[row], row]).ravel()
        data = pyvista.PolyData(np.array(self.position), lines=lines) if len(row) else pyvista.PolyData(np.array(self.position))
        for name in ("radius", "kind", "branch"):
            values = getattr(self, name)
            if values is not None:
                data.point_data[name] = np.array(values)
        return data


class Mesh(typing.NamedTuple):
    """One triangle surface, outward; vertices are unwrapped."""

    cell: int
    vertex: Floats  # (vertices, 3)
    face: npt.NDArray[np.uint32]  # (faces, 3)
    compartment: npt.NDArray[np.uint8]  # of each face: conceg.Substrate.compartment_name
    component: typing.Optional[npt.NDArray[np.uint32]]
    section: typing.Optional[npt.NDArray[np.uint32]]  # branch of the skeleton, 4294967295 on the soma
    volume: float
    area: float
    first_face: int
    form: str
    closed: bool
    genus: int
    min_gap: float
    origin: Floats  # vertices are this plus a float32

    def to_trimesh(self) -> "trimesh.Trimesh":
        """The surface for trimesh, vertices and faces as they are; compartments in face_attributes."""
        import trimesh

        return trimesh.Trimesh(np.array(self.vertex), np.array(self.face, np.int64), process=False, face_attributes={"compartment": np.array(self.compartment)}, metadata={"cell": self.cell})

    def to_pyvista(self) -> "pyvista.PolyData":
        """The surface for PyVista, with the faces' compartments."""
        import pyvista

        data = pyvista.PolyData(np.array(self.vertex), faces=np.insert(self.face.astype(np.int64), 0, 3, axis=1).ravel())
        data.cell_data["compartment"] = np.array(self.compartment)
        data.cell_data["cell"] = np.full(len(self.face), self.cell)
        return data


class Volumes(typing.NamedTuple):
    """Labelled voxels in leaves of 8 x 8 x 8, x slowest; voxels in no leaf are extracellular."""

    leaf_origin: npt.NDArray[np.int32]  # (leaves, 3), voxel indices
    label: typing.Optional[npt.NDArray[np.uint32]]  # (leaves, 512), cell + 1, 0 = extracellular
    distance: typing.Optional[npt.NDArray[np.float32]]  # (leaves, 512), um, negative inside
    origin: Floats  # centre of voxel (0, 0, 0)
    spacing: Floats
    shape: typing.Tuple[int, int, int]


class Hits(typing.NamedTuple):
    """First faces that rays meet; distance is infinite and cell -1 where there is none."""

    distance: Floats
    normal: Floats
    cell: npt.NDArray[np.int64]
    face: npt.NDArray[np.uint64]
    compartment: npt.NDArray[np.uint8]


class Cell:
    """One cell of a substrate."""

    def __init__(self, substrate: "Substrate", index: int, view: lib.CellView) -> None:
        self._substrate, self.index = substrate, index
        self.id: int = view.id
        self.type_name: str = (view.type_name or b"").decode()
        self.class_name: str = (view.class_name or b"").decode()
        self.type: int = view.type
        self.soma: Floats = np.array(view.soma)
        self.soma_radius: float = view.soma_radius

    def __repr__(self) -> str:
        return f"<Cell {self.index}: id {self.id}, {self.type_name}, soma of {self.soma_radius:g} um at {self.soma.round(3).tolist()}>"

    @property
    def skeleton(self) -> typing.Optional[Skeleton]:
        """None when the cell has none."""
        return self._substrate._skeleton(self.index)

    @property
    def meshes(self) -> typing.List[Mesh]:
        """The surfaces of the cell."""
        return [mesh for mesh in self._substrate.meshes if mesh.cell == self.index]


class Substrate:
    """What a simulator needs, as plain memory (conceg_substrate)."""

    def __init__(self, memory: _Memory) -> None:
        self._memory = memory
        self._library = memory.context.library

    @classmethod
    def _from_document(cls, context: lib.Context, document: c.c_void_p) -> "Substrate":
        pointer = c.c_void_p()
        context.call(context.library.conceg_substrate_open, document, c.byref(pointer))
        return cls(_Memory(pointer))

    @classmethod
    def open(cls, path: typing.Union[str, "os.PathLike[str]"]) -> "Substrate":
        """From a file."""
        from .document import Document

        with Document.open(path) as document:
            return document.substrate()

    def _fill(self, name: str, view: typing.Any, *index: int) -> typing.Any:
        view.size = c.sizeof(view)
        self._memory.context.call(getattr(self._library, name), self._memory.pointer, *index, c.byref(view))
        return view

    @property
    def box(self) -> Box:
        """Corners and periodic axes."""
        lo, hi, periodic = (c.c_double * 3)(), (c.c_double * 3)(), (c.c_uint8 * 3)()
        self._library.conceg_substrate_box(self._memory.pointer, lo, hi, periodic)
        return Box(np.array(lo), np.array(hi), np.array(periodic, bool))

    @property
    def cells(self) -> typing.List[Cell]:
        """All cells, in the order of the rows."""
        return [self.cell(i) for i in range(self._library.conceg_substrate_cells(self._memory.pointer))]

    def cell(self, index: int) -> Cell:
        """The cell of a row."""
        return Cell(self, index, self._fill("conceg_substrate_cell", lib.CellView(), index))

    def cell_with_id(self, identity: int) -> Cell:
        """The cell with an id."""
        row = c.c_uint64()
        self._memory.context.call(self._library.conceg_substrate_find_cell, self._memory.pointer, identity, c.byref(row))
        return self.cell(row.value)

    def _skeleton(self, cell: int) -> typing.Optional[Skeleton]:
        v, m = self._fill("conceg_substrate_skeleton", lib.SkeletonView(), cell), self._memory
        n = v.count
        if not n:
            return None
        return Skeleton(_view(v.position, (n, 3), "<f8", m), _view(v.radius, (n,), "<f4", m), _view(v.parent, (n,), "<i8", m), _view(v.kind, (n,), "|u1", m), _view(v.target_radius, (n,), "<f4", m), _view(v.branch, (n,), "<u4", m))

    @property
    def meshes(self) -> typing.List[Mesh]:
        """All surfaces."""
        return [self.mesh(i) for i in range(self._library.conceg_substrate_meshes(self._memory.pointer))]

    def mesh(self, index: int) -> Mesh:
        """A surface."""
        v, m = self._fill("conceg_substrate_mesh", lib.MeshView(), index), self._memory
        n = v.face_count
        return Mesh(
            v.cell, _view(v.vertex, (v.vertex_count, 3), "<f8", m), _view(v.face, (n, 3), "<u4", m), _view(v.compartment, (n,), "|u1", m), _view(v.component, (n,), "<u4", m),
            _view(v.section, (n,), "<u4", m), v.volume, v.area, v.first_face, (v.form or b"").decode(), bool(v.closed), v.genus, v.min_gap, np.array(v.origin))

    @property
    def volumes(self) -> typing.Optional[Volumes]:
        """None when the document had no /volumes."""
        try:
            v, m = self._fill("conceg_substrate_volumes", lib.VolumesView()), self._memory
        except lib.ConcegError as problem:
            if problem.status == lib.Status.E_MISSING:
                return None
            raise
        n = v.leaf_count
        return Volumes(_view(v.leaf_origin, (n, 3), "<i4", m), _view(v.label, (n, 512), "<u4", m), _view(v.distance, (n, 512), "<f4", m), np.array(v.origin), np.array(v.spacing), (v.shape[0], v.shape[1], v.shape[2]))

    def to_pyvista(self) -> "pyvista.MultiBlock":
        """All surfaces, a block for each."""
        import pyvista

        return pyvista.MultiBlock([mesh.to_pyvista() for mesh in self.meshes])

    @staticmethod
    def compartment_name(code: int) -> str:
        """English name of a compartment code, such as "basal dendrite"."""
        name = lib.core().conceg_compartment_name(code)
        if name is None:
            raise lib.ConcegError(lib.Status.E_RANGE, f"{code} is no compartment code")
        return str(name.decode())

    # ---- Points and rays ----

    def _query(self) -> typing.Tuple[typing.Any, c.c_void_p]:
        library = lib.query()
        with lib.lock:
            if not self._memory.query:
                pointer = c.c_void_p()
                self._memory.context.call(library.conceg_query_new, self._memory.context.pointer, self._memory.pointer, c.byref(pointer))
                self._memory.query.append(pointer)
        return library, self._memory.query[0]

    def locate(self, points: npt.ArrayLike) -> typing.Tuple[npt.NDArray[np.int64], npt.NDArray[np.uint8]]:
        """Cell (-1 = extracellular) and compartment code of each point (points, 3), any periodic image."""
        at = _rows(points, 3, "points")
        cell, compartment = np.empty(len(at), np.int64), np.empty(len(at), np.uint8)
        library, query = self._query()
        self._memory.context.call(library.conceg_query_locate, query, len(at), at.ctypes.data, cell.ctypes.data, compartment.ctypes.data)
        return cell, compartment

    def intersect(self, origins: npt.ArrayLike, directions: npt.ArrayLike, lengths: npt.ArrayLike) -> Hits:
        """First face that each ray meets, from an origin along a unit vector within a length in um."""
        origin, direction = _rows(origins, 3, "origins"), _rows(directions, 3, "directions")
        length = np.ascontiguousarray(np.broadcast_to(np.asarray(lengths, float), len(origin)))
        if len(direction) != len(origin):
            raise lib.ConcegError(lib.Status.E_USAGE, f"expected {len(origin)} directions, one for each origin, got {len(direction)}")
        hit = np.empty(len(origin), _HIT)
        library, query = self._query()
        self._memory.context.call(library.conceg_query_intersect, query, len(origin), origin.ctypes.data, direction.ctypes.data, length.ctypes.data, hit.ctypes.data)
        return Hits(hit["distance"], hit["normal"], hit["cell"], hit["face"], hit["compartment"])


def _rows(values: npt.ArrayLike, width: int, what: str) -> Floats:
    array = np.ascontiguousarray(np.atleast_2d(np.asarray(values, float)))
    if array.ndim != 2 or array.shape[1] != width:
        raise lib.ConcegError(lib.Status.E_USAGE, f"{what}: expected an array of shape (n, {width}), got {array.shape}")
    return array
