// SPDX-License-Identifier: BSD-3-Clause
// manifest.json beside the files of a format: what they hold, in which units and frame, and what is true of
// the substrate.
#pragma once

#include "formats.hpp"
#include "job.hpp"

namespace conceg::exporting {

// Of the files that were added to the folder since `first`.
void write_manifest(Job &job, const Format &format, std::size_t first);

} // namespace conceg::exporting
