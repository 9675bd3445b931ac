// SPDX-License-Identifier: BSD-3-Clause
#include "experiment_tables.hpp"

#include <utility>

namespace conceg::analyse {

Table composition_table(const Composition &composition, double erosion) {
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
    table.put("erosion", erosion, "um");
  }
  return table;
}

Table composition_fit_table(const Composition &composition, double erosion) {
  Table table("composition_fit");
  const auto put = [&](const char *name, const ScaleFit &fit) {
    if (fit.rows < 3) return;
    table.put("range", std::string(name));
    table.put("from", fit.from, "um"), table.put("to", fit.to, "um");
    table.put("lengths", static_cast<std::uint64_t>(fit.rows));
    table.put("fragment_exponent", fit.fragment, "1"), table.put("fragment_error", fit.fragment_error, "1");
    table.put("cell_exponent", fit.cell, "1"), table.put("cell_error", fit.cell_error, "1");
    table.put("erosion", erosion, "um");
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

namespace {

void put_source(Table &table, const Source &source) {
  table.put("block", source.block), table.put("ecs_fraction", source.ecs_fraction, "1");
  table.put("erosion", source.erosion, "um"), table.put("voxel", source.voxel, "um");
}

} // namespace

void add_block(Table &table, std::uint64_t block, const glm::dvec3 &lo, double side, const OpenVoxels &voxels,
               double median, const OpenPieces &pieces, bool valid) {
  table.put("block", block);
  table.put("x", lo.x, "um"), table.put("y", lo.y, "um"), table.put("z", lo.z, "um");
  table.put("side", side, "um"), table.put("voxel", largest_spacing(voxels), "um");
  table.put("ecs_fraction", open_fraction(voxels), "1"), table.put("cleft_width", 4 * median, "um");
  table.put("pieces", pieces.pieces), table.put("largest_piece", pieces.largest, "1");
  table.put("state", std::string(valid ? "valid" : "void"));
}

void add_transport(Table &table, std::uint64_t block, const Transport &coarse, const Transport &fine,
                   double voxel) {
  const auto put = [&](double size, const Transport &t) {
    table.put("block", block);
    table.put("voxel", size, "um"), table.put("ecs_fraction", t.open_fraction, "1");
    table.put("ratio_x", t.ratio[0], "1"), table.put("ratio_y", t.ratio[1], "1");
    table.put("ratio_z", t.ratio[2], "1"), table.put("lambda", t.lambda(), "1");
  };
  put(2 * voxel, coarse), put(voxel, fine), put(0, extrapolated(coarse, fine));
}

void add_pores(Table &table, const Source &source, std::uint64_t dimensions, const PoreSpace &pores) {
  const std::pair<const char *, const Distribution *> all[] = {{"centre_radius", &pores.centres},
                                                               {"voxel_radius", &pores.voxels},
                                                               {"thickness_radius", &pores.thickness},
                                                               {"gap_width", &pores.gaps},
                                                               {"chord", &pores.chords}};
  for (const auto &[name, d] : all) {
    put_source(table, source);
    table.put("dimensions", dimensions), table.put("measure", std::string(name));
    table.put("count", d->count), table.put("mean", d->mean, "um"), table.put("sd", d->sd, "um");
    table.put("median", d->median, "um"), table.put("p95", d->p95, "um");
  }
}

void add_paths(Table &table, const Source &source, std::uint64_t dimensions, double least,
               const PathStraightness &paths) {
  const auto put = [&](const char *way, const Distribution &d) {
    put_source(table, source);
    table.put("dimensions", dimensions), table.put("least", least, "um");
    table.put("way", std::string(way));
    table.put("pairs", paths.pairs), table.put("without_path", paths.apart);
    table.put("straightness", d.mean, "1"), table.put("sd", d.sd, "1"), table.put("median", d.median, "1");
  };
  put("fast_marching", paths.marched), put("steps", paths.stepped);
}

} // namespace conceg::analyse
