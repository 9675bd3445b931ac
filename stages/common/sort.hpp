// SPDX-License-Identifier: BSD-3-Clause
// Sorting by several workers. `less` must be a total order, or equal values must be the same bytes: then the
// result does not depend on the number of workers.
#pragma once

#include "parallel.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace conceg {

// Sorts `values`: equal parts by the workers, then neighbouring parts are merged, two and two.
template <class Value, class Less> void sort(std::vector<Value> &values, Less less, Workers &workers) {
  constexpr std::size_t worth_it = 1 << 14;
  std::size_t parts = 1;
  while (parts < workers.threads() && values.size() / parts > worth_it)
    parts *= 2;
  const auto at = [&](std::size_t part) {
    return values.begin() + static_cast<std::ptrdiff_t>(values.size() * part / parts);
  };
  workers.loop(parts, 1, [&](std::size_t p, unsigned) { std::sort(at(p), at(p + 1), less); });
  for (std::size_t width = 1; width < parts; width *= 2)
    workers.loop(parts / (2 * width), 1, [&](std::size_t m, unsigned) {
      const std::size_t p = 2 * width * m;
      std::inplace_merge(at(p), at(p + width), at(p + 2 * width), less);
    });
}

} // namespace conceg
