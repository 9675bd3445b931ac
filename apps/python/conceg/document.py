# SPDX-License-Identifier: BSD-3-Clause
"""A document: one CGX file, as NumPy arrays by path."""
import ctypes as c
import os
import typing
import weakref

import numpy as np

from . import _library as lib
from .substrate import Substrate

if typing.TYPE_CHECKING:
    import pandas

_TEXT = 9
_DTYPES: typing.Dict[int, typing.Any] = {1: np.uint8, 2: np.int8, 3: np.uint32, 4: np.int32, 5: np.uint64, 6: np.int64, 7: np.float32, 8: np.float64}
_CODES = {np.dtype(kind): code for code, kind in _DTYPES.items()}
Path = typing.Union[str, "os.PathLike[str]"]


class ArrayInfo(typing.NamedTuple):
    """What an array is, without its values."""

    dtype: str
    shape: typing.Tuple[int, ...]
    unit: str


class Problem(typing.NamedTuple):
    """One broken rule of the format."""

    is_error: bool
    rule: str
    path: str
    expected: str
    got: str


class _Handle:
    """Owns conceg_doc and its context; freed in that order, once."""

    def __init__(self, make: typing.Callable[[lib.Context, typing.Any], None]) -> None:
        self.context = lib.Context()
        pointer = c.c_void_p()
        try:
            make(self.context, c.byref(pointer))
        except lib.ConcegError:
            self.context.free()
            raise
        self.pointer = pointer
        self.close = weakref.finalize(self, _Handle._free, self.context, pointer)

    @staticmethod
    def _free(context: lib.Context, pointer: c.c_void_p) -> None:
        with lib.lock:
            context.library.conceg_doc_close(pointer)
            context.free()


