// SPDX-License-Identifier: BSD-3-Clause
// The figures of entries: what is in them, the same bytes again, grown cells beside donors, and nothing half
// written.
#include "figure.hpp"
#include "grown.hpp"

#include "check.h"
#include "view.hpp"

#include "conceg/conceg.h"

#include <algorithm>
#include <dirent.h>
#include <fstream>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>

extern "C" const conceg_stage conceg_stage_characterise;
using namespace conceg;
using namespace conceg::characterise;

namespace {

// An apical tree with a fork, a basal one and an axon: four bars.
const std::string cell_file =
    "1 1 0 0 0 5 -1\n2 4 0 0 5 1 1\n3 4 0 0 20 0.8 2\n4 4 5 0 40 0.6 3\n5 4 -6 0 65 0.5 3\n"
    "6 3 5 0 0 1 1\n7 3 30 5 0 0.7 6\n8 2 0 -5 0 0.4 1\n9 2 3 -40 2 0.3 8\n";
const std::string one_more_bar = "10 3 40 5 10 0.5 7\n11 3 40 8 -10 0.5 7\n";
const std::string entry_name = "entry/<1>";

std::string read(const std::string &path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

struct Folder {
  std::string path;
  Folder() {
    char name[] = "characterise_pictures_XXXXXX";
    path = mkdtemp(name);
  }
  ~Folder() {
    const std::string command = "rm -rf '" + path + "'";
    CHECK_EQUAL(system(command.c_str()), 0);
  }
  std::vector<std::string> files(const std::string &below = "") const {
    std::vector<std::string> out;
    DIR *folder = opendir((path + below).c_str());
    for (const dirent *entry; folder && (entry = readdir(folder));)
      if (std::string(entry->d_name) != "." && std::string(entry->d_name) != "..")
        out.push_back(entry->d_name);
    if (folder) closedir(folder);
    return out;
  }
};

// Runs the stage on one file; the document stays open for `use`.
template <class Use>
conceg_status run(const std::string &swc, const std::vector<std::string> &settings, std::string &error,
                  Use use) {
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  std::vector<std::string> words = settings;
  words.push_back("characterise.entry=" + entry_name);
  words.push_back("characterise.axons=true");
  words.push_back("characterise.frame=apical");
  std::vector<const char *> sets;
  for (const std::string &word : words)
    sets.push_back(word.c_str());
  sets.push_back(nullptr);
  const char *const files[] = {swc.c_str(), nullptr};
  conceg_status status = conceg_doc_new(ctx, &doc);
  if (status == CONCEG_OK)
    status = conceg_params_new(ctx, &conceg_stage_characterise, doc, nullptr, sets.data(), files, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_characterise, doc, params);
  error = conceg_ctx_error(ctx);
  if (status == CONCEG_OK) use(ctx, doc);
  conceg_params_free(params);
  CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return status;
}
conceg_status run(const std::string &swc, const std::vector<std::string> &settings, std::string &error) {
  return run(swc, settings, error, [](conceg_ctx *, conceg_doc *) {});
}

// Every tag is closed in turn, every quote too, and there is one root.
bool well_formed(const std::string &xml) {
  std::vector<std::string> open;
  std::size_t roots = 0;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (std::count(tag.begin(), tag.end(), '"') % 2 || tag.find('<') != std::string::npos) return false;
    if (tag[0] == '?') continue;
    const std::string name = tag.substr(tag[0] == '/', tag.find_first_of(" /", 1) - (tag[0] == '/'));
    if (tag[0] == '/') {
      if (open.empty() || open.back() != name) return false;
      open.pop_back();
    } else {
      if (open.empty()) roots++;
      if (tag.back() != '/') open.push_back(name);
    }
  }
  return open.empty() && roots == 1;
}

struct Stroke {
  double x0, y0, x1, y1;
};
// The lines of the barcode: no other strokes have this width and flat ends.
std::vector<Stroke> bars_in(const std::string &svg) {
  char style[64];
  std::snprintf(style, sizeof style, "fill:none;stroke-width:%g;stroke-linecap:butt;", bar_width);
  std::vector<Stroke> out;
  for (std::size_t at = svg.find(style); at != std::string::npos; at = svg.find(style, at + 1)) {
    Stroke stroke;
    if (std::sscanf(svg.c_str() + svg.find(" d=\"", at), " d=\"M %lf %lf L %lf %lf", &stroke.x0, &stroke.y0,
                    &stroke.x1, &stroke.y1) == 4)
      out.push_back(stroke);
  }
  return out;
}

void check_contents(const Folder &folder) {
  const std::string swc = folder.path + "/cell.swc", pictures = folder.path + "/made/here";
  std::ofstream(swc) << cell_file;
  std::string error;
  std::vector<double> lengths;
  double longest = 0.0;
  const conceg_status status =
      run(swc, {"characterise.pictures=" + pictures}, error, [&](conceg_ctx *, conceg_doc *doc) {
        const View<double> birth = view<double>(doc, "/dictionary/bar_birth"),
                           death = view<double>(doc, "/dictionary/bar_death");
        for (std::size_t i = 0; i < birth.rows(); i++)
          lengths.push_back(death[i] - birth[i]), longest = std::max(longest, death[i]);
      });
  CHECK_EQUAL(status, CONCEG_OK);
  CHECK(folder.files("/made/here") == std::vector<std::string>{"entry__1_.svg"});
  const std::string svg = read(pictures + "/entry__1_.svg");
  CHECK(well_formed(svg));
  CHECK(!well_formed(svg.substr(0, svg.size() / 2)));
  CHECK(svg.find("<title>entry/&lt;1&gt;</title>") != std::string::npos);

  std::vector<Stroke> bars = bars_in(svg);
  CHECK_EQUAL(lengths.size(), 4);
  CHECK_EQUAL(bars.size(), 4);
  std::vector<double> drawn;
  for (const Stroke &bar : bars) {
    CHECK(bar.y0 == bar.y1);
    drawn.push_back(bar.x1 - bar.x0);
  }
  std::sort(lengths.begin(), lengths.end()), std::sort(drawn.begin(), drawn.end());
  for (std::size_t i = 0; i < drawn.size(); i++)
    CHECK_NEAR(drawn[i] * longest / drawn.back(), lengths[i], 0.1);

  CHECK_EQUAL(run(swc, {"characterise.pictures=" + folder.path}, error), CONCEG_OK);
  CHECK(read(folder.path + "/entry__1_.svg") == svg);

  std::ofstream(swc, std::ios::app) << one_more_bar;
  CHECK_EQUAL(run(swc, {"characterise.pictures=" + folder.path}, error), CONCEG_OK);
  CHECK_EQUAL(bars_in(read(folder.path + "/entry__1_.svg")).size(), 5);
}

// Arms of the same length along x and z.
void check_scale() {
  DrawnEntry entry;
  entry.name = "cross";
  DrawnDonor donor;
  donor.bars = {{3, 0.0, 100.0}};
  donor.cell.samples = {
      {{0, 0, 0}, {100, 0, 0}, {0, 0, 0}, {0, 0, 100}}, {1, 1, 1, 1}, {3, 3, 3, 3}, {-1, 0, -1, 2}};
  donor.cell.samples.soma_radius = 1.0;
  entry.donors = {donor};
  const std::string svg = draw_entry(entry);
  const char *style = "stroke-linecap:round;stroke-linejoin:round;stroke:rgb(12.15%,43.52%,70.98%)";
  const std::size_t at = svg.find(style, svg.find(style) + 1); // after the dots of the diagram
  CHECK(at != std::string::npos);
  Stroke x{}, z{};
  if (at != std::string::npos)
    CHECK_EQUAL(std::sscanf(svg.c_str() + svg.find(" d=\"", at),
                            " d=\"M %lf %lf L %lf %lf M %lf %lf L %lf %lf", &x.x0, &x.y0, &x.x1, &x.y1, &z.x0,
                            &z.y0, &z.x1, &z.y1),
                8);
  CHECK(x.x1 - x.x0 > 50.0);
  CHECK_NEAR(x.x1 - x.x0, z.y0 - z.y1, 0.15); // the pia is up
  CHECK_NEAR(x.y1, x.y0, 1e-9);
  CHECK_NEAR(z.x1, z.x0, 1e-9);
}

// Puts two grown cells beside the dictionary: of its donor, turned by 90 degree about x.
void put_grown(conceg_doc *doc) {
  const double half = std::sqrt(0.5), pia[3] = {0, 0, 1}, low[3] = {0, 0, 0}, high[3] = {50, 50, 50};
  const std::uint8_t wraps[3] = {1, 1, 1};
  put(doc, "/domain@lo", low, 3), put(doc, "/domain@hi", high, 3), put(doc, "/domain@periodic", wraps, 3);
  put(doc, "/domain@pia", pia, 3);
  put_scalar(doc, "/domain@lattice_step", CONCEG_LATTICE_STEP_UM);
  put_texts(doc, "/types/name", {"kind"}), put_texts(doc, "/types/class", {"pyramidal"});
  put_texts(doc, "/types/entry", {entry_name});
  put(doc, "/cells/id", std::vector<std::uint64_t>{5, 7});
  put(doc, "/cells/type", std::vector<std::uint32_t>{0, 0});
  put(doc, "/cells/donor", std::vector<std::uint32_t>{0, 0});
  put(doc, "/cells/rotation", std::vector<double>{half, half, 0, 0, half, half, 0, 0}, 4);
  put(doc, "/cells/soma", std::vector<double>{10, 20, 30, 1, 2, 3}, 3);
  put(doc, "/cells/radius", std::vector<float>{5, 5});
  put(doc, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, 3, 6});
  const std::vector<double> tree{10, 15, 30, 10, 0, 30, 10, -10, 40, 1, -3, 3, 1, -18, 3, 1, -28, 13};
  put(doc, "/skeleton/position", tree, 3);
  put(doc, "/skeleton/radius", std::vector<float>(6, 0.5f));
  put(doc, "/skeleton/target_radius", std::vector<float>(6, 0.5f));
  put(doc, "/skeleton/parent", std::vector<std::int64_t>{-1, 0, 1, -1, 0, 1});
  put(doc, "/skeleton/kind", std::vector<std::uint8_t>(6, 4));
}

