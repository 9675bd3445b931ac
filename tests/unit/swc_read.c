/* SPDX-License-Identifier: BSD-3-Clause
 * The SWC reader: every code of spec/swc-plus.md has a file that causes it, in tolerant and in strict mode.
 */
#include "check.h"
#include "conceg/swc.h"

static conceg_ctx *ctx;

static int has_code(const conceg_swc *swc, const char *code, uint32_t line, uint32_t severity) {
  uint32_t i, at, how;
  const char *found, *text;
  for (i = 0; conceg_swc_problem(swc, i, &how, &at, &found, &text); i++)
    if (!strcmp(found, code) && (line == 0 || at == line) && how == severity && *text) return 1;
  return 0;
}

#define SOMA "1 1 0 0 0 5 -1\n"

/* text, problem code, its line, samples in tolerant mode (-1 = an error), 1 = an error in strict mode */
static const struct {
  const char *text, *code;
  uint32_t line;
  int samples, strict;
} cases[] = {
    {SOMA "2 3 6 0 0 1 1\n", NULL, 0, 1, 0},
    {"\r\n  # comment\r\n" SOMA "\t2 3\t6 0 0 1 1  \r\n\r\n3 3 7 0 0 1 2", NULL, 0, 2, 0},
    {"1 1 0 0 0 5 -1\r2 3 6 0 0 1 1\r3 3 7 0 0 1 2\r", "W_EOL", 1, 2, 0},
    {"1,1,0,0,0,5,-1\n2, 3, 6, 0, 0, 1, 1\n", "W_DELIM", 1, 1, 1},
    {SOMA "2 3 6,5 0 0 1 1\n", "E_DELIM", 2, -1, 1},
    {"1,1,0,0,,5,-1\n", "E_DELIM", 1, -1, 1},
    {SOMA "2 3 6 0 0 1 1 # here\n", "W_TRAILING", 2, 1, 0},
    {SOMA "2 3 6 0 0 1 1 9 8\n", "W_COLUMNS", 2, 1, 0},
    {SOMA "2 3 6 0 0 1\n", "E_COLUMNS", 2, -1, 1},
    {SOMA "2 3 6 0 0 # 1 1\n", "E_COLUMNS", 2, -1, 1},
    {"1.0 1.0 0 0 0 5 -1\n2.0 3 6 0 0 1 1.0\n", "W_FLOAT_ID", 1, 1, 1},
    {SOMA "2.5 3 6 0 0 1 1\n", "E_ID", 2, -1, 1},
    {SOMA "99999999999999999999 3 6 0 0 1 1\n", "E_ID", 2, -1, 1},
    {SOMA "2 3 6.0E+0 0 0 1e0 1\n", NULL, 0, 1, 0},
    {SOMA "2 3 nan 0 0 1 1\n", "E_NONFINITE", 2, -1, 1},
    {SOMA "2 3 6 0 0 -inf 1\n", "E_NONFINITE", 2, -1, 1},
    {SOMA "2 3 1e999 0 0 1 1\n", "E_NONFINITE", 2, -1, 1},
    {SOMA "2 3 6 x 0 1 1\n", "E_NUMBER", 2, -1, 1},
    {"\xef\xbb\xbf" SOMA "2 3 6 0 0 1 1\n", "W_BOM", 1, 1, 0},
    {"\xff\xfe"
     "1\0 \0",
     "E_ENCODING", 1, -1, 1},
    {"# caf\xe9\n" SOMA, "W_ENCODING", 1, 0, 0},
    {"", "E_EMPTY", 0, -1, 1},
    {"# nothing\n\n", "E_EMPTY", 0, -1, 1},
    {"A cell from somewhere\n" SOMA "2 3 6 0 0 1 1\n", "W_PROSE", 1, 1, 1},
    {SOMA "% comment\n2 3 6 0 0 1 1\n", "E_PROSE", 2, -1, 1},
    {"0 1 0 0 0 5 -1\n1 3 6 0 0 1 0\n", NULL, 0, 1, 0},
    {SOMA "-2 3 6 0 0 1 1\n", "E_ID", 2, -1, 1},
    {"1 1 0 0 0 5 -7\n2 3 6 0 0 1 1\n", "W_PARENT", 1, 1, 1},
    {"1 1 0 0 0 5 0\n2 3 6 0 0 1 1\n", "W_ROOT0", 1, 1, 1},
    {SOMA "9007199254740993 3 6 0 0 1 1\n4 3 7 0 0 1 9007199254740993\n", NULL, 0, 2, 0},
    {"3 3 7 0 0 1 2\n2 3 6 0 0 1 1\n" SOMA, NULL, 0, 2, 0},
    {SOMA "2 3 6 0 0 1 1\n2 3 6 0 0 1 1\n", "W_DUP", 3, 1, 0},
    {SOMA "2 3 6 0 0 1 1\n2 3 7 0 0 1 1\n", "E_DUP", 3, -1, 1},
    {SOMA "2 3 6 0 0 1 2\n", "E_CYCLE", 2, -1, 1},
    {SOMA "2 3 6 0 0 1 4\n3 3 7 0 0 1 2\n4 3 8 0 0 1 3\n", "E_CYCLE", 2, -1, 1},
    {SOMA "2 3 6 0 0 1 1\n3 3 60 0 0 1 77\n4 3 61 0 0 1 3\n", "W_ORPHAN", 3, 3, 1},
    {SOMA "2 0 6 0 0 1 1\n", NULL, 0, 1, 0},
    {SOMA "2 12 6 0 0 1 1\n", NULL, 0, 1, 0},
    {SOMA "2 256 6 0 0 1 1\n", "W_TYPE", 2, 1, 0},
    {SOMA "2 -1 6 0 0 1 1\n", "W_TYPE", 2, 1, 0},
    {SOMA "2 3 6 0 0 1 1\n3 5 7 0 0 1 2\n4 3 8 1 0 1 3\n5 6 8 -1 0 1 3\n", "W_CNIC", 3, 4, 0},
    {SOMA "2 3 6 0 0 1 1\n3 2 7 0 0 1 2\n4 2 8 0 0 1 3\n", "W_TYPECHANGE", 3, 3, 0},
    {SOMA "2 3 6 0 0 1 1\n3 2 7 1 0 1 2\n4 3 7 -1 0 1 2\n", NULL, 0, 3, 0},
    {SOMA "2 3 6 0 0 0 1\n3 3 7 0 0 -1 2\n", "W_RADIUS", 2, 2, 0},
    {SOMA "2 1 0 0 0 5 -1\n3 3 6 0 0 1 2\n", "W_SOMA_DUP", 2, 1, 0},
    {SOMA "2 1 40 0 0 5 -1\n3 3 6 0 0 1 2\n", "E_SOMATA", 2, -1, 1},
    {"1 3 0 0 0 1 -1\n2 3 6 0 0 1 1\n", "W_NO_SOMA", 0, 2, 0},
    {SOMA "2 3 6 0 0 1 1\n3 2 60 0 0 1 -1\n4 2 61 0 0 1 3\n", "W_FLOATING", 3, 3, 0},
    {SOMA "2 3 6 0 0 1 1\n3 2 60 0 0 1 -1\n", "W_POINT", 3, 2, 0},
    {SOMA "2 3 6 0 0 1 1\n3 1 7 0 0 1 2\n4 3 8 0 0 1 3\n", "W_SOMA_PARENT", 3, 3, 1},
    {"1 3 9 0 0 1 -1\n2 3 6 0 0 1 1\n3 1 0 0 0 5 2\n4 3 -6 0 0 1 3\n", "W_SOMA_PARENT", 3, 3, 1},
    {SOMA "2 3 6 0 0 1 1\n3 3 6 0 0 1 2\n4 3 7 0 0 1 3\n", "W_ZEROLEN", 3, 3, 0},
    {SOMA "2 3 6 0 0 1 1\n3 3 7 0 0 1 2\n4 3 7 1 0 1 2\n5 3 7 2 0 1 2\n", NULL, 0, 4, 0},
    {SOMA "2 1 1 0 0 5 1\n3 1 2 0 0 5 1\n", "W_SOMA_FORM", 1, 0, 0},
    {SOMA "# @begin nodes columns=x\n# @n 1 zzz\n# @end nodes\n", "W_FOOTER", 3, 0, 1},
    {SOMA "2 3 6 0 0 1 1\n# @begin nodes columns=x\n# @n 2 0x1.9p+2\n# @end nodes\n", "W_STALE", 4, 1, 0},
};

