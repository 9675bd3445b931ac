// SPDX-License-Identifier: BSD-3-Clause
#include "signal_files.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <locale>
#include <map>
#include <sstream>

namespace conceg::importing {
namespace {

// b of no scanner; what lies above is in another unit.
constexpr double largest_b = 100.0;

std::ifstream opened(const std::string &path) {
  std::ifstream in(path);
  if (!in) fail(CONCEG_E_IO, "%s: cannot open: %s", path.c_str(), std::strerror(errno));
  return in;
}

double number(const std::string &word, const std::string &path, std::size_t line, const char *what) {
  std::istringstream in(word);
  in.imbue(std::locale::classic());
  double value;
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof() || !std::isfinite(value))
    fail(CONCEG_E_FORMAT,
         "%s:%zu: %s: expected a finite number, got '%s'; leave the measurement out if it has none",
         path.c_str(), line, what, word.c_str());
  return value;
}

double checked_b(double b, const std::string &path, std::size_t line) {
  if (b < 0.0) fail(CONCEG_E_FORMAT, "%s:%zu: b: expected 0 or more, got %g", path.c_str(), line, b);
  if (b > largest_b)
    fail(CONCEG_E_FORMAT,
         "%s:%zu: b: expected at most %g ms/um^2, got %g; tables hold ms/um^2 in a column b or b_ms/um2, or "
         "s/mm^2 in "
         "b_s/mm2, FSL's bval files s/mm^2; 1 ms/um^2 = 1000 s/mm^2 = 1e9 s/m^2",
         path.c_str(), line, largest_b, b);
  return b;
}

void add_direction(SignalSet &set, const double *v, const std::string &path, std::size_t line) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (length == 0.0 && set.b.back() == 0.0) {
    set.direction.insert(set.direction.end(), {0.0, 0.0, 1.0});
    return;
  }
  if (!(std::fabs(length - 1.0) < 0.1))
    fail(CONCEG_E_FORMAT, "%s:%zu: direction: expected length 1, got %g", path.c_str(), line, length);
  for (int k = 0; k < 3; k++)
    set.direction.push_back(v[k] / length);
}

void add_timing(SignalSet &set, double duration, double separation, const std::string &path,
                std::size_t line) {
  if (!(duration > 0.0) || !(separation >= duration) || separation > 1e5)
    fail(CONCEG_E_FORMAT,
         "%s:%zu: expected pulses of some duration and a separation not below it (ms), got %g and %g; give "
         "--pulse-duration-ms and --pulse-separation-ms, or columns of these names",
         path.c_str(), line, duration, separation);
  set.duration.push_back(duration), set.separation.push_back(separation);
}

std::string trimmed(const std::string &word) {
  const std::size_t first = word.find_first_not_of(" \t\r\""), last = word.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? "" : word.substr(first, last - first + 1);
}

std::vector<std::string> fields_of(const std::string &line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string word; std::getline(in, word, ',');)
    out.push_back(trimmed(word));
  if (!line.empty() && line.back() == ',') out.emplace_back();
  return out;
}

// The columns of a table by name, with the file and the line that is being read.
class Rows {
public:
  Rows(const std::string &path) : path_(path), in_(opened(path)) {
    if (!next()) fail(CONCEG_E_FORMAT, "%s: expected a header and rows, got nothing", path.c_str());
    for (std::size_t i = 0; i < fields_.size(); i++)
      place_[fields_[i]] = i;
    width_ = fields_.size();
  }
  bool next() {
    for (std::string text; std::getline(in_, text);) {
      line_++;
      if (trimmed(text).empty() || text[0] == '#') continue;
      fields_ = fields_of(text);
      if (width_ && fields_.size() != width_)
        fail(CONCEG_E_FORMAT, "%s:%zu: expected %zu columns as in the header, got %zu", path_.c_str(), line_,
             width_, fields_.size());
      return true;
    }
    return false;
  }
  bool has(const char *column) const { return place_.count(column) != 0; }
  const std::string &text(const char *column) const { return fields_[place_.at(column)]; }
  double value(const char *column) const { return number(text(column), path_, line_, column); }
  double value(const char *column, double fallback) const { return has(column) ? value(column) : fallback; }
  std::size_t line() const { return line_; }

private:
  std::string path_;
  std::ifstream in_;
  std::map<std::string, std::size_t> place_;
  std::vector<std::string> fields_;
  std::size_t width_ = 0, line_ = 0;
};

const char *b_column(const Rows &rows, const std::string &path) {
  for (const char *name : {"b", "b_ms/um2", "b_s/mm2"})
    if (rows.has(name)) return name;
  fail(CONCEG_E_FORMAT, "%s:%zu: expected a column b, b_ms/um2 or b_s/mm2 in the header, got none",
       path.c_str(), rows.line());
}

