/* SPDX-License-Identifier: BSD-3-Clause
 * What a stranger's file can make the library allocate (CGX-016, and the bounds of recipes): planted files
 * that are small and claim much, each opened and read whole in a process of its own whose peak is measured.
 */
#define _XOPEN_SOURCE 700
#include "../unit/damage.h"
#include "../unit/hdf5_leaks.h"
#include "../unit/sample.h"

#include "conceg/params.h"

#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

/* The address sanitizer's own memory hides ours: there only the statuses are checked. */
#ifdef __SANITIZE_ADDRESS__
enum { MEASURED = 0 };
#else
enum { MEASURED = 1 };
#endif

static char good[256], bad[256];

/* Kibibytes of address space: "VmSize" now, "VmPeak" at most so far. */
static long address_space(const char *word) {
  char line[256];
  long found = 0;
  FILE *file = fopen("/proc/self/status", "r");
  while (file && fgets(line, sizeof line, file))
    if (!strncmp(line, word, strlen(word))) found = strtol(line + strlen(word) + 1, NULL, 10);
  if (file) fclose(file);
  return found;
}

struct outcome {
  int status;
  long kibibytes;
  char error[4096];
};

static conceg_status read_all(conceg_doc *doc, const char *group) {
  conceg_status worst = CONCEG_OK;
  for (uint64_t i = 0; i < conceg_doc_children(doc, group); i++) {
    const char *path = conceg_doc_child(doc, group, i);
    conceg_array array = {.size = sizeof array};
    const conceg_status status =
        path[strlen(path) - 1] == '/' ? read_all(doc, path) : conceg_doc_read(doc, path, &array);
    if (status != CONCEG_OK) worst = status;
  }
  return worst;
}

static conceg_status use_document(conceg_ctx *ctx, const void *path, size_t unused) {
  char hex[65];
  conceg_doc *doc = NULL;
  (void)unused;
  conceg_status status = conceg_doc_open(ctx, path, &doc);
  if (status == CONCEG_OK) status = read_all(doc, "/");
  if (status == CONCEG_OK) status = conceg_doc_digest(doc, "/", hex);
  if (status == CONCEG_OK && conceg_doc_validate(doc, NULL, NULL, NULL) == CONCEG_E_NOMEM)
    status = CONCEG_E_NOMEM;
  if (conceg_doc_close(doc) != CONCEG_OK && status == CONCEG_OK) status = CONCEG_E_IO;
  return status;
}

static conceg_status use_recipe(conceg_ctx *ctx, const void *text, size_t unused) {
  conceg_recipe *recipe = NULL;
  (void)unused;
  const conceg_status status = conceg_recipe_parse(ctx, text, "recipe.yaml", &recipe);
  conceg_recipe_free(recipe);
  return status;
}

/* Runs one use in a child; a crash or a hang is a status of its own. */
static struct outcome in_child(conceg_status (*use)(conceg_ctx *, const void *, size_t), const void *data,
                               size_t length) {
  struct outcome outcome = {.status = 1};
  int ends[2];
  CHECK_EQUAL(pipe(ends), 0);
  const pid_t pid = fork();
  if (pid == 0) {
    alarm(60);
    conceg_ctx *ctx = conceg_ctx_new();
    const long before = address_space("VmSize:");
    outcome.status = use(ctx, data, length);
    outcome.kibibytes = address_space("VmPeak:") - before;
    snprintf(outcome.error, sizeof outcome.error, "%s", conceg_ctx_error(ctx));
    conceg_ctx_free(ctx);
    _exit(write(ends[1], &outcome, sizeof outcome) != sizeof outcome);
  }
  close(ends[1]);
  if (read(ends[0], &outcome, sizeof outcome) != sizeof outcome) outcome.status = 1;
  close(ends[0]);
  waitpid(pid, NULL, 0);
  return outcome;
}

/* `most` in bytes is what the rules allow for an input of `length` bytes; HDF5 itself and malloc get 48 MiB.
 */
