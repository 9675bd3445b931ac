// SPDX-License-Identifier: BSD-3-Clause
#include "facts.hpp"

#include "guard.hpp"
#include "published.hpp"
#include "view.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace conceg::reporting {
namespace {

constexpr std::uint64_t most_values = 200'000; // of one array outside of the tables
constexpr std::uint64_t most_listed = 5'000;   // arrays in the list of contents
constexpr std::uint64_t most_columns = 16;     // that an array of rank 2 becomes in a table

// Groups of which small arrays go to the page, and arrays of others that are of interest by themselves.
const char *const groups[] = {"/domain", "/types", "/signals", "/protocol", "/provenance"};
const char *const singles[] = {"/walkers@leaks",    "/walkers@retractions",  "/walkers@steps",
                               "/meshes@icvf",      "/meshes@grid_step",     "/meshes@gap",
                               "/meshes@crossings", "/meshes@pairs_checked", "/volumes@spacing",
                               "/volumes@shape",    "/dictionary/entry_name"};

conceg_array described(conceg_doc *doc, const char *path) {
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_describe(doc, path, &array));
  return array;
}

conceg_array read(conceg_doc *doc, const char *path) {
  conceg_array array = {};
  array.size = sizeof array;
  must(conceg_doc_read(doc, path, &array));
  return array;
}

void put_value(Json &json, const conceg_array &array, std::uint64_t i) {
  switch (array.dtype) {
  case CONCEG_U8:
    json.whole(std::uint64_t{static_cast<const std::uint8_t *>(array.data)[i]});
    break;
  case CONCEG_I8:
    json.whole(std::int64_t{static_cast<const std::int8_t *>(array.data)[i]});
    break;
  case CONCEG_U32:
    json.whole(std::uint64_t{static_cast<const std::uint32_t *>(array.data)[i]});
    break;
  case CONCEG_I32:
    json.whole(std::int64_t{static_cast<const std::int32_t *>(array.data)[i]});
    break;
  case CONCEG_U64:
    json.whole(static_cast<const std::uint64_t *>(array.data)[i]);
    break;
  case CONCEG_I64:
    json.whole(static_cast<const std::int64_t *>(array.data)[i]);
    break;
  case CONCEG_F32:
    json.number(static_cast<const float *>(array.data)[i]);
    break;
  case CONCEG_F64:
    json.number(static_cast<const double *>(array.data)[i]);
    break;
  case CONCEG_TEXT:
    json.text(static_cast<const char *const *>(array.data)[i]);
    break;
  default:
    json.null();
  }
}

// Values first, first + step, ... : `count` of them.
void put_values(Json &json, const conceg_array &array, std::uint64_t first, std::uint64_t step,
                std::uint64_t count) {
  json.open('[');
  for (std::uint64_t i = 0; i < count; i++)
    put_value(json, array, first + i * step);
  json.close(']');
}

void put_shape(Json &json, const conceg_array &array) {
  json.key("type").text(conceg_dtype_name(array.dtype)).key("unit").text(array.unit ? array.unit : "");
  json.key("shape").open('[');
  for (std::uint32_t axis = 0; axis < array.rank; axis++)
    json.whole(array.shape[axis]);
  json.close(']');
}

std::vector<std::string> children(const conceg_doc *doc, const std::string &group) {
  std::vector<std::string> paths;
  const std::uint64_t count = conceg_doc_children(doc, group.c_str());
  for (std::uint64_t i = 0; i < count; i++)
    paths.emplace_back(conceg_doc_child(doc, group.c_str(), i));
  return paths;
}

bool is_group(const std::string &path) {
  return !path.empty() && path.back() == '/';
}

std::string name_in(const std::string &path) {
  return path.substr(path.find_last_of("/@") + 1);
}

void put_column(Json &json, const std::string &name, const std::string &path, const conceg_array &array,
                std::uint64_t first, std::uint64_t step, std::uint64_t rows) {
  json.open('{').key("name").text(name).key("path").text(path);
  json.key("type").text(conceg_dtype_name(array.dtype)).key("unit").text(array.unit ? array.unit : "");
  json.key("values");
  put_values(json, array, first, step, rows);
  json.close('}');
}

