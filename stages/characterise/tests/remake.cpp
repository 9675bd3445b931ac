// SPDX-License-Identifier: BSD-3-Clause
// Making the default dictionary again from the reconstructions gives the committed file.
#include "../../common/tests/bytes.hpp"
#include "check.h"

#include "conceg/conceg.h"

#include <fstream>
#include <iterator>
#include <string>

extern "C" const conceg_stage conceg_stage_characterise;

namespace {

std::string digest(conceg_ctx *ctx, conceg_doc *doc) {
  char hex[65] = "";
  if (conceg_doc_digest(doc, "/dictionary", hex) != CONCEG_OK) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  return hex;
}

conceg_doc *remake(conceg_ctx *ctx, const std::string &cells, const char *more) {
  const std::string table = "characterise.table=" CONCEG_DATA "/mouse-visual-cortex.csv",
                    sources = "characterise.sources=" CONCEG_DATA "/mouse-visual-cortex-sources.csv",
                    root = "characterise.root=" + cells;
  const char *const sets[] =
      {table.c_str(), sources.c_str(), root.c_str(), "characterise.axons=true", "characterise.metrics=none",
       more,          nullptr},
                    *const none[] = {nullptr};
  conceg_doc *doc = nullptr;
  conceg_params *params = nullptr;
  conceg_status status = conceg_doc_new(ctx, &doc);
  if (status == CONCEG_OK)
    status = conceg_params_new(ctx, &conceg_stage_characterise, doc, nullptr, sets, none, &params);
  if (status == CONCEG_OK) status = conceg_stage_run(ctx, &conceg_stage_characterise, doc, params);
  if (status != CONCEG_OK) fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
  CHECK_EQUAL(status, CONCEG_OK);
  conceg_params_free(params);
  return doc;
}

} // namespace

int main() {
  if (!check_shared()) SKIP("CONCEG_SHARED is not set: no reconstructions");
  const std::string cells = std::string(check_shared()) + "/morphologies";
  if (!std::ifstream(cells + "/mouse_vis_L4_pyr/313862022.swc"))
    SKIP("no reconstructions in CONCEG_SHARED/morphologies");
  const char *const committed_path = CONCEG_DATA "/mouse-visual-cortex.cgx";
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *committed = nullptr;
  CHECK_EQUAL(conceg_doc_open(ctx, committed_path, &committed), CONCEG_OK);
  conceg_doc *again = remake(ctx, cells, nullptr),
             *other = remake(ctx, cells, "characterise.twig_length_um=30");
  const std::string digest_committed = digest(ctx, committed), digest_again = digest(ctx, again);
  CHECK_TEXT(digest_again.c_str(), digest_committed.c_str());
  CHECK(digest(ctx, other) != digest_committed); // another rule gives another dictionary
  std::ifstream in(committed_path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  CHECK(bytes == conceg::testing::bytes_of(again));
  CHECK(bytes.size() < 3u << 20);
  for (conceg_doc *doc : {committed, again, other})
    CHECK_EQUAL(conceg_doc_close(doc), CONCEG_OK);
  conceg_ctx_free(ctx);
  return check_done();
}
