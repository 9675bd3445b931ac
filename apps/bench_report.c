/* SPDX-License-Identifier: BSD-3-Clause
 * What conceg bench scaling writes of its rows: JSON with the machine, and the figure. */
#define _GNU_SOURCE
#include "bench.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* ---- JSON ---- */

/* The value after "name ... :" in a file of /proc; "unknown" where there is none. Quotes and what is not text
 * go. */
static void proc_value(const char *path, const char *name, char *out, size_t size) {
  char line[512];
  FILE *in = fopen(path, "re");
  snprintf(out, size, "unknown");
  while (in && fgets(line, sizeof line, in)) {
    char *value = strchr(line, ':'), *c;
    if (strncmp(line, name, strlen(name)) != 0 || !value) continue;
    value += 1 + strspn(value + 1, " \t");
    value[strcspn(value, "\n")] = '\0';
    for (c = value; *c; c++)
      if (*c == '"' || *c == '\\' || (unsigned char)*c < ' ') *c = ' ';
    snprintf(out, size, "%s", value);
    break;
  }
  if (in) fclose(in);
}

static void json_fit(FILE *out, const char *name, const struct bench_fit *fit, const char *end) {
  if (fit->rows < 3)
    fprintf(out, "    \"%s\": null%s\n", name, end);
  else
    fprintf(out,
            "    \"%s\": {\"exponent\": %.4f, \"standard_error\": %.4f, \"boxes\": %u, \"from_um\": %g, "
            "\"seconds_at_100_um\": %.1f}%s\n",
            name, fit->exponent, fit->error, fit->rows, fit->from_um, fit->seconds_at_100_um, end);
}

/* 1 when an earlier stage has the same name: a recipe may grow twice. */
static int is_repeated(const struct bench_row *row, uint32_t index) {
  uint32_t i;
  for (i = 0; i < index; i++)
    if (!strcmp(row->stage[i].kind, row->stage[index].kind)) return 1;
  return 0;
}

static void json_row(FILE *out, const struct bench_row *r, const char *end) {
  uint32_t k;
  fprintf(
      out,
      "    {\"side_um\": %g, \"cells_asked\": %llu, \"cells\": %llu, \"nodes\": %llu, \"triangles\": %llu, "
      "\"icvf\": %.6f, \"load_before\": %.2f, \"wall_s\": %.3f, \"user_s\": %.3f, \"stages\": [",
      r->side_um, (unsigned long long)r->cells_asked, (unsigned long long)r->cells,
      (unsigned long long)r->nodes, (unsigned long long)r->triangles, r->icvf, r->load, bench_wall(r),
      bench_user(r));
  for (k = 0; k < r->stages; k++)
    fprintf(out,
            "%s\n      {\"stage\": \"%s\", \"wall_s\": %.3f, \"user_s\": %.3f, \"system_s\": %.3f, "
            "\"peak_mib\": %.1f}",
            k ? "," : "", r->stage[k].kind, r->stage[k].wall_s, r->stage[k].user_s, r->stage[k].system_s,
            r->stage[k].peak_mib);
  fprintf(out, "]}%s\n", end);
}

void bench_json(FILE *out, const struct bench_rows *rows, const struct bench_key *key) {
  char processor[256], memory[64];
  const struct bench_fit wall = bench_fit_rows(rows, NULL, 0), user = bench_fit_rows(rows, NULL, 1);
  uint32_t i;
  proc_value("/proc/cpuinfo", "model name", processor, sizeof processor);
  proc_value("/proc/meminfo", "MemTotal", memory, sizeof memory);
  fprintf(out, "{\n  \"recipe\": \"%s\", \"version\": \"%s\", \"seed\": %llu, \"threads\": %u,\n",
          key->recipe, key->version, (unsigned long long)key->seed, key->threads);
  fprintf(out, "  \"machine\": {\"processor\": \"%s\", \"processors\": %ld, \"memory\": \"%s\"},\n",
          processor, sysconf(_SC_NPROCESSORS_ONLN), memory);
  fprintf(out, "  \"paper\": {\"exponent\": %g, \"seconds_at_100_um\": %g},\n  \"fits\": {\n",
          BENCH_PAPER_EXPONENT, BENCH_PAPER_SECONDS);
  for (i = 0; rows->count && i < rows->row[0].stages; i++) {
    const struct bench_fit stage = bench_fit_rows(rows, rows->row[0].stage[i].kind, 0);
    if (!is_repeated(&rows->row[0], i)) json_fit(out, rows->row[0].stage[i].kind, &stage, ",");
  }
  json_fit(out, "all_wall", &wall, ",");
  json_fit(out, "all_user_cpu", &user, "");
  fprintf(out, "  },\n  \"boxes\": [\n");
  for (i = 0; i < rows->count; i++)
    json_row(out, &rows->row[i], i + 1 < rows->count ? "," : "");
  fprintf(out, "  ]\n}\n");
}

