# SPDX-License-Identifier: BSD-3-Clause
"""A strict linter for CATERPillar sphere tables (9 or 10 columns).

Written from a description of the format alone, without sight of the program's
writer or reader of it, so that the two can disagree.

The description, as far as it is checked here:

* `voxel.csv` is a sphere table with one space between fields, lengths in um,
  numbers as the C++ operator << prints them (6 significant digits). The 9
  columns are cell_type cell_id component component_id X Y Z inner_radius
  outer_radius; the 10-column layout has parent_component_id after
  component_id.
* All axons come first, then the glial cells, then the blood vessels. Axons
  are sorted by initial radius, largest first, and their ids need not be
  monotonic. A glial cell is one soma row, then its branch rows, each branch
  from soma to tip. cell_id restarts at 0 for each cell type and for each
  population of glia: two populations with 9 columns, three with 10.
* component_id is 0 for axons and somas. A vessel's side branches are `branch`
  rows with a component_id above 0.
* 0 < inner radius <= outer radius; equal for glia and vessels.
* Neighbouring spheres of a chain are max(r1, r2) / F apart; F is 4.
* The voxel is [0, L]^3; centres may lie outside it. L is `Voxel Size` in
  `voxel_growth_info.txt`, a file of `key value` lines where a key may hold
  spaces and digits.

What the description leaves open is not checked: how far outside the voxel a
centre may lie, the names of further keys (any key is taken, its value is
checked), whether the first branch of a glial cell is 0 or 1 (0 also stands
for the soma), and parent_component_id of an axon, a soma or a vessel's trunk,
for which 0 and -1 are both taken.

A caller that departs from the description on purpose names the rule in
`waive`; nothing is waived by default:

* digits: numbers may have up to 9 significant digits in place of 6;
* keys: of the known keys only `Voxel Size` has to be there, in any order;
* attach: a branch of a soma may start anywhere where its first sphere overlaps
  the soma, not only within the spacing of the soma's centre.

F is a setting of the program that the files do not hold (4 is its usual
value), so a caller may give another.
"""

import math
import pathlib
import re
import sys

import numpy

HEADERS = {
    9: "cell_type cell_id component component_id X Y Z inner_radius outer_radius",
    10: "cell_type cell_id component component_id parent_component_id"
    " X Y Z inner_radius outer_radius",
}
POPULATIONS = {9: 2, 10: 3}
COMPONENTS = {
    "axon": ("axon",),
    "glial_cell": ("soma", "branch"),
    "blood_vessel": ("blood_vessel", "branch"),
}
ORDER = tuple(COMPONENTS)
KEYS = ("Duration", "Num_axons", "Voxel Size", "Axon icvf", "Total icvf")
LIMIT_KEYS = ("Small voxel min limits", "Small voxel max limits")
WAIVERS = ("digits", "keys", "attach")
TABLE = "voxel.csv"
INFO = "voxel_growth_info.txt"

NATURAL = re.compile(r"0|[1-9][0-9]*")
INTEGER = re.compile(r"0|-?[1-9][0-9]*")
NUMBER = re.compile(r"-?(0|[1-9][0-9]*)(\.[0-9]+)?(e[+-][0-9]{2,3})?")


def fault(where, expected, got):
    raise ValueError(f"{where[0]}:{where[1]}: expected {expected}, got {got}")


def lines_of(path):
    """The lines of a plain ASCII file with \\n after every line."""
    if not path.is_file():
        fault((path, 0), "a file", "none")
    data = path.read_bytes()
    if not data:
        fault((path, 1), "a first line", "an empty file")
    lines = data.split(b"\n")
    for i, line in enumerate(lines[:-1], 1):
        bad = [c for c in line if not 32 <= c < 127]
        if bad:
            fault((path, i), "printable ASCII and single spaces", f"byte 0x{bad[0]:02x}")
        if not line:
            fault((path, i), "a line with fields", "an empty line")
    if lines[-1]:
        fault((path, len(lines)), "a line feed after the last line", "the end of the file")
    return [line.decode("ascii") for line in lines[:-1]]