class Document:
    """An open document. `document[path]` is a copy of an array: "/cells/soma" a dataset, "/domain@lo" an attribute.

    The file is never changed; what is written into the document is kept by `save`.
    """

    def __init__(self) -> None:
        """An empty document."""
        self._begin(_Handle(lambda context, out: context.call(context.library.conceg_doc_new, context.pointer, out)))

    def _begin(self, handle: _Handle, path: typing.Optional[str] = None) -> None:
        self._handle, self._path = handle, path  # path: a file with the same content

    @classmethod
    def _of(cls, handle: _Handle, path: typing.Optional[str] = None) -> "Document":
        document = cls.__new__(cls)
        document._begin(handle, path)
        return document

    @classmethod
    def open(cls, path: Path) -> "Document":
        """Opens a file. Arrays are read when they are asked for."""
        name = os.path.abspath(os.fspath(path))
        return cls._of(_Handle(lambda context, out: context.call(context.library.conceg_doc_open, context.pointer, os.fsencode(name), out)), name)

    @classmethod
    def from_bytes(cls, image: bytes) -> "Document":
        """Opens the bytes of a file."""
        return cls._of(_Handle(lambda context, out: context.call(context.library.conceg_doc_from_memory, context.pointer, image, len(image), out)))

    def close(self) -> None:
        """Ends the document; NumPy arrays and substrates made from it stay."""
        self._handle.close()

    def __enter__(self) -> "Document":
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def _call(self, name: str, *arguments: typing.Any) -> None:
        self._alive()
        self._handle.context.call(getattr(self._handle.context.library, name), self._handle.pointer, *arguments)

    def _alive(self) -> None:
        if not self._handle.close.alive:
            raise lib.ConcegError(lib.Status.E_USAGE, "the document is closed")

    # ---- Arrays ----

    def _array(self, name: str, path: str) -> lib.Array:
        array = lib.Array(size=c.sizeof(lib.Array))
        self._call(name, path.encode(), c.byref(array))
        return array

    def __getitem__(self, path: str) -> typing.Any:
        """A copy: an array, a number or text for rank 0, an array of texts."""
        with lib.lock:
            array = self._array("conceg_doc_read", path)
            shape = tuple(array.shape[: array.rank])
            count = int(np.prod(shape, dtype=np.uint64))
            if array.dtype == _TEXT:
                texts = [(text or b"").decode(errors="replace") for text in (c.c_char_p * count).from_address(array.data)] if count else []
                return texts[0] if not shape else np.array(texts, dtype=np.str_).reshape(shape)
            kind = np.dtype(_DTYPES[array.dtype])
            values = np.frombuffer(c.string_at(array.data, count * kind.itemsize), kind).reshape(shape).copy() if count else np.empty(shape, kind)
            return values if shape else values[()]

    def __setitem__(self, path: str, value: typing.Any) -> None:
        self.write(path, value)

    def write(self, path: str, value: typing.Any, unit: typing.Optional[str] = None) -> None:
        """Copies an array, a number or texts into the document. Without `unit` the schema's."""
        values = np.asarray(value)
        array = lib.Array(size=c.sizeof(lib.Array), rank=values.ndim, unit=None if unit is None else unit.encode())
        if values.ndim > 4:
            raise lib.ConcegError(lib.Status.E_PARAM, f"{path}: expected at most 4 dimensions, got {values.ndim}")
        array.shape[: values.ndim] = values.shape
        keep: typing.Any
        if values.dtype.kind in "UO":
            keep = (c.c_char_p * max(1, values.size))(*(str(text).encode() for text in values.ravel()))
            array.dtype, array.data = _TEXT, c.cast(keep, c.c_void_p)
        else:
            code = _CODES.get(values.dtype.newbyteorder("="))
            if code is None:
                raise lib.ConcegError(lib.Status.E_PARAM, f"{path}: expected one of {', '.join(str(kind) for kind in _CODES)} or text, got {values.dtype}")
            keep = np.ascontiguousarray(values, values.dtype.newbyteorder("="))
            array.dtype, array.data = code, keep.ctypes.data
        self._call("conceg_doc_write", path.encode(), c.byref(array))
        self._path = None

    def __delitem__(self, path: str) -> None:
        """Removes a dataset, an attribute or a group with all below it."""
        if path not in self:
            raise lib.ConcegError(lib.Status.E_MISSING, f"{path}: the document does not have it")
        self._call("conceg_doc_drop", path.encode())
        self._path = None

    def __contains__(self, path: object) -> bool:
        self._alive()
        with lib.lock:
            return isinstance(path, str) and bool(self._handle.context.library.conceg_doc_has(self._handle.pointer, path.encode()))

    def __iter__(self) -> typing.Iterator[str]:
        return iter(self.paths())

    def paths(self, group: str = "/") -> typing.List[str]:
        """All datasets and attributes of a group and below, in canonical order."""
        self._alive()
        library, pointer, found = self._handle.context.library, self._handle.pointer, []
        with lib.lock:
            children = [library.conceg_doc_child(pointer, group.encode(), i).decode() for i in range(library.conceg_doc_children(pointer, group.encode()))]
        for child in children:
            if child.endswith("/"):
                found += self.paths(child.rstrip("/"))
            else:
                found.append(child)
        return found

    def describe(self, path: str) -> ArrayInfo:
        """Type, shape and unit, without reading the values."""
        with lib.lock:
            array = self._array("conceg_doc_describe", path)
            kind = "text" if array.dtype == _TEXT else np.dtype(_DTYPES[array.dtype]).name
            return ArrayInfo(kind, tuple(array.shape[: array.rank]), (array.unit or b"").decode())

    # ---- The whole ----

    def save(self, path: Path) -> None:
        """Writes the canonical file, whole or not at all."""
        name = os.path.abspath(os.fspath(path))
        self._call("conceg_doc_save", os.fsencode(name))

    def to_bytes(self) -> bytes:
        """The canonical file."""
        image, count = c.c_void_p(), c.c_size_t()
        self._call("conceg_doc_to_memory", c.byref(image), c.byref(count))
        try:
            return c.string_at(image.value or 0, count.value)
        finally:
            self._handle.context.library.conceg_free(image)

    def digest(self, group: str = "/") -> str:
        """SHA-256 of the content; "/" leaves the provenance out."""
        out = c.create_string_buffer(65)
        self._call("conceg_doc_digest", group.encode(), out)
        return out.value.decode()

    def validate(self, group: typing.Optional[str] = None) -> typing.List[Problem]:
        """Every broken rule of the format; none is an empty list."""
        found: typing.List[Problem] = []

        def note(_user: typing.Any, problem: typing.Any) -> None:
            p = problem.contents
            index = "".join(f"[{p.index[i]}]" for i in range(min(4, p.rank)))
            found.append(Problem(p.severity == 0, *((text or b"").decode(errors="replace") for text in (p.rule, (p.path or b"") + index.encode(), p.expected, p.got))))

        try:
            self._call("conceg_doc_validate", None if group is None else group.encode(), lib.ProblemFunction(note), None)
        except lib.ConcegError as problem:
            if problem.status != lib.Status.E_FORMAT or not found:
                raise
        return found

    def substrate(self) -> Substrate:
        """Box, cells, skeletons, meshes and volumes in memory; the document may be closed afterwards."""
        self._alive()
        return Substrate._from_document(self._handle.context, self._handle.pointer)

    # ---- Tables ----

    def signals(self) -> "pandas.DataFrame":
        """/signals and /protocol, a row per compartment and measurement, with the columns that `conceg import signal` reads."""
        import pandas

        b, direction, compartment = self["/protocol/b"], self["/protocol/direction"], self["/signals/compartment"]
        columns: typing.Dict[str, typing.Any] = {"compartment": np.repeat(compartment, len(b)), "b_ms/um2": np.tile(b, len(compartment))}
        for axis, name in enumerate("xyz"):
            columns[f"direction_{name}"] = np.tile(direction[:, axis], len(compartment))
        for name in ("pulse_duration", "pulse_separation"):
            if f"/protocol/{name}" in self:
                columns[f"{name}_ms"] = np.tile(self[f"/protocol/{name}"], len(compartment))
        columns["signal"], columns["standard_error"] = self["/signals/signal"].ravel(), self["/signals/standard_error"].ravel()
        return pandas.DataFrame(columns)

    def powder(self) -> "pandas.DataFrame":
        """Means over directions, a row per compartment and shell."""
        import pandas

        b, compartment = self["/signals/powder_b"], self["/signals/compartment"]
        return pandas.DataFrame({
            "compartment": np.repeat(compartment, len(b)), "b_ms/um2": np.tile(b, len(compartment)),
            "signal": self["/signals/powder"].ravel(), "standard_error": self["/signals/powder_error"].ravel()})

    def tables(self) -> typing.List[str]:
        """Names of the tables of /statistics."""
        return list(dict.fromkeys(path.split("/")[2] for path in self.paths("/statistics") if path.count("/") == 3))

    def table(self, name: str) -> "pandas.DataFrame":
        """A table of /statistics."""
        import pandas

        paths = [path for path in self.paths(f"/statistics/{name}") if "@" not in path]
        if not paths:
            raise lib.ConcegError(lib.Status.E_MISSING, f"/statistics/{name}: the document does not have it; there are: {', '.join(self.tables()) or 'none'}")
        return pandas.DataFrame({path.rsplit("/", 1)[1]: list(values) if (values := self[path]).ndim > 1 else values for path in paths})

    # ---- Stages ----

    def run(self, kind: str, **options: typing.Any) -> "Document":
        """The document that a stage makes of this one; options as of run_stage."""
        from .stages import run_stage

        return run_stage(kind, self, **options)

    def export(self, to: str, folder: Path, **options: typing.Any) -> None:
        """Writes files of another program into a folder (`conceg export --to`); options as of run_stage."""
        from .stages import run_sink

        run_sink("export", self, to=to, dir=os.fspath(folder), **options)

    def render(self, folder: Path, **options: typing.Any) -> None:
        """Draws pictures into a folder (`conceg render`); options as of run_stage."""
        from .stages import run_sink

        run_sink("render", self, dir=os.fspath(folder), **options)

    def report(self, page: Path, **options: typing.Any) -> None:
        """Writes one HTML page: the cells in 3-D, every table and signal as a chart (`conceg report`); options as of run_stage."""
        from .stages import run_sink

        run_sink("report", self, page=os.fspath(page), **options)