static void check_cases(void) {
  size_t i;
  for (i = 0; i < sizeof cases / sizeof *cases; i++) {
    const size_t length =
        i && !strcmp(cases[i].code ? cases[i].code : "", "E_ENCODING") ? 6 : strlen(cases[i].text);
    uint32_t strict;
    for (strict = 0; strict < 2; strict++) {
      const int error = cases[i].samples < 0 || (strict && cases[i].strict);
      conceg_swc *swc = NULL;
      const conceg_status status = conceg_swc_parse(ctx, cases[i].text, length, "case.swc", strict, &swc);
      const int failed = check_failed_;
      CHECK_EQUAL(status, error ? CONCEG_E_FORMAT : CONCEG_OK);
      CHECK(swc != NULL);
      if (!cases[i].code)
        CHECK(!conceg_swc_problem(swc, 0, NULL, NULL, NULL, NULL));
      else
        CHECK(has_code(swc, cases[i].code, cases[i].line, error ? 0 : 1));
      CHECK_EQUAL(conceg_swc_count(swc), error ? 0 : cases[i].samples);
      if (error)
        CHECK(strstr(conceg_ctx_error(ctx), "case.swc:") == conceg_ctx_error(ctx) &&
              strstr(conceg_ctx_error(ctx), cases[i].code));
      if (check_failed_ != failed)
        fprintf(stderr, "  in case %zu (%s), strict %u: %s\n", i, cases[i].code ? cases[i].code : "-", strict,
                cases[i].text);
      conceg_swc_free(swc);
    }
  }
}