def fields_of(line, where):
    fields = line.split(" ")
    if "" in fields:
        fault(where, "one space between fields and none at the ends", repr(line))
    return fields


def natural(text, what, where):
    if not NATURAL.fullmatch(text):
        fault(where, f"{what}: a whole number from 0 without leading zeros", repr(text))
    return int(text)


def integer(text, what, where):
    if not INTEGER.fullmatch(text):
        fault(where, f"{what}: a whole number", repr(text))
    return int(text)


def number(text, what, where, digits=6):
    if not NUMBER.fullmatch(text):
        fault(where, f"{what}: a finite decimal number", repr(text))
    value = float(text)
    if not math.isfinite(value):
        fault(where, f"{what}: a finite decimal number", repr(text))
    printed = [f"{value:.{n}g}" for n in range(6, digits + 1)]
    if text not in printed:
        fault(where, f"{what}: {printed[-1]} ({digits} significant digits)", repr(text))
    return value


def half_unit(value):
    """Half a unit of the sixth significant digit."""
    return 0.5 * 10.0 ** (math.floor(math.log10(abs(value))) - 5) if value else 0.0


class Sphere:
    __slots__ = ("where", "centre", "inner", "outer", "slack")

    def __init__(self, where, centre, inner, outer):
        self.where = where
        self.centre = centre
        self.inner = inner
        self.outer = outer
        self.slack = sum(half_unit(x) for x in centre) + half_unit(outer)


def too_far(a, b, factor):
    """(distance, limit) if two neighbours are further apart than the spacing."""
    distance = math.dist(a.centre, b.centre)
    limit = max(a.outer, b.outer) / factor
    return None if distance <= limit + a.slack + b.slack else (distance, limit)


class Cell:
    """The cell being read: its kind, its id and the spheres of its components."""

    def __init__(self, kind, ident, where):
        self.kind = kind
        self.ident = ident
        self.where = where
        self.trunk = []  # the axon, the soma or the trunk of a vessel
        self.branches = {}
        self.parents = {}

    def earlier(self, parent):
        """The spheres a new branch may start from; parent None: all of them."""
        if parent is None:
            return self.trunk + [s for b in self.branches.values() for s in b]
        spheres = list(self.branches.get(parent, ()))
        return spheres + self.trunk if parent == 0 else spheres


def attach(cell, sphere, parent, factor, waive):
    candidates = cell.earlier(parent)
    if not candidates:
        fault(sphere.where, "spheres of the parent before the branch", "none")
    centres = numpy.array([s.centre for s in candidates])
    distances = numpy.sqrt(((centres - numpy.array(sphere.centre)) ** 2).sum(axis=1))
    outer = numpy.array([s.outer for s in candidates])
    slack = numpy.array([s.slack for s in candidates]) + sphere.slack
    limits = numpy.maximum(outer, sphere.outer) / factor
    if "attach" in waive and cell.kind == "glial_cell":
        is_soma = [s is cell.trunk[0] for s in candidates]
        limits = numpy.where(is_soma, outer + sphere.outer, limits)
    best = int(numpy.argmin(distances - limits - slack))
    if distances[best] > limits[best] + slack[best]:
        of = "the cell" if parent is None else f"component {parent}"
        fault(
            sphere.where,
            f"the branch to start within {limits[best]:g} um (spacing by {factor:g})"
            f" of an earlier sphere of {of}",
            f"{distances[best]:g} um from line {candidates[best].where[1]}",
        )


