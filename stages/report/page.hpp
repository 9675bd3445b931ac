// SPDX-License-Identifier: BSD-3-Clause
// The page: the viewer (one HTML file, made beforehand from viewer/) with the document's data in its slot.
#pragma once

#include "output.hpp"
#include "scene.hpp"

#include <string>
#include <vector>

namespace conceg::reporting {

std::string base64(const std::vector<std::uint8_t> &bytes);

// What stands in the slot: <script> elements that hold data and never run.
std::string data_elements(const std::string &json, const std::vector<Block> &blocks);

// Writes the page into a file that is then committed. E_IO names the path and the system's reason.
void write_page(OutputFile &file, const std::string &json, const std::vector<Block> &blocks);

} // namespace conceg::reporting
