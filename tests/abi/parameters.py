#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every parameter of every stage does something: it is flipped from its default to a bound (another choice, the other switch), and
the output must have other bytes, or be the same for a reason that is stated here and then demanded. Values beyond the bounds are
refused with exit code 2.  parameters.py BIN SOURCE [--plant STAGE:IMPL]

With --plant only the stage of that plugin is looked at: a planted parameter without an effect must be found."""
import hashlib
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile

# A value other than a bound, and why.
instead = {
    "triangulate.density_per_um3": ("1", "at the bounds there is one node, or 1e7"),
    "block.lo_um": ("5", "the lower bound is the default, at the upper one nothing is left"),
    "block.hi_um": ("12", "the upper bound is the default, at the lower one nothing is left"),
    "block.margin_um": ("6", "the whole box, which is the default, has no margin"),
    "mesh.h_um": ("0.8", "at the bounds the grid has 1e10 nodes, or holds no cell"),
    "mesh.gap_um": ("0.3", "at the upper bound nothing is left of the cells"),
    "mesh.inflate_um": ("0.1", "at the upper bound one cell fills the box"),
    "mesh.volume_step_um": ("1", "the lower bound is the default, the upper one is wider than the box"),
    "mesh.tolerance_um": ("0", "at the upper bound the surfaces are simplified for minutes"),
    "mesh.level_um": ("0.5", "at the bounds hardly a face goes, or few stay"),
    "relax.iterations": ("5", "the upper bound takes an hour"),
    "place.soma_gap_um": ("2", "the lower bound shows only where somata touch, the upper one fits no box"),
    "relax.skin_um": ("0.5", "at the upper bound the list of pairs is everything"),
    "relax.mesh_step_um": ("0.3", "at the upper bound all points are neighbours"),
    "relax.rounds": ("2", "the upper bound takes minutes"),
    "relax.sphere_spacing": ("2", "the lower bound makes twenty times the spheres"),
    "export.diffusivity_um2_per_ms": ("1", "any other value shows"),
    "export.pulse_ms": ("4", "the upper bound is longer than the separation"),
    "export.separation_ms": ("30", "any other value shows"),
    "grow.max_edge_um": ("1", "any shorter edge shows"),
    "simulate.walkers": ("50", "the upper bound takes a year"),
    "simulate.margin_um": ("2", "at the upper bound no room is left"),
    "simulate.directions": ("3", "at the upper bound the directions take a minute"),
    "simulate.separation_ms": ("3", "both bounds are refused beside the other times, or take long"),
    "simulate.echo_ms": ("4", "the upper bound is ten seconds of walking"),
    "simulate.step_ms": ("0.05", "the lower bound takes a thousand times the steps"),
    "analyse.points": ("1000", "the upper bound takes minutes"),
    "analyse.field_step_um": ("1", "the lower bound is the default, the upper one is wider than a cell"),
    "analyse.tail_from_ms": ("0.1", "the lower bound is the default, the upper one is beyond the walk"),
    "analyse.tail_to_ms": ("2", "the lower bound is the default, the upper one is beyond the walk"),
    "analyse.composition_cubes": ("16", "the upper bound takes minutes"),
    "analyse.composition_from_um": ("4", "the lower bound is below a voxel, the upper one wider than the box"),
    "analyse.erode_to": ("0.9", "the lower bound is the default"),
    "analyse.blocks": ("1", "the upper bound takes an hour"),
    "analyse.block_um": ("5", "the lower bound holds two voxels, the upper one is wider than the box"),
    "analyse.block_voxel_um": ("0.5", "the lower bound is the default"),
    "import.resample_um": ("2", "the lower bound is the default, the upper one is wider than the box"),
    "render.samples": ("1", "the upper bound takes a minute"),
    "render.zoom_um": ("6", "the upper bound is wider than the box"),
    "render.size_px": ("64", "the upper bound takes a minute"),
    "report.size_mb": ("0.05", "at the upper bound all that is there fits, as at the default"),
    "report.rows": ("1", "any smaller number shows"),
    "fit.diffusivity_max": ("4", "the lower bound is below diffusivity_min"),
    "fit.radius_max_um": ("6.5", "the lower bound is below radius_min_um"),
    "fit.shell_width": ("0.7", "the lower bound joins nothing less, the upper one everything"),
    "fit.starts": ("3", "the upper bound takes an hour"),
    "import.pulse_duration_ms": ("4", "the upper bound is longer than the time between the pulses"),
    "import.pulse_separation_ms": ("25", "the lower bound is the default"),
    "import.margin_um": ("7", "the upper bound is wider than any tissue"),
    "import.box_um": ("90", "the lower bound is the default, the upper one is wider than any tissue"),
    "export.level": ("1", "the document has no coarser ones"),
    "export.walkers": ("20", "the upper bound takes an hour"),
    "export.directions": ("6", "the upper bound makes a large table"),
    "export.fraction_um": ("4", "at the bounds there is one voxel, or those of the labels"),
    "characterise.astrocyte_donors": ("3", "the upper bound makes a large table"),
}
# The same bytes are demanded.
same = {
    "relax.mesh_step_um": "grid for which thin places are warned about",
    "relax.trace": "a file beside the document",
    "relax.pictures": "a folder for the figure beside the document",
    "grow.finish": "without grown cells there is nothing to finish: tests/pipe/second-growth.sh has them",
    "mesh.space": "a line of the log",
    "triangulate.tile_um": "size of the pieces that are worked on: changes the time only",
    "analyse.icvf_tolerance": "where a warning begins: the measures are the same",
    "analyse.paths": "the voxels of this tissue are too coarse for it: unit.analyse_paths has finer ones",
    "analyse.path_um": "the voxels of this tissue are too coarse for paths: unit.analyse_stage has finer ones",
    "analyse.pores": "the voxels of this tissue are too coarse for it: unit.analyse_stage has finer ones",
    "analyse.csv": "a folder for tables beside the document",
    "analyse.transport": "the voxels of this tissue are too coarse for it: unit.analyse_stage has finer ones",
    "analyse.structure_dir": "a folder for files beside the document",
    "characterise.root": "a folder that the files of this test are not in",
    "characterise.csv": "a folder for files beside the document",
    "characterise.pictures": "a folder for pictures beside the document",
    "characterise.beside": "grown cells for those pictures",
    "mesh.vdb": "a file beside the document",
    "mesh.checkpoint": "a file for a run that goes on",
    "simulate.csv": "a folder for tables beside the document",
    "simulate.nifti": "a folder for images beside the document",
    "simulate.pictures": "a folder for the figure beside the document",
    "simulate.checkpoint": "a file for a run that goes on",
    "fit.csv": "a folder for files beside the document",
    "fit.pictures": "a folder for pictures beside the document",
    "export.dir": "where the files go, not what is in them",
    "render.dir": "where the files go, not what is in them",
    "report.page": "where the page goes, not what is in it",
}
# Texts and paths have no bounds.
texts = {
    "analyse.structure": "{work}/real.cgx",
    "analyse.structure_pool": "{work}/analysed.cgx",
    "analyse.structure_dir": "{work}/structure",
    "characterise.entry": "others",
    "characterise.table": "{work}/two.csv",
    "characterise.root": "{work}",
    "characterise.sources": "{work}/sources.csv",
    "characterise.csv": "{work}/csv",
    "characterise.pictures": "{work}/pictures",
    "characterise.beside": "{work}/mesh.cgx",
    "mesh.vdb": "{work}/cells.vdb",
    "mesh.checkpoint": "{work}/cells.part",
    "simulate.cells": "0",
    "simulate.kind": "pyramidal",
    "simulate.protocol": "{work}/one.scheme",
    "simulate.b": "0,2",
    "simulate.permeability": "0.05",
    "simulate.times_ms": "0.5",
    "analyse.csv": "{work}/csv",
    "simulate.csv": "{work}/signals",
    "simulate.nifti": "{work}/signals",
    "simulate.pictures": "{work}/signals",
    "simulate.checkpoint": "{work}/kept.cgx",
    "relax.trace": "{work}/trace.csv",
    "relax.pictures": "{work}/pictures",
    "fit.compartment": "intra",
    "fit.free": "none",
    "fit.csv": "{work}/csv",
    "fit.pictures": "{work}/pictures",
    "import.bval": "{work}/bvals",
    "import.bvec": "{work}/bvecs",
    "import.compartment": "intra",
    "import.voxel_um": "1,1,2",
    "import.array": "second",
    "export.cells": "0",
    "export.dir": "{work}/exported",
    "export.tiles": "2x1x1",
    "export.b_values_ms_per_um2": "0 2",
    "import.info": "{work}/other_info.txt",
    "render.cells": "0",
    "render.dir": "{work}/rendered",
    "report.page": "{work}/reported/page.html",
    "render.zoom_at": "3,4,5",
}
# Options that the flip needs to be seen.
needs = {
    "characterise.beside": ["--pictures", "{work}/pictures"],
    "export.ascii": ["--to", "ply"],
    "fit.neurite_diffusivity": ["--free", "extra"],
    "fit.extra_diffusivity": ["--free", "neurite"],
    "import.bval": ["--pulse-duration-ms=5", "--pulse-separation-ms=20"],
    "import.bvec": ["--bval={work}/bvals", "--pulse-duration-ms=5", "--pulse-separation-ms=20"],
    "import.compartment": ["--bval={work}/bvals", "--pulse-duration-ms=5", "--pulse-separation-ms=20"],
    "import.pulse_duration_ms": ["--bval={work}/bvals", "--pulse-separation-ms=20"],
    "import.pulse_separation_ms": ["--bval={work}/bvals", "--pulse-duration-ms=5"],
    "export.columns": ["--to", "caterpillar"],
    "export.whole": ["--to", "caterpillar"],
    "export.fraction_um": ["--to", "nifti"],
    "export.walkers": ["--to", "mcdc"],
    **{f"export.{name}": ["--to", "mcdc", "--walkers", "10"] for name in ("diffusivity_um2_per_ms", "b_values_ms_per_um2", "directions", "pulse_ms", "separation_ms")},
    "relax.widening_um": ["--rounds", "2"],
    "block.margin_um": ["--lo-um", "8", "--hi-um", "12"],
    **{f"analyse.{name}": ["--diffusivity"] for name in ("tail_from_ms", "tail_to_ms", "csv")},
    "analyse.composition_cubes": ["--composition"],
    "analyse.structure_pool": ["--structure", "{work}/real.cgx"],
    "analyse.structure_dir": ["--structure", "{work}/real.cgx"],
    "analyse.composition_from_um": ["--composition"],
    "analyse.erode_to": ["--composition"],
    "analyse.blocks": ["--pores"],
    "analyse.block_um": ["--pores", "--blocks=1"],
    "analyse.block_voxel_um": ["--pores", "--blocks=1"],
    **{f"import.{name}": ["--voxel-um=1"] for name in ("array", "axes", "resample_um")},
    "relax.swelling": ["--rounds", "2"],
    "grow.smoothing": ["--straightness", "free"],
    "triangulate.grade_levels": ["--nodes", "graded"],
    "triangulate.grade_distance_um": ["--nodes", "graded"],
    "triangulate.grade_spacing_radii": ["--nodes", "graded", "--grade-territory-um", "1000"],
    "triangulate.grade_territory_um": ["--nodes", "graded", "--grade-spacing-radii", "0.5"],
    "render.cut_axis": ["--what", "cut"],
    "render.cut_position": ["--what", "cut"],
    "render.zoom_at": ["--zoom-um", "6"],
}
quick = {"simulate": ["--walkers", "100", "--step-ms", "0.02", "--b", "0,1", "--directions", "2", "--delta-ms", "1", "--separation-ms", "2"],
         "render": ["--size-px", "96"], "analyse": ["--points", "20000"], "mesh": ["--h-um", "0.6"], "relax": ["--iterations", "8"],
         "fit": ["--starts", "4"]}

cell = """1 1 0 0 0 5 -1
2 4 0 0 5 1 1
3 4 0 0 20 0.8 2
4 4 5 0 40 0.6 3
5 4 -6 0 45 0.02 3
6 4 0.5 1 21 0.1 3
7 3 5 0 0 1 1
8 3 20 5 0 0.7 7
9 3 22 5.5 0 0.25 8
10 3 30 12 4 0.4 8
11 3 0 5 0 0.5 1
12 3 0 6.5 0 0.5 11
13 2 0 -5 0 0.4 1
14 2 3 -40 2 0.3 13
15 2 30 -60 2 0.3 14
"""


class Parameters:
    def __init__(self, programs, source, work):
        self.programs, self.source, self.work = programs, source, work
        self.flips = self.changed = self.refused = 0
        self.excused, self.by_refusal, self.failures = [], [], []

    def run(self, word, *words):
        own = self.programs / f"conceg-{word}"
        command = [own] if own.exists() else [self.programs / "conceg", word]
        return subprocess.run([*map(str, command), *map(str, words)], capture_output=True, text=True)

    def must(self, *words):
        done = self.run(*words)
        if done.returncode:
            sys.exit(f"{' '.join(map(str, words))} failed: {done.stderr}")

    def prepare(self, until="mesh"):
        work = self.work
        recipe = work / "recipe.yaml"
        recipe.write_text((self.source / "tests/pipe/small.yaml").read_text().replace("[28, 28, 28]", "[20, 20, 20]").replace("1.4e-4", "2.6e-4"))
        self.must("run", recipe, "--until", until, "--set", "mesh.h_um=0.6", "--set", "mesh.levels=1", "-q", "--checkpoint", work / "made", "-o", work / "mesh.cgx")
        (work / "cell.swc").write_text(cell)
        (work / "one.scheme").write_text("VERSION: STEJSKALTANNER\n1 0 0 0.5 0.003 0.001 0.004\n")
        (work / "reported").mkdir()
        (work / "loose-trees.swc").write_text(cell + "16 3 50 0 0 0.4 -1\n17 3 55 0 0 0.4 16\n")
        (work / "pieces.swc").write_text(cell + "16 2 0 -5 0 0.2 1\n17 2 0 -30 0 0.2 16\n18 2 0 -40 0 0.2 -1\n19 2 0 -60 0 0.2 18\n")
        (work / "loose.swc").write_text(cell.replace("2 4 0 0 5 1 1", "2.0 4 0 0 5 1 1"))
        (work / "table.csv").write_text("cell_type cell_id component component_id X Y Z inner_radius outer_radius\naxon 0 axon 0 1 2 3 0.5 0.5\naxon 0 axon 0 2 2 3 0.5 0.5\n")
        (work / "table_info.txt").write_text("Voxel Size 20\n")
        (work / "other_info.txt").write_text("Voxel Size 30\n")
        columns = "file,entry,class,donor_id,fold,frame,soma_radius_um,axon,note\n"
        (work / "two.csv").write_text(columns + "cell.swc,two,interneuron,,0,-y,,full,\n")
        (work / "sourced.csv").write_text("file,entry,class,source\ncell.swc,two,interneuron,here\n")
        (work / "sources.csv").write_text("source,repository,licence,terms\nhere,a/b,MIT,cite\n")
        (work / "glia.csv").write_text(columns + f"{self.source}/data/astrocyte-barcodes.csv,glia,astrocyte,,0,unknown,,,\n")
        signals = [0.8, 0.66, 0.43, 0.31, 0.25, 0.21, 0.16]
        rows = [f"{name},{b},{1 if b == 0 else signals[i - 1] * scale},{0.001 * (i + 1)}" for name, scale in (("intra", 1), ("all", 0.9)) for i, b in enumerate([0, 0.5, 1, 2, 3, 4, 6, 10])]
        (work / "signals.csv").write_text("compartment,b,signal,standard_error\n" + "\n".join(rows) + "\n")
        (work / "signals.txt").write_text("1 0.8 0.4\n")
        with zipfile.ZipFile(work / "labels.npz", "w") as file:
            header = b"{'descr': '|u1', 'fortran_order': False, 'shape': (4, 6, 9)}"
            for name, step in (("labels", 1), ("second", 2)):
                file.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + bytes(i * step // 7 % 5 for i in range(216)))
        (work / "bvals").write_text("0 1000 3000\n")
        (work / "bvecs").write_text("0 1 0\n0 0 1\n0 0 0\n")
        self.must("analyse", work / "mesh.cgx", "--points", "1000", "-q", "-o", work / "tables.cgx")
        self.must("import", "signal", work / "signals.csv", "--pulse-duration-ms=5", "--pulse-separation-ms=20", "-q", "-o", work / "signals.cgx")
        for real, file in (("real", "cell.swc"), ("other", "loose-trees.swc")):
            self.must("characterise", work / file, "--entry", "L23_pyramidal", "-q", "-o", work / f"{real}.cgx")
        if until == "mesh":
            self.must("analyse", work / "mesh.cgx", "--structure", work / "other.cgx", "--points", "0", "--field-step-um", "1", "-q", "-o", work / "analysed.cgx")
        if until == "mesh" and (self.programs / "conceg-simulate").exists():
            self.must("simulate", work / "mesh.cgx", *quick["simulate"], "--times-ms=0.1:4:12", "-q", "-o", work / "walked.cgx")
        made = work / "made"
        self.inputs = {
            "place": ["-p", recipe], "triangulate": [made / "01-place.cgx"], "grow": [made / "02-triangulate.cgx"], "relax": [made / "03-grow.cgx"],
            "block": [made / "04-relax.cgx"], "mesh": [made / "04-relax.cgx"], "analyse": [work / "mesh.cgx"], "simulate": [work / "mesh.cgx"], "export": [work / "mesh.cgx"], "render": [work / "mesh.cgx"], "report": [work / "tables.cgx"],
            "fit": [work / "signals.cgx"],
            "characterise": [work / "cell.swc"], "import": ["swc", work / "loose-trees.swc"],
        }

    def words_of(self, stage, name):
        if stage == "characterise" and name.startswith("astrocyte"):
            return ["--table", self.work / "glia.csv"]
        if stage == "import" and name in ("bval", "bvec", "compartment", "pulse_duration_ms", "pulse_separation_ms"):
            return ["signal", self.work / "signals.txt"]
        if stage == "import" and name in ("voxel_um", "array", "axes", "resample_um"):
            return ["labels", self.work / "labels.npz"]
        if stage == "analyse" and name in ("diffusivity", "tail_from_ms", "tail_to_ms", "csv") and (self.work / "walked.cgx").exists():
            return [self.work / "walked.cgx"]
        if stage == "import" and name in ("box_um", "info"):
            return ["caterpillar", self.work / "table.csv"]
        if name == "strict":
            return [*(["swc"] if stage == "import" else []), self.work / "loose.swc"]
        if stage == "characterise" and name == "axon_gap_um":
            return [self.work / "pieces.swc", "--axons=true"]
        if stage == "characterise" and name == "sources":
            return ["--table", self.work / "sourced.csv"]
        if stage == "characterise" and name == "table":
            return []
        return self.inputs[stage]

    def output(self, stage, words, sink):
        """Bytes of what a run makes, as a digest; None and the error of a run that refuses."""
        target = self.work / "out"
        shutil.rmtree(target, ignore_errors=True)
        target.mkdir()
        if sink:
            # The page of a report lies in a folder of its own, under one name.
            option, place = ("--page=", "files/page.html") if stage == "report" else ("--dir=", "files")
            given = [w for w in map(str, words) if w.startswith(option)]
            (target / "files").mkdir()
            done = self.run(stage, *words, *([] if given else [f"{option}{target}/{place}"]), "-q")
        else:
            done = self.run(stage, *words, "-q", "-o", target / "out.cgx")
        if done.returncode:
            return None, done
        if not sink:
            # A source that got no recipe writes one only when a parameter was given.
            recipe = "recipe," if self.run("dump", "/recipe", target / "out.cgx", "-q").returncode == 0 else ""
            self.must("strip", recipe + "provenance", target / "out.cgx", "-q", "-o", target / "bare.cgx")
            return hashlib.sha256((target / "bare.cgx").read_bytes()).hexdigest(), done
        folder = target / "files"
        if given:
            folder = pathlib.Path(given[0].split("=", 1)[1])
            folder = folder.parent if stage == "report" else folder
        digest = hashlib.sha256()
        files = sorted(p for p in folder.rglob("*") if p.is_file())
        for path in files:
            digest.update(str(path.relative_to(folder)).encode() + path.read_bytes())
        return (digest.hexdigest() if files else None), done

    def values(self, stage, row):
        """Values to try, in turn, until one shows."""
        key, default = f"{stage}.{row['name']}", row["default"]
        if key in instead:
            return [instead[key][0]]
        if key in texts:
            return [texts[key].format(work=self.work)]
        if row["type"] in ("text", "file"):
            return ["other"]
        if row["type"] == "bool":
            return ["false" if default == "true" else "true"]
        if row["type"] == "choice":
            return [c for c in row["choices"].split("|") if c != default]
        return [f"{v:g}" for v in (row["lo"], row["hi"]) if f"{v:g}" != default]

    def flip(self, stage, row, base, sink, extra):
        key = f"{stage}.{row['name']}"
        option = "--" + row["name"].replace("_", "-")
        words = [*self.words_of(stage, row["name"]), *extra, *[w.format(work=self.work) for w in needs.get(key, [])]]
        words = [w for i, w in enumerate(words) if w != option and (i == 0 or words[i - 1] != option)]
        special = words != [*self.inputs[stage], *extra]
        before = self.output(stage, words, sink)[0] if special and row["name"] != "table" else base
        if row["name"] == "table":
            before = base
        self.flips += 1
        shown = []
        for value in self.values(stage, row):
            after, done = self.output(stage, [*words, f"{option}={value}"], sink)
            if after is None:
                # A refusal that names the parameter, or the file it now refuses, is an effect too.
                if done.returncode in (1, 3) and "error" in done.stderr:
                    shown.append(f"{value}: refused ({done.stderr.strip().splitlines()[-1][:110]})")
                    continue
                self.failures.append(f"{key}={value}: exit code {done.returncode}: {done.stderr.strip()[:200]}")
                return
            if after != before:
                shown.append(value)
                break
        if key in same:
            if shown:
                self.failures.append(f"{key}: expected the same bytes ({same[key]}), but {shown[0]} changes them")
            else:
                self.excused.append(f"{key}: {same[key]}")
        elif not shown:
            self.failures.append(f"{key}: {' '.join(self.values(stage, row))}: no byte of the output changes")
        elif all(": refused (" in value for value in shown):
            self.by_refusal.append(f"{key}={shown[0]}")
        else:
            self.changed += 1

    def refuse(self, stage, row):
        beyond = {"f64": ["nan", "inf"], "i64": ["0.5"], "bool": ["maybe"], "choice": ["none-of-these"]}.get(row["type"], [])
        if row["type"] in ("f64", "i64"):
            beyond += [f"{row['lo'] - 1:.15g}", f"{row['hi'] * 2 + 1:.15g}"]
        source = stage in ("place", "characterise", "import")
        for value in beyond:
            done = self.run(stage, *(self.inputs[stage] if source else [self.work / "made/01-place.cgx"]), "--set", f"{stage}.{row['name']}={value}",
                            "-o", self.work / "refused.cgx", "-q")
            if done.returncode != 2 or row["name"] not in done.stderr:
                self.failures.append(f"{stage}.{row['name']}={value!r}: expected exit code 2 and its name, got {done.returncode}: {done.stderr.strip()[:160]}")
            self.refused += 1

    def stage(self, stage, impl=None):
        extra = ["--impl", impl] if impl else quick.get(stage, [])
        listed = json.loads(self.run("params", stage, "--json", *(["--impl", impl] if impl else [])).stdout)
        rows = listed if isinstance(listed, list) else listed["parameters"]
        sink = stage in ("export", "render", "report")
        base, done = self.output(stage, [*self.inputs[stage], *extra], sink)
        if base is None:
            sys.exit(f"{stage}: the run at the defaults failed: {done.stderr}")
        start = time.monotonic()
        for row in rows:
            self.flip(stage, row, base, sink, extra)
            if not impl:
                self.refuse(stage, row)
        print(f"{stage}: {len(rows)} parameters, {time.monotonic() - start:.1f} s", flush=True)


def main():
    programs, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        test = Parameters(programs, source, pathlib.Path(folder))
        test.prepare("grow" if "--plant" in sys.argv else "mesh")
        if "--plant" in sys.argv:
            stage, impl = sys.argv[sys.argv.index("--plant") + 1].split(":")
            test.stage(stage, impl)
        else:
            words = [p.name[7:] for p in sorted(programs.glob("conceg-*"))]
            for stage in words:
                if stage in test.inputs:
                    test.stage(stage)
                else:
                    test.failures.append(f"{stage}: this test does not know how to run the stage")
    for line in test.excused:
        print(f"same bytes demanded: {line}")
    for line in test.by_refusal:
        print(f"refused by the stage at every value tried: {line}")
    for line in test.failures:
        print(f"FAILED: {line}")
    print(f"{test.flips} parameters flipped: {test.changed} change the output, {len(test.by_refusal)} make the stage refuse, {len(test.excused)} keep it for a stated reason, {len(test.failures)} failures; "
          f"{test.refused} values beyond the bounds refused")
    return 1 if test.failures or not test.flips else 0


sys.exit(main())