def read_info(path, digits):
    """The `key value` lines as {key: (line, [tokens])}."""
    keys = {}
    for i, line in enumerate(lines_of(path), 1):
        where = (path, i)
        tokens = fields_of(line, where)
        if tokens[-1] in ("true", "false"):
            first = len(tokens) - 1
        else:
            first = len(tokens)
            while first and NUMBER.fullmatch(tokens[first - 1]):
                first -= 1
        if first == len(tokens):
            fault(where, "a value at the end (a number, true or false)", repr(line))
        key = " ".join(tokens[:first])
        if not re.match("[A-Za-z]", key):
            fault(where, "a key that starts with a letter", repr(line))
        values = tokens[first:]
        if values[0] not in ("true", "false"):
            for value in values:
                number(value, key, where, digits)
        count = 3 if key in LIMIT_KEYS else 1
        if len(values) != count:
            fault(where, f"{count} value(s) of {key!r}", len(values))
        if key in keys:
            fault(where, f"{key!r} once", f"it again after line {keys[key][0]}")
        keys[key] = (i, values)
    return keys


def lint_info(path, waive):
    """Check the info file.

    Return (voxel side, (axons, line) or None, small voxel limits or None).
    """
    keys = read_info(path, 9 if "digits" in waive else 6)
    for key in ("Voxel Size",) if "keys" in waive else KEYS:
        if key not in keys:
            fault((path, len(keys) + 1), f"a line {key!r}", "the end of the file")
    if "keys" not in waive:
        for a, b in zip(KEYS, KEYS[1:]):
            if keys[b][0] < keys[a][0]:
                fault((path, keys[b][0]), f"{b!r} after {a!r}", "it before")

    def one(key):
        line, values = keys[key]
        if not NUMBER.fullmatch(values[0]):
            fault((path, line), f"a number for {key!r}", repr(values[0]))
        return float(values[0]), (path, line)

    if "Duration" in keys:
        duration, where = one("Duration")
        if duration < 0:
            fault(where, "a duration from 0", duration)
    side, where = one("Voxel Size")
    if side <= 0:
        fault(where, "a voxel side above 0", side)
    axons = None
    if "Num_axons" in keys:
        line, values = keys["Num_axons"]
        axons = (natural(values[0], "Num_axons", (path, line)), line)
    total = one("Total icvf")[0] if "Total icvf" in keys else 1.0
    for key in keys:
        if "icvf" not in key.split(" "):
            continue
        value, where = one(key)
        if not 0 <= value <= 1:
            fault(where, f"a fraction from 0 to 1 for {key!r}", value)
        if value > total + half_unit(total) + half_unit(value):
            fault(where, f"{key!r} at most the total of {total:g}", value)
    limits = [keys.get(key) for key in LIMIT_KEYS]
    if any(limits):
        if not all(limits):
            found = limits[0] or limits[1]
            fault((path, found[0]), "both small voxel limits or neither", "one of them")
        for low, high in zip(limits[0][1], limits[1][1]):
            if not float(low) < float(high):
                fault((path, limits[1][0]), f"a maximum above {low}", high)
    return side, axons, limits


def check_order(cell, before, seen, populations, columns):
    """Check the id and the place of a new cell after the cell `before`."""
    where, kind, ident = cell.where, cell.kind, cell.ident
    if before and ORDER.index(kind) < ORDER.index(before.kind):
        fault(where, "axons, then glial cells, then blood vessels", f"{kind} after {before.kind}")
    new_kind = before is None or before.kind != kind
    if kind == "axon":
        if ident in seen:
            wanted = f"the spheres of axon {ident} in one block"
            fault(where, wanted, f"more after those from line {seen[ident]} on")
        if not new_kind:
            last, first = before.trunk[0], cell.trunk[0]
            if first.outer > last.outer and first.inner > last.inner:
                fault(
                    where,
                    f"axons by first radius, largest first (at most {last.outer:g})",
                    f"{first.outer:g}",
                )
        seen[ident] = where[1]
    elif kind == "glial_cell":
        if new_kind:
            if ident != 0:
                fault(where, "glial_cell 0 first", ident)
            populations[0] = 1
        elif ident == 0:
            populations[0] += 1
            if populations[0] > POPULATIONS[columns]:
                fault(
                    where,
                    f"at most {POPULATIONS[columns]} populations of glial cells",
                    "the ids start at 0 once more",
                )
        elif ident != before.ident + 1:
            fault(where, f"glial_cell {before.ident + 1} (or 0, a new population)", ident)
    else:
        wanted = 0 if new_kind else before.ident + 1
        if ident != wanted:
            fault(where, f"blood_vessel {wanted}", ident)


