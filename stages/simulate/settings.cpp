// SPDX-License-Identifier: BSD-3-Clause
#include "settings.hpp"

#include "conceg/model.h"

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

std::vector<double> sorted_times(std::vector<double> times) {
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
