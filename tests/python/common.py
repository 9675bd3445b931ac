# SPDX-License-Identifier: BSD-3-Clause
"""Counting of checks, and a small meshed document."""
import pathlib
import subprocess
import sys
import tempfile

source, build = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
program = build / "bin/conceg"
failures, checks = [], 0


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)


def raises(status, pattern, call, *words, **named):
    """The error of a call: its status by name, and its text."""
    import conceg

    try:
        call(*words, **named)
    except conceg.ConcegError as problem:
        expect(problem.status.name == status and pattern in problem.message and pattern in str(problem), f"expected {status} with \"{pattern}\", got {problem}")
    else:
        expect(False, f"expected {status} with \"{pattern}\", and nothing was raised")


def small(folder, *settings, until="mesh", name="cube.cgx"):
    path = pathlib.Path(folder) / name
    words = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([program, "run", source / "tests/pipe/small.yaml", "--until", until, *words, "-q", "-o", path], check=True)
    return path


def end(what):
    for line in failures:
        print("FAILED:", line)
    print(f"{what}: {checks} checks, {len(failures)} failures")
    sys.exit(bool(failures))


def temporary():
    return tempfile.TemporaryDirectory()
