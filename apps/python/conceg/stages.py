# SPDX-License-Identifier: BSD-3-Clause
"""Stages, run as the programs that are installed with the library, with progress and clean ends.

A stage is a program of its own and not a call within Python: it may use all of the memory and can be stopped at any time, and its libraries
(VTK, Embree, TBB) do not meet those of other packages. Documents go there and back as files in the temporary folder.
"""
import collections
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import typing

from . import _library as lib
from .document import Document, Path

# Told what is being done, how much, and of how much (0 = unknown); a true value cancels.
Progress = typing.Callable[[str, int, int], object]
ProgressOption = typing.Union[bool, Progress]

# Exit codes of the programs (spec/cli.md) as the nearest status.
_EXIT = {1: lib.Status.E_STAGE, 2: lib.Status.E_PARAM, 3: lib.Status.E_FORMAT, 4: lib.Status.E_IO, 5: lib.Status.E_MISSING, 6: lib.Status.E_CANCELLED}


def _program() -> str:
    """conceg: CONCEG_PROGRAM, that beside the library, or that of PATH."""
    named = os.environ.get("CONCEG_PROGRAM")
    if named:
        return named
    library = pathlib.Path(lib.library_path())
    if library.is_absolute():
        for folder in list(library.parents)[1:3]:  # PREFIX/lib or PREFIX/lib/TRIPLET
            if os.access(folder / "bin" / "conceg", os.X_OK):
                return str(folder / "bin" / "conceg")
    found = shutil.which("conceg")
    if not found:
        raise lib.ConcegError(lib.Status.E_MISSING, "the program conceg was found neither beside the library nor in PATH: set CONCEG_PROGRAM")
    return found


class _Bar:
    """Progress as bars of tqdm, in notebooks too, or else as a line on standard error."""

    def __init__(self) -> None:
        self.what, self.shown = "", -1
        self.bar: typing.Any = None
        self.tqdm: typing.Any = None
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return
        self.tqdm = tqdm

    def __call__(self, what: str, done: int, total: int) -> None:
        if self.tqdm is None:
            percent = 100 * done // total if total else 0
            if (what, percent) != (self.what, self.shown):
                print(f"{what}: {percent} %" if total else what, file=sys.stderr)
            self.what, self.shown = what, percent
            return
        if not total:
            return
        if what != self.what or self.bar is None:
            self.close()
            self.what, self.bar = what, self.tqdm(total=total, desc=what)
        self.bar.update(done - self.bar.n)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
            self.bar = None


def _listen(lines: typing.Iterable[str], tell: typing.Optional[Progress], stop: typing.Callable[[], None]) -> str:
    """Reads a program's messages to their end; returns its last error."""
    error = ""
    last: typing.Deque[str] = collections.deque(maxlen=5)
    for line in lines:
        line = line.rstrip("\n")
        if line.startswith("{"):
            try:
                event = json.loads(line)
            except ValueError:
                event = {}
            if tell and "phase" in event and tell(f"{event['phase']} {event.get('stage', '')}".strip(), 0, 0):
                stop()
            if tell and "progress" in event and tell(event["progress"], event["done"], event["total"]):
                stop()
            continue
        last.append(line)
        if ": error: " in line:
            error = line.split(": error: ", 1)[1]
        elif ": warning: " in line:
            lib.logger.warning("%s", line.split(": warning: ", 1)[1])
        else:
            lib.logger.info("%s", line)
    return error or " ".join(last)


def _execute(words: typing.Sequence[str], progress: ProgressOption, capture: bool = False) -> str:
    """Runs the program; a callback's exception and the user's interrupt cancel it and go on to the caller."""
    bar = _Bar() if progress is True else None
    tell: typing.Optional[Progress] = bar or (progress if callable(progress) else None)
    command = [_program(), *words, *([] if capture else ["--progress", "json" if tell else "none"])]
    stopped = False
    # A session of its own: an interrupt of the notebook reaches the program once, from here.
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE if capture else subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True) as process:

        def stop() -> None:
            nonlocal stopped
            if not stopped:  # a second signal would kill it
                process.send_signal(signal.SIGINT)
            stopped = True

        try:
            if capture:
                out, messages = process.communicate()
                error = _listen(messages.splitlines(), None, stop)
            else:
                assert process.stderr is not None
                out, error = "", _listen(process.stderr, tell, stop)
        except BaseException:
            stop()
            process.communicate()
            raise
        finally:
            if bar:
                bar.close()
        code = process.wait()
    if code:
        raise lib.ConcegError(_EXIT.get(code, lib.Status.E_STAGE), error or f"{os.path.basename(command[0])} {words[0]} ended with code {code}")
    return out


