/* SPDX-License-Identifier: BSD-3-Clause
 * Every real SWC file of the shared folder loads in tolerant mode, and its samples form a tree. */
#define _GNU_SOURCE
#include "check.h"
#include "conceg/swc.h"

#include <dirent.h>

static conceg_ctx *ctx;
static int files;

static void check_file(const char *path) {
  conceg_swc *swc = NULL;
  const conceg_status status = conceg_swc_read(ctx, path, 0, &swc);
  uint64_t i, floating = 0;
  files++;
  CHECK_EQUAL(status, CONCEG_OK);
  if (status != CONCEG_OK) {
    fprintf(stderr, "  %s\n", conceg_ctx_error(ctx));
    conceg_swc_free(swc);
    return;
  }
  CHECK(conceg_swc_count(swc) > 100);
  for (i = 0; i < conceg_swc_count(swc); i++) {
    const int64_t up = conceg_swc_parent(swc)[i];
    if (up >= (int64_t)i || up < -1 || (up >= 0 && conceg_swc_on_soma(swc)[i])) CHECK(!"parents come first");
    floating += up < 0 && !conceg_swc_on_soma(swc)[i];
  }
  if (strstr(path, "471077857")) CHECK_EQUAL(floating, 177); /* a broken axon in many pieces */
  conceg_swc_free(swc);
}

static void check_folder(const char *path) {
  DIR *folder = opendir(path);
  struct dirent *item;
  char name[4096];
  if (!folder) return;
  while ((item = readdir(folder)) != NULL) {
    const size_t length = strlen(item->d_name);
    if (item->d_name[0] == '.') continue;
    if (snprintf(name, sizeof name, "%s/%s", path, item->d_name) >= (int)sizeof name) continue;
    if (length > 4 && !strcmp(item->d_name + length - 4, ".swc"))
      check_file(name);
    else
      check_folder(name);
  }
  closedir(folder);
}

int main(void) {
  char path[4096];
  if (!check_shared()) SKIP("CONCEG_SHARED is not set: no real cells");
  snprintf(path, sizeof path, "%s/morphologies", check_shared());
  ctx = conceg_ctx_new();
  check_folder(path);
  if (!files) SKIP("no SWC file in CONCEG_SHARED/morphologies");
  CHECK(files >= 144);
  conceg_ctx_free(ctx);
  return check_done();
}
