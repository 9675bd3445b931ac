// SPDX-License-Identifier: BSD-3-Clause
#include "settings.hpp"

#include "conceg/model.h"
#include "conceg/portable.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace conceg::simulate {

std::vector<double> numbers(const char *name, const std::string &text, double low, double high) {
  std::vector<double> out;
  for (const char *at = text.c_str() + std::strspn(text.c_str(), " \t,"); *at;) {
    char *after = nullptr;
    const double value = std::strtod(at, &after);
    if (after == at || (*after && !std::strchr(" \t,", *after)))
      fail(CONCEG_E_PARAM, "%s: expected numbers with commas between, got \"%.40s\"", name, text.c_str());
    if (!(value >= low && value <= high))
      fail(CONCEG_E_PARAM, "%s: expected numbers from %g to %g, got %g", name, low, high, value);
    out.push_back(value);
    at = after + std::strspn(after, " \t,");
  }
  return out;
}

std::vector<double> displacement_times(const std::string &text) {
  constexpr double shortest_ms = 1e-6, longest_ms = 1e4;
  std::vector<double> times;
  if (text.find(':') == std::string::npos) {
    times = numbers("times_ms", text, shortest_ms, longest_ms);
  } else {
    std::string words = text;
    std::replace(words.begin(), words.end(), ':', ',');
    const std::vector<double> range = numbers("times_ms", words, shortest_ms, longest_ms);
    const bool whole =
        range.size() == 3 && range[2] >= 2.0 && range[2] <= 10000.0 && range[2] == std::floor(range[2]);
    if (!whole || !(range[0] < range[1]))
      fail(CONCEG_E_PARAM, "times_ms: expected FIRST:LAST:COUNT such as 0.1:100:30, got \"%.40s\"",
           text.c_str());
    const double ratio = conceg_log(range[1] / range[0]) / (range[2] - 1.0);
    for (double i = 0.0; i < range[2] - 1.0; i++)
      times.push_back(range[0] * conceg_exp(i * ratio));
    times.push_back(range[1]);
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end(), [](double a, double b) { return b - a <= 1e-9; }),
              times.end());
  return times;
}

std::vector<double> face_permeability(const std::string &text, const std::vector<std::uint8_t> &code) {
  double value[256] = {};
  if (text.find('=') == std::string::npos) {
    const std::vector<double> all = numbers("permeability", text, 0.0, 1e3);
    if (all.size() != 1)
      fail(CONCEG_E_PARAM, "permeability: expected one value or name=value with commas, got \"%.80s\"",
           text.c_str());
    std::fill(value, value + 256, all[0]);
  } else {
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size()), equal = text.find('=', begin);
      if (equal >= end)
        fail(CONCEG_E_PARAM, "permeability: expected name=value, got \"%.80s\"",
             text.substr(begin, end - begin).c_str());
      const std::size_t first = text.find_first_not_of(' ', begin);
      const std::string name = text.substr(first, equal - first);
      int found = -1;
      for (int c = 1; c < 256; c++)
        if (const char *known = conceg_compartment_name(static_cast<std::uint32_t>(c));
            known && name == known)
          found = c;
      if (found < 0)
        fail(CONCEG_E_PARAM,
             "permeability: expected a compartment such as soma, axon or basal dendrite, got \"%.80s\"",
             name.c_str());
      const std::vector<double> one =
          numbers("permeability", text.substr(equal + 1, end - equal - 1), 0.0, 1e3);
      if (one.size() != 1)
        fail(CONCEG_E_PARAM, "permeability: expected one value for %s, got %zu", name.c_str(), one.size());
      value[found] = one[0];
      begin = end + 1;
    }
  }
  std::vector<double> out(code.size());
  bool any = false;
  for (std::size_t f = 0; f < code.size(); f++)
    out[f] = value[code[f]], any = any || out[f] > 0.0;
  if (!any) out.clear();
  return out;
}

} // namespace conceg::simulate
