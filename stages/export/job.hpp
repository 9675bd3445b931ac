// SPDX-License-Identifier: BSD-3-Clause
// One run of the stage: what all writers share.
#pragma once

#include "folder.hpp"
#include "parallel.hpp"
#include "protocol.hpp"
#include "source.hpp"

#include <string>
#include <vector>

namespace conceg::exporting {

struct Options {
  std::string to, dir, cells;
  bool wrapped, ascii;
  bool whole;            // CATERPillar and CACTUS: the cells as they are stored
  Form form;             // of surfaces
  Tiles tiles;           // of surfaces
  int level;             // of surfaces
  int columns;           // of a CATERPillar table
  std::uint64_t walkers; // starting points, intracellular and as many extracellular
  double fraction_um;    // voxel of the fraction map
  double diffusivity;    // um2/ms
  Protocol protocol;
};

struct Job {
  conceg_ctx *ctx;
  conceg_doc *doc;
  const Options &options;
  Source source;
  std::vector<Cell> cells;
  OutputFolder folder;
  Progress progress;
  std::string cells_are; // for the manifest, where it is not the same for all files of a format

  Job(conceg_ctx *context, conceg_doc *document, const Options &all)
      : ctx(context), doc(document), options(all), source(document, all.level),
        cells(source.select(all.cells)), folder(all.dir), progress(progress_of(context)) {}

  // A row of the index about a file of one cell.
  Written about(const Cell &cell, std::string file, const char *what) const;
  // The cell's surface in the form and the tiles that were asked for.
  CellSurface surface_of(const Cell &cell) const;
  // The cell's skeleton, split at the box where that was asked for.
  Tree tree_of(const Cell &cell) const;
  // Writes a text file of the folder and lists it.
  void text_file(const std::string &file, const char *what, const std::string &text);
};

// A PLY of surfaces, listed in the index; of one cell, or of all when `cell` is NULL.
void write_ply_file(Job &job, const std::string &file, const std::vector<const Surface *> &surfaces,
                    const Cell *cell, bool ascii, const char *unit = "lengths in um",
                    const char *more = nullptr);

// The surface of the extracellular space, in a mesh format.
void write_extracellular(Job &job, const std::string &format);

// "cell_0007_L23_pyramidal" of a cell.
std::string name_of(const Cell &cell);
// The shortest text of at most 17 digits that reads back as the same double.
std::string number_text(double value);

// The writers, one file each; what each needs is in stage.cpp. They write into the sub-folder of their
// name.
void export_vtk(Job &job);
void export_ply(Job &job);
void export_swc(Job &job);
void export_cactus(Job &job);
void export_caterpillar(Job &job);
void export_mcdc(Job &job);
void export_disimpy(Job &job);
void export_camino(Job &job);
void export_rms(Job &job);
void export_spindoctor(Job &job);
void export_dmipy(Job &job);
void export_mcmr(Job &job);
void export_stl(Job &job);
void export_obj(Job &job);
void export_gltf(Job &job);
void export_vdb(Job &job);
void export_nifti(Job &job);
void export_h5v1(Job &job);
void export_network(Job &job);

} // namespace conceg::exporting
