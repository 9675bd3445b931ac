// SPDX-License-Identifier: BSD-3-Clause
// Reading the comma-separated numbers of astrocyte.hpp: record,process,item,first,second.
#include "astrocyte.hpp"
#include "guard.hpp"
#include "table.hpp"

#include <cmath>
#include <locale>
#include <sstream>

namespace conceg::characterise {
namespace {

struct Field {
  const char *name;
  double ProcessStatistics::*member;
};
const Field fields[] = {
    {"trees_mean", &ProcessStatistics::trees_mean},
    {"trees_sd", &ProcessStatistics::trees_sd},
    {"trees_low", &ProcessStatistics::trees_low},
    {"trees_high", &ProcessStatistics::trees_high},
    {"trunk_loc", &ProcessStatistics::trunk_loc},
    {"trunk_scale", &ProcessStatistics::trunk_scale},
    {"trunk_shape", &ProcessStatistics::trunk_shape},
    {"trunk_low", &ProcessStatistics::trunk_low},
    {"trunk_high", &ProcessStatistics::trunk_high},
    {"sibling_loc", &ProcessStatistics::sibling_loc},
    {"sibling_scale", &ProcessStatistics::sibling_scale},
    {"sibling_low", &ProcessStatistics::sibling_low},
    {"sibling_high", &ProcessStatistics::sibling_high},
    {"tip_loc", &ProcessStatistics::tip_loc},
    {"tip_scale", &ProcessStatistics::tip_scale},
    {"tip_shape", &ProcessStatistics::tip_shape},
    {"tip_low", &ProcessStatistics::tip_low},
    {"tip_high", &ProcessStatistics::tip_high},
};

class Reader {
public:
  Reader(const std::string &text, const std::string &name) : in_(text), name_(name) {}

  AstrocyteStatistics read() {
    for (std::string line; std::getline(in_, line);) {
      line_++;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.empty() || line[0] == '#' || line == "record,process,item,first,second") continue;
      const std::vector<std::string> f = split_csv(line);
      if (f.size() != 5)
        fail(CONCEG_E_FORMAT, "%s:%zu: expected record,process,item,first,second, got %zu columns",
             name_.c_str(), line_, f.size());
      if (f[0] == "bar")
        add_bar(f);
      else if (f[0] == "number")
        add_number(f);
      else
        fail(CONCEG_E_FORMAT, "%s:%zu: record: expected bar or number, got '%s'", name_.c_str(), line_,
             f[0].c_str());
    }
    check();
    return std::move(out_);
  }

private:
  double number(const std::string &text, double lo, double hi) const {
    std::istringstream in(text);
    in.imbue(std::locale::classic());
    double value;
    if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof() ||
        !(value >= lo && value <= hi))
      fail(CONCEG_E_RANGE, "%s:%zu: expected a number from %g to %g, got '%s'", name_.c_str(), line_, lo, hi,
           text.c_str());
    return value;
  }

  ProcessStatistics &process(const std::string &name) {
    for (std::size_t i = 0; i < names_.size(); i++)
      if (names_[i] == name) return out_.processes[i];
    names_.push_back(name);
    out_.processes.emplace_back();
    return out_.processes.back();
  }

  void add_bar(const std::vector<std::string> &f) {
    auto &diagrams = process(f[1]).diagrams;
    const auto index = static_cast<std::size_t>(number(f[2], 0.0, 1e4));
    const double birth = number(f[3], 0.0, 1e5), death = number(f[4], 0.0, 1e5);
    if (index > diagrams.size() || !(death > birth))
      fail(CONCEG_E_FORMAT, "%s:%zu: expected diagrams 0, 1, ... in order and birth < death", name_.c_str(),
           line_);
    if (index == diagrams.size()) diagrams.emplace_back();
    diagrams[index].push_back({birth, death});
  }

  void add_number(const std::vector<std::string> &f) {
    const double value = number(f[3], -1e5, 1e5);
    if (f[1] == "soma" && f[2] == "radius_mean")
      out_.soma_radius_mean = value;
    else if (f[1] == "soma" && f[2] == "radius_sd")
      out_.soma_radius_sd = value;
    else {
      for (const Field &field : fields)
        if (f[2] == field.name) {
          process(f[1]).*field.member = value;
          return;
        }
      fail(CONCEG_E_FORMAT, "%s:%zu: item: unknown number '%s'", name_.c_str(), line_, f[2].c_str());
    }
  }

  void check() const {
    const char *name = name_.c_str();
    if (!(out_.soma_radius_mean > 0.0))
      fail(CONCEG_E_FORMAT, "%s: soma radius_mean: expected a positive number", name);
    if (out_.processes.empty()) fail(CONCEG_E_FORMAT, "%s: expected bars, got none", name);
    for (std::size_t i = 0; i < names_.size(); i++) {
      const ProcessStatistics &p = out_.processes[i];
      if (p.diagrams.empty() ||
          !(p.trees_low >= 0.0 && p.trees_high >= p.trees_low && p.trees_high <= 100.0) ||
          !(p.trunk_low > 0.0 && p.trunk_high >= p.trunk_low) ||
          !(p.tip_low > 0.0 && p.tip_high >= p.tip_low) ||
          !(p.sibling_low > 0.0 && p.sibling_high >= p.sibling_low))
        fail(CONCEG_E_FORMAT, "%s: %s: expected bars and 0 < low <= high for trees, trunk, tip and sibling",
             name, names_[i].c_str());
      for (const auto &diagram : p.diagrams) {
        bool rooted = false;
        for (const auto &bar : diagram)
          rooted |= bar[0] == 0.0;
        if (!rooted)
          fail(CONCEG_E_FORMAT, "%s: %s: every diagram needs a bar that starts at 0", name,
               names_[i].c_str());
      }
    }
  }

  std::istringstream in_;
  std::string name_;
  std::size_t line_ = 0;
  std::vector<std::string> names_;
  AstrocyteStatistics out_;
};

} // namespace

AstrocyteStatistics parse_astrocyte(const std::string &text, const std::string &name) {
  return Reader(text, name).read();
}

} // namespace conceg::characterise
