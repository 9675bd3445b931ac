// SPDX-License-Identifier: BSD-3-Clause
#include "trace.hpp"

#include "output.hpp"

#include <cstdio>

namespace conceg::relax {

void write_table(const std::string &path, const std::vector<Step> &steps) {
  std::string rows =
      "iteration,contact_energy_um2,shape_energy_um2,overlapping_pairs,overlap_sum_um,largest_overlap_um,"
      "icvf_united,icvf_several,icvf_planes\n";
  for (const Step &step : steps) {
    char line[256];
    const State &s = step.state;
    std::snprintf(line, sizeof line, "%d,%.6g,%.6g,%llu,%.6g,%.6g,%.6f,%.6f,%.6f\n", step.iteration,
                  s.contact_energy, s.shape_energy, static_cast<unsigned long long>(s.overlapping),
                  s.overlap_sum, s.largest_overlap, step.fractions.united, step.fractions.several,
                  step.fractions.planes);
    rows += line;
  }
  OutputFile file(path);
  file.write(rows);
  file.commit();
}

} // namespace conceg::relax
