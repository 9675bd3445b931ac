// SPDX-License-Identifier: BSD-3-Clause
// A volume of labels, such as a segmentation of electron microscopy -> /domain /types /cells /volumes.
#include "labels.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace conceg::importing {
namespace {

constexpr std::uint64_t side = 8, leaf_voxels = side * side * side;

// Voxels of the document: those of the file, or the ones nearest to the centres of others.
struct Grid {
  std::array<std::uint64_t, 3> shape;
  std::array<double, 3> spacing;
  std::array<std::vector<std::uint64_t>, 3> from; // per axis and voxel: the file's
};

Grid lay_out(const NpyArray &array, const std::array<int, 3> &axis, const std::array<double, 3> &voxel_um,
             double resample_um) {
  Grid grid = {};
  for (std::size_t a = 0; a < 3; a++) {
    const std::uint64_t n = array.shape[static_cast<std::size_t>(axis[a])];
    const double step = resample_um > 0 ? resample_um : voxel_um[a];
    grid.spacing[a] = step;
    grid.shape[a] =
        resample_um > 0
            ? static_cast<std::uint64_t>(std::floor(static_cast<double>(n) * voxel_um[a] / step + 1e-9))
            : n;
    if (!grid.shape[a] || grid.shape[a] > (std::uint64_t(1) << 30))
      fail(CONCEG_E_RANGE,
           "resample_um: voxels of %g um: expected 1 to 2^30 of them along axis %zu of %g um, got %llu", step,
           a, static_cast<double>(n) * voxel_um[a], static_cast<unsigned long long>(grid.shape[a]));
    for (std::uint64_t i = 0; i < grid.shape[a]; i++) {
      const double centre = (static_cast<double>(i) + 0.5) * step / voxel_um[a];
      grid.from[a].push_back(std::min(n - 1, static_cast<std::uint64_t>(centre)));
    }
  }
  return grid;
}

class Labels {
public:
  Labels(const NpyArray &array, const std::array<int, 3> &axis, const Grid &grid)
      : array_(array), axis_(axis), grid_(grid) {}
  std::uint64_t at(std::uint64_t x, std::uint64_t y, std::uint64_t z) const {
    std::array<std::uint64_t, 3> p = {};
    p[static_cast<std::size_t>(axis_[0])] = grid_.from[0][x];
    p[static_cast<std::size_t>(axis_[1])] = grid_.from[1][y];
    p[static_cast<std::size_t>(axis_[2])] = grid_.from[2][z];
    return array_.at(p[0], p[1], p[2]);
  }

private:
  const NpyArray &array_;
  const std::array<int, 3> &axis_;
  const Grid &grid_;
};

// Calls visit(voxel of the leaf, label, x, y, z) for the voxels of a leaf in the box.
template <class Visit>
void visit_leaf(const Labels &labels, const Grid &grid, const std::array<std::uint64_t, 3> &first,
                const Visit &visit) {
  for (std::uint64_t voxel = 0; voxel < leaf_voxels; voxel++) {
    const std::uint64_t x = first[0] + voxel / (side * side), y = first[1] + voxel / side % side,
                        z = first[2] + voxel % side;
    if (x < grid.shape[0] && y < grid.shape[1] && z < grid.shape[2])
      visit(voxel, labels.at(x, y, z), x, y, z);
  }
}

template <class Visit> void for_each_leaf(const Grid &grid, const Visit &visit) {
  for (std::uint64_t x = 0; x < grid.shape[0]; x += side)
    for (std::uint64_t y = 0; y < grid.shape[1]; y += side)
      for (std::uint64_t z = 0; z < grid.shape[2]; z += side)
        visit(std::array<std::uint64_t, 3>{x, y, z});
}

struct Found {
  std::vector<std::uint64_t> id;         // labels above 0, in order
  std::vector<std::int32_t> leaf_origin; // leaves with a label, [leaves][3]
};

Found look_through(const Labels &labels, const Grid &grid) {
  Found found;
  std::unordered_set<std::uint64_t> seen;
  std::uint64_t last = 0; // neighbours mostly have one label
  for_each_leaf(grid, [&](const std::array<std::uint64_t, 3> &first) {
    bool any = false;
    visit_leaf(labels, grid, first, [&](std::uint64_t, std::uint64_t label, auto...) {
      if (!label) return;
      any = true;
      if (label != last) seen.insert(label), last = label;
    });
    if (any)
      for (const std::uint64_t at : first)
        found.leaf_origin.push_back(static_cast<std::int32_t>(at));
  });
  found.id.assign(seen.begin(), seen.end());
  std::sort(found.id.begin(), found.id.end());
  return found;
}

std::uint32_t *new_labels(conceg_doc *doc, std::size_t leaves) {
  const std::uint64_t shape[2] = {leaves, leaf_voxels};
  void *storage = nullptr;
  must(conceg_doc_new_array(doc, "/volumes/label", CONCEG_U32, 2, shape, &storage));
  return static_cast<std::uint32_t *>(storage);
}

void write_cells(conceg_doc *doc, const std::vector<std::uint64_t> &id,
                 const std::vector<std::array<double, 3>> &middle) {
  put_texts(doc, "/types/name", {"label"}), put_texts(doc, "/types/class", {"other"});
  put(doc, "/types/placed", std::vector<std::uint64_t>{id.size()});
  put(doc, "/cells/id", id), put(doc, "/cells/type", std::vector<std::uint32_t>(id.size(), 0));
  put(doc, "/cells/soma", middle.data()->data(), middle.size(), 3);
  put(doc, "/cells/radius", std::vector<float>(id.size(), 0.0f));
}

} // namespace

