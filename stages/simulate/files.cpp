// SPDX-License-Identifier: BSD-3-Clause
#include "files.hpp"

#include "output.hpp"

#include <cstdio>
#include <cstring>

namespace conceg::simulate {

namespace {

// %.17g reads back as the same double.
std::string number(double x, const char *format = "%.17g") {
  char text[40];
  std::snprintf(text, sizeof text, format, x);
  return text;
}
std::string line(std::initializer_list<std::string> fields) {
  std::string out;
  for (const std::string &field : fields) {
    if (!out.empty()) out += ',';
    const bool plain = field.find_first_of(",\"\n") == std::string::npos;
    if (plain) {
      out += field;
      continue;
    }
    out += '"';
    for (const char c : field)
      out += c == '"' ? std::string("\"\"") : std::string(1, c);
    out += '"';
  }
  return out + '\n';
}
void write(const std::string &folder, const char *name, const std::string &bytes) {
  OutputFile file(folder + "/" + name);
  file.write(bytes);
  file.commit();
}

} // namespace

void write_csv(const std::string &folder, const Protocol &p, const Results &r) {
  make_folder(folder);
  const std::vector<std::uint32_t> shell = shells(p);
  std::string rows = "compartment,walkers,measurement,b_ms/"
                     "um2,direction_x,direction_y,direction_z,delta_ms,Delta_ms,echo_ms,"
                     "signal,standard_error,imaginary\n";
  std::string powder = "compartment,walkers,shell,b_ms/um2,directions,signal,standard_error\n";
  std::string spread = "compartment,walkers,time_ms,msd_um2,msd_error_um2,D_x_um2/ms,D_y_um2/ms,D_z_um2/"
                       "ms,D_x_error,D_y_error,"
                       "D_z_error,K_x,K_y,K_z,K_x_error,K_y_error,K_z_error\n";
  for (std::size_t c = 0; c < r.compartment.size(); c++) {
    const std::string &name = r.compartment[c].name, walkers = std::to_string(r.compartment[c].walker.size());
    const Signals &s = r.signals[c];
    for (std::size_t m = 0; m < p.measurements(); m++)
      rows += line({name, walkers, std::to_string(m), number(p.b[m]), number(p.direction[m].x),
                    number(p.direction[m].y), number(p.direction[m].z), number(p.pulse_duration[m]),
                    number(p.pulse_separation[m]), number(p.echo_time[m]), number(s.real[m].value),
                    number(s.real[m].error), number(s.imaginary[m])});
    for (std::size_t i = 0; i < s.powder.size(); i++) {
      std::size_t directions = 0, first = p.measurements();
      for (std::size_t m = p.measurements(); m-- > 0;)
        if (shell[m] == i) directions++, first = m;
      powder += line({name, walkers, std::to_string(i), number(p.b[first]), std::to_string(directions),
                      number(s.powder[i].value), number(s.powder[i].error)});
    }
    for (std::size_t t = 0; t < r.time.size(); t++) {
      const Spread &d = r.spread[c][t];
      spread += line({name, walkers, number(r.time[t]), number(d.msd.value), number(d.msd.error),
                      number(d.diffusivity[0].value), number(d.diffusivity[1].value),
                      number(d.diffusivity[2].value), number(d.diffusivity[0].error),
                      number(d.diffusivity[1].error), number(d.diffusivity[2].error),
                      number(d.kurtosis[0].value), number(d.kurtosis[1].value), number(d.kurtosis[2].value),
                      number(d.kurtosis[0].error), number(d.kurtosis[1].error), number(d.kurtosis[2].error)});
    }
  }
  write(folder, "signals.csv", rows);
  write(folder, "powder.csv", powder);
  if (!r.time.empty()) write(folder, "displacements.csv", spread);
}

// NIfTI-1 as one file: a header of 348 bytes, 4 bytes without extensions, the values.
void write_nifti(const std::string &folder, const Protocol &p, const Results &r) {
  make_folder(folder);
  std::string bytes(352, '\0');
  const auto put16 = [&](std::size_t at, std::int16_t v) { std::memcpy(&bytes[at], &v, 2); };
  const auto put32 = [&](std::size_t at, auto v) { std::memcpy(&bytes[at], &v, 4); };
  if (r.compartment.size() > 32767 || p.measurements() > 32767)
    fail(CONCEG_E_RANGE, "nifti: expected at most 32767 measurements and compartments, got %zu and %zu",
         p.measurements(), r.compartment.size());
  put32(0, std::int32_t{348});
  const std::int16_t dim[8] = {4,
                               static_cast<std::int16_t>(r.compartment.size()),
                               1,
                               1,
                               static_cast<std::int16_t>(p.measurements()),
                               1,
                               1,
                               1};
  for (std::size_t i = 0; i < 8; i++)
    put16(40 + 2 * i, dim[i]), put32(76 + 4 * i, 1.0f);
  put16(70, 16), put16(72, 32);         // float32
  put32(108, 352.0f), put32(112, 1.0f); // where values begin; their slope
  std::strcpy(&bytes[148], "ConCeG signals: x = compartment, t = measurement");
  std::memcpy(&bytes[344], "n+1", 4);
  for (std::size_t m = 0; m < p.measurements(); m++)
    for (std::size_t c = 0; c < r.compartment.size(); c++) {
      const float value = static_cast<float>(r.signals[c].real[m].value);
      bytes.append(reinterpret_cast<const char *>(&value), 4);
    }
  std::string bval, bvec, names;
  for (std::size_t m = 0; m < p.measurements(); m++)
    bval += (m ? " " : "") + number(1e3 * p.b[m], "%.6g");
  for (int axis = 0; axis < 3; axis++) {
    for (std::size_t m = 0; m < p.measurements(); m++)
      bvec += (m ? " " : "") + number(p.direction[m][axis], "%.9f");
    bvec += '\n';
  }
  for (const Compartment &c : r.compartment)
    names += c.name + '\n';
  write(folder, "signals.nii", bytes);
  write(folder, "signals.bval", bval + '\n');
  write(folder, "signals.bvec", bvec);
  write(folder, "signals.txt", names);
}

} // namespace conceg::simulate
