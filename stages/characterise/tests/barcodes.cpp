// SPDX-License-Identifier: BSD-3-Clause
// Barcodes of real and hand-made cells: what must hold for each, and what must not matter: the order of the
// rows, the ids, the frame. Which of two equally far tips goes on is the ids' choice; births and deaths are
// not.
#include "golden.hpp"

#include "dictionary.hpp"
#include "tests/trees.hpp"

#include "conceg/rng.h"

#include <array>
#include <functional>
#include <numeric>

using namespace conceg;
using namespace conceg::characterise;
using golden::Json;

namespace {

constexpr std::uint64_t seeds = 5;

// birth, death, the parent's birth and death, and what add_cell writes of a bar: radius, taper, cv,
// correlation length, angle, distance of the tip.
using Row = std::array<double, 10>;
constexpr std::size_t only_bars = 2, bars_and_parents = 4;

// One cell as the dictionary holds it.
std::vector<Row> rows_of(const Cell &cell) {
  Dictionary d;
  EntrySums sums;
  add_cell(d, sums, Donor{}, cell);
  std::vector<Row> rows;
  for (std::size_t tree = 0; tree + 1 < d.tree_bar_offset.size(); tree++)
    for (std::size_t b = d.tree_bar_offset[tree]; b < d.tree_bar_offset[tree + 1]; b++) {
      const bool root = d.bar_parent[b] < 0;
      const std::size_t up = root ? b : d.tree_bar_offset[tree] + static_cast<std::size_t>(d.bar_parent[b]);
      rows.push_back({d.bar_birth[b], d.bar_death[b], root ? -1.0 : d.bar_birth[up],
                      root ? -1.0 : d.bar_death[up], d.bar_radius[b], d.bar_taper[b], d.bar_cv[b],
                      d.bar_correlation_length[b], d.bar_angle[b], d.bar_tip_distance[b]});
    }
  return rows;
}

// Rows of one side without a partner on the other that is as near in the first columns.
std::size_t unmatched(const std::vector<Row> &a, std::vector<Row> b, std::size_t columns, double tolerance) {
  std::size_t alone = 0;
  for (const Row &row : a) {
    const auto partner = std::find_if(b.begin(), b.end(), [&](const Row &other) {
      for (std::size_t k = 0; k < columns; k++)
        if (!(std::abs(row[k] - other[k]) <= tolerance)) return false;
      return true;
    });
    if (partner == b.end())
      alone++;
    else
      b.erase(partner);
  }
  return alone + b.size();
}

// A bar that ends as far away as the one that goes on at its fork.
std::size_t ties(const std::vector<Row> &rows, double tolerance) {
  return static_cast<std::size_t>(std::count_if(
      rows.begin(), rows.end(), [&](const Row &row) { return std::abs(row[1] - row[3]) <= tolerance; }));
}

// The seven columns of a file, as text.
using Lines = std::vector<std::array<std::string, 7>>;

Lines lines_of(std::istream &in) {
  Lines lines;
  for (std::string text; std::getline(in, text);) {
    std::istringstream words(text);
    std::array<std::string, 7> line;
    for (std::string &word : line)
      words >> word;
    if (!words.fail() && line[0][0] != '#') lines.push_back(line);
  }
  return lines;
}

std::vector<std::size_t> permutation(conceg_rng &rng, std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; i--)
    std::swap(order[i - 1], order[conceg_rng_below(&rng, i)]);
  return order;
}

// The same rows in another order; with other ids too where `renumber` is set.
Lines shuffled(const Lines &lines, std::uint64_t seed, bool renumber) {
  conceg_rng rng = conceg_rng_stream(seed, "test.rows", renumber);
  const std::vector<std::size_t> order = permutation(rng, lines.size()),
                                 number = permutation(rng, lines.size());
  std::map<std::string, std::string> id;
  for (std::size_t i = 0; i < lines.size(); i++)
    id[lines[i][0]] = renumber ? std::to_string(3 * number[i] + 11) : lines[i][0];
  Lines out;
  for (const std::size_t i : order) {
    out.push_back(lines[i]);
    out.back()[0] = id.at(lines[i][0]);
    if (lines[i][6] != "-1") out.back()[6] = id.at(lines[i][6]);
  }
  return out;
}

