// SPDX-License-Identifier: BSD-3-Clause
// Surfaces, by the mesh stage's final check, and what the document says of them.
#include "gates.hpp"
#include "rows.hpp"

#include "components.hpp"
#include "final_check.hpp"
#include "finish.hpp"
#include "topology.hpp"
#include "wrap.hpp"

#include <cmath>
#include <numeric>

namespace conceg::gates {
namespace {

using namespace conceg::mesh;

constexpr double kExact = 1e-9; // relative, of sums of doubles
const char *const g = "/meshes";

struct FlawGate {
  const char *name;
  std::vector<Flaw> flaws;
};
const FlawGate flaw_gates[] = {
    {"closed", {Flaw::bad_index, Flaw::degenerate_face, Flaw::unused_vertex, Flaw::open_edge}},
    {"manifold", {Flaw::split_vertex}},
    {"oriented outward", {Flaw::turned_face, Flaw::inward}},
    {"no two cells cross", {Flaw::crossing_cells}},
    {"no cell crosses its own image", {Flaw::crossing_image}},
    {"no cell crosses itself", {Flaw::crossing_self, Flaw::fold}},
};

const char *const other_names[] = {"rows",
                                   "values",
                                   "gap",
                                   "every cell has its surface",
                                   "one piece",
                                   "genus as stored",
                                   "measures as stored",
                                   "detached pieces",
                                   "volume fraction as stored",
                                   "coarser levels closed"};

void nothing_judged(Gates &gates, const std::string &why) {
  gates.not_judged(g, "values", why);
  for (const FlawGate &gate : flaw_gates)
    gates.not_judged(g, gate.name, why);
  for (std::size_t i = 2; i < std::size(other_names); i++)
    gates.not_judged(g, other_names[i], why);
}

std::string of_surfaces(const FinalCheck &check) {
  std::size_t faces = 0;
  for (const SurfaceView &surface : check.surfaces)
    faces += surface.faces;
  return formatted("%zu closed surfaces of level 0, %zu faces", check.surfaces.size(), faces);
}

void flaws_of(const FinalCheck &check, Gates &gates) {
  for (const FlawGate &gate : flaw_gates) {
    std::uint64_t found = 0;
    std::string first;
    for (const Defect &defect : check.result.defects)
      if (std::find(gate.flaws.begin(), gate.flaws.end(), defect.flaw) != gate.flaws.end() && !found++)
        first = describe(defect, check.surfaces);
    const bool pairs = is_pair(gate.flaws[0]);
    gates.none(g, gate.name, found,
               pairs ? formatted("%llu pairs of faces in all images",
                                 static_cast<unsigned long long>(check.result.pairs_checked))
                     : of_surfaces(check),
               first);
  }
}

void gap_of(const FinalCheck &check, double least_gap, Gates &gates) {
  double least = INFINITY;
  std::string where;
  for (std::size_t s = 0; s < check.surfaces.size(); s++)
    if (check.result.min_gap[s] < least)
      least = check.result.min_gap[s], where = formatted("least at cell %u", check.surfaces[s].cell);
  for (const Defect &defect : check.result.defects)
    if (defect.flaw == Flaw::near) {
      where = describe(defect, check.surfaces);
      break;
    }
  gates.at_least(g, "gap", least, least_gap, "um", "to the nearest other cell or image; " + where);
}

void completeness(conceg_doc *doc, const FinalCheck &check, Gates &gates) {
  const Cells cells(doc);
  std::uint64_t missing = 0, excused = 0;
  std::string first;
  for (const std::uint32_t cell : check.missing) {
    if (cell < cells.rows() && !(cells.radius[cell] > 0) && !cells.points_of(cell))
      excused++;
    else if (!missing++)
      first = formatted("cell %u has no surface", cell);
  }
  gates.none(g, "every cell has its surface", missing,
             formatted("%zu cells; %llu have neither soma nor skeleton", cells.rows(),
                       static_cast<unsigned long long>(excused)),
             first);
}

std::size_t pieces_of(const SurfaceView &surface) {
  std::vector<std::uint32_t> up(surface.vertices);
  std::iota(up.begin(), up.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (up[v] != v)
      v = up[v] = up[up[v]];
    return v;
  };
  std::size_t pieces = surface.vertices;
  for (std::size_t f = 0; f < surface.faces; f++)
    for (int k = 1; k < 3; k++) {
      const std::uint32_t a = root(surface.face[f].x), b = root(surface.face[f][k]);
      if (a == b) continue;
      up[std::max(a, b)] = std::min(a, b), pieces--;
    }
  return pieces;
}

// One value per surface, measured again.
struct Measured {
  std::vector<double> volume, area, inside;
  std::vector<std::int64_t> genus;
  std::vector<std::size_t> pieces;
};

Measured measure(const FinalCheck &check, const conceg_box &box, Workers &workers) {
  Measured m;
  const std::size_t count = check.surfaces.size();
  m.volume.resize(count), m.area.resize(count), m.inside.resize(count), m.genus.resize(count);
  m.pieces.resize(count);
  workers.loop(count, 1, [&](std::size_t s, unsigned) {
    const SurfaceView &surface = check.surfaces[s];
    if (!check.result.usable[s]) return;
    m.volume[s] = volume_of(surface), m.area[s] = area_of(surface);
    m.inside[s] = volume_inside(surface, box);
    m.pieces[s] = pieces_of(surface);
    m.genus[s] = static_cast<std::int64_t>(m.pieces[s]) - euler_characteristic(surface) / 2;
  });
  return m;
}

bool near(double a, double b) {
  return std::fabs(a - b) <= kExact * std::max(std::fabs(a), std::fabs(b));
}

// Rows of /meshes that the check looked at, in its order.
std::vector<std::size_t> judged_rows(conceg_doc *doc) {
  const View<std::uint8_t> lod = rows_of<std::uint8_t>(doc, "/meshes/lod");
  const std::vector<std::string> form = texts_of(doc, "/meshes/form");
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < lod.rows() && k < form.size(); k++)
    if (lod[k] == 0 && form[k] == "closed") rows.push_back(k);
  return rows;
}

void pieces_and_genus(conceg_doc *doc, const FinalCheck &check, const Measured &m, Gates &gates) {
  const std::vector<std::size_t> row = judged_rows(doc);
  const View<std::int64_t> genus = rows_of<std::int64_t>(doc, "/meshes/genus");
  std::uint64_t several = 0, other = 0, handles = 0, with_handles = 0;
  std::string first_several, first_other;
  for (std::size_t s = 0; s < check.surfaces.size(); s++) {
    const unsigned cell = check.surfaces[s].cell;
    if (!check.result.usable[s]) continue;
    if (m.pieces[s] != 1 && !several++)
      first_several = formatted("cell %u has %zu pieces", cell, m.pieces[s]);
    handles += static_cast<std::uint64_t>(std::max<std::int64_t>(0, m.genus[s])),
        with_handles += m.genus[s] > 0;
    if (row[s] < genus.rows() && genus[row[s]] != m.genus[s] && !other++)
      first_other = formatted("cell %u: stored %lld, counted %lld", cell,
                              static_cast<long long>(genus[row[s]]), static_cast<long long>(m.genus[s]));
  }
  gates.none(g, "one piece", several, of_surfaces(check), first_several);
  if (!genus.rows())
    gates.not_judged(g, "genus as stored", "no /meshes/genus");
  else
    gates.none(g, "genus as stored", other,
               formatted("%llu cells touch themselves and have %llu handles",
                         static_cast<unsigned long long>(with_handles),
                         static_cast<unsigned long long>(handles)),
               first_other);
}

void measures_as_stored(conceg_doc *doc, const FinalCheck &check, const Measured &m, Gates &gates) {
  const std::vector<std::size_t> row = judged_rows(doc);
  const View<double> volume = rows_of<double>(doc, "/meshes/volume"),
                     area = rows_of<double>(doc, "/meshes/area");
  const View<std::uint8_t> closed = rows_of<std::uint8_t>(doc, "/meshes/closed");
  if (!volume.rows() && !area.rows() && !closed.rows())
    return gates.not_judged(g, "measures as stored", "no volume, area or closed");
  std::uint64_t other = 0;
  std::string first;
  const auto differ = [&](std::size_t s, const char *what, double stored, double found) {
    if (!other++)
      first =
          formatted("cell %u: %s stored %.9g, measured %.9g", check.surfaces[s].cell, what, stored, found);
  };
  for (std::size_t s = 0; s < check.surfaces.size(); s++) {
    const std::size_t k = row[s];
    if (!check.result.usable[s]) continue;
    if (k < volume.rows() && !near(volume[k], m.volume[s])) differ(s, "volume", volume[k], m.volume[s]);
    if (k < area.rows() && !near(area[k], m.area[s])) differ(s, "area", area[k], m.area[s]);
    if (k < closed.rows() && closed[k] != check.result.closed[s])
      differ(s, "closed", closed[k], check.result.closed[s]);
  }
  gates.none(g, "measures as stored", other, "volume, area and closed of each surface, to 1e-9", first);
}

void left_out(conceg_doc *doc, const Measured &m, const Limits &limits, Gates &gates) {
  const View<double> detached = rows_of<double>(doc, "/meshes/detached_volume");
  if (!detached.rows()) return gates.not_judged(g, "detached pieces", "no /meshes/detached_volume");
  const double lost = std::accumulate(detached.begin(), detached.end(), 0.0),
               kept = std::accumulate(m.volume.begin(), m.volume.end(), 0.0);
  std::size_t cells = 0;
  for (const double d : detached)
    cells += d > 0;
  gates.at_most(g, "detached pieces", kept + lost > 0 ? lost / (kept + lost) : 0, limits.detached, "1",
                formatted("of the cells' volume is cut off from somata and left out: %.2f um3 of %zu cells",
                          lost, cells));
}

void fraction_as_stored(conceg_doc *doc, const conceg_box &box, const Measured &m, Gates &gates) {
  const double stored = scalar_of<double>(doc, "/meshes@icvf", NAN),
               found = std::accumulate(m.inside.begin(), m.inside.end(), 0.0) / volume(box);
  if (std::isnan(stored)) return gates.not_judged(g, "volume fraction as stored", "no /meshes@icvf");
  gates.at_most(g, "volume fraction as stored", std::fabs(found - stored), kExact, "1",
                formatted("stored %.9f, the surfaces enclose %.9f of the box", stored, found));
}

// Coarser levels are for viewers: each must be closed, manifold and outward by itself.
void coarser_levels(conceg_doc *doc, Workers &workers, Gates &gates) {
  const char *const name = "coarser levels closed";
  const View<std::uint8_t> lod = rows_of<std::uint8_t>(doc, "/meshes/lod");
  const View<std::uint32_t> cell = rows_of<std::uint32_t>(doc, "/meshes/cell");
  const View<std::uint64_t> vertices = rows_of<std::uint64_t>(doc, "/meshes/vertex_offset"),
                            faces = rows_of<std::uint64_t>(doc, "/meshes/face_offset");
  const View<double> vertex = rows_of<double>(doc, "/meshes/vertex", 3);
  const View<std::uint32_t> face = rows_of<std::uint32_t>(doc, "/meshes/face", 3);
  if (std::none_of(lod.begin(), lod.end(), [](std::uint8_t level) { return level > 0; }))
    return gates.not_judged(g, name, "no surfaces but those of level 0");
  if (cell.rows() != lod.rows() || !ascends(vertices, lod.rows(), vertex.rows()) ||
      !ascends(faces, lod.rows(), face.rows()))
    return gates.not_judged(g, name, "/meshes cannot be read as surfaces");
  std::vector<std::vector<Defect>> found(lod.rows());
  Views surfaces(lod.rows());
  workers.loop(lod.rows(), 1, [&](std::size_t k, unsigned) {
    if (!lod[k]) return;
    Bits plain;
    SurfaceView &s = surfaces[k];
    s.cell = cell[k];
    s.absolute = reinterpret_cast<const glm::dvec3 *>(vertex.data()) + vertices[k];
    s.face = reinterpret_cast<const glm::uvec3 *>(face.data()) + faces[k];
    s.vertices = vertices[k + 1] - vertices[k], s.faces = faces[k + 1] - faces[k];
    check_topology(s, static_cast<std::uint32_t>(k), found[k], plain);
  });
  std::uint64_t defects = 0, looked_at = 0;
  std::string first;
  for (std::size_t k = 0; k < found.size(); k++) {
    looked_at += lod[k] > 0;
    if (first.empty() && !found[k].empty())
      first = formatted("level %u, ", unsigned(lod[k])) + describe(found[k][0], surfaces);
    defects += found[k].size();
  }
  gates.none(g, name, defects, formatted("%llu surfaces", static_cast<unsigned long long>(looked_at)), first);
}

} // namespace

