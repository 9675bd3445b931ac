// SPDX-License-Identifier: BSD-3-Clause
// For tests of stages: a document as the bytes of its file.
#pragma once

#include "check.h"

#include "conceg/doc.h"

#include <string>

namespace conceg::testing {

inline std::string bytes_of(conceg_doc *doc) {
  void *bytes = nullptr;
  size_t count = 0;
  CHECK_EQUAL(conceg_doc_to_memory(doc, &bytes, &count), CONCEG_OK);
  const std::string out(static_cast<const char *>(bytes), count);
  conceg_free(bytes);
  return out;
}

} // namespace conceg::testing