/* ---- The figure: seconds against volume, both logarithmic ---- */

#define LEFT 62.0
#define TOP 30.0
#define WIDTH 330.0
#define HEIGHT 250.0

struct frame {
  double low_x, high_x, low_y, high_y; /* log10 of um^3 and s */
};

static double place_x(const struct frame *f, double log10_x) {
  return LEFT + WIDTH * (log10_x - f->low_x) / (f->high_x - f->low_x);
}
static double place_y(const struct frame *f, double log10_y) {
  return TOP + HEIGHT * (1 - (log10_y - f->low_y) / (f->high_y - f->low_y));
}

static struct frame frame_of(const struct bench_rows *rows) {
  struct frame f = {6, 6, 0, log10(BENCH_PAPER_SECONDS)};
  uint32_t i, k;
  for (i = 0; i < rows->count; i++) {
    const double x = 3 * log10(rows->row[i].side_um), y = log10(fmax(1e-3, bench_wall(&rows->row[i])));
    f.low_x = fmin(f.low_x, x), f.high_x = fmax(f.high_x, x), f.high_y = fmax(f.high_y, y);
    f.low_y = fmin(f.low_y, y);
    for (k = 0; k < rows->row[i].stages; k++)
      f.low_y = fmin(f.low_y, log10(fmax(0.01, rows->row[i].stage[k].wall_s)));
  }
  f.low_x -= 0.2, f.high_x += 0.2, f.low_y -= 0.2, f.high_y += 0.2;
  return f;
}

static void svg_text(FILE *out, double x, double y, const char *anchor, const char *words) {
  fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x, y, anchor, words);
}

static void svg_axes(FILE *out, const struct frame *f) {
  double at;
  char power[64];
  fprintf(out, "<path d=\"M%.1f %.1fV%.1fH%.1f\" fill=\"none\" stroke=\"#444\"/>\n", LEFT, TOP, TOP + HEIGHT,
          LEFT + WIDTH);
  for (at = ceil(f->low_x); at <= f->high_x; at++) {
    fprintf(out, "<path d=\"M%.1f %.1fv4\" stroke=\"#444\"/>\n", place_x(f, at), TOP + HEIGHT);
    snprintf(power, sizeof power, "10<tspan dy=\"-4\" font-size=\"8\">%.0f</tspan>", at);
    svg_text(out, place_x(f, at), TOP + HEIGHT + 17, "middle", power);
  }
  for (at = ceil(f->low_y); at <= f->high_y; at++) {
    fprintf(out, "<path d=\"M%.1f %.1fh-4\" stroke=\"#444\"/>\n", LEFT, place_y(f, at));
    snprintf(power, sizeof power, "%g", pow(10, at));
    svg_text(out, LEFT - 7, place_y(f, at) + 4, "end", power);
  }
  svg_text(out, LEFT + WIDTH / 2, TOP + HEIGHT + 36, "middle", "volume of the box (um\302\263)");
  fprintf(out,
          "<text transform=\"translate(16 %.1f) rotate(-90)\" text-anchor=\"middle\">wall time (s)</text>\n",
          TOP + HEIGHT / 2);
}

/* seconds = at_100_um (V / 1e6)^exponent over the whole width. */
static void svg_law(FILE *out, const struct frame *f, double at_100_um, double exponent, const char *style) {
  const double left = log10(at_100_um) + exponent * (f->low_x - 6),
               right = log10(at_100_um) + exponent * (f->high_x - 6);
  fprintf(out, "<path d=\"M%.1f %.1fL%.1f %.1f\" fill=\"none\" clip-path=\"url(#plot)\" %s/>\n",
          place_x(f, f->low_x), place_y(f, left), place_x(f, f->high_x), place_y(f, right), style);
}

