// SPDX-License-Identifier: BSD-3-Clause
// What a build without Cairo answers.
#include "../pictures.hpp"

#include "check.h"
#include "guard.hpp"

#include <cstring>

using namespace conceg;

namespace {

conceg_status answer(const char *folder, const char *beside, std::string &line) {
  try {
    characterise::Pictures(folder, beside).draw(nullptr, {});
    return CONCEG_OK;
  } catch (const Error &error) {
    line = error.what();
    return error.status();
  }
}

} // namespace

int main() {
  std::string line;
  CHECK_EQUAL(answer("", "", line), CONCEG_OK);
  CHECK_EQUAL(answer("pictures", "", line), CONCEG_E_UNSUPPORTED);
  CHECK(line.find("libcairo2-dev") != std::string::npos);
  CHECK_EQUAL(answer("", "grown.cgx", line), CONCEG_E_UNSUPPORTED);
  return check_done();
}