Cell read(conceg_ctx *ctx, const Lines &lines) {
  std::string text;
  for (const auto &line : lines)
    for (const std::string &word : line)
      text += word + (&word == &line.back() ? "\n" : " ");
  conceg_swc *swc = nullptr;
  CHECK_EQUAL(conceg_swc_parse(ctx, text.data(), text.size(), "rows", 0, &swc), CONCEG_OK);
  Cell cell;
  double center[3];
  conceg_swc_soma(swc, center, &cell.soma_radius);
  cell.soma = {center[0], center[1], center[2]}, cell.trees = whole_trees(swc);
  for (Tree &tree : cell.trees)
    for (double &radius : tree.radius)
      radius = std::max(radius, 0.05); // as the stage raises them: a fixture has radii of 0
  conceg_swc_free(swc);
  return cell;
}

// Barcodes by another rule for the daughter that goes on: given the farthest tips below the daughters, its
// place.
using Rule = std::function<std::size_t(const std::vector<double> &)>;
std::vector<Bar> bars_by(const Tree &tree, const Rule &rule) {
  const Children children(tree.parent);
  const std::vector<double> path = path_lengths(tree);
  std::vector<double> farthest(path);
  for (std::size_t i = tree.size(); i-- > 1;) {
    double &up = farthest[static_cast<std::size_t>(tree.parent[i])];
    up = std::max(up, farthest[i]);
  }
  std::vector<Bar> bars(1);
  std::vector<std::size_t> bar_of(tree.size(), 0);
  for (std::size_t i = 0; i < tree.size(); i++) {
    bars[bar_of[i]].death = path[i];
    std::vector<double> below;
    for (const std::size_t *child = children.begin(i); child != children.end(i); child++)
      below.push_back(farthest[*child]);
    if (below.empty()) continue;
    const std::size_t goes_on = rule(below);
    for (std::size_t k = 0; k < below.size(); k++) {
      const std::size_t child = children.begin(i)[k];
      bar_of[child] = k == goes_on ? bar_of[i] : bars.size();
      if (k == goes_on) continue;
      bars.emplace_back();
      bars.back().birth = path[i], bars.back().parent = static_cast<std::int64_t>(bar_of[i]);
    }
  }
  return bars;
}

std::size_t elder(const std::vector<double> &below) {
  return static_cast<std::size_t>(std::max_element(below.begin(), below.end()) - below.begin());
}
std::size_t younger(const std::vector<double> &below) {
  return static_cast<std::size_t>(std::min_element(below.begin(), below.end()) - below.begin());
}
std::size_t first(const std::vector<double> &) {
  return 0;
}

std::vector<Row> bare_rows(const Cell &cell, const std::function<std::vector<Bar>(const Tree &)> &make) {
  std::vector<Row> rows;
  for (const Tree &tree : cell.trees) {
    const std::vector<Bar> bars = make(tree);
    for (const Bar &bar : bars) {
      const Bar *up = bar.parent < 0 ? nullptr : &bars[static_cast<std::size_t>(bar.parent)];
      rows.push_back({bar.birth, bar.death, up ? up->birth : -1.0, up ? up->death : -1.0});
    }
  }
  return rows;
}