static conceg_swc *parse(const char *text) {
  conceg_swc *swc = NULL;
  CHECK_EQUAL(conceg_swc_parse(ctx, text, strlen(text), "text", 0, &swc), CONCEG_OK);
  return swc;
}

/* Preorder with children in the order of their ids, links, and flags; rows shuffled on purpose. */
static void check_tree(void) {
  conceg_swc *swc = parse("7 3 9 0 0 .4 4\n1 1 0 0 0 5 -1\n3 2 0 6 0 .5 1\n4 3 7 0 0 .6 2\n2 3 6 0 0 1 1\n5 "
                          "3 8 1 0 .5 4\n9 2 90 0 0 .1 -1\n8 2 91 0 0 .1 9\n");
  static const double x[] = {6, 7, 8, 9, 0, 90, 91};
  static const int64_t parent[] = {-1, 0, 1, 1, -1, -1, 5};
  static const int on_soma[] = {1, 0, 0, 0, 1, 0, 0}, kind[] = {3, 3, 3, 3, 2, 2, 2},
                   line[] = {5, 4, 6, 1, 3, 7, 8};
  uint64_t i;
  CHECK_EQUAL(conceg_swc_count(swc), 7);
  for (i = 0; i < conceg_swc_count(swc); i++) {
    CHECK_NEAR(conceg_swc_position(swc)[3 * i], x[i], 0);
    CHECK_EQUAL(conceg_swc_parent(swc)[i], parent[i]);
    CHECK_EQUAL(conceg_swc_on_soma(swc)[i], on_soma[i]);
    CHECK_EQUAL(conceg_swc_kind(swc)[i], kind[i]);
    CHECK_EQUAL(conceg_swc_line(swc)[i], line[i]);
  }
  conceg_swc_free(swc);
  /* A soma in the middle: links above it are turned round. */
  swc = parse("1 3 9 0 0 1 -1\n2 3 6 0 0 1 1\n3 1 0 0 0 5 2\n4 3 -6 0 0 1 3\n");
  CHECK_NEAR(conceg_swc_position(swc)[0], 6, 0);
  CHECK_NEAR(conceg_swc_position(swc)[3], 9, 0);
  CHECK_EQUAL(conceg_swc_parent(swc)[1], 0);
  CHECK_EQUAL(conceg_swc_on_soma(swc)[2], 1);
  conceg_swc_free(swc);
  swc = parse(SOMA "2 3 6 0 0 1 1 2.5 x\n3 3 7 0 0 1 2\n");
  CHECK(conceg_swc_column(swc, "column8") != NULL && conceg_swc_column(swc, "column8")[0] == 2.5);
  CHECK(isnan(conceg_swc_column(swc, "column8")[1]) && isnan(conceg_swc_column(swc, "column9")[0]));
  CHECK(conceg_swc_column(swc, "column10") == NULL);
  conceg_swc_free(swc);
}

