#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes CGX with h5py alone: each passed document from its text twin, and failed ones.  foreign.py CORPUS OUT"""
import pathlib
import re
import sys

import h5py
import numpy

TYPES = {"u8": "u1", "i8": "i1", "u32": "<u4", "i32": ">i4", "u64": "<u8", "i64": ">i8", "f32": "<f4", "f64": ">f8"}
HEAD = re.compile(r"^(/\S*) (\w+)((?:\[[\d,]*\])?)(?: ([^:]*))?:(.*)$")
STRING = re.compile(r'"((?:[^"\\]|\\.)*)"', re.S)
ESCAPE = {'\\"': '"', "\\\\": "\\", "\\n": "\n"}


def values_of(kind, text, shape):
    if kind == "text":
        words = [re.sub(r"\\.", lambda m: ESCAPE[m[0]], w) for w in STRING.findall(text)]
        if shape is None:
            return numpy.array(words[0], dtype=h5py.string_dtype())
        return numpy.array(words, dtype=object).astype(h5py.string_dtype()).reshape(shape)
    numbers = text.split()
    array = numpy.array(numbers, dtype=numpy.float64) if kind[0] == "f" else numpy.array([int(n) for n in numbers], dtype=object)
    array = array.astype(TYPES[kind])
    return array[0] if shape is None else array.reshape(shape)


def read_twin(path):
    """(path, type, shape or None, unit, values) of each array; rows are indented lines after a head."""
    heads = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("  "):
            heads[-1][4] += " " + line
        else:
            name, kind, shape, unit, rest = HEAD.match(line).groups()
            extents = tuple(int(n) for n in shape[1:-1].split(",")) if shape else None
            heads.append([name, kind, extents, unit or "", rest])
    return [(name, kind, shape, unit, values_of(kind, text, shape)) for name, kind, shape, unit, text in heads]


def write(path, arrays):
    with h5py.File(path, "w") as document:
        for name, kind, shape, unit, values in arrays:
            owner, _, attribute = name.partition("@")
            dtype = h5py.string_dtype() if kind == "text" else TYPES[kind]
            if attribute:
                item = document[owner] if owner in document else document.create_group(owner)
                item.attrs.create(attribute, values, shape=shape or (), dtype=dtype)
                continue
            document.create_dataset(name, data=values, shape=shape or (), dtype=dtype).attrs["unit"] = unit


def failed(out, arrays):
    """One defect each, made by h5py in a document that h5py wrote."""
    def put(path, index, value):
        return lambda document: document[path].__setitem__(index, value)
    rows = [
        ("0010-nan", "invalid", "CGX-030", put("cells/soma", (1, 2), float("nan"))),
        ("0011-index", "invalid", "CGX-034", put("cells/type", 2, 9)),
        ("0012-parent", "invalid", "CGX-050", put("skeleton/parent", 1, 1)),
        ("0013-no-array", "invalid", "CGX-020", lambda d: d.__delitem__("cells/radius")),
        ("0014-unit", "invalid", "CGX-011", lambda d: d["cells/soma"].attrs.__setitem__("unit", "mm")),
        ("0015-half", "invalid", "CGX-008", lambda d: d["cells"].create_dataset("half", data=numpy.zeros(3, "f2"))),
        ("0016-format", "not-a-document", "CGX-002", lambda d: d.attrs.__setitem__("format", "other")),
        ("0017-link", "not-a-document", "CGX-005", lambda d: d.__setitem__("x_alias", h5py.SoftLink("/cells"))),
    ]
    with open(out / "manifest.tsv", "w", encoding="utf-8") as manifest:
        for name, verdict, rule, defect in rows:
            path = out / "failed" / f"{name}.cgx"
            write(path, arrays)
            with h5py.File(path, "r+") as document:
                defect(document)
            manifest.write(f"failed/{name}.cgx\t{verdict}\t{rule}\t3\tby h5py\n")


def main():
    corpus, out = (pathlib.Path(word) for word in sys.argv[1:])
    for twin in sorted((corpus / "passed").glob("*.txt")):
        write(out / "passed" / f"{twin.stem}.cgx", read_twin(twin))
    failed(out, read_twin(corpus / "passed" / "0010-skeleton.txt"))


main()