conceg_status status_of(conceg_doc *doc) {
  try {
    grown_cells(doc, "grown.cgx");
    return CONCEG_OK;
  } catch (const Error &error) {
    return error.status();
  }
}

void check_reading(conceg_doc *doc) {
  CHECK_EQUAL(status_of(doc), CONCEG_E_MISSING);
  put_grown(doc);
  const std::vector<GrownCell> cells = grown_cells(doc, "grown.cgx");
  CHECK_EQUAL(cells.size(), 2);
  CHECK_TEXT(cells.at(0).entry.c_str(), entry_name.c_str());
  CHECK_TEXT(cells.at(0).donor.c_str(), "cell");
  CHECK(cells.at(0).id == 5 && cells.at(0).turned_back && cells.at(0).samples.size() == 3);
  const glm::dvec3 tip = cells.at(0).samples.position.back(); // (0, -30, 10) turned by -90 degree about x
  CHECK_NEAR(tip.x, 0.0, 1e-9);
  CHECK_NEAR(tip.y, 10.0, 1e-9);
  CHECK_NEAR(tip.z, 30.0, 1e-9);

  put(doc, "/skeleton/parent", std::vector<std::int64_t>{-1, 1, 1, -1, 0, 1}); // a row that is its own parent
  CHECK_EQUAL(status_of(doc), CONCEG_E_FORMAT);
  put_grown(doc);
  put(doc, "/cells/donor", std::vector<std::uint32_t>{0, 1}); // there is one donor
  CHECK_EQUAL(status_of(doc), CONCEG_E_FORMAT);
  put(doc, "/cells/donor", std::vector<std::uint32_t>{0, 4294967295u}); // none: the type tells the entry
  const std::vector<GrownCell> one_without = grown_cells(doc, "grown.cgx");
  CHECK_TEXT(one_without.at(1).entry.c_str(), entry_name.c_str());
  CHECK_TEXT(one_without.at(1).donor.c_str(), "");
  put_grown(doc);
  put(doc, "/skeleton/cell_offset", std::vector<std::uint64_t>{0, 3, 7});
  CHECK_EQUAL(status_of(doc), CONCEG_E_FORMAT);
  put_grown(doc);
}