static void check_soma(const char *text, conceg_soma_form form, double x, double radius) {
  double center[3], got;
  conceg_swc *swc = parse(text);
  CHECK_EQUAL(conceg_swc_soma(swc, center, &got), form);
  CHECK_NEAR(center[0], x, 1e-9);
  CHECK_NEAR(got, radius, 1e-9);
  conceg_swc_free(swc);
}

static void check_somas(void) {
  char ring[4096] = "";
  size_t used = 0;
  int i;
  check_soma("1 3 0 0 0 1 -1\n2 3 1 0 0 1 1\n", CONCEG_SOMA_NONE, 0, 0);
  check_soma("1 1 3 0 0 5 -1\n", CONCEG_SOMA_POINT, 3, 5);
  check_soma("1 1 3 0 0 5 -1\n2 1 3 -5 0 5 1\n3 1 3 5 0 5 1\n4 3 3 6 0 1 2\n", CONCEG_SOMA_THREE_POINT, 3, 5);
  /* A cylinder of radius 2 and length 18: the sphere with its lateral area has r = sqrt(2 * 18 / 2). */
  check_soma("1 1 0 0 0 2 -1\n2 1 9 0 0 2 1\n3 1 18 0 0 2 2\n", CONCEG_SOMA_CHAIN, 9, sqrt(18.0));
  /* One large sample that holds the others. */
  check_soma("1 1 0 0 0 6 -1\n2 1 5 0 0 .3 1\n3 3 7 0 0 .3 2\n", CONCEG_SOMA_CHAIN, 0, 6);
  check_soma("1 1 0 0 0 6 -1\n2 1 5 0 0 .3 1\n3 1 6 1 0 .3 2\n4 1 6 -1 0 .3 2\n", CONCEG_SOMA_TREE, 0, 6);
  for (i = 0; i < 24; i++)
    used +=
        (size_t)snprintf(ring + used, sizeof ring - used, "%d 1 %.12f %.12f 0 0 %d\n", i + 1,
                         2 + 4 * cos(i * 0.26179938779914943), 4 * sin(i * 0.26179938779914943), i ? i : -1);
  check_soma(ring, CONCEG_SOMA_CONTOUR, 2, 4);
}

/* Numbers are correctly rounded: compared with the C library over many forms. */
static void check_numbers(void) {
  uint64_t state = 88172645463325252ull;
  char text[256], digits[64];
  int i;
  for (i = 0; i < 20000; i++) {
    conceg_swc *swc = NULL;
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    switch (i % 5) {
    case 0:
      snprintf(digits, sizeof digits, "%.4f", (double)(int64_t)state / 1e15);
      break;
    case 1:
      snprintf(digits, sizeof digits, "%.17g", (double)(int64_t)state * 1e-12);
      break;
    case 2:
      snprintf(digits, sizeof digits, "%llue-%d", (unsigned long long)state, (int)(state % 40));
      break;
    case 3:
      snprintf(digits, sizeof digits, "0.%030llu", (unsigned long long)state);
      break;
    default:
      snprintf(digits, sizeof digits, "%a", (double)(int64_t)state * 1e-9);
      break;
    }
    snprintf(text, sizeof text, SOMA "2 3 %s 0 0 1 1\n", digits);
    CHECK_EQUAL(conceg_swc_parse(ctx, text, strlen(text), "number", 0, &swc), CONCEG_OK);
    if (conceg_swc_count(swc) && conceg_swc_position(swc)[0] != strtod(digits, NULL)) {
      CHECK(!"correctly rounded");
      fprintf(stderr, "  %s: expected %a, got %a\n", digits, strtod(digits, NULL),
              conceg_swc_position(swc)[0]);
    }
    conceg_swc_free(swc);
  }
}

