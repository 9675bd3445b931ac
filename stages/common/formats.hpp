// SPDX-License-Identifier: BSD-3-Clause
// The formats of other programs, once: the choices of import and export, their help and spec/interop.md come
// from these lists.
#pragma once

#include <cstddef>
#include <string>

namespace conceg {

struct Format {
  const char *name;    // the word on the command line
  const char *program; // whose format it is
  const char *files;   // what is read or written
  const char *unit;    // of lengths in the files
  const char *frame;   // where the box lies in the files
  const char *becomes; // import: the groups that it makes; export: the groups that it needs
};

// name, program, files, unit, frame, groups
#define CONCEG_IMPORT_FORMATS(F)                                                                             \
  F("swc", "SWC, SWC-plus", "*.swc", "um", "as it stands; the box is put around, or [0, L]^3",               \
    "cells, skeleton")                                                                                       \
  F("cactus", "CACTUS", "strand list: .init, .partial, optimized_final.txt", "um", "box [-L/2, L/2]^3",      \
    "cells, skeleton")                                                                                       \
  F("ply", "CACTUS, ConFiG, MC/DC", "a folder of *.ply, one a cell; strand_NNNNN_outer|inner_erode_K.ply",   \
    "um", "as it stands", "cells, meshes")                                                                   \
  F("caterpillar", "CATERPillar", "sphere table of any of its five headers, with growth_info", "um",         \
    "box [0, L]^3, or the limits in growth_info", "cells, skeleton")                                         \
  F("nfg", "Numerical Fibre Generator", "a folder of strand_*-rRADIUS.txt", "mm",                            \
    "as it stands; the box is put around", "cells, skeleton")                                                \
  F("fastpli", "fastpli", "fibre bundles: .dat, .h5", "um", "as it stands; the box is put around",           \
    "cells, skeleton")                                                                                       \
  F("wmg", "White Matter Generator", "JSON, configuration or output", "um", "box centred on the origin",     \
    "cells, skeleton")                                                                                       \
  F("network", "ConFiG-like node network", "nodes.txt (id x y z rmax), edges.txt (i j)", "um",               \
    "as it stands", "network")                                                                               \
  F("signal", "a scanner, a simulator, FSL", "a table .csv, or one of numbers with bval and bvec",           \
    "ms/um2; s/mm2", "none", "protocol, signal")                                                             \
  F("labels", "NumPy, such as segmented electron microscopy", "an array of labels: .npy, .npz",              \
    "voxels, of import.voxel_um", "box [0, L]", "cells, volumes")

#define CONCEG_EXPORT_FORMATS(F)                                                                             \
  F("vtk", "ParaView, VTK", ".vtp, .vtm, .vti", "um", "as it stands", "skeleton, meshes or volumes")         \
  F("ply", "any mesh program", "a .ply per cell and one of all", "um", "as it stands", "meshes")             \
  F("swc", "SWC, SWC-plus", "a .swc per cell", "um", "as it stands", "skeleton")                             \
  F("cactus", "CACTUS", "strands.txt, strands.csv", "um", "box [-L/2, L/2]^3", "skeleton")                   \
  F("caterpillar", "CATERPillar", "voxel.csv of 9 or 10 columns, voxel_growth_info.txt, cells.csv", "um",    \
    "box [0, L]^3", "skeleton")                                                                              \
  F("mcdc", "MC/DC Simulator", "a text .ply per cell and one of all, .conf, .scheme, ini_walkers",           \
    "um; mm in .conf and ini_walkers", "box [0, L]", "meshes")                                               \
  F("disimpy", "DiSimPy", "arrays .npy, run.py", "m", "box [0, L], pinned by two points", "meshes")          \
  F("camino", "Camino datasynth", "mesh.ply, .scheme, run.sh", "m", "box [0, L], pinned by two points",      \
    "meshes")                                                                                                \
  F("rms", "RMS",                                                                                            \
    "intra/, extra/: fiber.txt, simParamInput.txt, diffusivity.txt, T2.txt, bval.txt, bvec.txt", "um",       \
    "box [0, L]", "volumes")                                                                                 \
  F("spindoctor", "SpinDoctor", ".node with .poly, and a text .stl, per cell", "um", "as it stands",         \
    "meshes")                                                                                                \
  F("dmipy-sim", "dmipy-sim", "mesh.ply, mesh.py", "um; m by its scale", "box [0, L]", "meshes")             \
  F("mcmr", "MCMRSimulator.jl", "a text .ply per cell, geometry.jl", "um", "box [0, L]", "meshes")           \
  F("stl", "any mesh program", "a binary .stl per cell", "um", "as it stands", "meshes")                     \
  F("obj", "any mesh program", "cells.obj, an object per cell", "um", "as it stands", "meshes")              \
  F("gltf", "viewers", "cells.glb, a node per cell", "um", "as it stands, turned so that +z is up (+y)",     \
    "meshes")                                                                                                \
  F("vdb", "OpenVDB", "volume.vdb: label, distance", "um", "as it stands", "volumes")                        \
  F("nifti", "NIfTI", "labels.nii, fraction.nii", "mm", "as it stands", "volumes")                           \
  F("h5v1", "BlueBrain, MorphIO", "a .h5 per cell", "um", "as it stands", "skeleton")                        \
  F("network", "ConFiG-like node network", "nodes.txt, edges.txt", "um", "as it stands", "network")

#define CONCEG_FORMAT_ROW(name, program, files, unit, frame, groups)                                         \
  {name, program, files, unit, frame, groups},
inline constexpr Format import_formats[] = {CONCEG_IMPORT_FORMATS(CONCEG_FORMAT_ROW)};
inline constexpr Format export_formats[] = {CONCEG_EXPORT_FORMATS(CONCEG_FORMAT_ROW)};
#undef CONCEG_FORMAT_ROW
// "|vtk|ply|...", for tables of parameters.
#define CONCEG_FORMAT_CHOICE(name, program, files, unit, frame, groups) "|" name

// "swc, cactus, ..." for a message.
template <std::size_t count> std::string format_names(const Format (&formats)[count]) {
  std::string names;
  for (const Format &format : formats)
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  return names;
}

} // namespace conceg