def _text(value: object) -> str:
    """A parameter's value as YAML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    return str(value)


def _options(folder: pathlib.Path, recipe: typing.Optional[Path], seed: typing.Optional[int], threads: typing.Optional[int], settings: typing.Optional[typing.Mapping[str, object]],
             parameters: typing.Mapping[str, object]) -> typing.List[str]:
    words = []
    if recipe is not None:
        text = os.fspath(recipe)
        if "\n" in text:
            (folder / "recipe.yaml").write_text(text)
            text = str(folder / "recipe.yaml")
        words += ["-p", text]
    if seed is not None:
        words += ["--seed", str(seed)]
    if threads is not None:
        words += ["--threads", str(threads)]
    for path, value in (settings or {}).items():
        words += ["--set", f"{path}={_text(value)}"]
    return words + [f"--{name.replace('_', '-')}={_text(value)}" for name, value in parameters.items()]


def _input(folder: pathlib.Path, document: typing.Optional[Document]) -> typing.List[str]:
    """A file of the document: its own when it was not changed."""
    if document is None:
        return []
    document._alive()
    if document._path is not None and os.path.exists(document._path):
        return [document._path]
    document.save(folder / "input.cgx")
    return [str(folder / "input.cgx")]


def _result(folder: pathlib.Path) -> Document:
    """What the program wrote; the file has no name any more once it is open, and goes with the document."""
    document = Document.open(folder / "output.cgx")
    document._path = None
    return document


def run_stage(kind: str, document: typing.Optional[Document] = None, *, recipe: typing.Optional[Path] = None, files: typing.Sequence[Path] = (), seed: typing.Optional[int] = None,
              threads: typing.Optional[int] = None, impl: typing.Optional[str] = None, settings: typing.Optional[typing.Mapping[str, object]] = None, progress: ProgressOption = False, **parameters: object) -> Document:
    """Runs one stage on a document, or a source without one, and returns the document that it makes.

    recipe: a path, or YAML text of more than one line. files: the words of a source (characterise, import). settings: values by their path in the recipe
    ({"domain.size_um": [20, 20, 20]}). progress: True for bars, or a function of what, done and total that cancels by a true value. parameters: those of the
    stage, as `parameters(kind)` lists them.
    """
    with tempfile.TemporaryDirectory(prefix="conceg-") as name:
        folder = pathlib.Path(name)
        if impl is not None:
            parameters = {"impl": impl, **parameters}
        words = [kind, *(os.fspath(file) for file in files), *_input(folder, document), "-o", str(folder / "output.cgx")]
        _execute(words + _options(folder, recipe, seed, threads, settings, parameters), progress)
        return _result(folder)


def run_sink(kind: str, document: Document, *, progress: ProgressOption = False, threads: typing.Optional[int] = None, settings: typing.Optional[typing.Mapping[str, object]] = None, **parameters: object) -> None:
    """Runs a stage that writes files (export, render, report)."""
    with tempfile.TemporaryDirectory(prefix="conceg-") as name:
        folder = pathlib.Path(name)
        _execute([kind, *_input(folder, document), *_options(folder, None, None, threads, settings, parameters)], progress)


def run_recipe(recipe: Path, *, until: typing.Optional[str] = None, seed: typing.Optional[int] = None, threads: typing.Optional[int] = None, settings: typing.Optional[typing.Mapping[str, object]] = None,
               progress: ProgressOption = False) -> Document:
    """Runs the stages of a recipe, a path or YAML text of more than one line, and returns the last document (`conceg run`)."""
    with tempfile.TemporaryDirectory(prefix="conceg-") as name:
        folder = pathlib.Path(name)
        words = _options(folder, recipe, seed, threads, settings, {})[1:]
        _execute(["run", *words, *(["--until", until] if until else []), "-o", str(folder / "output.cgx")], progress)
        return _result(folder)


def import_files(form: str, files: typing.Union[Path, typing.Sequence[Path]], **options: typing.Any) -> Document:
    """A document of files of another program (`conceg import FORMAT`); options as of run_stage."""
    names: typing.Sequence[Path] = [files] if isinstance(files, (str, os.PathLike)) else files
    return run_stage("import", None, files=[form, *names], **options)


def parameters(kind: str) -> typing.List[typing.Dict[str, typing.Any]]:
    """The table of a stage's parameters: name, unit, default, range, help."""
    listed = json.loads(_execute(["params", kind, "--json"], False, capture=True))
    rows: typing.List[typing.Dict[str, typing.Any]] = listed if isinstance(listed, list) else listed["parameters"]
    return rows