def check_parent(cell, component, ident, parent, where):
    if component != "branch":
        if parent not in (0, -1):
            fault(where, f"parent_component_id 0 or -1 of a {component} row", parent)
        return
    if parent < 0:
        fault(where, "parent_component_id from 0 of a branch", parent)
    if ident in cell.parents:
        if cell.parents[ident] != parent:
            fault(where, f"parent {cell.parents[ident]} as in branch {ident} before", parent)
    elif parent != 0 and parent not in cell.branches:
        fault(where, "a parent that is an earlier branch of the cell, or 0", parent)
    elif parent == ident and ident != 0:
        fault(where, "a parent other than the branch", parent)
    cell.parents[ident] = parent


def lint_table(path, columns, factor, waive):
    """Check the rows; return (centres, outer radii, number of axons)."""
    lines = lines_of(path)
    if lines[0] != HEADERS[columns]:
        fault((path, 1), repr(HEADERS[columns]), repr(lines[0]))
    if len(lines) < 2:
        fault((path, 2), "a sphere", "the end of the file")
    digits = 9 if "digits" in waive else 6
    centres, radii = [], []
    axons, populations = {}, [0]
    before = cell = last = None
    for i, line in enumerate(lines[1:], 2):
        where = (path, i)
        fields = fields_of(line, where)
        if len(fields) != columns:
            wanted = f"{columns} fields with one space between them"
            fault(where, wanted, f"{len(fields)}: {line!r}")
        kind, component = fields[0], fields[2]
        if kind not in COMPONENTS:
            fault(where, f"cell_type one of {', '.join(COMPONENTS)}", repr(kind))
        if component not in COMPONENTS[kind]:
            fault(where, f"component of {kind}: {' or '.join(COMPONENTS[kind])}", repr(component))
        ident = natural(fields[1], "cell_id", where)
        part = natural(fields[3], "component_id", where)
        parent = integer(fields[4], "parent_component_id", where) if columns == 10 else None
        centre = [number(t, n, where, digits) for t, n in zip(fields[-5:-2], "XYZ")]
        inner = number(fields[-2], "inner_radius", where, digits)
        outer = number(fields[-1], "outer_radius", where, digits)
        if inner <= 0:
            fault(where, "an inner radius above 0", fields[-2])
        if outer < inner:
            fault(where, f"an outer radius from {fields[-2]}", fields[-1])
        if kind != "axon" and inner != outer:
            fault(where, f"equal radii of a {kind} sphere", f"{fields[-2]} and {fields[-1]}")
        sphere = Sphere(where, centre, inner, outer)

        starts = component == "soma" or cell is None or (kind, ident) != (cell.kind, cell.ident)
        if starts:
            if component == "branch":
                got = f"a branch of {kind} {ident}"
                if cell is not None:
                    got += f" after {cell.kind} {cell.ident}"
                fault(where, "a soma or trunk row at the start of a cell", got)
            before, cell = cell, Cell(kind, ident, where)
            cell.trunk.append(sphere)
            check_order(cell, before, axons, populations, columns)
        if component != "branch":
            if part != 0:
                fault(where, f"component_id 0 of a {component} row", part)
            if cell.branches:
                fault(where, "the trunk before the branches", f"a {component} row after a branch")
        if columns == 10:
            check_parent(cell, component, part, parent, where)
        if component == "branch" and part not in cell.branches:
            if cell.branches:
                wanted = (next(reversed(cell.branches)) + 1,)
            else:
                wanted = (0, 1) if kind == "glial_cell" else (1,)
            if part in wanted:
                attach(cell, sphere, parent, factor, waive)
            else:
                asked = " or ".join(map(str, wanted))
                fault(where, f"component_id {asked} of the next branch", part)
            cell.branches[part] = [sphere]
        elif not starts:
            if component == "branch":
                if part != next(reversed(cell.branches)):
                    fault(where, f"the rows of branch {part} in one block", "more of them later")
                cell.branches[part].append(sphere)
            else:
                cell.trunk.append(sphere)
            apart = too_far(last, sphere, factor)
            if apart:
                fault(
                    where,
                    f"a sphere within max(r1, r2)/{factor:g} = {apart[1]:g} um of the last one",
                    f"{apart[0]:g} um",
                )
        last = sphere
        centres.append(centre)
        radii.append(outer)
    for wanted, ident in enumerate(sorted(axons)):
        if ident != wanted:
            fault((path, axons[ident]), f"axon ids from 0 without a gap ({wanted} missing)", ident)
    return numpy.array(centres), numpy.array(radii), len(axons)


