# SPDX-License-Identifier: BSD-3-Clause
"""Finding and loading libconceg, the types of its functions, and its errors."""
import ctypes as c
import enum
import logging
import os
import pathlib
import threading
import typing

logger = logging.getLogger("conceg")
# HDF5, below the library, serves one thread at a time.
lock = threading.RLock()


class Status(enum.IntEnum):
    """conceg_status"""

    OK = 0
    E_USAGE = -1
    E_NOMEM = -2
    E_IO = -3
    E_FORMAT = -4
    E_VERSION = -5
    E_MISSING = -6
    E_RANGE = -7
    E_PARAM = -8
    E_STAGE = -9
    E_ABI = -10
    E_UNSUPPORTED = -11
    E_CANCELLED = -12
    E_INTERNAL = -13


class ConcegError(Exception):
    """A call or a program that failed: what the library said, and its status."""

    def __init__(self, status: Status, message: str) -> None:
        super().__init__(f"{message} ({status.name})")
        self.status, self.message = status, message


class Array(c.Structure):
    """conceg_array"""

    _fields_ = [("size", c.c_uint32), ("dtype", c.c_int), ("rank", c.c_uint32), ("reserved", c.c_uint32), ("shape", c.c_uint64 * 4), ("data", c.c_void_p), ("unit", c.c_char_p)]


class ProblemView(c.Structure):
    """conceg_problem"""

    _fields_ = [("size", c.c_uint32), ("severity", c.c_uint32), ("rule", c.c_char_p), ("path", c.c_char_p), ("expected", c.c_char_p), ("got", c.c_char_p), ("rank", c.c_uint32), ("reserved", c.c_uint32), ("index", c.c_uint64 * 4)]


class CellView(c.Structure):
    """conceg_cell_view"""

    _fields_ = [("size", c.c_uint32), ("type", c.c_uint32), ("id", c.c_uint64), ("type_name", c.c_char_p), ("class_name", c.c_char_p), ("soma", c.c_double * 3), ("soma_radius", c.c_double)]


class SkeletonView(c.Structure):
    """conceg_skeleton_view"""

    _fields_ = [("size", c.c_uint32), ("reserved", c.c_uint32), ("count", c.c_uint64), ("position", c.c_void_p), ("radius", c.c_void_p), ("parent", c.c_void_p), ("kind", c.c_void_p), ("target_radius", c.c_void_p), ("branch", c.c_void_p)]


class MeshView(c.Structure):
    """conceg_mesh_view"""

    _fields_ = [("size", c.c_uint32), ("cell", c.c_uint32), ("vertex_count", c.c_uint64), ("face_count", c.c_uint64), ("vertex", c.c_void_p), ("face", c.c_void_p), ("compartment", c.c_void_p), ("volume", c.c_double), ("area", c.c_double), ("first_face", c.c_uint64), ("component", c.c_void_p), ("section", c.c_void_p), ("form", c.c_char_p), ("origin", c.c_double * 3), ("min_gap", c.c_double), ("genus", c.c_int64), ("closed", c.c_uint32), ("reserved", c.c_uint32)]


class VolumesView(c.Structure):
    """conceg_volumes_view"""

    _fields_ = [("size", c.c_uint32), ("reserved", c.c_uint32), ("leaf_count", c.c_uint64), ("leaf_origin", c.c_void_p), ("label", c.c_void_p), ("distance", c.c_void_p), ("origin", c.c_double * 3), ("spacing", c.c_double * 3), ("shape", c.c_uint64 * 3)]


LOG_LEVELS = {0: logging.ERROR, 1: logging.WARNING, 2: logging.INFO, 3: logging.DEBUG, 4: logging.DEBUG}
LOG_WARNING = 1
LogFunction = c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p)
ProblemFunction = c.CFUNCTYPE(None, c.c_void_p, c.POINTER(ProblemView))