static void judge(const char *name, const struct outcome *outcome, uint64_t length, uint64_t most,
                  conceg_status status, const char *words) {
  const uint64_t allowed = most + ((uint64_t)48 << 20);
  printf("%-22s %9llu bytes: %-8s peak %7.1f MiB of %8.1f\n", name, (unsigned long long)length,
         outcome->status == 1 ? "CRASHED" : conceg_status_name(outcome->status),
         (double)outcome->kibibytes / 1024, (double)allowed / 1048576);
  CHECK_EQUAL(outcome->status, status);
  CHECK(!MEASURED || (uint64_t)outcome->kibibytes * 1024 <= allowed);
  if (strstr(outcome->error, words)) return;
  fprintf(stderr, "%s: expected \"%s\" in \"%s\"\n", name, words, outcome->error);
  CHECK(!"the message says what is too large");
}

/* `factor`: 64 for what opening may take, 256 where an array is read too. */
static void document(const char *name, uint64_t factor, conceg_status status, const char *words) {
  struct stat info;
  CHECK_EQUAL(stat(bad, &info), 0);
  const uint64_t length = (uint64_t)info.st_size;
  const struct outcome outcome = in_child(use_document, bad, 0);
  judge(name, &outcome, length, factor * length + ((uint64_t)16 << 20), status, words);
}

/* A recipe's nodes cost about 100 bytes for each of the million that are allowed, its text a few times
 * itself. */
static void recipe(const char *name, const char *text, size_t length, const char *words) {
  const struct outcome outcome = in_child(use_recipe, text, length);
  judge(name, &outcome, length, ((uint64_t)192 << 20) + 8 * length, CONCEG_E_FORMAT, words);
}

static hid_t copy_good(void) {
  char command[600];
  snprintf(command, sizeof command, "cp '%s' '%s'", good, bad);
  CHECK_EQUAL(system(command), 0);
  return damage_open(bad);
}