/* Ties and near ties between two doubles, in whole and fractional digits, where a second rounding would show.
 */
static void check_ties(void) {
  static const char *const digits[] = {"9007199254740993",
                                       "9007199254740992.5",
                                       "9007199254740993.5",
                                       "9007199254740995",
                                       "18014398509481982",
                                       "18014398509481987",
                                       "9223372036854775807",
                                       "1844674407370955161.5",
                                       "900719925474099.25",
                                       "0.9007199254740993",
                                       "0.1000000000000000056",
                                       "123456.7890123456789",
                                       "9999999999999999999",
                                       "0.0000000000000000001",
                                       "1.000000000000000111",
                                       "1.0000000000000001110",
                                       "1.000000000000000112",
                                       "9007199254740993e3",
                                       "9007199254740993e19",
                                       "9007199254740993e-19",
                                       "9007199254740993e20",
                                       "1e22",
                                       "1e23",
                                       "000000000000000000000012.5",
                                       "12.50000000000000000000000000",
                                       "0.9448099766859293092",
                                       "0.2699549814031953210",
                                       "1.607944710337317340",
                                       "5.574912896965761977",
                                       "85.53217338906316769",
                                       "81.57170922883336317",
                                       "4.9e-324",
                                       "2.2250738585072011e-308"};
  char text[256];
  size_t i;
  for (i = 0; i < sizeof digits / sizeof *digits; i++) {
    conceg_swc *swc = NULL;
    snprintf(text, sizeof text, SOMA "2 3 0 -%s 0 1 1\n", digits[i]);
    CHECK_EQUAL(conceg_swc_parse(ctx, text, strlen(text), "tie", 0, &swc), CONCEG_OK);
    CHECK_EQUAL(conceg_swc_count(swc), 1);
    if (conceg_swc_count(swc) && conceg_swc_position(swc)[1] != -strtod(digits[i], NULL)) {
      CHECK(!"correctly rounded");
      fprintf(stderr, "  %s: got %a\n", digits[i], conceg_swc_position(swc)[1]);
    }
    conceg_swc_free(swc);
  }
}

static int same_reading(const conceg_swc *a, const conceg_swc *b) {
  const uint64_t count = conceg_swc_count(a);
  uint32_t i, line[2], severity[2];
  const char *code[2], *what[2];
  if (count != conceg_swc_count(b)) return 0;
  for (i = 0; conceg_swc_problem(a, i, &severity[0], &line[0], &code[0], &what[0]); i++)
    if (!conceg_swc_problem(b, i, &severity[1], &line[1], &code[1], &what[1]) || severity[0] != severity[1] ||
        line[0] != line[1] || strcmp(code[0], code[1]) != 0 || strcmp(what[0], what[1]) != 0)
      return 0;
  return !conceg_swc_problem(b, i, NULL, NULL, NULL, NULL) &&
         !memcmp(conceg_swc_position(a), conceg_swc_position(b), count * 3 * sizeof(double)) &&
         !memcmp(conceg_swc_radius(a), conceg_swc_radius(b), count * sizeof(double)) &&
         !memcmp(conceg_swc_parent(a), conceg_swc_parent(b), count * sizeof(int64_t)) &&
         !memcmp(conceg_swc_line(a), conceg_swc_line(b), count * sizeof(uint32_t));
}

/* A file is read in pieces: wherever they end, in a number, between CR and LF or in a long comment, the
 * reading is that of the whole text. */
