// SPDX-License-Identifier: BSD-3-Clause
// CATERPillar sphere tables. Five layouts exist and none carries a version, so columns are taken by their
// names:
//   A   id_ax id_sph id_branch Type X Y Z Rin Rout P              P = sphere before, -1 at a start
//   B   cell_type cell_id component component_id X Y Z inner_radius outer_radius        (B': vessels with
//   branches; D: capitals) C   as B with parent_component_id after component_id
// A glial cell begins at every soma row, because ids begin again in each population. Only A and C say where a
// branch begins; a start is joined to what lies nearest, over the gap between the spheres.
#include "scene.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

namespace conceg::importing {
namespace {

constexpr double most_comparisons = 4e9; // starts of branches x spheres of a cell

// A row under the names of layout C; text is lower case.
struct Row {
  std::string type, component;
  std::int64_t cell = 0, component_id = 0, parent_component = -1, sphere = -1, before = -1;
  glm::dvec3 at = glm::dvec3(0.0);
  double inner = 0.0, outer = 0.0;
};

std::string lower(std::string_view word) {
  std::string text(word);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

class Table {
public:
  explicit Table(TextFile text) : text_(std::move(text)) {
    std::string_view line;
    do
      if (!text_.line(line)) text_.refuse("expected a header of column names, got an empty file");
    while (words_of(line).empty() || line[0] == '#');
    std::set<std::string> names;
    for (const std::string_view word : words_of(line)) {
      header_.push_back(lower(word));
      if (!names.insert(header_.back()).second)
        text_.refuse("the column %s comes twice", shown(word).c_str());
    }
    const std::set<std::string> a = {"id_ax", "id_sph", "id_branch", "type", "x",
                                     "y",     "z",      "rin",       "rout", "p"},
                                b = {"cell_type", "cell_id", "component",    "component_id", "x",
                                     "y",         "z",       "inner_radius", "outer_radius"};
    std::set<std::string> c = b;
    c.insert("parent_component_id");
    old_ = names == a;
    if (!old_ && names != b && names != c)
      text_.refuse("unknown header \"%s\": expected the columns of a CATERPillar table (cell_type cell_id "
                   "component component_id [parent_component_id] X Y Z inner_radius "
                   "outer_radius, or id_ax id_sph id_branch Type X Y Z Rin Rout P)",
                   shown(line).c_str());
  }

  bool next(Row &row) {
    std::string_view line;
    std::vector<std::string_view> words;
    do
      if (!text_.line(line)) return false;
    while (words = words_of(line), words.empty() || words[0][0] == '#');
    if (words.size() != header_.size())
      text_.refuse("expected %zu values, one a column, got %zu", header_.size(), words.size());
    row = Row();
    for (std::size_t i = 0; i < words.size(); i++)
      take(header_[i], words[i], row);
    if (row.inner > row.outer)
      text_.refuse("expected an inner radius of at most the outer one, got %g and %g", row.inner, row.outer);
    if (old_) {
      static const std::map<std::string, std::pair<const char *, const char *>> types = {
          {"axon", {"axon", "axon"}},
          {"cellsoma", {"glial_cell", "soma"}},
          {"process", {"glial_cell", "branch"}}};
      const auto found = types.find(row.type);
      if (found == types.end())
        text_.refuse("expected the type axon, CellSoma or Process, got %s", shown(row.type).c_str());
      row.type = found->second.first, row.component = found->second.second;
    }
    return true;
  }
  const TextFile &text() const { return text_; }
  bool old() const { return old_; }

private:
  void take(const std::string &name, std::string_view word, Row &row) {
    if (name == "cell_type" || name == "type")
      row.type = lower(word);
    else if (name == "component")
      row.component = lower(word);
    else if (name == "x" || name == "y" || name == "z")
      row.at[name[0] - 'x'] = text_.coordinate(word, name.c_str());
    else if (name == "inner_radius" || name == "rin")
      row.inner = text_.radius(word, name.c_str());
    else if (name == "outer_radius" || name == "rout")
      row.outer = text_.radius(word, name.c_str());
    else
      index(name, row) = whole(word, name.c_str());
  }
  static std::int64_t &index(const std::string &name, Row &row) {
    if (name == "cell_id" || name == "id_ax") return row.cell;
    if (name == "parent_component_id") return row.parent_component;
    if (name == "id_sph") return row.sphere;
    if (name == "p") return row.before;
    return row.component_id;
  }
  std::int64_t whole(std::string_view word, const char *what) const {
    const double value = text_.number(word, what);
    if (value != std::floor(value) || std::fabs(value) > 1e15)
      text_.refuse("%s: expected a whole number, got %s", what, shown(word).c_str());
    return static_cast<std::int64_t>(value);
  }

  TextFile text_;
  std::vector<std::string> header_;
  bool old_ = false;
};

class Builder {
public:
  explicit Builder(TextFile text) : table_(std::move(text)) {}

  Scene run() {
    Row row;
    while (table_.next(row))
      add(row);
    finish();
    if (scene_.cells.empty()) table_.text().refuse("expected rows of spheres, got none");
    return std::move(scene_);
  }

private:
  void add(const Row &row) {
    const bool axon = row.type == "axon", glia = row.type == "glial_cell",
               vessel = row.type == "blood_vessel";
    if (!axon && !glia && !vessel)
      table_.text().refuse("expected the cell type axon, glial_cell or blood_vessel, got %s",
                           shown(row.type).c_str());
    const bool soma = row.component == "soma", branch = row.component == "branch",
               whole = row.component == (vessel ? "blood_vessel" : "axon");
    if (!(axon && whole) && !(vessel && (whole || branch)) && !(glia && (soma || branch)))
      table_.text().refuse("unexpected component %s of a cell of type %s", shown(row.component).c_str(),
                           row.type.c_str());
    if (glia ? soma : row.type != type_ || row.cell != id_) {
      finish();
      type_ = row.type, id_ = row.cell, open_ = true;
      if (!glia && !seen_.insert({type_, id_}).second)
        table_.text().refuse("%s %lld comes again: expected the rows of a cell together", type_.c_str(),
                             static_cast<long long>(id_));
      cell_.type = glia ? "glial cell" : vessel ? "vessel" : "axon";
      cell_.cell_class = glia ? "astrocyte" : vessel ? "other" : "axon";
      if (soma) cell_.soma = row.at, cell_.soma_radius = row.outer;
    } else if (glia && (!open_ || type_ != row.type)) {
      table_.text().refuse("a branch before the soma of its glial cell");
    }
    if (glia && row.cell != id_)
      table_.text().refuse("a branch of glial cell %lld among the rows of glial cell %lld",
                           static_cast<long long>(row.cell), static_cast<long long>(id_));
    if (table_.old() && row.sphere >= 0 && !soma) row_of_sphere_.emplace(row.sphere, cell_.position.size());
    if (soma) return;
    cell_.kind.push_back(axon ? CONCEG_SWC_AXON : glia ? CONCEG_SWC_GLIA : CONCEG_SWC_BASAL);
    cell_.parent.push_back(parent_of(row));
    cell_.position.push_back(row.at), cell_.radius.push_back(row.outer),
        cell_.inner_radius.push_back(row.inner);
    component_.push_back(row.component_id);
    last_ = row.component + std::to_string(row.component_id);
  }

  std::int64_t parent_of(const Row &row) {
    const auto count = static_cast<std::int64_t>(cell_.position.size());
    if (table_.old()) {
      const auto found = row_of_sphere_.find(row.before);
      if (row.before >= 0 && found != row_of_sphere_.end() && found->second < cell_.position.size())
        return static_cast<std::int64_t>(found->second);
      return count && row.component != "branch" ? count - 1 : nearest(row);
    }
    if (count && last_ == row.component + std::to_string(row.component_id)) return count - 1;
    return nearest(row);
  }

  // The earlier sphere with the smallest gap to this one, of the component that the row names where it does;
  // -1 = the soma, or none.
  std::int64_t nearest(const Row &row) {
    comparisons_ += static_cast<double>(cell_.position.size());
    if (comparisons_ > most_comparisons)
      table_.text().refuse("too many branches to join: expected at most %g pairs of starts and spheres",
                           most_comparisons);
    const auto gap = [&](const glm::dvec3 &at, double r) { return glm::length(at - row.at) - r; };
    // In layout C, 0 is both the first branch and the mark for the soma: then all are looked at.
    const bool named = row.parent_component > 0;
    double best = cell_.soma_radius > 0.0 && !named ? gap(cell_.soma, cell_.soma_radius) : INFINITY;
    std::int64_t parent = -1;
    for (std::size_t i = 0; i < cell_.position.size(); i++) {
      if (named && component_[i] != row.parent_component) continue;
      const double here = gap(cell_.position[i], cell_.radius[i]);
      if (here < best) best = here, parent = static_cast<std::int64_t>(i);
    }
    return parent;
  }

  void finish() {
    if (open_) {
      if (!(cell_.soma_radius > 0.0)) cell_.soma = cell_.position[0];
      scene_.cells.push_back(std::move(cell_));
    }
    cell_ = SceneCell(), open_ = false, component_.clear(), row_of_sphere_.clear(), last_.clear(),
    comparisons_ = 0.0;
  }

  Table table_;
  Scene scene_;
  SceneCell cell_;
  bool open_ = false;
  std::string type_, last_;
  std::int64_t id_ = 0;
  double comparisons_ = 0.0;
  std::vector<std::int64_t> component_;
  std::map<std::int64_t, std::size_t> row_of_sphere_;
  std::set<std::pair<std::string, std::int64_t>> seen_;
};

// voxel.csv -> voxel_growth_info.txt, voxel_2.csv -> voxel_growth_info_2.txt, and what else was seen.
std::string find_info(const std::string &table) {
  const std::filesystem::path path(table);
  const std::string stem = path.stem().string();
  std::vector<std::string> names = {stem + "_growth_info.txt", stem + "_info.txt", "growth_info.txt"};
  const std::size_t bar = stem.rfind('_');
  if (bar != std::string::npos && bar + 1 < stem.size() &&
      stem.find_first_not_of("0123456789", bar + 1) == std::string::npos)
    names.insert(names.begin(), stem.substr(0, bar) + "_growth_info" + stem.substr(bar) + ".txt");
  for (const std::string &name : names) {
    const std::filesystem::path info = path.parent_path() / name;
    std::error_code error;
    if (std::filesystem::is_regular_file(info, error)) return info.string();
  }
  return "";
}

} // namespace

Scene parse_caterpillar(TextFile table) {
  return Builder(std::move(table)).run();
}

// Lines "key value": the key may hold blanks and digits, so that the value is what numbers end the line.
void parse_growth_info(TextFile info, Scene &scene) {
  std::string_view line;
  bool low = false, high = false;
  double side = 0.0;
  while (info.line(line)) {
    const auto words = words_of(line);
    std::size_t first = words.size();
    double value = 0.0;
    while (first > 0 && parse_number(words[first - 1], value))
      first--;
    std::string key;
    for (std::size_t i = 0; i < first; i++)
      key += (i ? " " : "") + lower(words[i]);
    if (key == "voxel size" || key == "voxel") {
      if (words.size() != first + 1) info.refuse("expected one number after %s", key.c_str());
      side = info.radius(words[first], "the voxel's side");
    } else if (key == "small voxel min limits" || key == "small voxel max limits") {
      if (words.size() != first + 3) info.refuse("expected three numbers after %s", key.c_str());
      glm::dvec3 &corner = key[12] == 'm' && key[13] == 'i' ? scene.lo : scene.hi;
      for (std::size_t axis = 0; axis < 3; axis++)
        corner[static_cast<int>(axis)] = info.coordinate(words[first + axis], key.c_str());
      (&corner == &scene.lo ? low : high) = true;
    }
  }
  if (low != high)
    info.refuse("expected both the min and the max limits of the small voxel, got one of them");
  if (low && !(scene.lo.x < scene.hi.x && scene.lo.y < scene.hi.y && scene.lo.z < scene.hi.z))
    info.refuse("expected min limits below the max limits of the small voxel");
  if (low)
    scene.has_box = true;
  else if (side > 0.0)
    scene.corner_box(side);
  else
    info.refuse("expected a line \"Voxel Size L\" or \"Voxel L\", got none");
}

Scene read_caterpillar(const Request &request) {
  const std::string &path = only_file(request, "a sphere table");
  Scene scene = parse_caterpillar(TextFile::open(request.ctx, path));
  const std::string info = request.info.empty() ? find_info(path) : request.info;
  if (request.box_um > 0.0)
    scene.corner_box(request.box_um);
  else if (!info.empty())
    parse_growth_info(TextFile::open(request.ctx, info), scene);
  else
    fail(CONCEG_E_MISSING,
         "%s: the table does not say how large the voxel is, and there is no growth_info file beside it; "
         "give --info FILE or --box-um L",
         path.c_str());
  check_frame(scene, path, "tables are in um; look at the growth_info file, or give --box-um");
  return scene;
}

} // namespace conceg::importing