void surface_gates(conceg_doc *doc, const Limits &limits, Workers &workers, const Progress &progress,
                   Gates &gates) {
  if (!has(doc, "/meshes/cell")) {
    gates.not_judged(g, "rows", "no /meshes");
    return nothing_judged(gates, "no /meshes");
  }
  for (const char *path : {"/meshes/lod", "/meshes/form"})
    if (!has(doc, path)) {
      gates.not_judged(g, "rows", formatted("no %s, which tells the surfaces to look at", path));
      return nothing_judged(gates, "the surfaces are not told apart");
    }
  const double gap = scalar_of<double>(doc, "/meshes@gap", 0),
               least = limits.least_gap_um > 0 ? limits.least_gap_um : kLeastGap * gap;
  FinalCheck check;
  try {
    check = check_document(doc, least, std::max(0.09, 1.5 * gap), limits.check_memory, workers, progress);
  } catch (const Error &error) { // an array of another type or width
    if (error.status() == CONCEG_E_CANCELLED || error.status() == CONCEG_E_NOMEM) throw;
    check.broken.push_back(*error.what() ? error.what() : "an array is missing or cannot be read");
  }
  std::vector<std::string> values, rows;
  for (const std::string &text : check.broken)
    (text.compare(0, 6, "vertex") == 0 ? values : rows).push_back(text);
  gates.none(g, "rows", rows.size(), "lengths, offsets, cells and faces of the rows",
             rows.empty() ? "" : rows[0]);
  if (check.surfaces.empty() || check.result.usable.size() != check.surfaces.size())
    return nothing_judged(gates, "/meshes cannot be read as surfaces");
  gates.none(g, "values", values.size(), "each vertex is its origin plus a single-precision value",
             values.empty() ? "" : values[0]);
  flaws_of(check, gates);
  if (least > 0)
    gap_of(check, least, gates);
  else
    gates.not_judged(g, "gap", "no /meshes@gap: which gap was asked for is not known");
  completeness(doc, check, gates);
  const conceg_box box = read_box(doc);
  const Measured measured = measure(check, box, workers);
  pieces_and_genus(doc, check, measured, gates);
  measures_as_stored(doc, check, measured, gates);
  left_out(doc, measured, limits, gates);
  fraction_as_stored(doc, box, measured, gates);
  coarser_levels(doc, workers, gates);
}

} // namespace conceg::gates
