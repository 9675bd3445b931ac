/* SPDX-License-Identifier: BSD-3-Clause
 * spec/cgx.md against spec/schema.yaml and the validator: every array of the schema has its row with the same
 * type, shape and unit; every rule that the library names is written down. SOURCE_FOLDER is the checkout. */
#include "check.h"

static char *read_text(const char *name) {
  char path[1024];
  snprintf(path, sizeof path, "%s/%s", SOURCE_FOLDER, name);
  FILE *file = fopen(path, "rb");
  CHECK(file != NULL);
  if (!file) exit(1);
  char *text = calloc(1 << 20, 1);
  CHECK(fread(text, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  return text;
}

/* The value of "key: value" in a flow mapping, up to the comma or brace that ends it; brackets are kept
 * whole. */
static int value_of(const char *line, const char *key, char value[128]) {
  const char *at = strstr(line, key);
  size_t length = 0;
  int depth = 0;
  value[0] = '\0';
  if (!at) return 0;
  for (at += strlen(key); *at && length < 127; at++) {
    if (*at == '[') depth++;
    if (depth == 0 && (*at == ',' || *at == '}')) break;
    if (*at == ']') depth--;
    if (*at != '"') value[length++] = *at;
  }
  value[length] = '\0';
  return 1;
}

static void test_arrays(const char *cgx) {
  char *schema = read_text("spec/schema.yaml"), group[64] = "", row[1024];
  int items = 0, groups = 0;
  for (char *line = strtok(schema, "\n"); line; line = strtok(NULL, "\n")) {
    char name[128], type[128], shape[128], unit[128];
    if (strncmp(line, "  - name: ", 10) == 0) {
      snprintf(group, sizeof group, "%.*s", (int)strcspn(line + 10, " #"), line + 10);
      snprintf(row, sizeof row, "### /%s\n", group);
      if (!strstr(cgx, row)) fprintf(stderr, "not in cgx.md: %s", row);
      CHECK(strstr(cgx, row) != NULL);
      groups++;
    }
    if (strcmp(group, "") != 0 && strncmp(line, "depends:", 8) == 0) break;
    if (!value_of(line, "{name: ", name) || !value_of(line, "type: ", type)) continue;
    CHECK(value_of(line, "shape: ", shape));
    value_of(line, "unit: ", unit);
    const char *between = strstr(line, "kind: attribute") ? "@" : "/";
    snprintf(row, sizeof row, "| `%s%s%s%s` | %s | %s | %s |", *group ? "/" : "", group,
             *group ? between : "/@", name, type, shape, unit);
    if (!strstr(cgx, row)) fprintf(stderr, "not in cgx.md: %s\n", row);
    CHECK(strstr(cgx, row) != NULL);
    items++;
  }
  CHECK(items > 100 && groups > 10);
  free(schema);
}

static void test_rules(const char *cgx) {
  static const char *const sources[] = {
      "validate.c", "validate_form.c", "validate_values.c", "validate_links.c", "validate_tissue.c",
      "stream.c",   "doc.c",           "h5_read.c"};
  char path[64], rule[16];
  int rules = 0;
  for (size_t i = 0; i < sizeof sources / sizeof *sources; i++) {
    snprintf(path, sizeof path, "libconceg/src/%s", sources[i]);
    char *text = read_text(path);
    for (const char *at = text; (at = strstr(at, "CGX-0")); at += 7) {
      snprintf(rule, sizeof rule, "| %.7s |", at);
      if (!strstr(cgx, rule)) fprintf(stderr, "not in cgx.md: %s\n", rule);
      CHECK(strstr(cgx, rule) != NULL);
      rules++;
    }
    free(text);
  }
  CHECK(rules > 30);
}

int main(void) {
  char *cgx = read_text("spec/cgx.md");
  test_arrays(cgx);
  test_rules(cgx);
  free(cgx);
  return check_done();
}
