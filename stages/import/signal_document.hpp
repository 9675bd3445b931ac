// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "signal_files.hpp"

#include "conceg/doc.h"

namespace conceg::importing {

// Writes /protocol, as pairs of rectangular pulses, and /signals.
void write_signals(conceg_doc *doc, const SignalSet &set);

} // namespace conceg::importing
