# SPDX-License-Identifier: BSD-3-Clause
"""Grey-matter substrates of ConCeG in Python: documents and substrates as NumPy arrays, stages with progress.

Everything is asked of the C library (libconceg, found as `library_path` says) and of the programs installed with it.
"""
from ._library import ConcegError, Status, library_path, library_version
from .document import ArrayInfo, Document, Problem
from .stages import Progress, import_files, parameters, run_recipe, run_stage
from .substrate import Box, Cell, Hits, Mesh, Skeleton, Substrate, Volumes

__version__ = "0.1.0"
open = Document.open
__all__ = [
    "ArrayInfo", "Box", "Cell", "ConcegError", "Document", "Hits", "Mesh", "Problem", "Progress", "Skeleton", "Status", "Substrate", "Volumes",
    "import_files", "library_path", "library_version", "open", "parameters", "run_recipe", "run_stage",
]