std::array<double, 3> parse_voxel_um(const std::string &text) {
  std::array<double, 3> out = {};
  std::size_t at = 0, count = 0;
  while (at <= text.size() && count < 4) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    double value = 0;
    if (!parse_number(std::string_view(text).substr(at, end - at), value) ||
        !(value >= 1e-4 && value <= 1e3)) // also of what is no number
      break;
    if (count < 3) out[count] = value;
    count++, at = end + 1;
  }
  if (at <= text.size() || (count != 1 && count != 3))
    fail(CONCEG_E_PARAM,
         "voxel_um: expected one or three sizes of 0.0001 to 1000 um, such as 0.016,0.016,0.04, got \"%s\"",
         shown(text).c_str());
  if (count == 1) out[1] = out[2] = out[0];
  return out;
}

void write_labels(conceg_ctx *ctx, conceg_doc *doc, const NpyArray &array, const LabelOptions &options) {
  const std::array<int, 3> axis =
      options.reversed_axes ? std::array<int, 3>{2, 1, 0} : std::array<int, 3>{0, 1, 2};
  const Grid grid = lay_out(array, axis, options.voxel_um, options.resample_um);
  const Labels labels(array, axis, grid);
  const double voxels = static_cast<double>(grid.shape[0]) * static_cast<double>(grid.shape[1]) *
                        static_cast<double>(grid.shape[2]);
  const auto memory = static_cast<double>(conceg_ctx_memory(ctx));
  if (4.0 * voxels > memory)
    fail(CONCEG_E_NOMEM,
         "%s: %.3g voxels take more than the %.3g GB of --memory; give larger voxels with "
         "import.resample_um",
         array.where.c_str(), voxels, 1e-9 * memory);
  const Found found = look_through(labels, grid);
  if (found.id.empty()) fail(CONCEG_E_FORMAT, "%s: expected labels above 0, got none", array.where.c_str());
  if (found.id.size() >= UINT32_MAX)
    fail(CONCEG_E_RANGE, "%s: expected fewer than 2^32 labels", array.where.c_str());

  std::vector<std::array<double, 3>> sum(found.id.size(), {0, 0, 0});
  std::vector<double> count(found.id.size(), 0);
  const std::size_t leaves = found.leaf_origin.size() / 3;
  std::uint32_t *out = new_labels(doc, leaves);
  std::uint64_t last = 0;
  std::uint32_t last_row = 0;
  for (std::size_t leaf = 0; leaf < leaves; leaf++) {
    std::fill_n(out + leaf * leaf_voxels, leaf_voxels, 0u);
    std::array<std::uint64_t, 3> first = {};
    for (std::size_t a = 0; a < 3; a++)
      first[a] = static_cast<std::uint64_t>(found.leaf_origin[3 * leaf + a]);
    visit_leaf(labels, grid, first, [&](std::uint64_t voxel, std::uint64_t label, auto... at) {
      if (!label) return;
      if (label != last)
        last = label, last_row = static_cast<std::uint32_t>(
                          std::lower_bound(found.id.begin(), found.id.end(), label) - found.id.begin());
      out[leaf * leaf_voxels + voxel] = last_row + 1;
      const std::array<std::uint64_t, 3> p = {at...};
      for (std::size_t a = 0; a < 3; a++)
        sum[last_row][a] += (static_cast<double>(p[a]) + 0.5) * grid.spacing[a];
      count[last_row]++;
    });
  }
  double labelled = 0;
  for (std::size_t row = 0; row < sum.size(); row++) {
    labelled += count[row];
    for (double &x : sum[row])
      x /= count[row];
  }
  Scene box;
  box.has_box = true;
  glm::dvec3 origin(0.0), spacing(0.0);
  for (int a = 0; a < 3; a++) {
    const auto k = static_cast<std::size_t>(a);
    spacing[a] = grid.spacing[k], origin[a] = 0.5 * spacing[a];
    box.hi[a] = spacing[a] * static_cast<double>(grid.shape[k]);
  }
  static const std::uint8_t open[3] = {0, 0, 0};
  write_domain(doc, box, 0, open);
  write_cells(doc, found.id, sum);
  put(doc, "/volumes@origin", &origin.x, 3), put(doc, "/volumes@spacing", &spacing.x, 3);
  put(doc, "/volumes@shape", grid.shape.data(), 3);
  put(doc, "/volumes/leaf_origin", found.leaf_origin, 3);
  conceg_ctx_log(
      ctx, CONCEG_LOG_INFO,
      "import: %zu labels in %llu x %llu x %llu voxels of %g x %g x %g um; %.4f of them unlabelled",
      found.id.size(), static_cast<unsigned long long>(grid.shape[0]),
      static_cast<unsigned long long>(grid.shape[1]), static_cast<unsigned long long>(grid.shape[2]),
      spacing.x, spacing.y, spacing.z, 1.0 - labelled / voxels);
}

} // namespace conceg::importing