def check_frame(path, centres, radii, side):
    """Check units and origin: lengths in um and the voxel [0, L]^3."""
    biggest = int(numpy.argmax(radii))
    if radii[biggest] > side:
        wanted = f"a radius in um (at most the voxel side {side:g})"
        fault((path, biggest + 2), wanted, radii[biggest])
    if len(radii) > 1 and numpy.abs(centres).max() < side / 500:
        fault(
            (path, 2),
            f"centres in um in a voxel of {side:g} um",
            f"none beyond {numpy.abs(centres).max():g}",
        )
    here = int(((centres >= 0) & (centres <= side)).all(axis=1).sum())
    centred = int((numpy.abs(centres) <= side / 2).all(axis=1).sum())
    if here == 0:
        fault((path, 2), f"centres in the voxel [0, {side:g}]^3", "none")
    if centred > here:
        fault(
            (path, 2),
            f"the voxel to be [0, {side:g}]^3",
            f"{centred} centres in the voxel centred on the origin and {here} in that one",
        )


def lint(folder, columns, factor=4.0, waive=()):
    """Check voxel.csv and its info file; return (voxel side in um, spheres).

    Raises ValueError("FILE:LINE: expected ..., got ...") on the first fault.
    """
    if columns not in HEADERS:
        raise ValueError(f"columns: expected 9 or 10, got {columns}")
    for rule in waive:
        if rule not in WAIVERS:
            raise ValueError(f"waive: expected {', '.join(WAIVERS)}, got {rule}")
    folder = pathlib.Path(folder)
    table = folder / TABLE
    for path in sorted(folder.glob("*growth_info*.txt")):
        found = re.fullmatch(r"voxel_growth_info(_[1-9][0-9]*)?\.txt", path.name)
        if not found:
            fault((path, 0), f"the name {INFO}", path.name)
        if not (folder / f"voxel{found[1] or ''}.csv").is_file():
            fault((path, 0), f"the table voxel{found[1] or ''}.csv", "none")
    side, axons, limits = lint_info(folder / INFO, waive)
    centres, radii, found = lint_table(table, columns, factor, waive)
    if axons and found != axons[0]:
        fault((folder / INFO, axons[1]), f"Num_axons {found} as in the table", axons[0])
    if not any(limits):
        check_frame(table, centres, radii, side)
    return side, len(radii)


def main(arguments):
    if len(arguments) < 2 or arguments[1] not in ("9", "10"):
        print("usage: caterpillar_linter.py FOLDER 9|10 [factor=F] [WAIVED RULES]", file=sys.stderr)
        return 2
    factors = [a[len("factor="):] for a in arguments[2:] if a.startswith("factor=")]
    waive = [a for a in arguments[2:] if not a.startswith("factor=")]
    try:
        factor = float(factors[-1]) if factors else 4.0
        side, spheres = lint(arguments[0], int(arguments[1]), factor, waive)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    print(f"voxel side {side:g} um, {spheres} spheres")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