// Rows in another order are the same cell to the last figure; with other ids too, unless tips are equally
// far.
void check_order(conceg_ctx *ctx, const Lines &lines, const std::vector<Row> &rows) {
  const std::size_t columns = ties(rows, 0.0) ? only_bars : Row{}.size();
  for (std::uint64_t seed = 0; seed < seeds; seed++) {
    CHECK_EQUAL(unmatched(rows, rows_of(read(ctx, shuffled(lines, seed, false))), Row{}.size(), 1e-9), 0);
    CHECK_EQUAL(unmatched(rows, rows_of(read(ctx, shuffled(lines, seed, true))), columns, 1e-9), 0);
  }
}

void check_frame(const Cell &cell, const std::vector<Row> &rows) {
  const std::size_t columns = ties(rows, 1e-6) ? only_bars : bars_and_parents;
  for (std::uint64_t seed = 0; seed < seeds; seed++) {
    conceg_rng rng = conceg_rng_stream(seed, "test.frame", 0);
    Rotation q;
    double square = 0.0;
    for (double &part : q)
      part = conceg_rng_normal(&rng), square += part * part;
    for (double &part : q)
      part /= std::sqrt(square);
    glm::dvec3 shift;
    for (int axis = 0; axis < 3; axis++)
      shift[axis] = 1000.0 * (2.0 * conceg_rng_uniform(&rng) - 1.0);
    Cell moved = cell;
    moved.soma = rotate(q, cell.soma) + shift;
    for (Tree &tree : moved.trees)
      for (glm::dvec3 &p : tree.position)
        p = rotate(q, p) + shift;
    CHECK_EQUAL(unmatched(rows, rows_of(moved), columns, 1e-6), 0);
  }
}

// Each defect must be seen by the check that is there for it.
void check_defects(conceg_ctx *ctx, const Cell &cell, const Lines &lines) {
  std::size_t broken = 0;
  for (const Tree &tree : cell.trees) {
    CHECK(invariants_hold(tree, find_bars(tree)));
    CHECK(invariants_hold(tree, bars_by(tree, elder)));
    broken += !invariants_hold(tree, bars_by(tree, younger));
  }
  CHECK(broken > 0);
  const auto bars_of = [](const Rule &rule) {
    return [rule](const Tree &tree) { return bars_by(tree, rule); };
  };
  const std::vector<Row> ours = bare_rows(cell, find_bars);
  CHECK_EQUAL(unmatched(ours, bare_rows(cell, bars_of(elder)), bars_and_parents, 0.0), 0);
  CHECK(unmatched(ours, bare_rows(cell, bars_of(younger)), only_bars, 1e-9) > 0);
  std::size_t moved = 0; // by the first daughter's rule the order of ids decides
  for (std::uint64_t seed = 0; seed < seeds; seed++)
    moved += unmatched(bare_rows(cell, bars_of(first)),
                       bare_rows(read(ctx, shuffled(lines, seed, true)), bars_of(first)), only_bars, 1e-9);
  CHECK(moved > 0);
}

void check_cell(conceg_ctx *ctx, const Lines &lines) {
  const Cell cell = read(ctx, lines);
  const std::vector<Row> rows = rows_of(cell);
  CHECK(rows.size() > cell.trees.size());
  printf("%zu trees, %zu bars, %zu ties\n", cell.trees.size(), rows.size(), ties(rows, 0.0));
  check_order(ctx, lines, rows);
  check_frame(cell, rows);
  check_defects(ctx, cell, lines);
}

Lines hand_made(const char *text) {
  std::istringstream in(text);
  return lines_of(in);
}

