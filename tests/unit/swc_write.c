/* SPDX-License-Identifier: BSD-3-Clause
 * The SWC-plus writer: plain columns, exact values back, whole or not at all. */
#define _GNU_SOURCE
#include "check.h"
#include "conceg/swc.h"

#include <sys/stat.h>
#include <unistd.h>

static conceg_ctx *ctx;
static char folder[] = "swc_write_XXXXXX";

static const char *in_folder(const char *name) {
  static char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static char *slurp(const char *path) {
  static char text[1 << 16];
  FILE *file = fopen(path, "rb");
  size_t length;
  if (!file) return NULL;
  length = fread(text, 1, sizeof text - 1, file);
  text[length] = 0;
  fclose(file);
  return text;
}

/* Samples that are not in preorder: 0 and 1 are roots, 2 belongs to 0. */
static const double position[] = {1.0 / 3, 6, 0, -6, -1e-7, 1e5 / 7, 2.5, 7, 0.1234567, 3, 8, -0.0};
static const double radius[] = {1, 0.30000000000000004, 0.5, 1e-3};
static const uint8_t kind[] = {3, 2, 3, 3};
static const int64_t parent[] = {-1, -1, 0, 2};
static const double bar[] = {0, 1.0 / 7, 2, -3e-300}, image[] = {1, 2, NAN, 4};
static const double *const columns[] = {bar, image};
static const char *const names[] = {"bar", "image"}, *const header[] = {"species mouse",
                                                                        "@conceg {\"cell\": 3}", NULL};

static conceg_swc_cell cell(void) {
  conceg_swc_cell c;
  memset(&c, 0, sizeof c);
  c.size = sizeof c, c.count = 4, c.position = position, c.radius = radius, c.kind = kind, c.parent = parent;
  c.soma[0] = 0.1, c.soma_radius = 5.0 / 3;
  c.column_count = 2, c.column_name = names, c.column = columns, c.header = header;
  return c;
}

static void check_round_trip(void) {
  static const int order[] = {0, 2, 3, 1};
  const conceg_swc_cell c = cell();
  conceg_swc *swc = NULL;
  double center[3], soma_radius;
  char *text;
  int i, axis;
  CHECK_EQUAL(conceg_swc_write(ctx, in_folder("a.swc"), &c), CONCEG_OK);
  text = slurp(in_folder("a.swc"));
  CHECK(text && !strncmp(text, "# SWC-plus 1.0 (ConCeG)\n# species mouse\n# @conceg {\"cell\": 3}\n", 62));
  CHECK(
      text &&
      strstr(
          text,
          "\n1 1 0.100000 0.000000 0.000000 1.666667 -1\n2 3 0.333333 6.000000 0.000000 1.000000 1\n"
          "3 3 2.500000 7.000000 0.123457 0.500000 2\n4 3 3.000000 8.000000 0.000000 0.001000 3\n"
          "5 2 -6.000000 0.000000 14285.714286 0.300000 1\n# @begin nodes columns=x,y,z,radius,bar,image\n"));
  CHECK(text && !strchr(text, '\r') && !strchr(text, '\t'));
  CHECK_EQUAL(conceg_swc_read(ctx, in_folder("a.swc"), CONCEG_SWC_STRICT, &swc), CONCEG_OK);
  CHECK(!conceg_swc_problem(swc, 0, NULL, NULL, NULL, NULL));
  CHECK_EQUAL(conceg_swc_count(swc), 4);
  for (i = 0; i < 4; i++) {
    for (axis = 0; axis < 3; axis++)
      CHECK(conceg_swc_position(swc)[3 * i + axis] == position[3 * order[i] + axis]);
    CHECK(conceg_swc_radius(swc)[i] == radius[order[i]]);
    CHECK_EQUAL(conceg_swc_kind(swc)[i], kind[order[i]]);
    CHECK(conceg_swc_column(swc, "bar")[i] == bar[order[i]]);
    CHECK(isnan(image[order[i]]) ? isnan(conceg_swc_column(swc, "image")[i])
                                 : conceg_swc_column(swc, "image")[i] == image[order[i]]);
  }
  CHECK_EQUAL(conceg_swc_soma(swc, center, &soma_radius), CONCEG_SOMA_POINT);
  CHECK(center[0] == 0.1 && soma_radius == 5.0 / 3);
  CHECK_TEXT(conceg_swc_header(swc, "species"), "mouse");
  CHECK_TEXT(conceg_swc_header(swc, "@conceg"), "{\"cell\": 3}");
  CHECK_TEXT(conceg_swc_header(swc, "SWC-plus"), "1.0 (ConCeG)");
  CHECK(conceg_swc_header(swc, "nothing") == NULL);
  conceg_swc_free(swc);
}

/* A column that was edited by hand wins over the exact value, with a warning. */
static void check_edited(void) {
  char *text = slurp(in_folder("a.swc")), *place;
  conceg_swc *swc = NULL;
  const char *code = "";
  CHECK(text && (place = strstr(text, "2 3 0.333333")) != NULL && (place[4] = '9', 1));
  CHECK_EQUAL(conceg_swc_parse(ctx, text, strlen(text), "edited", 0, &swc), CONCEG_OK);
  CHECK_NEAR(conceg_swc_position(swc)[0], 9.333333, 0);
  CHECK(conceg_swc_problem(swc, 0, NULL, NULL, &code, NULL) && !strcmp(code, "W_STALE"));
  conceg_swc_free(swc);
}

static void check_refused(const conceg_swc_cell *c, conceg_status expected, const char *word) {
  const conceg_status status = conceg_swc_write(ctx, in_folder("bad.swc"), c);
  CHECK_EQUAL(status, expected);
  CHECK(strstr(conceg_ctx_error(ctx), word) != NULL);
  CHECK(access(in_folder("bad.swc"), F_OK) != 0);
}

static void check_refusals(void) {
  static const double bad_radius[] = {1, 0, 1, 1}, bad_position[12] = {INFINITY};
  static const int64_t bad_parent[] = {-1, 2, 0, 2};
  static const uint8_t bad_kind[] = {3, 1, 3, 3};
  static const char *const bad_header[] = {"two\nlines", NULL}, *const footer[] = {"@begin nodes", NULL},
                           *const bad_name[] = {"a b", "c"}, *const taken[] = {"a", "x"};
  conceg_swc_cell c = cell();
  c.radius = bad_radius, check_refused(&c, CONCEG_E_RANGE, "radius[1]"), c = cell();
  c.position = bad_position, check_refused(&c, CONCEG_E_RANGE, "position[0]"), c = cell();
  c.parent = bad_parent, check_refused(&c, CONCEG_E_FORMAT, "parent[1]"), c = cell();
  c.kind = bad_kind, check_refused(&c, CONCEG_E_RANGE, "kind[1]"), c = cell();
  c.header = bad_header, check_refused(&c, CONCEG_E_FORMAT, "header[0]"), c = cell();
  c.header = footer, check_refused(&c, CONCEG_E_FORMAT, "header[0]"), c = cell();
  c.column_name = bad_name, check_refused(&c, CONCEG_E_PARAM, "column_name[0]"), c = cell();
  c.column_name = taken, check_refused(&c, CONCEG_E_PARAM, "column_name[1]"), c = cell();
  c.soma_radius = NAN, check_refused(&c, CONCEG_E_RANGE, "soma"), c = cell();
  c.count = 0, c.soma_radius = 0, check_refused(&c, CONCEG_E_FORMAT, "soma"), c = cell();
  c.size = 8, check_refused(&c, CONCEG_E_ABI, "size"), c = cell();
  CHECK_EQUAL(conceg_swc_write(ctx, in_folder("none/a.swc"), &c), CONCEG_E_IO);
  CHECK(strstr(conceg_ctx_error(ctx), "none/a.swc") != NULL);
}

/* Lines after the rows; a caller that was built before there were any has none. */
static void check_footer(void) {
  static const char *const lines[] = {"@lab 1", "@values 0x1p+0", NULL}, *const two[] = {"two\nlines", NULL},
                           *const taken[] = {"fine", "@n 1 2", NULL};
  conceg_swc_cell c = cell();
  char *text;
  c.footer = lines;
  CHECK_EQUAL(conceg_swc_write(ctx, in_folder("d.swc"), &c), CONCEG_OK);
  text = slurp(in_folder("d.swc"));
  CHECK(text && strstr(text, "\n# @end nodes\n# @lab 1\n# @values 0x1p+0\n") != NULL);
  c.size = offsetof(conceg_swc_cell, footer);
  CHECK_EQUAL(conceg_swc_write(ctx, in_folder("d.swc"), &c), CONCEG_OK);
  text = slurp(in_folder("d.swc"));
  CHECK(text && strstr(text, "@end nodes\n") != NULL && !strstr(text, "@lab"));
  CHECK(unlink(in_folder("d.swc")) == 0);
  c = cell(), c.footer = two, check_refused(&c, CONCEG_E_FORMAT, "footer[0]");
  c = cell(), c.footer = taken, check_refused(&c, CONCEG_E_FORMAT, "footer[1]");
}

/* A piece that is not joined to the soma stays apart from it. */
static void check_floating(void) {
  static const int64_t apart[] = {-1, CONCEG_SWC_FLOATING, 0, 2};
  conceg_swc_cell c = cell();
  conceg_swc *swc = NULL;
  c.parent = apart;
  CHECK_EQUAL(conceg_swc_write(ctx, in_folder("c.swc"), &c), CONCEG_OK);
  CHECK_EQUAL(conceg_swc_read(ctx, in_folder("c.swc"), 0, &swc), CONCEG_OK);
  CHECK_EQUAL(conceg_swc_count(swc), 4);
  CHECK(conceg_swc_on_soma(swc)[0] == 1 && conceg_swc_on_soma(swc)[3] == 0 &&
        conceg_swc_parent(swc)[3] == -1);
  CHECK(conceg_swc_position(swc)[9] == position[3]);
  conceg_swc_free(swc);
  CHECK(unlink(in_folder("c.swc")) == 0);
}

/* A cell without soma; nothing but the files asked for is left in the folder. */
static void check_rest(void) {
  conceg_swc_cell c = cell();
  conceg_swc *swc = NULL;
  c.soma_radius = 0;
  CHECK_EQUAL(conceg_swc_write(ctx, in_folder("b.swc"), &c), CONCEG_OK);
  CHECK_EQUAL(conceg_swc_read(ctx, in_folder("b.swc"), 0, &swc), CONCEG_OK);
  CHECK_EQUAL(conceg_swc_soma(swc, NULL, NULL), CONCEG_SOMA_NONE);
  CHECK_EQUAL(conceg_swc_count(swc), 4);
  conceg_swc_free(swc);
  CHECK(unlink(in_folder("a.swc")) == 0);
  CHECK(unlink(in_folder("b.swc")) == 0);
  CHECK(rmdir(folder) == 0); /* fails when a temporary file was left behind */
}

int main(void) {
  ctx = conceg_ctx_new();
  CHECK(ctx != NULL && mkdtemp(folder) != NULL);
  check_round_trip();
  check_edited();
  check_refusals();
  check_footer();
  check_floating();
  check_rest();
  conceg_ctx_free(ctx);
  return check_done();
}
