// SPDX-License-Identifier: BSD-3-Clause
// What every importer makes of its files, as plain data, and the document made of that.
#pragma once

#include "guard.hpp"
#include "text_file.hpp"
#include "tile.hpp"

#include "conceg/model.h"
#include "conceg/swc.h"

#include <cstdint>
#include <string>
#include <vector>

namespace conceg::importing {

// One cell: a soma, or none, and points in parent-before-child order. Lengths in um.
struct SceneCell {
  std::string type;                  // name of its type
  std::string cell_class = "axon";   // of /types/class
  glm::dvec3 soma = glm::dvec3(0.0); // set by place_soma() when there is none
  double soma_radius = 0.0;          // 0 = none
  std::vector<glm::dvec3> position;
  std::vector<double> radius, inner_radius; // inner: below the myelin; empty where the format has none
  std::vector<std::int64_t> parent;         // row, -1 = a root
  std::vector<std::uint8_t> kind;           // SWC code

  // Adds a point whose parent is the last one, or a root when it is the first.
  void follow(const glm::dvec3 &at, double r, std::uint8_t code);
};

// A triangle surface of a cell, outward; compartment of /meshes/compartment.
struct SceneSurface {
  std::uint32_t cell;
  std::uint8_t compartment;
  Surface surface;
};

struct Scene {
  std::vector<SceneCell> cells;
  std::vector<SceneSurface> surfaces;
  bool has_box = false; // else one is put around
  glm::dvec3 lo = glm::dvec3(0.0), hi = glm::dvec3(0.0);

  void centred_box(const glm::dvec3 &sides) { has_box = true, lo = -0.5 * sides, hi = 0.5 * sides; }
  void corner_box(double side) { has_box = true, lo = glm::dvec3(0.0), hi = glm::dvec3(side); }
};

// Parameters of the stage that several importers use.
struct Request {
  conceg_ctx *ctx;
  std::vector<std::string> names; // files and folders
  std::string cell_class;         // empty: by the file
  double margin_um, radius_min_um, box_um;
  std::string info; // growth_info file of CATERPillar; empty: beside the table
  bool roots_are_cells;
  std::uint32_t swc_flags;
};

// The files named and those below the folders named whose ending is in `endings` (".ply"), by name; E_MISSING
// when a folder has none.
std::vector<std::string> find_files(const std::vector<std::string> &names,
                                    const std::vector<std::string> &endings);
std::string base_name(const std::string &path);
// The one file of a format that has one; E_USAGE otherwise.
const std::string &only_file(const Request &request, const char *what);

// Refuses a scene of which no point lies within a side of its box, or with a radius wider than it: a wrong
// unit or frame.
void check_frame(const Scene &scene, const std::string &path, const char *remedy);

// /domain alone. A box that the scene lacks is put around it on whole micrometres with the margin on each
// side.
void write_domain(conceg_doc *doc, const Scene &scene, double margin_um, const std::uint8_t periodic[3]);
// /domain, with all sides open, /types /cells /skeleton and, where there are surfaces, /meshes.
void write_document(conceg_ctx *ctx, conceg_doc *doc, const Scene &scene, double margin_um);

// The importers: one file each, named after its format.
Scene read_cactus(const Request &request);
Scene read_caterpillar(const Request &request);
Scene read_nfg(const Request &request);
Scene read_fastpli(const Request &request);
Scene read_wmg(const Request &request);
Scene read_ply_folder(const Request &request);
void import_swc(const Request &request, conceg_doc *doc, bool *restored);
void import_network(const Request &request, conceg_doc *doc);

// Their parsers of one text, for the tests and the fuzz target.
Scene parse_cactus(TextFile text);
Scene parse_caterpillar(TextFile table);
void parse_growth_info(TextFile info, Scene &scene);
void parse_fastpli(TextFile text, Scene &scene);
void parse_nfg(TextFile text, Scene &scene);
void parse_wmg(const std::string &bytes, const std::string &path, Scene &scene);
Surface parse_ply(const std::string &bytes, const std::string &path);

} // namespace conceg::importing
