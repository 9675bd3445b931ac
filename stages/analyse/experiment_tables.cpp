// SPDX-License-Identifier: BSD-3-Clause
#include "experiment_tables.hpp"

#include <utility>

namespace conceg::analyse {

Table composition_table(const Composition &composition) {
  Table table("composition");
  for (const ScaleRow &row : composition.rows) {
    table.put("side", row.side, "um");
    table.put("cubes", row.cubes), table.put("empty", row.empty);
    table.put("fragment_volume", row.fragment_mean, "um^3"),
        table.put("fragment_sd", row.fragment_sd, "um^3");
    table.put("fragment_geometric_mean", row.fragment_geometric_mean, "um^3");
    table.put("fragment_slope", row.fragment_slope, "1");
    table.put("cell_volume", row.cell_mean, "um^3"), table.put("cell_sd", row.cell_sd, "um^3");
    table.put("cell_geometric_mean", row.cell_geometric_mean, "um^3");
    table.put("cell_slope", row.cell_slope, "1");
  }
  return table;
}

Table composition_fit_table(const Composition &composition) {
  Table table("composition_fit");
  const auto put = [&](const char *name, const ScaleFit &fit) {
    if (fit.rows < 3) return;
    table.put("range", std::string(name));
    table.put("from", fit.from, "um"), table.put("to", fit.to, "um");
    table.put("lengths", static_cast<std::uint64_t>(fit.rows));
    table.put("fragment_exponent", fit.fragment, "1"), table.put("fragment_error", fit.fragment_error, "1");
    table.put("cell_exponent", fit.cell, "1"), table.put("cell_error", fit.cell_error, "1");
  };
  put("all", composition.all), put("beyond_somas", composition.beyond_somas);
  return table;
}

Table spectrum_table(const std::vector<ClassSpectrum> &spectra) {
  Table table("spectrum");
  for (const ClassSpectrum &c : spectra)
    for (std::size_t k = 0; k < c.spectrum.q.size(); k++) {
      const Spectrum &s = c.spectrum;
      table.put("class", c.name);
      table.put("q", s.q[k], "rad/um");
      table.put("raw", s.raw[k], "um"), table.put("raw_low", s.raw_low[k], "um");
      table.put("raw_high", s.raw_high[k], "um");
      table.put("power", s.power[k], "um"), table.put("power_low", s.power_low[k], "um");
      table.put("power_high", s.power_high[k], "um");
    }
  return table;
}

Table spectrum_fit_table(const std::vector<ClassSpectrum> &spectra) {
  Table table("spectrum_fit");
  for (const ClassSpectrum &c : spectra) {
    const Spectrum &s = c.spectrum;
    table.put("class", c.name);
    table.put("tips", c.tips), table.put("paths", s.paths), table.put("cells", s.cells);
    table.put("spacing", c.spacing, "um");
    table.put("raw_exponent", s.raw_exponent, "1"), table.put("exponent", s.exponent, "1");
    table.put("plateau", s.plateau, "um"), table.put("reciprocal_plateau", s.reciprocal_plateau, "um");
    table.put("diffusivity_ratio", s.diffusivity_ratio, "1");
  }
  return table;
}

Table transport_table(const Transport &coarse, double coarse_um, const Transport &fine, double fine_um) {
  Table table("transport");
  const auto put = [&](double voxel, const Transport &t) {
    table.put("voxel", voxel, "um"), table.put("ecs_fraction", t.open_fraction, "1");
    table.put("ratio_x", t.ratio[0], "1"), table.put("ratio_y", t.ratio[1], "1");
    table.put("ratio_z", t.ratio[2], "1"), table.put("lambda", t.lambda(), "1");
  };
  put(coarse_um, coarse), put(fine_um, fine), put(0, extrapolated(coarse, fine));
  return table;
}

Table pore_table(const PoreSpace &space, const PoreSpace &sections) {
  Table table("pore_space");
  const auto put = [&](std::uint64_t dimensions, const PoreSpace &p) {
    const std::pair<const char *, const Distribution *> all[] = {{"centre_radius", &p.centres},
                                                                 {"voxel_radius", &p.voxels},
                                                                 {"thickness_radius", &p.thickness},
                                                                 {"gap_width", &p.gaps},
                                                                 {"chord", &p.chords}};
    for (const auto &[name, d] : all) {
      table.put("dimensions", dimensions), table.put("measure", std::string(name));
      table.put("count", d->count), table.put("mean", d->mean, "um"), table.put("sd", d->sd, "um");
      table.put("median", d->median, "um"), table.put("p95", d->p95, "um");
    }
  };
  put(3, space), put(2, sections);
  return table;
}

Table path_table(const PathStraightness &paths) {
  Table table("paths");
  const auto put = [&](const char *way, const Distribution &d) {
    table.put("way", std::string(way));
    table.put("pairs", paths.pairs), table.put("without_path", paths.apart);
    table.put("straightness", d.mean, "1"), table.put("sd", d.sd, "1"), table.put("median", d.median, "1");
  };
  put("fast_marching", paths.marched), put("steps", paths.stepped);
  return table;
}

} // namespace conceg::analyse
