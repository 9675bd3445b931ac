#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the fenced blocks of a tutorial in order, in a folder of its own.

    run.py SOURCE BUILD FILE.md | --planted

```sh         run by bash -euo pipefail; the installed programs are in PATH, CONCEG_SOURCE is the source tree
```python     run by the Python of CONCEG_PYTHON, with the package in PYTHONPATH
```LANG NAME  (c, python, yaml, cmake, ...) written to the file NAME
```output     what the block before printed, line by line; "..." stands for anything, a line "..." for any lines
needs=WORD    after the language: left out, and said so, where WORD is not there: a Python module, or a variable of the environment
"""
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

source, build = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
python = os.environ.get("CONCEG_PYTHON", sys.executable)


class Failed(Exception):
    pass


def blocks(text):
    """(line, language, words, content) of each fence."""
    for fence in re.finditer(r"^```(\w+)([^\n]*)\n(.*?)^```$", text, re.M | re.S):
        yield text.count("\n", 0, fence.start()) + 1, fence.group(1), fence.group(2).split(), fence.group(3)


def there(word):
    return word in os.environ or (word.islower() and subprocess.run([python, "-c", f"import {word}"], capture_output=True).returncode == 0)


def environment(folder, needs):
    settings = {**os.environ, "CONCEG_SOURCE": str(source), "CONCEG_LIBRARY": str(build / "lib"), "PYTHONPATH": str(source / "apps/python"), "PKG_CONFIG_PATH": str(build / "pkgconfig"),
                "conceg_DIR": str(build / "cmake"), "PYTHONDONTWRITEBYTECODE": "1"}
    settings.pop("CONCEG_STAGE_PATH", None)
    settings["PATH"] = os.pathsep.join([str(folder / ".bin"), str(build / "bin"), settings["PATH"]])
    if "disimpy" in needs:  # no GPU here
        settings["PYTHONPATH"] += os.pathsep + str(source / "tests/interop/disimpy_cpu")
        settings.update(NUMBA_ENABLE_CUDASIM="1", PYTHONWARNINGS="ignore")
    return settings


def matches(pattern, text):
    parts = [".*?" if line.strip() == "..." else ".*".join(re.escape(part) for part in line.split("...")) for line in pattern.rstrip("\n").split("\n")]
    whole = "\n".join(parts).replace("\n.*?\n", "\n(?s:.*?)").replace(".*?\n", "(?s:.*?)", 1) if parts[0] == ".*?" else "\n".join(parts).replace("\n.*?\n", "\n(?s:.*?)")
    return re.fullmatch(re.sub(r"\n\.\*\?$", "(?s:.*)", whole), text.rstrip("\n")) is not None


def run(name, text, folder):
    """Returns how many blocks ran, and which were left out."""
    ran, left_out, printed = 0, [], None
    (folder / ".bin").mkdir()
    (folder / ".bin/python3").write_text(f"#!/bin/sh\nexec '{python}' \"$@\"\n")
    (folder / ".bin/python3").chmod(0o755)
    for line, language, words, content in blocks(text):
        needs = [word[6:] for word in words if word.startswith("needs=")]
        files = [word for word in words if "=" not in word]
        missing = [word for word in needs if not there(word)]
        if language == "output":
            if printed is not None and not matches(content, printed):
                raise Failed(f"{name}:{line}: expected the output\n{content}got\n{printed}")
            continue
        if missing:
            left_out.append(f"{name}:{line} (needs {', '.join(missing)})")
            printed = None
            continue
        if files:
            (folder / files[0]).write_text(content)
        elif language in ("sh", "python"):
            command = ["bash", "-euo", "pipefail", "-c", content] if language == "sh" else [python, "-c", content]
            done = subprocess.run(command, cwd=folder, env=environment(folder, needs), stdin=subprocess.DEVNULL, capture_output=True, text=True)
            if done.returncode:
                raise Failed(f"{name}:{line}: exit {done.returncode}\n{content}{done.stdout[-2000:]}{done.stderr[-2000:]}")
            ran, printed = ran + 1, done.stdout
        else:
            raise Failed(f"{name}:{line}: a block of {language} without a file name: nobody would notice when it is wrong")
    return ran, left_out


def planted():
    """Tutorials that must fail, and one that must not."""
    good = "```sh\necho a 12 b; echo last\n```\n```output\na ... b\n...\n```\n```python one.py\nprint(2)\n```\n```sh\npython3 one.py\n```\n```output\n2\n```\n"
    bad = {"a command that fails": "```sh\nfalse\n```\n", "a failure within a pipe": "```sh\nfalse | cat\n```\n", "an unset variable": "```sh\necho $not_set\n```\n", "other output": "```sh\necho 1\n```\n```output\n2\n```\n",
           "more output": "```sh\necho 1; echo 2\n```\n```output\n1\n```\n", "Python": "```python\nassert 1 == 2\n```\n", "an unknown language": "```c\nint x;\n```\n", "good but its last line": good.replace("output\n2\n", "output\n3\n")}
    wrong = []
    for what, text in {"": good, **bad}.items():
        with tempfile.TemporaryDirectory() as folder:
            try:
                run("planted", text, pathlib.Path(folder))
                wrong += [what] if what else []
            except Failed as problem:
                wrong += [] if what else [str(problem)]
    print(f"{len(bad)} planted faults, unseen or wrongly seen: {wrong}")
    return bool(wrong)


def main():
    if sys.argv[3] == "--planted":
        return planted()
    page = pathlib.Path(sys.argv[3])
    if any(language == "python" or "python" in content for _, language, _, content in blocks(page.read_text())) and not all(map(there, ("numpy", "pandas", "trimesh"))):
        print("SKIPPED: no Python with numpy, pandas and trimesh")
        return 77
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        ran, left_out = run(page.name, page.read_text(), folder)
    except Failed as problem:
        print("FAILED:", problem)
        return 1
    finally:
        shutil.rmtree(folder)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{page.name}: {ran} blocks run, CPU {used.ru_utime + used.ru_stime:.1f} s; left out: {', '.join(left_out) or 'none'}")
    return 0 if ran else 1


sys.exit(main())