void check_beside(const Folder &folder) {
  const std::string swc = folder.path + "/cell.swc", grown = folder.path + "/grown.cgx",
                    picture = folder.path + "/entry__1_.svg",
                    pictures = "characterise.pictures=" + folder.path;
  std::ofstream(swc) << cell_file;
  std::string error;
  const conceg_status status = run(swc, {pictures}, error, [&](conceg_ctx *, conceg_doc *doc) {
    check_reading(doc);
    CHECK_EQUAL(conceg_doc_save(doc, grown.c_str()), CONCEG_OK);
  });
  CHECK_EQUAL(status, CONCEG_OK);
  const std::string alone = read(picture);
  CHECK_EQUAL(run(swc, {pictures, "characterise.beside=" + grown}, error), CONCEG_OK);
  const std::string both = read(picture);
  CHECK(well_formed(both) && both != alone);
  CHECK_EQUAL(bars_in(both).size(), bars_in(alone).size());
  CHECK_EQUAL(run(swc, {"characterise.beside=" + grown}, error), CONCEG_E_PARAM);
  CHECK_EQUAL(run(swc, {pictures, "characterise.beside=" + swc}, error), CONCEG_E_FORMAT);
}

void check_failures(const Folder &folder) {
  const std::string swc = folder.path + "/cell.swc";
  std::ofstream(swc) << cell_file;
  std::string error;
  CHECK_EQUAL(run(swc, {"characterise.pictures=" + swc}, error), CONCEG_E_IO);
  CHECK(error.find("cell.swc") != std::string::npos);
  CHECK_EQUAL(run(swc, {"characterise.pictures=" + swc + "/below"}, error), CONCEG_E_IO);
  // A folder stands where the picture should go: nothing is left, not even under a hidden name.
  CHECK_EQUAL(mkdir((folder.path + "/entry__1_.svg").c_str(), 0777), 0);
  CHECK_EQUAL(run(swc, {"characterise.pictures=" + folder.path}, error), CONCEG_E_IO);
  CHECK(error.find("entry__1_.svg") != std::string::npos);
  CHECK_EQUAL(folder.files().size(), 2);
}

} // namespace

int main() {
  check_contents(Folder());
  check_scale();
  check_beside(Folder());
  check_failures(Folder());
  return check_done();
}