/* Levels of groups, each with several long names for the next: few bytes, and a tree without end. */
static void plant_names(hid_t file) {
  char name[450];
  hid_t at = H5Gcreate2(file, "/x_names", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  for (int level = 0; level < 13; level++) {
    const hid_t next = H5Gcreate_anon(file, H5P_DEFAULT, H5P_DEFAULT);
    for (int i = 0; i < 6; i++) {
      snprintf(name, sizeof name, "%0440d", i);
      CHECK(H5Olink(next, at, name, H5P_DEFAULT, H5P_DEFAULT) >= 0);
    }
    H5Gclose(at);
    at = next;
  }
  H5Gclose(at);
}

/* One group with a large attribute, under many names. */
static void plant_links(hid_t file) {
  static char text[60000];
  char name[32];
  memset(text, 'a', sizeof text - 1);
  const hid_t group = H5Gcreate2(file, "/x_links", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t one = H5Gcreate2(group, "one", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  damage_text_attribute(one, ".", "large", text);
  for (int i = 0; i < 5000; i++) {
    snprintf(name, sizeof name, "n%d", i);
    CHECK(H5Olink(one, group, name, H5P_DEFAULT, H5P_DEFAULT) >= 0);
  }
  H5Gclose(one);
  H5Gclose(group);
}

/* Many strings of variable length that are all the same long bytes of the file. */
static void plant_strings(hid_t file) {
  enum { COUNT = 20000, LONG = 200000 };
  const char **strings = malloc(COUNT * sizeof *strings);
  char *text = calloc(LONG + 1, 1);
  const hsize_t count = COUNT;
  memset(text, 'a', LONG);
  for (int i = 0; i < COUNT; i++)
    strings[i] = i ? "b" : text;
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  damage_dataset(file, "/x_strings", type, 1, &count, H5P_DEFAULT, strings);
  H5Tclose(type);
  free(strings);
  free(text);
  const hid_t dataset = H5Dopen2(file, "/x_strings", H5P_DEFAULT);
  const haddr_t offset = H5Dget_offset(dataset);
  H5Dclose(dataset);
  damage_close(file);
  unsigned char first[16];
  FILE *bytes = fopen(bad, "r+b");
  CHECK(bytes && fseek(bytes, (long)offset, SEEK_SET) == 0 && fread(first, sizeof first, 1, bytes) == 1);
  fseek(bytes, (long)offset, SEEK_SET);
  for (int i = 0; i < COUNT; i++)
    CHECK(fwrite(first, sizeof first, 1, bytes) == 1);
  fclose(bytes);
}

/* The bytes of an array look like heaps of strings, each inside the one before. */
static void plant_heaps(hid_t file) {
  const hsize_t count = (hsize_t)16 << 20;
  unsigned char *bytes = calloc(count, 1);
  for (uint64_t at = 0; at + 64 <= count; at += 32) {
    const uint64_t size = count - at, inside = size - 32;
    memcpy(bytes + at, "GCOL\1\0\0", 8);
    memcpy(bytes + at + 8, &size, 8);
    bytes[at + 16] = 1;
    memcpy(bytes + at + 24, &inside, 8);
  }
  damage_dataset(file, "/x_heaps", H5T_STD_U8LE, 1, &count, H5P_DEFAULT, bytes);
  free(bytes);
}

static void plant_one_string(hid_t file) {
  const char *string = "a";
  const hsize_t one = 1;
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  damage_dataset(file, "/x_string", type, 1, &one, H5P_DEFAULT, &string);
  H5Tclose(type);
}

static void plant_string_attribute(hid_t file) {
  const char *strings[100];
  for (int i = 0; i < 100; i++)
    strings[i] = "a";
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  damage_attribute(file, "/cells", "x_strings", type, 100, strings);
  H5Tclose(type);
}

/* A dataset of zeros in chunks with the filters that `list` names already. */
static void plant_chunks(hid_t file, hid_t list, hsize_t rows, hsize_t chunk, int write) {
  const hsize_t most = H5S_UNLIMITED;
  H5Pset_chunk(list, 1, &chunk);
  const hid_t space = H5Screate_simple(1, &rows, &most);
  const hid_t dataset = H5Dcreate2(file, "/x_chunks", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
  CHECK(dataset >= 0);
  if (write) {
    double *zeros = calloc(rows, sizeof *zeros);
    CHECK(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros) >= 0);
    free(zeros);
  }
  H5Dclose(dataset);
  H5Sclose(space);
  H5Pclose(list);
}

/* Many children and attributes in no order: none of the work may grow with their square. */
static void plant_many(hid_t file, int count) {
  char name[32];
  const hid_t links = H5Pcreate(H5P_GROUP_CREATE);
  H5Pset_link_phase_change(links, 0, 0);
  H5Pset_attr_phase_change(links, 0, 0);
  const hid_t group = H5Gcreate2(file, "/x_many", H5P_DEFAULT, links, H5P_DEFAULT);
  const hid_t space = H5Screate(H5S_SCALAR);
  for (int i = 0; i < count; i++) {
    const uint8_t value = 0;
    snprintf(name, sizeof name, "n%08x", (unsigned)i * 2654435761u);
    const hid_t attribute = H5Acreate2(group, name, H5T_STD_U8LE, space, H5P_DEFAULT, H5P_DEFAULT);
    CHECK(attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_UINT8, &value) >= 0);
    H5Aclose(attribute);
    const hid_t child = H5Gcreate2(group, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    CHECK(child >= 0);
    H5Gclose(child);
  }
  H5Sclose(space);
  H5Pclose(links);
  H5Gclose(group);
}

static void test_documents(void) {
  hid_t file = copy_good();
  damage_close(file);
  document("a good document", 64, CONCEG_OK, "");
  plant_names(file = copy_good());
  damage_close(file);
  document("groups of many names", 64, CONCEG_E_FORMAT, "CGX-016");
  plant_links(file = copy_good());
  damage_close(file);
  document("attribute, many names", 64, CONCEG_E_FORMAT, "CGX-016");
  plant_strings(copy_good());
  document("strings, same bytes", 256, CONCEG_E_FORMAT, "CGX-016");
  plant_heaps(file = copy_good());
  plant_one_string(file);
  damage_close(file);
  document("heaps inside heaps", 64, CONCEG_E_FORMAT, "well-formed heap");
  plant_string_attribute(file = copy_good());
  damage_close(file);
  document("strings of attribute", 64, CONCEG_E_FORMAT, "at most 64 strings");
  plant_chunks(file = copy_good(), H5Pcreate(H5P_DATASET_CREATE), 10, 1 << 28, 0);
  damage_close(file);
  document("a chunk of 2 GiB", 64, CONCEG_E_FORMAT, "a chunk claims");
  hid_t list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_deflate(list, 9);
  H5Pset_deflate(list, 9);
  plant_chunks(file = copy_good(), list, 1 << 20, 1 << 20, 1);
  damage_close(file);
  document("deflated twice", 64, CONCEG_E_FORMAT, "no filter but");
  list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_nbit(list);
  plant_chunks(file = copy_good(), list, 1000, 1000, 1);
  damage_close(file);
  document("filter nbit", 64, CONCEG_E_FORMAT, "no filter but");
  list = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_deflate(list, 9);
  plant_chunks(file = copy_good(), list, 1 << 24, 1 << 20, 1);
  damage_close(file);
  document("deflated 1000 times", 64, CONCEG_E_FORMAT, "CGX-006");
  plant_many(file = copy_good(), 30000);
  damage_close(file);
  document("30000 names, unsorted", 64, CONCEG_OK, "");
}

static char *repeat(const char *head, const char *text, size_t count, size_t *length) {
  const size_t first = strlen(head), each = strlen(text);
  char *all = malloc(first + each * count + 1);
  memcpy(all, head, first);
  for (size_t i = 0; i < count; i++)
    memcpy(all + first + i * each, text, each);
  *length = first + each * count;
  all[*length] = '\0';
  return all;
}

static void test_recipes(void) {
  size_t length, more;
  char *text = repeat("a: &x '", "0123456789abcdef", 1 << 16, &length);
  char *aliases = repeat("'\nb: [*x", ",*x", 100000, &more);
  char *all = malloc(length + more + 2);
  memcpy(all, text, length);
  memcpy(all + length, aliases, more);
  memcpy(all + length + more, "]", 2);
  recipe("aliases of a text", all, length + more + 1, "16 MiB");
  free(all), free(aliases), free(text);
  static const char laughs[] =
      "a: &a [1,1,1,1,1,1,1,1,1,1]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a,*a]\n"
      "c: &c [*b,*b,*b,*b,*b,*b,*b,*b,*b,*b]\nd: &d [*c,*c,*c,*c,*c,*c,*c,*c,*c,*c]\n"
      "e: &e [*d,*d,*d,*d,*d,*d,*d,*d,*d,*d]\nf: &f [*e,*e,*e,*e,*e,*e,*e,*e,*e,*e]\n";
  recipe("aliases of aliases", laughs, sizeof laughs - 1, "1000000 values");
  text = repeat("a: [1", ",&x []", 500000, &length);
  recipe("anchors without end", text, length, "256 anchors");
  free(text);
  text = repeat("a: ", "[", 1000000, &length);
  recipe("nested without end", text, length, "32 deep");
  free(text);
  text = repeat("a: [1", ",1", 4000000, &length);
  recipe("values without end", text, length, "1000000 values");
  free(text);
  text = repeat("", "a", ((size_t)16 << 20) + 1, &length);
  recipe("16 MiB and one", text, length, "16 MiB");
  free(text);
}

int main(void) {
  conceg_ctx *ctx = sample_ctx();
  sample_path(good, "good.cgx");
  sample_path(bad, "bad.cgx");
  conceg_doc *doc = sample_doc(ctx);
  CHECK_EQUAL(conceg_doc_save(doc, good), CONCEG_OK);
  conceg_doc_close(doc);
  test_documents();
  test_recipes();
  conceg_ctx_free(ctx);
  sample_clean();
  return check_done();
}