_p, _text, _u64 = c.c_void_p, c.c_char_p, c.c_uint64
_out = c.POINTER(c.c_void_p)
# Result and arguments of the functions that are used: a wrong type would be a crash, not an exception.
CORE: typing.Dict[str, typing.Tuple[typing.Any, typing.List[typing.Any]]] = {
    "conceg_version": (_text, []),
    "conceg_status_text": (_text, [c.c_int]),
    "conceg_free": (None, [_p]),
    "conceg_ctx_new": (_p, []),
    "conceg_ctx_free": (None, [_p]),
    "conceg_ctx_error": (_text, [_p]),
    "conceg_ctx_clear_error": (None, [_p]),
    "conceg_ctx_set_log": (None, [_p, c.c_int, LogFunction, _p]),
    "conceg_doc_new": (c.c_int, [_p, _out]),
    "conceg_doc_open": (c.c_int, [_p, _text, _out]),
    "conceg_doc_from_memory": (c.c_int, [_p, _p, c.c_size_t, _out]),
    "conceg_doc_to_memory": (c.c_int, [_p, _out, c.POINTER(c.c_size_t)]),
    "conceg_doc_save": (c.c_int, [_p, _text]),
    "conceg_doc_close": (c.c_int, [_p]),
    "conceg_doc_digest": (c.c_int, [_p, _text, c.c_char_p]),
    "conceg_doc_validate": (c.c_int, [_p, _text, ProblemFunction, _p]),
    "conceg_doc_has": (c.c_int, [_p, _text]),
    "conceg_doc_read": (c.c_int, [_p, _text, c.POINTER(Array)]),
    "conceg_doc_describe": (c.c_int, [_p, _text, c.POINTER(Array)]),
    "conceg_doc_write": (c.c_int, [_p, _text, c.POINTER(Array)]),
    "conceg_doc_drop": (c.c_int, [_p, _text]),
    "conceg_doc_children": (_u64, [_p, _text]),
    "conceg_doc_child": (_text, [_p, _text, _u64]),
    "conceg_compartment_name": (_text, [c.c_uint32]),
    "conceg_substrate_open": (c.c_int, [_p, _out]),
    "conceg_substrate_free": (None, [_p]),
    "conceg_substrate_box": (None, [_p, c.POINTER(c.c_double), c.POINTER(c.c_double), c.POINTER(c.c_uint8)]),
    "conceg_substrate_cells": (_u64, [_p]),
    "conceg_substrate_cell": (c.c_int, [_p, _u64, c.POINTER(CellView)]),
    "conceg_substrate_find_cell": (c.c_int, [_p, _u64, c.POINTER(_u64)]),
    "conceg_substrate_skeleton": (c.c_int, [_p, _u64, c.POINTER(SkeletonView)]),
    "conceg_substrate_meshes": (_u64, [_p]),
    "conceg_substrate_mesh": (c.c_int, [_p, _u64, c.POINTER(MeshView)]),
    "conceg_substrate_volumes": (c.c_int, [_p, c.POINTER(VolumesView)]),
}
QUERY: typing.Dict[str, typing.Tuple[typing.Any, typing.List[typing.Any]]] = {
    "conceg_query_new": (c.c_int, [_p, _p, _out]),
    "conceg_query_free": (None, [_p]),
    "conceg_query_locate": (c.c_int, [_p, _u64, _p, _p, _p]),
    "conceg_query_intersect": (c.c_int, [_p, _u64, _p, _p, _p, _p]),
}
INTERFACE = "0.1"  # versions of the library that these tables describe


def _candidates() -> typing.Iterator[str]:
    """Where libconceg may be: CONCEG_LIBRARY (the file or its folder), beside the package, its environment's lib, the loader's path."""
    named = os.environ.get("CONCEG_LIBRARY")
    if named:
        path = pathlib.Path(named).resolve()
        yield str(path / "libconceg.so" if path.is_dir() else path)
        return
    here = pathlib.Path(__file__).resolve().parent
    for folder in (here, *list(here.parents)[:3]):  # PREFIX/lib/pythonX/site-packages/conceg up to PREFIX/lib
        if (folder / "libconceg.so").exists():
            yield str(folder / "libconceg.so")
    yield "libconceg.so.0"


def _load(path: str, functions: typing.Dict[str, typing.Tuple[typing.Any, typing.List[typing.Any]]]) -> c.CDLL:
    library = c.CDLL(path)
    for name, (result, arguments) in functions.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


class _Libraries:
    core: typing.Optional[c.CDLL] = None
    query: typing.Optional[c.CDLL] = None
    path = ""


def core() -> c.CDLL:
    """libconceg, loaded at the first call."""
    if _Libraries.core is None:
        tried = []
        for path in _candidates():
            try:
                loaded = _load(path, CORE)
            except (OSError, AttributeError) as problem:
                tried.append(str(problem))
                continue
            version = loaded.conceg_version().decode()
            if version.rsplit(".", 1)[0] != INTERFACE:
                raise ConcegError(Status.E_ABI, f"{path}: expected version {INTERFACE} of the library, got {version}")
            _Libraries.core, _Libraries.path = loaded, path
            return loaded
        raise ConcegError(Status.E_MISSING, f"libconceg was not found ({'; '.join(tried)}): set CONCEG_LIBRARY to libconceg.so or its folder")
    return _Libraries.core


def query() -> c.CDLL:
    """libconceg_query, beside libconceg."""
    if _Libraries.query is None:
        path = pathlib.Path(library_path())
        try:
            _Libraries.query = _load(str(path.with_name("libconceg_query.so")) if path.is_absolute() else "libconceg_query.so.0", QUERY)
        except OSError as problem:
            raise ConcegError(Status.E_MISSING, f"libconceg_query was not found beside libconceg: {problem}") from None
    return _Libraries.query


def library_path() -> str:
    """The file that answers: absolute, or the name that the loader found."""
    core()
    return _Libraries.path


def library_version() -> str:
    """Version of the library, "major.minor.patch"."""
    version: bytes = core().conceg_version()
    return version.decode()


def _log(_user: typing.Any, level: int, line: bytes) -> None:
    logger.log(LOG_LEVELS.get(level, logging.DEBUG), "%s", line.decode(errors="replace"))


_log_function = LogFunction(_log)


class Context:
    """conceg_ctx of one document; warnings go to the logger "conceg"."""

    def __init__(self) -> None:
        self.library = core()
        self.pointer = self.library.conceg_ctx_new()
        if not self.pointer:
            raise ConcegError(Status.E_NOMEM, "out of memory")
        self.library.conceg_ctx_set_log(self.pointer, LOG_WARNING, _log_function, None)

    def call(self, function: typing.Any, *arguments: typing.Any) -> None:
        """Calls a function that returns a status; raises what the library says of a failure."""
        with lock:
            self.library.conceg_ctx_clear_error(self.pointer)
            status = function(*arguments)
            if status:
                message = self.library.conceg_ctx_error(self.pointer) or self.library.conceg_status_text(status)
                raise ConcegError(Status(status), message.decode(errors="replace"))

    def free(self) -> None:
        self.library.conceg_ctx_free(self.pointer)