static void check_pieces(void) {
  static const char *const line_end[] = {"\n", "\r\n", "\r"};
  const size_t room = 2 << 20;
  char *text = malloc(room), path[] = "swc_pieces.swc";
  size_t shift, ends;
  CHECK(text != NULL);
  for (ends = 0; text && ends < 3; ends++)
    for (shift = 0; shift < 40; shift += ends == 1 ? 1 : 7) {
      size_t length = (size_t)snprintf(text, room, "#%*s%s", (int)shift, "", line_end[ends]);
      conceg_swc *whole = NULL, *pieces = NULL;
      FILE *file;
      int i;
      for (i = 1; length < room / 2; i++) {
        length += (size_t)snprintf(text + length, room - length, "%d %d %d.25 0 0 0.5 %d%s", i,
                                   i % 1000 ? 3 : 7, i, i > 1 ? i - 1 : -1, line_end[ends]);
        if (i == 15000) {
          memset(text + length, '#', 300000);
          length += 300000;
          length += (size_t)snprintf(text + length, room - length, "%s", line_end[ends]);
        }
      }
      file = fopen(path, "wb");
      CHECK(file && fwrite(text, 1, length, file) == length && fclose(file) == 0);
      CHECK_EQUAL(conceg_swc_parse(ctx, text, length, path, 0, &whole), CONCEG_OK);
      CHECK_EQUAL(conceg_swc_read(ctx, path, 0, &pieces), CONCEG_OK);
      CHECK(conceg_swc_count(whole) > 20000 && same_reading(whole, pieces));
      conceg_swc_free(whole), conceg_swc_free(pieces);
    }
  remove(path);
  free(text);
}

/* Any bytes: no crash, and either samples or an error with a line. */
static void check_garbage(void) {
  static const char seed[] =
      "# SWC-plus 1.0\n" SOMA "2 3 6.5 0 0 1 1\n3 3 7 -1.25e1 0 .5 2\n4 2 7 1 0 .5 2\n5 2 8 1 0 .5 4 7\n"
      "# @begin nodes columns=x,y,q\n# @n 2 0x1.ap+2 0x0p+0 -\n# @n 9 1 2 3\n# @end nodes\n";
  static const char spice[] = "0123456789-+.eExXpP#,@ \n\r\t\0nan\xff";
  static const uint32_t flags[8] = {0,
                                    CONCEG_SWC_STRICT,
                                    CONCEG_SWC_SPLIT,
                                    CONCEG_SWC_DROP_FLOATING,
                                    CONCEG_SWC_ATTACH_FLOATING,
                                    CONCEG_SWC_SPLIT | CONCEG_SWC_ATTACH_FLOATING,
                                    CONCEG_SWC_SPLIT | CONCEG_SWC_DROP_FLOATING,
                                    CONCEG_SWC_STRICT | CONCEG_SWC_SPLIT};
  char text[sizeof seed];
  uint64_t state = 12345;
  int i, k;
  for (i = 0; i < 20000; i++) {
    conceg_swc *swc = NULL;
    conceg_status status;
    size_t length = sizeof seed - 1;
    memcpy(text, seed, sizeof seed);
    for (k = 0; k <= i % 8; k++) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      text[(state >> 33) % length] = i % 3 ? spice[(state >> 20) % (sizeof spice - 1)] : (char)(state >> 56);
    }
    if (i % 7 == 0) length = (state >> 40) % length;
    status = conceg_swc_parse(ctx, text, length, "garbage", flags[i % 8], &swc);
    CHECK(swc != NULL && (status == CONCEG_OK || status == CONCEG_E_FORMAT));
    CHECK(status != CONCEG_OK || conceg_swc_count(swc) <= 6);
    conceg_swc_free(swc);
  }
}

int main(void) {
  conceg_swc *swc = NULL;
  ctx = conceg_ctx_new();
  CHECK(ctx != NULL);
  check_cases();
  check_tree();
  check_somas();
  check_numbers();
  check_ties();
  check_pieces();
  check_garbage();
  CHECK_EQUAL(conceg_swc_read(ctx, "no/such/file.swc", 0, &swc), CONCEG_E_IO);
  CHECK(swc == NULL && strstr(conceg_ctx_error(ctx), "no/such/file.swc"));
  CHECK_EQUAL(conceg_swc_read(ctx, ".", 0, &swc), CONCEG_E_IO);
  conceg_swc_free(NULL);
  conceg_ctx_free(ctx);
  return check_done();
}
