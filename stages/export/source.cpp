// SPDX-License-Identifier: BSD-3-Clause
#include "source.hpp"
#include "cut.hpp"

#include "view.hpp"

namespace conceg::exporting {
namespace {

// The rows of a cell in an optional column of `rows` values.
template <class T> View<T> optional_column(conceg_doc *doc, const char *path, std::size_t rows) {
  if (!has(doc, path)) return {};
  const View<T> column = view<T>(doc, path);
  if (column.rows() != rows)
    fail(CONCEG_E_FORMAT, "%s: expected %zu rows, got %zu", path, rows, column.rows());
  return column;
}

template <class T>
void copy_doubles(const View<T> &column, std::size_t from, std::size_t to, std::vector<double> &out) {
  if (column.data()) out.assign(column.data() + from, column.data() + to);
}

std::uint64_t placing_seed(conceg_doc *doc) {
  if (!has(doc, "/provenance/stage") || !has(doc, "/provenance/seed")) return 0;
  const std::vector<std::string> stages = texts(doc, "/provenance/stage");
  const View<std::uint64_t> seeds = view<std::uint64_t>(doc, "/provenance/seed");
  for (std::size_t i = 0; i < stages.size() && i < seeds.rows(); i++)
    if (stages[i] == "place") return seeds[i];
  return seeds.rows() ? seeds[0] : 0;
}

} // namespace

Source::Source(conceg_doc *doc, int level) : doc_(doc), box_(read_box(doc)), level_(level) {
  conceg_substrate *substrate = nullptr;
  must(conceg_substrate_open(doc, &substrate));
  substrate_.reset(substrate, conceg_substrate_free);
  seed_ = placing_seed(doc);
  has_skeleton_ = has(doc, "/skeleton/position");
  if (has(doc, "/types/layer")) layers_ = texts(doc, "/types/layer");
  find_surfaces();
}

// Rows and arrays of all levels were checked when the substrate was opened, which holds level 0.
void Source::find_surfaces() {
  const std::uint64_t finest = conceg_substrate_meshes(substrate_.get());
  if (!finest) return;
  surfaces_of_.resize(conceg_substrate_cells(substrate_.get()));
  if (level_ == 0) {
    for (std::uint64_t row = 0; row < finest; row++)
      surfaces_of_[mesh(row).cell].push_back(row);
    return;
  }
  const View<std::uint32_t> cell = view<std::uint32_t>(doc_, "/meshes/cell");
  const View<std::uint8_t> lod = optional_column<std::uint8_t>(doc_, "/meshes/lod", cell.rows());
  int most = 0;
  bool found = false;
  for (std::uint64_t row = 0; lod.data() && row < cell.rows(); row++) {
    most = std::max(most, int(lod[row]));
    if (lod[row] == level_) surfaces_of_[cell[row]].push_back(row), found = true;
  }
  if (!found)
    fail(CONCEG_E_MISSING,
         "level=%d: the document has surfaces up to level %d; run the mesh stage with levels=%d", level_,
         most, level_);
}

conceg_mesh_view Source::mesh(std::uint64_t row) const {
  conceg_mesh_view found = {};
  found.size = sizeof found;
  if (level_ == 0) {
    must(conceg_substrate_mesh(substrate_.get(), row, &found));
    return found;
  }
  const View<std::uint64_t> vertex_offset = view<std::uint64_t>(doc_, "/meshes/vertex_offset"),
                            face_offset = view<std::uint64_t>(doc_, "/meshes/face_offset");
  found.vertex = view<double>(doc_, "/meshes/vertex", 3).row(vertex_offset[row]);
  found.face = view<std::uint32_t>(doc_, "/meshes/face", 3).row(face_offset[row]);
  found.vertex_count = vertex_offset[row + 1] - vertex_offset[row];
  found.face_count = face_offset[row + 1] - face_offset[row];
  return found;
}

std::vector<Cell> Source::select(const std::string &cells) const {
  std::vector<Cell> chosen;
  for (CellInfo &info : select_cells(substrate_.get(), cells)) {
    chosen.push_back({std::move(info), ""});
    if (chosen.back().type < layers_.size()) chosen.back().layer = layers_[chosen.back().type];
  }
  return chosen;
}

Tree Source::tree(std::uint64_t cell) const {
  conceg_skeleton_view found = {};
  found.size = sizeof found;
  must(conceg_substrate_skeleton(substrate_.get(), cell, &found));
  Tree tree;
  tree.position.resize(found.count);
  for (std::uint64_t i = 0; i < found.count; i++)
    tree.position[i] = {found.position[3 * i], found.position[3 * i + 1], found.position[3 * i + 2]};
  tree.radius.assign(found.radius, found.radius + found.count);
  tree.parent.assign(found.parent, found.parent + found.count);
  tree.kind.assign(found.kind, found.kind + found.count);
  tree.on_soma.assign(found.count, 1);

  const View<std::uint64_t> offset = view<std::uint64_t>(doc_, "/skeleton/cell_offset");
  const std::size_t from = offset[cell], to = offset[cell + 1],
                    rows = view<double>(doc_, "/skeleton/position", 3).rows();
  copy_doubles(optional_column<float>(doc_, "/skeleton/target_radius", rows), from, to, tree.target_radius);
  copy_doubles(optional_column<std::uint32_t>(doc_, "/skeleton/bar", rows), from, to, tree.bar);
  copy_doubles(optional_column<std::uint32_t>(doc_, "/skeleton/branch", rows), from, to, tree.branch);
  copy_doubles(optional_column<std::uint32_t>(doc_, "/skeleton/tree", rows), from, to, tree.tree);
  copy_doubles(optional_column<std::uint8_t>(doc_, "/skeleton/status", rows), from, to, tree.status);
  return tree;
}

namespace {

CutSurface formed(const conceg_box &box, const Surface &surface, Form form) {
  if (form == Form::open) return cut_at_box(box, surface);
  if (form == Form::capped) return capped_at_box(box, surface);
  CutSurface out;
  if (form == Form::images) {
    TiledSurface tiled = tile(box, surface);
    out.source_face = std::move(tiled.source_face);
    static_cast<Surface &>(out) = std::move(static_cast<Surface &>(tiled));
    return out;
  }
  static_cast<Surface &>(out) = surface;
  for (std::uint32_t f = 0; f < surface.face.size(); f++)
    out.source_face.push_back(f);
  return out;
}

// A tile after the other; sides between tiles cut nothing.
CutSurface repeated(const conceg_box &box, const Tiles &tiles, const Surface &surface, Form form) {
  if (tiles.one()) return formed(box, surface, form);
  const conceg_box all = tiles.of(box);
  CutSurface out;
  for (int x = 0; x < tiles.count[0]; x++)
    for (int y = 0; y < tiles.count[1]; y++)
      for (int z = 0; z < tiles.count[2]; z++) {
        Surface moved = surface;
        for (glm::dvec3 &p : moved.vertex)
          p += glm::dvec3(x, y, z) * side(box);
        const CutSurface part = formed(all, moved, form);
        append(out, part);
        out.source_face.insert(out.source_face.end(), part.source_face.begin(), part.source_face.end());
      }
  return out;
}

} // namespace

CellSurface Source::surface(std::uint64_t cell, Form form, const Tiles &tiles) const {
  CellSurface out;
  const View<std::uint64_t> face_offset = view<std::uint64_t>(doc_, "/meshes/face_offset");
  const std::size_t rows = view<std::uint32_t>(doc_, "/meshes/face", 3).rows();
  const View<std::uint8_t> compartment = optional_column<std::uint8_t>(doc_, "/meshes/compartment", rows);
  const View<std::uint32_t> component = optional_column<std::uint32_t>(doc_, "/meshes/component", rows);
  const View<std::uint32_t> section = optional_column<std::uint32_t>(doc_, "/meshes/section", rows);
  for (const std::uint64_t surface : surfaces_of_[cell]) {
    const conceg_mesh_view found = mesh(surface);
    const auto base = static_cast<std::uint32_t>(out.surface.vertex.size());
    for (std::uint64_t i = 0; i < found.vertex_count; i++)
      out.surface.vertex.emplace_back(found.vertex[3 * i], found.vertex[3 * i + 1], found.vertex[3 * i + 2]);
    for (std::uint64_t i = 0; i < found.face_count; i++)
      out.surface.face.emplace_back(found.face[3 * i] + base, found.face[3 * i + 1] + base,
                                    found.face[3 * i + 2] + base);
    const std::size_t from = face_offset[surface], to = face_offset[surface + 1];
    if (compartment.data())
      out.compartment.insert(out.compartment.end(), compartment.data() + from, compartment.data() + to);
    if (component.data())
      out.component.insert(out.component.end(), component.data() + from, component.data() + to);
    if (section.data()) out.section.insert(out.section.end(), section.data() + from, section.data() + to);
  }
  if (form == Form::closed && tiles.one()) return out;
  CutSurface changed = repeated(box_, tiles, out.surface, form);
  const auto pick = [&](auto &column) {
    if (column.empty()) return;
    auto picked = column;
    picked.clear();
    for (const std::uint32_t face : changed.source_face)
      picked.push_back(column[face]);
    column = std::move(picked);
  };
  pick(out.compartment), pick(out.component), pick(out.section);
  out.surface = std::move(static_cast<Surface &>(changed));
  return out;
}

bool Source::has_volumes() const {
  return has(doc_, "/volumes/leaf_origin") && has(doc_, "/volumes@shape");
}

double Source::volume_bytes() const {
  const View<std::uint64_t> shape = view<std::uint64_t>(doc_, "/volumes@shape", 3);
  return static_cast<double>(shape[0]) * static_cast<double>(shape[1]) * static_cast<double>(shape[2]) * 8.0;
}

Volume Source::volume() const {
  constexpr int leaf = 8, leaf_voxels = leaf * leaf * leaf;
  const View<std::uint64_t> shape = view<std::uint64_t>(doc_, "/volumes@shape", 3);
  const View<double> origin = view<double>(doc_, "/volumes@origin", 3),
                     spacing = view<double>(doc_, "/volumes@spacing", 3);
  const View<std::int32_t> leaf_origin = view<std::int32_t>(doc_, "/volumes/leaf_origin", 3);
  Volume volume;
  for (int axis = 0; axis < 3; axis++) {
    if (shape[axis] < 1 || shape[axis] > 1000000)
      fail(CONCEG_E_RANGE, "/volumes@shape[%d]: expected 1 to 1000000 voxels, got %llu", axis,
           static_cast<unsigned long long>(shape[axis]));
    volume.shape[axis] = static_cast<int>(shape[axis]);
    volume.origin[axis] = origin[axis], volume.spacing[axis] = spacing[axis];
  }
  const std::size_t voxels = shape[0] * shape[1] * shape[2];
  View<std::uint32_t> label;
  View<float> distance;
  if (has(doc_, "/volumes/label")) label = view<std::uint32_t>(doc_, "/volumes/label", leaf_voxels);
  if (has(doc_, "/volumes/distance")) distance = view<float>(doc_, "/volumes/distance", leaf_voxels);
  if ((label.data() && label.rows() != leaf_origin.rows()) ||
      (distance.data() && distance.rows() != leaf_origin.rows()))
    fail(CONCEG_E_FORMAT, "/volumes: expected %zu leaves in label and distance, got %zu and %zu",
         leaf_origin.rows(), label.rows(), distance.rows());
  if (label.data()) volume.label.assign(voxels, 0);
  if (distance.data()) {
    // Voxels without a leaf lie in the ECS beyond the stored band.
    float farthest = 0.0f;
    for (const float d : distance)
      farthest = std::max(farthest, d);
    volume.distance.assign(voxels, farthest);
  }
  for (std::size_t row = 0; row < leaf_origin.rows(); row++)
    for (int k = 0; k < leaf_voxels; k++) {
      const std::int64_t x = std::int64_t(leaf_origin.row(row)[0]) + k / (leaf * leaf),
                         y = std::int64_t(leaf_origin.row(row)[1]) + k / leaf % leaf,
                         z = std::int64_t(leaf_origin.row(row)[2]) + k % leaf;
      if (x < 0 || y < 0 || z < 0 || x >= volume.shape.x || y >= volume.shape.y || z >= volume.shape.z)
        continue;
      const std::size_t at = (static_cast<std::size_t>(z) * static_cast<std::size_t>(volume.shape.y) +
                              static_cast<std::size_t>(y)) *
                                 static_cast<std::size_t>(volume.shape.x) +
                             static_cast<std::size_t>(x);
      if (label.data()) volume.label[at] = label.row(row)[k];
      if (distance.data()) volume.distance[at] = distance.row(row)[k];
    }
  return volume;
}

} // namespace conceg::exporting