void add_measurement(SignalSet &set, const Rows &rows, const char *b, const SignalOptions &options,
                     const std::string &path) {
  set.b.push_back(
      checked_b(rows.value(b) * (std::strcmp(b, "b_s/mm2") == 0 ? 1e-3 : 1.0), path, rows.line()));
  const bool directed = rows.has("direction_x") && rows.has("direction_y") && rows.has("direction_z");
  const double v[3] = {directed ? rows.value("direction_x") : 0.0, directed ? rows.value("direction_y") : 0.0,
                       directed ? rows.value("direction_z") : 1.0};
  add_direction(set, v, path, rows.line());
  // The second names are those of conceg simulate --csv.
  add_timing(set, rows.value("pulse_duration_ms", rows.value("delta_ms", options.pulse_duration_ms)),
             rows.value("pulse_separation_ms", rows.value("Delta_ms", options.pulse_separation_ms)), path,
             rows.line());
}

struct Numbers {
  std::vector<double> value;
  std::vector<std::size_t> line;
  std::size_t rows = 0;
};
Numbers read_numbers(const std::string &path, const char *what) {
  std::ifstream in = opened(path);
  Numbers out;
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); line++) {
    std::istringstream words(text);
    const std::size_t before = out.value.size();
    for (std::string word; words >> word;)
      out.value.push_back(number(word, path, line, what)), out.line.push_back(line);
    out.rows += out.value.size() > before;
  }
  return out;
}

} // namespace

SignalSet read_signal_table(const std::string &path, const SignalOptions &options) {
  Rows rows(path);
  const char *b = b_column(rows, path);
  if (!rows.has("signal"))
    fail(CONCEG_E_FORMAT, "%s:%zu: expected a column signal in the header, got none", path.c_str(),
         rows.line());
  // Measurements by compartment; all compartments must have the same ones.
  std::vector<SignalSet> sets;
  while (rows.next()) {
    const std::string name = rows.has("compartment") ? rows.text("compartment") : options.compartment;
    auto set =
        std::find_if(sets.begin(), sets.end(), [&](const SignalSet &s) { return s.compartment[0] == name; });
    if (set == sets.end()) set = sets.insert(sets.end(), SignalSet{{}, {}, {}, {}, {name}, {}, {}});
    add_measurement(*set, rows, b, options, path);
    set->signal.push_back(rows.value("signal"));
    const double error = rows.value("standard_error", rows.value("error", 0.0));
    if (error < 0.0)
      fail(CONCEG_E_FORMAT, "%s:%zu: standard_error: expected 0 or more, got %g", path.c_str(), rows.line(),
           error);
    set->error.push_back(error);
  }
  if (sets.empty())
    fail(CONCEG_E_FORMAT, "%s: expected rows of signals below the header, got none", path.c_str());
  SignalSet out = sets[0];
  for (std::size_t i = 1; i < sets.size(); i++) {
    const SignalSet &s = sets[i];
    if (s.b != out.b || s.direction != out.direction || s.duration != out.duration ||
        s.separation != out.separation)
      fail(CONCEG_E_FORMAT,
           "%s: compartment %s: expected the same measurements in the same order as in %s; import them "
           "apart",
           path.c_str(), s.compartment[0].c_str(), out.compartment[0].c_str());
    out.compartment.push_back(s.compartment[0]);
    out.signal.insert(out.signal.end(), s.signal.begin(), s.signal.end());
    out.error.insert(out.error.end(), s.error.begin(), s.error.end());
  }
  return out;
}

SignalSet read_signal_fsl(const std::string &path, const SignalOptions &options) {
  const Numbers b = read_numbers(options.bval, "bval"), signal = read_numbers(path, "signal");
  const std::size_t n = b.value.size();
  if (n == 0) fail(CONCEG_E_FORMAT, "%s: expected values of b, got none", options.bval.c_str());
  if (signal.value.size() != n)
    fail(CONCEG_E_FORMAT, "%s: expected %zu signals, one for each value of b in %s, got %zu", path.c_str(), n,
         options.bval.c_str(), signal.value.size());
  const double largest = *std::max_element(b.value.begin(), b.value.end());
  if (largest > 0.0 && largest < 50.0)
    fail(CONCEG_E_FORMAT,
         "%s: the largest b is %g; bval files hold s/mm^2 (1000 s/mm^2 = 1 ms/um^2), so multiply by 1000, or "
         "import a "
         "table with a column b_ms/um2",
         options.bval.c_str(), largest);
  Numbers direction;
  if (!options.bvec.empty()) direction = read_numbers(options.bvec, "bvec");
  if (!options.bvec.empty() &&
      (direction.value.size() != 3 * n || (direction.rows != 3 && direction.rows != n)))
    fail(CONCEG_E_FORMAT, "%s: expected 3 lines of %zu numbers, got %zu numbers on %zu lines",
         options.bvec.c_str(), n, direction.value.size(), direction.rows);
  SignalSet out;
  out.compartment = {options.compartment}, out.signal = signal.value, out.error.assign(n, 0.0);
  for (std::size_t i = 0; i < n; i++) {
    out.b.push_back(checked_b(b.value[i] / 1000.0, options.bval, b.line[i]));
    double v[3] = {0.0, 0.0, 1.0};
    for (std::size_t k = 0; k < 3 && !options.bvec.empty(); k++)
      v[k] = direction.value[direction.rows == 3 ? k * n + i : 3 * i + k];
    add_direction(out, v, options.bvec.empty() ? options.bval : options.bvec, 1);
    add_timing(out, options.pulse_duration_ms, options.pulse_separation_ms, options.bval, b.line[i]);
  }
  return out;
}

} // namespace conceg::importing
