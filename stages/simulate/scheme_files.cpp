// SPDX-License-Identifier: BSD-3-Clause
#include "scheme_files.hpp"

#include "guard.hpp"

#include <glm/geometric.hpp>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace conceg::simulate {

namespace {

constexpr std::size_t file_limit = std::size_t{1} << 28;
constexpr double most_b = 1000.0; // ms/um^2; above, units were mistaken

struct Row {
  std::size_t line;
  std::vector<double> value;
};
struct Text {
  std::string version; // after VERSION:, "" when there is no such line
  std::vector<Row> rows;
};

Text read_rows(const std::string &path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) fail(CONCEG_E_IO, "%s: cannot read: %s", path.c_str(), std::strerror(errno));
  std::string all;
  char block[65536];
  for (std::size_t got; (got = std::fread(block, 1, sizeof block, file.get())) > 0;) {
    all.append(block, got);
    if (all.size() > file_limit)
      fail(CONCEG_E_FORMAT, "%s: expected a protocol, got more than %zu bytes", path.c_str(), file_limit);
  }
  if (std::ferror(file.get())) fail(CONCEG_E_IO, "%s: cannot read: %s", path.c_str(), std::strerror(errno));
  if (all.find('\0') != std::string::npos)
    fail(CONCEG_E_FORMAT, "%s: expected text, got binary data", path.c_str());
  Text text;
  std::size_t line = 0;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = all.find('\n', begin);
    if (end == std::string::npos) end = all.size();
    const std::string row = all.substr(begin, end - begin);
    begin = end + 1, line++;
    const std::size_t first = row.find_first_not_of(" \t\r");
    if (first == std::string::npos || row[first] == '#') continue;
    if (row.compare(first, 8, "VERSION:") == 0) {
      const std::size_t word = row.find_first_not_of(" \t", first + 8);
      if (word != std::string::npos)
        text.version = row.substr(word, row.find_last_not_of(" \t\r") + 1 - word);
      continue;
    }
    Row out{line, {}};
    for (const char *at = row.c_str() + first; *at;) {
      char *after = nullptr;
      const double value = std::strtod(at, &after);
      if (after == at || !std::isfinite(value))
        fail(CONCEG_E_FORMAT, "%s:%zu: expected finite numbers, got \"%.20s\"", path.c_str(), line, at);
      out.value.push_back(value);
      at = after + std::strspn(after, " \t\r,");
    }
    text.rows.push_back(std::move(out));
  }
  return text;
}

glm::dvec3 unit(const std::string &path, std::size_t line, const glm::dvec3 &v, bool weighted) {
  const double length = glm::length(v);
  if (!weighted && !(length > 0.0)) return {1.0, 0.0, 0.0};
  if (!(std::fabs(length - 1.0) < 0.02))
    fail(CONCEG_E_FORMAT, "%s:%zu: expected a direction of length 1, got %g", path.c_str(), line, length);
  return v / length;
}

void check_pulses(const std::string &path, const Pulses &p) {
  if (!(p.duration_ms > 0.0 && p.separation_ms >= p.duration_ms &&
        p.separation_ms + p.duration_ms <= 10000.0))
    fail(CONCEG_E_RANGE, "%s:%zu: expected times in s with 0 < delta <= Delta, got delta %g s, Delta %g s",
         path.c_str(), p.line, 1e-3 * p.duration_ms, 1e-3 * p.separation_ms);
  if (!(p.echo_ms >= p.separation_ms + p.duration_ms - 1e-6))
    fail(CONCEG_E_RANGE, "%s:%zu: expected TE of at least Delta + delta = %g s, got %g s", path.c_str(),
         p.line, 1e-3 * (p.separation_ms + p.duration_ms), 1e-3 * p.echo_ms);
  if (!(p.b <= most_b))
    fail(CONCEG_E_RANGE,
         "%s:%zu: expected b below %g ms/um^2, got %g: are gradients in T/m, times in s and b-values in "
         "s/mm^2?",
         path.c_str(), p.line, most_b, p.b);
}

Protocol pulsed_scheme(const std::string &path, const Text &text) {
  std::vector<Pulses> rows;
  for (const Row &row : text.rows) {
    if (row.value.size() != 7)
      fail(CONCEG_E_FORMAT, "%s:%zu: expected 7 columns (gx gy gz |G| Delta delta TE), got %zu", path.c_str(),
           row.line, row.value.size());
    const auto &v = row.value;
    Pulses p;
    p.line = row.line;
    if (!(v[3] >= 0.0))
      fail(CONCEG_E_RANGE, "%s:%zu: expected |G| >= 0 T/m, got %g", path.c_str(), row.line, v[3]);
    p.separation_ms = 1e3 * v[4], p.duration_ms = 1e3 * v[5],
    p.echo_ms = std::max(1e3 * v[6], p.separation_ms + p.duration_ms);
    if (1e3 * v[6] < p.separation_ms + p.duration_ms - 1e-6) p.echo_ms = 1e3 * v[6]; // refused below
    p.direction = unit(path, row.line, {v[0], v[1], v[2]}, v[3] > 0.0);
    // rad/um/ms: 1e-6 m/um, 1e-3 s/ms.
    const double strength = gamma_camino * v[3] * 1e-9 * p.duration_ms;
    p.b = strength * strength * (p.separation_ms - p.duration_ms / 3.0);
    check_pulses(path, p);
    rows.push_back(p);
  }
  return pulsed(rows);
}

