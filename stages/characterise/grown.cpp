// SPDX-License-Identifier: BSD-3-Clause
#include "grown.hpp"

#include "frame.hpp"
#include "view.hpp"

#include <memory>

namespace conceg::characterise {
namespace {

// The arrays of the document that a cell is made of; their sizes and indices are checked here, once.
class GrownDocument {
public:
  explicit GrownDocument(conceg_doc *doc)
      : id_(view<std::uint64_t>(doc, "/cells/id")), type_(view<std::uint32_t>(doc, "/cells/type")),
        soma_(view<double>(doc, "/cells/soma", 3)), soma_radius_(view<float>(doc, "/cells/radius")),
        offset_(view<std::uint64_t>(doc, "/skeleton/cell_offset")),
        position_(view<double>(doc, "/skeleton/position", 3)), radius_(view<float>(doc, "/skeleton/radius")),
        parent_(view<std::int64_t>(doc, "/skeleton/parent")),
        kind_(view<std::uint8_t>(doc, "/skeleton/kind")),
        donor_offset_(view<std::uint64_t>(doc, "/dictionary/entry_donor_offset")),
        entry_name_(texts(doc, "/dictionary/entry_name")), donor_id_(texts(doc, "/dictionary/donor_id")) {
    if (has(doc, "/types/entry")) type_entry_ = texts(doc, "/types/entry");
    if (has(doc, "/cells/donor")) donor_ = view<std::uint32_t>(doc, "/cells/donor");
    if (has(doc, "/cells/rotation")) rotation_ = view<double>(doc, "/cells/rotation", 4);
    expect("/cells/type", type_.rows(), cells());
    expect("/cells/soma", soma_.rows(), cells());
    expect("/cells/radius", soma_radius_.rows(), cells());
    if (donor_.rows()) expect("/cells/donor", donor_.rows(), cells());
    if (rotation_.rows()) expect("/cells/rotation", rotation_.rows(), cells());
    expect("/skeleton/radius", radius_.rows(), position_.rows());
    expect("/skeleton/parent", parent_.rows(), position_.rows());
    expect("/skeleton/kind", kind_.rows(), position_.rows());
    check_offsets("/skeleton/cell_offset", offset_, cells(), position_.rows());
    check_offsets("/dictionary/entry_donor_offset", donor_offset_, entry_name_.size(), donor_id_.size());
  }

  std::size_t cells() const { return id_.rows(); }
  std::size_t samples(std::size_t cell) const { return offset_[cell + 1] - offset_[cell]; }

  GrownCell cell(std::size_t row) const {
    GrownCell out;
    out.id = id_[row];
    name(row, out);
    Rotation back{1.0, 0.0, 0.0, 0.0}; // the inverse of a unit quaternion is its conjugate
    if (rotation_.rows()) {
      const double *q = rotation_.row(row);
      back = {q[0], -q[1], -q[2], -q[3]}, out.turned_back = true;
    }
    const glm::dvec3 soma = vector(soma_, row);
    out.samples.soma_radius = static_cast<double>(soma_radius_[row]);
    for (std::size_t at = offset_[row]; at < offset_[row + 1]; at++) {
      const auto own = static_cast<std::int64_t>(at - offset_[row]);
      if (parent_[at] < -1 || parent_[at] >= own)
        fail(CONCEG_E_FORMAT, "/skeleton/parent[%zu]: expected -1 or a row of its cell below %lld, got %lld",
             at, static_cast<long long>(own), static_cast<long long>(parent_[at]));
      out.samples.position.push_back(rotate(back, vector(position_, at) - soma));
      out.samples.radius.push_back(static_cast<double>(radius_[at]));
      out.samples.kind.push_back(kind_[at]);
      out.samples.parent.push_back(parent_[at]);
    }
    return out;
  }

private:
  static void expect(const char *path, std::size_t rows, std::size_t expected) {
    if (rows != expected) fail(CONCEG_E_FORMAT, "%s: expected %zu rows, got %zu", path, expected, rows);
  }
  static void check_offsets(const char *path, const View<std::uint64_t> &offset, std::size_t groups,
                            std::size_t rows) {
    expect(path, offset.rows(), groups + 1);
    for (std::size_t i = 0; i < offset.rows(); i++)
      if (offset[i] < (i ? offset[i - 1] : 0) || offset[i] > rows || (i == groups && offset[i] != rows))
        fail(CONCEG_E_FORMAT, "%s[%zu]: expected ascending offsets that end with %zu, got %llu", path, i,
             rows, static_cast<unsigned long long>(offset[i]));
  }
  static glm::dvec3 vector(const View<double> &table, std::size_t row) {
    return {table.row(row)[0], table.row(row)[1], table.row(row)[2]};
  }

  // The donor tells the entry; without donors, or for a cell that has none, the cell's type does.
  void name(std::size_t row, GrownCell &out) const {
    constexpr std::uint32_t none = 4294967295u;
    if (donor_.rows() && donor_[row] != none) {
      const std::size_t donor = donor_[row];
      if (donor >= donor_id_.size())
        fail(CONCEG_E_FORMAT, "/cells/donor[%zu]: expected a row of the donors below %zu, got %zu", row,
             donor_id_.size(), donor);
      out.donor = donor_id_[donor];
      std::size_t entry = 0;
      while (donor_offset_[entry + 1] <= donor)
        entry++;
      out.entry = entry_name_[entry];
      return;
    }
    if (type_[row] >= type_entry_.size())
      fail(CONCEG_E_FORMAT, "/cells/type[%zu]: expected a row of /types/entry below %zu, got %u", row,
           type_entry_.size(), type_[row]);
    out.entry = type_entry_[type_[row]];
  }

  View<std::uint64_t> id_;
  View<std::uint32_t> type_;
  View<double> soma_;
  View<float> soma_radius_;
  View<std::uint64_t> offset_;
  View<double> position_;
  View<float> radius_;
  View<std::int64_t> parent_;
  View<std::uint8_t> kind_;
  View<std::uint64_t> donor_offset_;
  std::vector<std::string> entry_name_, donor_id_, type_entry_;
  View<std::uint32_t> donor_;
  View<double> rotation_;
};

} // namespace

std::vector<GrownCell> grown_cells(conceg_doc *doc, const std::string &path) {
  for (const char *group : {"/types", "/dictionary", "/cells", "/skeleton"}) {
    if (!has(doc, group))
      fail(CONCEG_E_MISSING, "beside: %s has no %s; give a document with grown cells", path.c_str(), group);
    must(conceg_doc_validate(doc, group, nullptr, nullptr));
  }
  const GrownDocument grown(doc);
  std::vector<GrownCell> out;
  for (std::size_t row = 0; row < grown.cells(); row++)
    if (grown.samples(row)) out.push_back(grown.cell(row));
  return out;
}

std::vector<GrownCell> read_grown(conceg_ctx *ctx, const std::string &path) {
  conceg_doc *raw = nullptr;
  must(conceg_doc_open(ctx, path.c_str(), &raw));
  struct Close {
    void operator()(conceg_doc *doc) const { (void)conceg_doc_close(doc); } // only read from
  };
  const std::unique_ptr<conceg_doc, Close> doc(raw);
  return grown_cells(raw, path);
}

} // namespace conceg::characterise
