# SPDX-License-Identifier: BSD-3-Clause
"""Who has taken the files of each format, in which test: the last column of the tables of spec/interop.md, which table.py writes.

An entry is (who, test) or (who, test, remark). Tests compare what they did with the entries that name them; "by hand" is outside of the tests.
"""
HAND = "by hand"

READ = {
    "swc": [("own reader's table", "swc.reader_table"), ("files that MorphIO, NeuroM and navis read", "swc.peers")],
    "cactus": [("samples by the description", "interop.files"), ("lists that its Python (ee81f86) writes", "interop.programs"), ("fuzzed", "hardening.fuzz")],
    "ply": [("headers in the form of VTK's writer", "interop.files"), ("our own surfaces, there and back", "interop.files"), ("fuzzed", "hardening.fuzz")],
    "caterpillar": [("samples of the five layouts by the description: one document", "interop.files"), ("a table that the program wrote", HAND, "its first layout, 59 609 rows"), ("fuzzed", "hardening.fuzz")],
    "nfg": [("samples by the description", "interop.files"), ("fuzzed", "hardening.fuzz")],
    "fastpli": [("samples of .dat by the description", "interop.files"), ("files of h5py: the document of the .dat", "interop.bundles"), ("a .dat and a .h5 that its own writers (39cb21a) wrote", HAND, "one document"), ("fuzzed", "hardening.fuzz"),
                ("damaged .h5", "hardening.mutants_bundles")],
    "wmg": [("samples by the description, by the names that its writer uses", "interop.files"), ("fuzzed", "hardening.fuzz")],
    "network": [("own format, there and back", "interop.files"), ("fuzzed", "hardening.fuzz")],
    "signal": [("own tables", "cli.fit", "stages/import/README.md"), ("fuzzed", "hardening.fuzz")],
    "labels": [("files that NumPy writes", "interop.labels", "every type, order and packing: one document"), ("fuzzed", "hardening.fuzz")],
}

WRITTEN = {
    "vtk": [("VTK's readers", "unit.export_files"), ("PyVista", "interop.peers")],
    "ply": [("trimesh", "interop.peers"), ("meshio", "interop.peers"), ("PyVista", "interop.peers")],
    "swc": [("MorphIO", "interop.peers"), ("NeuroM", "interop.peers"), ("navis", "interop.peers")],
    "cactus": [("linter", "interop.peers"), ("its Python reader and its quick-mesh (ee81f86)", "interop.programs"), ("our importer", "interop.files", "exactly")],
    "caterpillar": [("linter", "interop.peers"), ("our importer", "interop.peers", "there and back, and as spheres alone, less than 0.5 % of the union volume differ: 0.00 % and 0.24 % measured")],
    "mcdc": [("linter", "interop.peers"), ("trimesh", "interop.peers"), ("MC/DC 6d043d6", "interop.programs", "the signal of `conceg simulate` within 3 standard errors")],
    "disimpy": [("linter", "interop.peers"), ("NumPy", "interop.peers"), ("DiSimPy 0.3.0 in Numba's simulator of CUDA", "tutorials.simulators", "the script runs, the signal within 3 standard errors of 16 walkers")],
    "camino": [("linter", "interop.peers"), ("meshio", "interop.peers"), ("not run with Camino", HAND)],
    "rms": [("linter", "interop.peers"), ("not run with RMS", HAND)],
    "spindoctor": [("linter", "interop.peers"), ("trimesh", "interop.peers"), ("TetGen 1.5.0, which it calls", "interop.programs", "both forms are meshed"), ("not run with SpinDoctor", HAND)],
    "dmipy-sim": [("linter", "interop.peers"), ("trimesh", "interop.peers", "which it loads PLY with"), ("not run with dmipy-sim", HAND)],
    "mcmr": [("linter", "interop.peers"), ("trimesh", "interop.peers"), ("meshio", "interop.peers"), ("not run with MCMRSimulator", HAND)],
    "stl": [("trimesh", "interop.peers")],
    "obj": [("trimesh", "interop.peers")],
    "gltf": [("trimesh", "interop.peers")],
    "vdb": [("OpenVDB", "unit.mesh_volume", "every voxel")],
    "nifti": [("nibabel", "interop.peers")],
    "h5v1": [("MorphIO", "interop.peers"), ("NeuroM", "interop.peers")],
    "network": [("our importer", "interop.files")],
}


def named(table, test):
    """{format: who} of the entries of one test."""
    found = {form: {entry[0] for entry in entries if entry[1] == test} for form, entries in table.items()}
    return {form: who for form, who in found.items() if who}


def text(entries):
    """The cell of a table: who, grouped by test."""
    parts = []
    for test in dict.fromkeys(entry[1] for entry in entries):
        group = [entry for entry in entries if entry[1] == test]
        who = ", ".join(entry[0] + (f" [{entry[2]}]" if len(entry) > 2 else "") for entry in group)
        parts.append(who if test == HAND and all(entry[0].startswith("not run") for entry in group) else f"{who} ({test})")
    return "; ".join(parts)
