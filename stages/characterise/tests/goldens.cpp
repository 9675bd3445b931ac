// SPDX-License-Identifier: BSD-3-Clause
// Barcodes, sections and angles of real cells against figures made with NeuroM and TMD
// (CONCEG_SHARED/goldens).
#include "check.h"

#include "barcode.hpp"
#include "sections.hpp"

#include "conceg/swc.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

using namespace conceg;
using namespace conceg::characterise;

namespace {

// Enough of JSON for the golden file.
struct Json {
  double number = 0.0;
  std::string text;
  std::vector<Json> items;
  std::map<std::string, Json> members;
  const Json &at(const char *key) const { return members.at(key); }
};

class Parser {
public:
  explicit Parser(const std::string &text) : p_(text.c_str()) {}
  Json value() {
    Json out;
    space();
    if (*p_ == '{' || *p_ == '[') {
      const bool object = *p_++ == '{';
      for (space(); *p_ && *p_ != '}' && *p_ != ']'; space()) {
        if (*p_ == ',') {
          p_++;
          continue;
        }
        if (object) {
          const std::string key = string();
          space(), p_++;
          out.members[key] = value();
        } else
          out.items.push_back(value());
      }
      p_++;
    } else if (*p_ == '"')
      out.text = string();
    else {
      char *stop;
      out.number = std::strtod(p_, &stop);
      if (stop == p_) stop++; // true, false, null: letter by letter
      p_ = stop;
      while (*p_ >= 'a' && *p_ <= 'z')
        p_++;
    }
    return out;
  }

private:
  void space() {
    while (*p_ == ' ' || *p_ == '\n' || *p_ == '\t' || *p_ == '\r')
      p_++;
  }
  std::string string() {
    std::string out;
    for (p_++; *p_ && *p_ != '"'; p_++) {
      if (*p_ == '\\') p_++;
      out += *p_;
    }
    p_++;
    return out;
  }
  const char *p_;
};

using Barcode = std::vector<std::array<double, 2>>; // {death, birth}

// One tree per root, whatever its types.
std::vector<Tree> whole_trees(const conceg_swc *swc) {
  std::vector<Tree> trees;
  const double *position = conceg_swc_position(swc);
  std::int64_t first = 0;
  for (std::uint64_t i = 0; i < conceg_swc_count(swc); i++) {
    const std::int64_t up = conceg_swc_parent(swc)[i];
    if (up < 0) {
      first = static_cast<std::int64_t>(i);
      trees.emplace_back();
      trees.back().neurite = conceg_swc_kind(swc)[i];
    }
    trees.back().position.emplace_back(position[3 * i], position[3 * i + 1], position[3 * i + 2]);
    trees.back().radius.push_back(conceg_swc_radius(swc)[i]);
    trees.back().parent.push_back(up < 0 ? -1 : up - first);
  }
  return trees;
}

void check_barcodes(const std::vector<Tree> &trees, const Json &golden) {
  std::vector<Barcode> ours, theirs;
  for (const Tree &tree : trees) {
    ours.emplace_back();
    for (const Bar &bar : find_bars(tree))
      ours.back().push_back({bar.death, bar.birth});
  }
  for (const Json &tree : golden.at("trees").items) {
    theirs.emplace_back();
    for (const Json &bar : tree.at("bars").items)
      theirs.back().push_back({bar.items[0].number, bar.items[1].number});
  }
  for (auto *side : {&ours, &theirs}) {
    for (Barcode &barcode : *side)
      std::sort(barcode.rbegin(), barcode.rend());
    std::sort(side->begin(), side->end(), [](const Barcode &a, const Barcode &b) {
      return a.size() != b.size() ? a.size() > b.size() : a[0] > b[0];
    });
  }
  CHECK_EQUAL(ours.size(), theirs.size());
  for (std::size_t t = 0; t < std::min(ours.size(), theirs.size()); t++) {
    CHECK_EQUAL(ours[t].size(), theirs[t].size());
    for (std::size_t b = 0; b < std::min(ours[t].size(), theirs[t].size()); b++) {
      CHECK_NEAR(ours[t][b][0], theirs[t][b][0], 2e-3);
      CHECK_NEAR(ours[t][b][1], theirs[t][b][1], 2e-3);
    }
  }
}

void check_figures(const std::vector<Tree> &trees, const Json &golden) {
  double sections = 0.0, length = 0.0, order = 0.0, angle = 0.0, tau = 0.0;
  std::size_t forks = 0;
  for (const Tree &tree : trees) {
    for (const Section &s : find_sections(tree)) {
      const double chord = glm::length(tree.position[s.nodes.back()] - tree.position[s.nodes.front()]);
      sections++, length += s.length, order += s.order - 1, tau += s.length > 0.0 ? chord / s.length : 1.0;
    }
    for (double a : fork_angles(tree))
      angle += a, forks++;
  }
  CHECK_NEAR(sections, golden.at("number_of_sections").number, 0);
  CHECK_NEAR(length, golden.at("total_length").number, 1e-6 * length);
  CHECK_NEAR(order / sections, golden.at("branch_order_mean").number, 1e-9);
  CHECK_NEAR(tau / sections, golden.at("tau_mean").number, 1e-5);
  CHECK_NEAR(angle / static_cast<double>(forks) * 57.29577951308232, golden.at("local_angle_mean").number,
             1e-3);
}

} // namespace

int main() {
  if (!check_shared()) SKIP("CONCEG_SHARED is not set: no golden figures");
  const std::string folder = std::string(check_shared()) + "/goldens/morphology/";
  std::ifstream in(folder + "goldens.json");
  if (!in) SKIP("no goldens/morphology/goldens.json in CONCEG_SHARED");
  std::ostringstream text;
  text << in.rdbuf();
  const std::string json = text.str();
  const Json golden = Parser(json).value();
  conceg_ctx *ctx = conceg_ctx_new();
  CHECK(golden.at("cells").members.size() >= 7);
  for (const auto &[name, cell] : golden.at("cells").members) {
    const int failed = check_failed_;
    conceg_swc *swc = nullptr;
    CHECK_EQUAL(conceg_swc_read(ctx, (folder + cell.at("file").text).c_str(), 0, &swc), CONCEG_OK);
    const std::vector<Tree> trees = whole_trees(swc);
    check_barcodes(trees, cell.at("path_barcode"));
    check_figures(trees, cell.at("ref64_all"));
    if (failed != check_failed_) fprintf(stderr, "  in %s\n", name.c_str());
    conceg_swc_free(swc);
  }
  conceg_ctx_free(ctx);
  return check_done();
}
