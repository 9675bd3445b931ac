// SPDX-License-Identifier: BSD-3-Clause
// Protocols in files: Camino's STEJSKALTANNER and GRADIENT_WAVEFORM schemes, FSL's bval with bvec.
#pragma once

#include "protocol.hpp"

#include <string>

namespace conceg::simulate {

// Gyromagnetic ratio of the proton as Camino has it, rad/s/T: schemes give gradients in T/m.
inline constexpr double gamma_camino = 2.6751525e8;

// Reads a scheme (first line VERSION: ...) or a bval file, whose bvec file has the same name but for its
// ending. FSL's files hold no times: they are those of `times`. Errors name file and line: E_IO, E_FORMAT
// (columns, numbers), E_RANGE (units: values that no scanner has).
Protocol read_protocol(const std::string &path, const Pulses &times);

} // namespace conceg::simulate