// A fork at 10 um, with a thick and a thin daughter of 10 um each: the smaller id goes on, wherever its row
// is.
void check_tie(conceg_ctx *ctx) {
  const Lines thick =
      hand_made("1 1 0 0 0 5 -1\n2 3 5 0 0 1 1\n3 3 15 0 0 1 2\n4 3 15 10 0 1 3\n5 3 15 -10 0 0.2 3\n");
  Lines thin = thick;
  std::swap(thin[3][0], thin[4][0]);
  const std::vector<Row> with_thick = rows_of(read(ctx, thick)), with_thin = rows_of(read(ctx, thin));
  CHECK_EQUAL(ties(with_thick, 0.0), 1);
  CHECK_NEAR(with_thick[0][4], 1.0, 1e-12);
  CHECK_NEAR(with_thick[1][4], 0.2, 1e-12);
  CHECK_NEAR(with_thin[0][4], 0.8, 1e-12); // 1 over 10 um, then 1 to 0.2
  CHECK_NEAR(with_thin[1][4], 1.0, 1e-12);
  CHECK_EQUAL(unmatched(with_thick, with_thin, bars_and_parents, 0.0), 0);
  check_order(ctx, thick, with_thick);
}

// Every fork a tie: two and three daughters in turn, each 8 um long with a radius of its own, so that births
// and deaths are known and all else is the ids' choice.
void check_ties_everywhere(conceg_ctx *ctx) {
  std::ostringstream text;
  text << "1 1 0 0 0 5 -1\n2 3 0 0 0 1 1\n";
  std::vector<glm::dvec3> at(3, glm::dvec3(0.0));
  std::size_t begin = 2, end = 3; // ids of a level
  for (const int daughters : {2, 3, 2, 3}) {
    for (std::size_t up = begin; up < end; up++)
      for (int k = 0; k < daughters; k++) {
        glm::dvec3 here = at[up];
        here[k] += 8.0;
        text << at.size() << " 3 " << here.x << ' ' << here.y << ' ' << here.z << ' '
             << 0.1 + 0.01 * static_cast<double>(at.size()) << ' ' << up << '\n';
        at.push_back(here);
      }
    begin = end, end = at.size();
  }
  std::vector<Row> known{{0.0, 32.0}};
  const int started[] = {1, 4, 6, 24}; // nodes of the level times (daughters - 1)
  for (int level = 0; level < 4; level++)
    known.insert(known.end(), static_cast<std::size_t>(started[level]), Row{8.0 * level, 32.0});
  const Lines lines = hand_made(text.str().c_str());
  const Cell cell = read(ctx, lines);
  const std::vector<Row> rows = rows_of(cell);
  CHECK(invariants_hold(cell.trees[0], find_bars(cell.trees[0])));
  CHECK_EQUAL(unmatched(rows, known, only_bars, 0.0), 0);
  CHECK_EQUAL(ties(rows, 0.0), 35);
  check_order(ctx, lines, rows);
  std::size_t changed = 0; // more than births and deaths does follow the ids
  for (std::uint64_t seed = 0; seed < seeds; seed++)
    changed += unmatched(rows, rows_of(read(ctx, shuffled(lines, seed, true))), Row{}.size(), 1e-9);
  CHECK(changed > 0);
}

} // namespace

int main() {
  conceg_ctx *ctx = conceg_ctx_new();
  check_tie(ctx);
  check_ties_everywhere(ctx);
  // A dendrite that turns and branches, beside an apical one of another depth.
  check_cell(
      ctx,
      hand_made("1 1 0 0 0 5 -1\n2 3 5 0 0 1 1\n3 3 15 0 0 1 2\n4 3 15 3 4 0.5 3\n5 3 31 0 0 0.7 3\n"
                "6 3 31 7 0 0.4 5\n7 3 44 0 0 0.3 5\n8 3 31 0 9 0.6 5\n9 4 0 0 6 1 1\n10 4 0 0 80 0.8 9\n"
                "11 4 20 0 95 0.6 10\n12 4 -9 2 88 0.4 10\n"));
  const Json figures = golden::load();
  for (const auto &[name, cell] : figures.at("cells").members) {
    const int failed = check_failed_;
    std::ifstream in(golden::folder() + cell.at("file").text);
    check_cell(ctx, lines_of(in));
    if (failed != check_failed_) fprintf(stderr, "  in %s\n", name.c_str());
  }
  conceg_ctx_free(ctx);
  return check_done();
}