Protocol waveform_scheme(const std::string &path, const Text &text) {
  Waveforms w;
  for (const Row &row : text.rows) {
    const double samples = row.value[0];
    if (!(samples >= 2.0 && samples <= 1e6 && samples == std::floor(samples)) ||
        row.value.size() != 2 + 3 * static_cast<std::size_t>(samples))
      fail(CONCEG_E_FORMAT, "%s:%zu: expected n, dt and 3 n gradients, got n = %g and %zu columns",
           path.c_str(), row.line, samples, row.value.size());
    const double step = 1e3 * row.value[1];
    if (!(step > 0.0 && step * samples <= 10000.0))
      fail(CONCEG_E_RANGE, "%s:%zu: expected dt in s, above 0 and n dt below 10 s, got %g", path.c_str(),
           row.line, row.value[1]);
    if (w.step_ms > 0.0 && std::fabs(step - w.step_ms) > 1e-9 * step)
      fail(CONCEG_E_FORMAT, "%s:%zu: expected the dt of the rows before, %g s, got %g s", path.c_str(),
           row.line, 1e-3 * w.step_ms, row.value[1]);
    w.step_ms = step;
    std::vector<glm::dvec3> gradient;
    glm::dvec3 sum(0.0);
    double size = 0.0;
    for (std::size_t i = 2; i < row.value.size(); i += 3) {
      gradient.push_back(gamma_camino * 1e-9 * glm::dvec3(row.value[i], row.value[i + 1], row.value[i + 2]));
      sum += gradient.back(), size += glm::length(gradient.back());
    }
    if (glm::length(sum) > 1e-3 * size)
      fail(CONCEG_E_FORMAT,
           "%s:%zu: expected an effective gradient whose integral is 0 (its sign changed by refocusing), got "
           "%g of its size",
           path.c_str(), row.line, glm::length(sum) / size);
    w.row.push_back(std::move(gradient));
  }
  Protocol p = sampled(w);
  for (std::size_t r = 0; r < p.b.size(); r++)
    if (!(p.b[r] <= most_b))
      fail(CONCEG_E_RANGE, "%s:%zu: expected b below %g ms/um^2, got %g: are gradients in T/m and dt in s?",
           path.c_str(), text.rows[r].line, most_b, p.b[r]);
  return p;
}

Protocol fsl(const std::string &path, const Text &bval, const Pulses &times) {
  const std::size_t dot = path.rfind(".bval");
  const std::string vectors = dot == std::string::npos ? path + ".bvec" : path.substr(0, dot) + ".bvec";
  const Text bvec = read_rows(vectors);
  std::vector<double> b;
  for (const Row &row : bval.rows)
    b.insert(b.end(), row.value.begin(), row.value.end());
  if (bvec.rows.size() != 3)
    fail(CONCEG_E_FORMAT, "%s: expected 3 rows (x, y, z), got %zu", vectors.c_str(), bvec.rows.size());
  for (const Row &row : bvec.rows)
    if (row.value.size() != b.size())
      fail(CONCEG_E_FORMAT, "%s:%zu: expected %zu columns, as many as b-values, got %zu", vectors.c_str(),
           row.line, b.size(), row.value.size());
  std::vector<Pulses> rows;
  for (std::size_t i = 0; i < b.size(); i++) {
    Pulses p = times;
    p.line = bval.rows.front().line, p.b = 1e-3 * b[i];
    if (!(p.b >= 0.0))
      fail(CONCEG_E_RANGE, "%s:%zu: expected b >= 0 s/mm^2, got %g", path.c_str(), p.line, b[i]);
    p.direction = unit(vectors, bvec.rows[0].line,
                       {bvec.rows[0].value[i], bvec.rows[1].value[i], bvec.rows[2].value[i]}, b[i] > 0.0);
    check_pulses(path, p);
    rows.push_back(p);
  }
  return pulsed(rows);
}

} // namespace

Protocol read_protocol(const std::string &path, const Pulses &times) {
  const Text text = read_rows(path);
  if (text.rows.empty()) fail(CONCEG_E_FORMAT, "%s: expected measurements, got none", path.c_str());
  if (text.version.empty()) return fsl(path, text, times);
  if (text.version == "STEJSKALTANNER" || text.version == "1") return pulsed_scheme(path, text);
  if (text.version == "GRADIENT_WAVEFORM" || text.version == "0") return waveform_scheme(path, text);
  fail(CONCEG_E_UNSUPPORTED, "%s: expected VERSION: STEJSKALTANNER or GRADIENT_WAVEFORM, got %s",
       path.c_str(), text.version.c_str());
}

} // namespace conceg::simulate
