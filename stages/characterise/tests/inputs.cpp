// SPDX-License-Identifier: BSD-3-Clause
// The table, the astrocyte numbers, and the stage's answers to bad input.
#include "check.h"

#include "astrocyte.hpp"
#include "guard.hpp"
#include "table.hpp"

#include "conceg/conceg.h"

#include <fstream>
#include <set>
#include <string>

extern "C" const conceg_stage conceg_stage_characterise;
using namespace conceg;
using namespace conceg::characterise;

namespace {

const std::string header = "file,entry,class,donor_id,fold,frame,soma_radius_um,axon,note\n";

template <class Body> std::string error_of(Body &&body) {
  try {
    body();
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}
void check_table_error(const std::string &text, const char *word) {
  const std::string line = error_of([&] { parse_table(text, "t.csv"); });
  if (line.find(word) == std::string::npos) fprintf(stderr, "  '%s' not in '%s'\n", word, line.c_str());
  CHECK(line.find(word) != std::string::npos);
}

void check_table() {
  const std::vector<TableRow> rows =
      parse_table("# remark\n" + header +
                      ",A,pyramidal,,,,,,\"note, with "
                      "\"\"quotes\"\"\"\r\na.swc,A,pyramidal,x,3,apical,,full,\nb.swc,B,microglia,,,,3.5,,\n",
                  "t.csv");
  CHECK_EQUAL(rows.size(), 3);
  CHECK_TEXT(rows[0].note.c_str(), "note, with \"quotes\"");
  CHECK_EQUAL(rows[1].fold, 3);
  CHECK(rows[1].whole_axon && !rows[2].whole_axon && rows[1].soma_radius_um < 0.0 &&
        rows[2].soma_radius_um == 3.5);
  CHECK_TEXT(rows[2].frame.c_str(), "unknown");
  check_table_error("", "rows of files");
  check_table_error("file,entry\n", "t.csv:1: expected a column class");
  check_table_error("file,entry,class,colour\n", "t.csv:1: expected a header of file, entry, class");
  check_table_error("file,entry,class,file\n", "got 'file'");
  check_table_error("file,entry,class\na.swc,A\n", "t.csv:2: expected 3 columns as in the header, got 2");
  check_table_error(header + "a.swc,A,tree,,,,,,\n", "t.csv:2: class");
  check_table_error(header + "a.swc,A,other,,,up,,,\n", "t.csv:2: frame");
  check_table_error(header + "a.swc,A,other,,300,,,,\n", "t.csv:2: fold");
  check_table_error(header + "a.swc,A,other,,,,-1,,\n", "t.csv:2: soma_radius_um");
  check_table_error(header + "a.swc,A,other,,,,,half,\n", "t.csv:2: axon");
  check_table_error(header + "a.swc,,other,,,,,,\n", "t.csv:2: entry");
  check_table_error(header + "a.swc,A,other,,,,,,\nb.swc,B,other,,,,,,\nc.swc,A,other,,,,,,\n",
                    "t.csv:4: entry A");
  check_table_error(header + "a.swc,A,other,,1,,,,\na.swc,B,other,,2,,,,\n", "t.csv:3: fold: expected 1");
  const std::vector<TableRow> few = // columns in another order, most left out
      parse_table("class,pooled_from,source,file,entry\npyramidal,layer 4,allen,a.swc,A\n", "t.csv");
  CHECK_TEXT(few[0].file.c_str(), "a.swc");
  CHECK_TEXT(few[0].pooled_from.c_str(), "layer 4");
  CHECK_TEXT(few[0].source.c_str(), "allen");
  CHECK_TEXT(few[0].frame.c_str(), "unknown");
  check_table_error(header + "a.swc,A,other,,,,,,\nb.swc,A,axon,,,,,,\n", "t.csv:3: class");
}

void check_sources() {
  const std::string head = "source,repository,licence,terms\n";
  const auto error = [](const std::string &text) { return error_of([&] { parse_sources(text, "s.csv"); }); };
  const std::vector<Source> rows = parse_sources(head + "allen,a/b,MIT,\"cite, and read\"\n", "s.csv");
  CHECK_EQUAL(rows.size(), 1);
  CHECK_TEXT(rows[0].terms.c_str(), "cite, and read");
  CHECK(error(head).find("rows of sources") != std::string::npos);
  CHECK(error("source,repository\na,b\n").find("column licence") != std::string::npos);
  CHECK(error(head + "a,,,\na,,,\n").find("s.csv:3: source") != std::string::npos);
}

const std::string numbers =
    "record,process,item,first,second\nnumber,soma,radius_mean,4,\nnumber,soma,radius_sd,0.3,\n"
    "number,p,trees_mean,5,\nnumber,p,trees_sd,1,\nnumber,p,trees_low,3,\nnumber,p,trees_high,7,\n"
    "number,p,trunk_loc,1.3,\nnumber,p,trunk_scale,0.4,\nnumber,p,trunk_low,0.8,\nnumber,p,trunk_high,2,\n"
    "number,p,tip_loc,0.5,\nnumber,p,tip_scale,0.2,\nnumber,p,tip_low,0.4,\nnumber,p,tip_high,1,\n"
    "number,p,sibling_loc,-1,\nnumber,p,sibling_scale,0.2,\nnumber,p,sibling_low,0.4,\nnumber,p,sibling_high,"
    "1,\n";
const std::string bars =
    "bar,p,0,0,60\nbar,p,0,10,39\nbar,p,0,20,50\nbar,p,0,5,7\nbar,p,0,30,34\nbar,p,1,0,14\nbar,p,1,4,5\n";

void check_astrocyte_errors() {
  const auto error = [](const std::string &text) {
    return error_of([&] { parse_astrocyte(text, "a.csv"); });
  };
  CHECK(error(numbers + bars).empty());
  CHECK(error(numbers).find("bars") != std::string::npos);
  CHECK(error(bars).find("soma") != std::string::npos);
  CHECK(error(numbers + "bar,p,0,9,3\n").find("a.csv:20") != std::string::npos);
  CHECK(error(numbers + "bar,p,3,0,3\n").find("a.csv:20") != std::string::npos);
  CHECK(error(numbers + "bar,p,0,1,3\n").find("starts at 0") != std::string::npos);
  CHECK(error(numbers + "number,p,colour,1,\n").find("colour") != std::string::npos);
  CHECK(error(numbers + "bar,p,x,0,3\n").find("'x'") != std::string::npos);
  CHECK(error(numbers + "row\n").find("a.csv:20") != std::string::npos);
}

void check_astrocyte() {
  const AstrocyteStatistics statistics = parse_astrocyte(numbers + bars, "a.csv");
  AstrocyteRules rules;
  const double reach = rules.territory_radius_um / rules.straightness;
  const std::vector<BarRow> rows = prune_diagram(statistics.processes[0].diagrams[0], rules);
  CHECK(rows.size() >= 2);
  CHECK_NEAR(rows[0].birth, 0.0, 0);
  CHECK_NEAR(rows[0].death, reach, 1e-12); // cut at the territory
  CHECK_EQUAL(rows[0].parent, -1);
  for (std::size_t i = 1; i < rows.size(); i++) {
    CHECK(rows[i].death - rows[i].birth >= rules.shortest_bar_um);
    CHECK(rows[i].parent >= 0 && rows[i].parent < static_cast<std::int64_t>(i));
    const BarRow &up = rows[static_cast<std::size_t>(rows[i].parent)];
    CHECK(up.birth <= rows[i].birth && up.death >= rows[i].death);
  }
  CHECK_NEAR(mean_order({{0, 9, 0, 0, 0, 0, -1, {}}, {2, 5, 0, 0, 0, 0, 0, {}}, {3, 4, 0, 0, 0, 0, 1, {}}}),
             (1 + 2 + 2 + 3 + 3) / 5.0, 1e-12);

  const Astrocyte a = make_astrocyte(statistics, rules, 1, 0), b = make_astrocyte(statistics, rules, 1, 0),
                  c = make_astrocyte(statistics, rules, 1, 1);
  CHECK(a.trees.size() >= 3 && a.trees.size() <= 7);
  CHECK(a.soma_radius == b.soma_radius && a.soma_radius != c.soma_radius);
  glm::dvec3 mean(0.0);
  for (std::size_t t = 0; t < a.trees.size(); t++) {
    mean += a.trees[t].trunk_direction / static_cast<double>(a.trees.size());
    for (std::size_t i = 0; i < a.trees[t].bars.size(); i++) {
      const BarRow &row = a.trees[t].bars[i];
      CHECK(row.tip_direction == b.trees[t].bars[i].tip_direction && row.radius == b.trees[t].bars[i].radius);
      CHECK_NEAR(glm::length(row.tip_direction), 1.0, 1e-12);
      CHECK(row.tip_distance > 0.0 && row.tip_distance <= rules.territory_radius_um);
      CHECK(row.radius > 0.0 && row.radius <= 1.0 && row.taper <= 0.0);
    }
  }
  CHECK(glm::length(mean) < 0.35); // spread over the sphere
}

conceg_status run(conceg_ctx *ctx, const char *const *sets, const char *const *arguments) {
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  conceg_status status = conceg_doc_new(ctx, &doc);
  if (status == CONCEG_OK)
    status = conceg_params_new(ctx, &conceg_stage_characterise, doc, nullptr, sets, arguments, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_characterise, doc, params);
  conceg_params_free(params);
  if (conceg_doc_close(doc) != CONCEG_OK) CHECK(!"close");
  return status;
}

void write_file(const char *path, const std::string &text) {
  std::ofstream(path, std::ios::binary) << text;
}

void check_stage() {
  conceg_ctx *ctx = conceg_ctx_new();
  const char *const none[] = {nullptr};
  const auto fails = [&](const char *const *sets, const char *const *arguments, const char *word) {
    const conceg_status status = run(ctx, sets, arguments);
    if (status == CONCEG_OK || !strstr(conceg_ctx_error(ctx), word))
      fprintf(stderr, "  '%s' not in '%s'\n", word, conceg_ctx_error(ctx));
    CHECK(status != CONCEG_OK && strstr(conceg_ctx_error(ctx), word));
  };
  fails(none, none, "no input");
  const char *const missing[] = {"no-such.swc", nullptr};
  fails(none, missing, "no-such.swc");
  const std::string name = "characterise_inputs.swc";
  const char *const file[] = {name.c_str(), nullptr}, *const apical[] = {"characterise.frame=apical",
                                                                         nullptr};
  write_file(name.c_str(), "1 1 0 0 0 5 -1\n2 3 5 0 0 1 3\n3 3 9 0 0 1 2\n");
  fails(none, file, "E_CYCLE");
  write_file(name.c_str(), "1 3 0 0 0 5 -1\n2 3 5 0 0 1 1\n");
  fails(none, file, "soma");
  write_file(name.c_str(), "1 1 0 0 0 5 -1\n2 3 5 0 0 1 1\n");
  fails(none, file, "trees");
  write_file(name.c_str(), "1 1 0 0 0 5 -1\n2 3 5 0 0 1 1\n3 3 25 0 0 1 2\n");
  fails(apical, file, "apical");
  CHECK_EQUAL(run(ctx, none, file), CONCEG_OK);

  // Files of one entry that do not agree: named, with what was expected.
  const std::string large = "characterise_nm.swc", axon = "characterise_axon.swc",
                    table = "characterise_group.csv", of_sources = "characterise_sources.csv";
  write_file(large.c_str(), "1 1 0 0 0 5 -1\n2 3 5 0 0 1 1\n3 3 20000 0 0 1 2\n");
  write_file(axon.c_str(), "1 1 0 0 0 5 -1\n2 2 5 0 0 1 1\n3 2 25 0 0 1 2\n");
  const char *const units[] = {name.c_str(), large.c_str(), nullptr},
                    *const axon_only[] = {name.c_str(), axon.c_str(), nullptr},
                    *const with_axons[] = {"characterise.axons=true", nullptr},
                    *const of_class_axon[] = {"characterise.axons=true", "characterise.class=axon", nullptr};
  fails(none, units, "characterise_nm.swc: expected a cell of about 20 um across");
  fails(with_axons, axon_only, "characterise_axon.swc: expected dendrites");
  CHECK_EQUAL(run(ctx, of_class_axon, axon_only), CONCEG_OK);

  const std::string head = "file,entry,class,source\n";
  const char *const by_table[] = {"characterise.table=characterise_group.csv", nullptr},
                    *const with_sources[] = {"characterise.table=characterise_group.csv",
                                             "characterise.sources=characterise_sources.csv", nullptr};
  write_file(of_sources.c_str(), "source,repository,licence,terms\nallen,a/b,MIT,cite\n");
  write_file(table.c_str(), head + name + ",A,pyramidal,allen\n");
  fails(by_table, none, "--sources");
  CHECK_EQUAL(run(ctx, with_sources, none), CONCEG_OK);
  write_file(table.c_str(), head + name + ",A,pyramidal,other\n");
  fails(with_sources, none, "characterise_sources.csv, got 'other'");
  for (const std::string &file_name : {name, large, axon, table, of_sources})
    remove(file_name.c_str());
  conceg_ctx_free(ctx);
}

} // namespace

int main() {
  check_table();
  check_sources();
  check_astrocyte_errors();
  check_astrocyte();
  check_stage();
  return check_done();
}