// The datasets of one group as a table. Scalars make a row of their own when there is nothing else.
void put_table(conceg_doc *doc, const std::string &name, const std::vector<std::string> &datasets,
               std::uint64_t most, Json &json) {
  std::uint64_t rows = 0;
  for (const std::string &path : datasets) {
    const conceg_array array = described(doc, path.c_str());
    rows = std::max(rows, array.rank ? array.shape[0] : 1);
  }
  const std::uint64_t shown = std::min(rows, most);
  json.open('{').key("name").text(name).key("path").text(name.empty() ? "/statistics"
                                                                      : "/statistics/" + name);
  json.key("rows").whole(rows).key("shown").whole(shown).key("columns").open('[');
  std::vector<std::string> left_out;
  for (const std::string &path : datasets) {
    std::uint64_t width = 1;
    const conceg_array shape = described(doc, path.c_str());
    for (std::uint32_t axis = 1; axis < shape.rank; axis++)
      width *= shape.shape[axis];
    if (width == 0 || width > most_columns) {
      left_out.push_back(path + ": " + std::to_string(width) + " values a row");
      continue;
    }
    const conceg_array array = read(doc, path.c_str());
    const std::uint64_t own = std::min(array.rank ? array.shape[0] : 1, shown);
    for (std::uint64_t k = 0; k < width; k++)
      put_column(json, name_in(path) + (width > 1 ? "[" + std::to_string(k) + "]" : ""), path, array, k,
                 width, own);
  }
  json.close(']').key("left_out").open('[');
  for (const std::string &line : left_out)
    json.text(line);
  json.close(']').close('}');
}

void put_tables(conceg_doc *doc, const std::string &group, std::uint64_t rows, Json &json) {
  std::vector<std::string> datasets;
  for (const std::string &path : children(doc, group)) {
    if (is_group(path))
      put_tables(doc, path.substr(0, path.size() - 1), rows, json);
    else if (path.find('@') == std::string::npos)
      datasets.push_back(path);
  }
  if (!datasets.empty())
    put_table(doc, group == "/statistics" ? "" : group.substr(std::strlen("/statistics/")), datasets, rows,
              json);
}

void put_array(conceg_doc *doc, const std::string &path, Json &json) {
  const conceg_array shape = described(doc, path.c_str());
  json.key(path).open('{');
  put_shape(json, shape);
  if (conceg_array_count(&shape) <= most_values) {
    const conceg_array array = read(doc, path.c_str());
    json.key("values");
    put_values(json, array, 0, 1, conceg_array_count(&array));
  } else {
    json.key("left_out").flag(true);
  }
  json.close('}');
}

void put_arrays(conceg_doc *doc, Json &json) {
  json.key("arrays").open('{');
  for (const char *group : groups)
    for (const std::string &path : children(doc, group))
      if (!is_group(path) && name_in(path) != "made_from") put_array(doc, path, json);
  for (const char *path : singles)
    if (has(doc, path)) put_array(doc, path, json);
  json.close('}');
}

void put_contents(conceg_doc *doc, const std::string &group, std::uint64_t &listed, Json &json) {
  for (const std::string &path : children(doc, group)) {
    if (is_group(path))
      put_contents(doc, path.substr(0, path.size() - 1), listed, json);
    else if (path.find('@') == std::string::npos && listed++ < most_listed) {
      json.open('{').key("path").text(path);
      put_shape(json, described(doc, path.c_str()));
      json.close('}');
    }
  }
}

void put_published(const PublishedRow &row, Json &json) {
  json.open('{').key("cells").whole(std::uint64_t{row.cells});
  json.key("order").number(row.order).key("order_sd").number(row.order_sd);
  json.key("length_um").number(row.length_um).key("length_sd_um").number(row.length_sd_um);
  json.key("straightness").number(row.straightness).key("straightness_sd").number(row.straightness_sd);
  json.key("angle_degree").number(row.angle_degree).key("angle_sd_degree").number(row.angle_sd_degree);
  json.close('}');
}

// Table 1 of the paper, which the comparison is drawn beside.
void put_paper(Json &json) {
  json.key("paper").open('[');
  for (const Published &entry : published) {
    json.open('{').key("entry").text(entry.entry).key("real");
    put_published(entry.real, json), json.key("grown");
    put_published(entry.grown, json), json.close('}');
  }
  json.close(']');
}

} // namespace

void put_facts(conceg_doc *doc, std::uint64_t rows, Json &json) {
  json.key("tables").open('[');
  put_tables(doc, "/statistics", rows, json);
  json.close(']');
  put_arrays(doc, json);
  std::uint64_t listed = 0;
  json.key("contents").open('[');
  put_contents(doc, "/", listed, json);
  json.close(']').key("contents_left_out").whole(listed > most_listed ? listed - most_listed : 0);
  put_paper(json);
  const char *recipe = "";
  if (has(doc, "/recipe")) must(conceg_doc_read_text(doc, "/recipe", &recipe));
  json.key("recipe").text(recipe);
}

} // namespace conceg::reporting
