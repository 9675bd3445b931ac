#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of spec/interop.md: columns from stages/common/formats.hpp, "checked by" from checked_by.py, whose entries the tests compare with what
they did. Fails when the file says otherwise or an entry names a test that is not there.  table.py BUILD [--write]"""
import pathlib
import re
import subprocess
import sys
import tempfile

import checked_by

source = pathlib.Path(__file__).resolve().parents[2]
spec = source / "spec/interop.md"


def formats(name):
    """Rows of CONCEG_IMPORT_FORMATS or CONCEG_EXPORT_FORMATS."""
    text = (source / "stages/common/formats.hpp").read_text().replace("\\\n", "\n")
    body = re.search(rf"#define CONCEG_{name}_FORMATS\(F\)(.*?)\n\s*\n", text, re.S)[1]
    return [re.findall(r'"((?:[^"\\]|\\.)*)"', row) for row in re.findall(r'F\(((?:\s*"(?:[^"\\]|\\.)*",?)+)\s*\)', body)]


def table(name, last, entries):
    head = ["format", "program", "files", "unit", "frame", last, "checked by"]
    rows = [row + [checked_by.text(entries[row[0]])] for row in formats(name)]
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] + ["| " + " | ".join(cell.replace("|", " or ") for cell in row) + " |" for row in rows]) + "\n"


def produced(text):
    for mark, name, last, entries in (("read", "IMPORT", "becomes", checked_by.READ), ("written", "EXPORT", "needs", checked_by.WRITTEN)):
        text, count = re.subn(rf"(<!-- {mark} -->\n)(?:\|.*\n)*", lambda found: found[1] + table(name, last, entries), text)
        if count != 1:
            raise ValueError(f"{spec}: expected one mark <!-- {mark} -->, got {count}")
    return text


def problems(build):
    found = []
    for name, entries in (("IMPORT", checked_by.READ), ("EXPORT", checked_by.WRITTEN)):
        listed = [row[0] for row in formats(name)]
        if listed != list(entries):
            found.append(f"checked_by.py: formats {list(entries)}, the program has {listed}")
    tests = set(re.findall(r": (\S+)$", subprocess.run(["ctest", "--test-dir", build, "-N"], capture_output=True, text=True, check=True).stdout, re.M))
    for form, entries in [*checked_by.READ.items(), *checked_by.WRITTEN.items()]:
        found += [f"checked_by.py: {form}: there is no test {entry[1]}" for entry in entries if entry[1] != checked_by.HAND and entry[1] not in tests]
    return found


def main(build):
    wanted = produced(spec.read_text())
    if "--write" in sys.argv:
        with tempfile.NamedTemporaryFile("w", dir=spec.parent, delete=False) as file:
            file.write(wanted)
        pathlib.Path(file.name).chmod(0o644)
        pathlib.Path(file.name).replace(spec)
    failures = problems(build)
    if spec.read_text() != wanted:
        failures.append(f"{spec.name}: the tables are stale; run tests/interop/table.py BUILD --write")
    # A change of one word is seen.
    if produced(wanted.replace("trimesh", "nobody")) != wanted or wanted.count("| linter") < 8:
        failures.append("a stale table would not be seen")
    for line in failures:
        print("FAILED:", line)
    print(f"tables of spec/interop.md: {len(checked_by.READ)} formats read, {len(checked_by.WRITTEN)} written, {len(failures)} failures")
    return bool(failures)


sys.exit(main(sys.argv[1]))