static void svg_dots(FILE *out, const struct frame *f, const struct bench_rows *rows, const char *kind,
                     const char *colour) {
  uint32_t i, k;
  for (i = 0; i < rows->count; i++) {
    const struct bench_row *row = &rows->row[i];
    double seconds = kind ? 0 : bench_wall(row);
    for (k = 0; kind && k < row->stages; k++)
      if (!strcmp(row->stage[k].kind, kind)) seconds += row->stage[k].wall_s;
    if (!(seconds > 0.005)) continue;
    fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%s\" fill=\"%s\" stroke=\"%s\"/>\n",
            place_x(f, 3 * log10(row->side_um)), place_y(f, log10(seconds)), kind ? "2.2" : "3.6",
            row->cells_asked ? "white" : colour, colour);
  }
}

void bench_svg(FILE *out, const struct bench_rows *rows, const struct bench_key *key) {
  static const char *const colour[] = {"#2471a3", "#d68910", "#1e8449", "#7d3c98",
                                       "#0e6655", "#935116", "#5d6d7e"};
  const struct frame f = frame_of(rows);
  const struct bench_fit fit = bench_fit_rows(rows, NULL, 0);
  const double keys = LEFT + WIDTH + 18;
  double y = TOP + 6;
  char words[128];
  uint32_t i;
  (void)key;
  fprintf(out,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"330\" viewBox=\"0 0 640 330\" "
          "font-family=\"sans-serif\" font-size=\"11\">\n<title>Time to make a substrate against its "
          "volume</title>\n"
          "<rect width=\"640\" height=\"330\" fill=\"white\"/>\n"
          "<clipPath id=\"plot\"><rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"/></clipPath>\n",
          LEFT, TOP, WIDTH, HEIGHT);
  svg_axes(out, &f);
  svg_law(out, &f, BENCH_PAPER_SECONDS, BENCH_PAPER_EXPONENT, "stroke=\"#999\" stroke-dasharray=\"5 3\"");
  fprintf(out, "<path d=\"M%.1f %.1fh18\" stroke=\"#999\" stroke-dasharray=\"5 3\"/>\n", keys - 9, y - 4);
  snprintf(words, sizeof words, "paper: 3 h at (100 um)\302\263, V^%.3f", BENCH_PAPER_EXPONENT);
  svg_text(out, keys + 13, y, "start", words);
  if (fit.rows >= 3) {
    svg_law(out, &f, fit.seconds_at_100_um, fit.exponent, "stroke=\"#c0392b\"");
    snprintf(words, sizeof words, "fit from %g um: V^%.3f \302\261 %.3f", fit.from_um, fit.exponent,
             fit.error);
    y += 16;
    fprintf(out, "<path d=\"M%.1f %.1fh18\" stroke=\"#c0392b\"/>\n", keys - 9, y - 4);
    svg_text(out, keys + 13, y, "start", words);
  }
  svg_dots(out, &f, rows, NULL, "#c0392b");
  y += 16;
  fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.6\" fill=\"#c0392b\"/>\n", keys, y - 4);
  svg_text(out, keys + 13, y, "start", "all stages");
  for (i = 0; rows->count && i < rows->row[0].stages; i++) {
    const char *const kind = rows->row[0].stage[i].kind, *const own =
                                                             colour[i % (sizeof colour / sizeof *colour)];
    if (is_repeated(&rows->row[0], i)) continue;
    svg_dots(out, &f, rows, kind, own);
    y += 16;
    fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.2\" fill=\"%s\"/>\n", keys, y - 4, own);
    svg_text(out, keys + 13, y, "start", kind);
  }
  for (i = 0; i < rows->count; i++)
    if (rows->row[i].cells_asked) {
      y += 16;
      fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.6\" fill=\"white\" stroke=\"#c0392b\"/>\n", keys,
              y - 4);
      snprintf(words, sizeof words, "a box of %llu cells", (unsigned long long)rows->row[i].cells_asked);
      svg_text(out, keys + 13, y, "start", words);
    }
  fprintf(out, "</svg>\n");
}
