/* SPDX-License-Identifier: BSD-3-Clause
 * A meshed document for the examples: eight balls on a grid, one across the corner of the box, one hollow
 * with a cell in its cavity, and a tube longer than the box between them.  tissue FILE [hole|flipped] hole
 * faces are missing from every ball flipped  the faces of one cell are turned round */
#include "shapes.h"

static void ball(shapes *s, double x, double y, double z, double radius) {
  shapes_begin(s, x, y, z, radius);
  shapes_sphere(s, 3, x, y, z, radius, 0, CONCEG_SOMA);
  shapes_end(s);
}

int main(int argc, char **argv) {
  shapes s;
  const double centre[3] = {9.4, 9.6, 9}, tube[3][3] = {{0.7, 0, 0.9}, {0, 0.7, 0.6}, {0, 0, 15}};
  const char *damage = argc > 2 ? argv[2] : "";
  if (argc < 2) return 2;
  shapes_new(&s, 20);
  for (int i = 0; i < 7; i++)
    ball(&s, i & 1 ? 14.5 : 4.5, i & 2 ? 14.5 : 4.5, i & 4 ? 14.5 : 4.5, 4.6);
  shapes_begin(&s, 14.5, 14.5, 14.5, 0);
  shapes_sphere(&s, 3, 14.5, 14.5, 14.5, 4.6, 0, CONCEG_GLIAL_PROCESS);
  shapes_sphere(&s, 3, 14.5, 14.5, 14.5, 3, 1, CONCEG_GLIAL_PROCESS);
  shapes_end(&s);
  ball(&s, 14.5, 14.5, 14.5, 2);
  shapes_begin(&s, centre[0], centre[1], centre[2], 0);
  shapes_ellipsoid(&s, 3, centre, tube, 0, CONCEG_AXON);
  shapes_end(&s);
  if (!strcmp(damage, "hole")) /* degenerate faces leave the offsets as they are */
    for (uint64_t f = 0; f < s.face_offset[7]; f += 16)
      s.face[f][1] = s.face[f][2] = s.face[f][0];
  if (!strcmp(damage, "flipped"))
    for (uint64_t f = 0; f < s.face_offset[1]; f++) {
      const uint32_t corner = s.face[f][1];
      s.face[f][1] = s.face[f][2], s.face[f][2] = corner;
    }
  conceg_ctx *ctx = conceg_ctx_new();
  conceg_doc *doc = shapes_doc(ctx, &s);
  if (!*damage && conceg_doc_validate(doc, NULL, NULL, NULL) != CONCEG_OK) {
    fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return 1;
  }
  if (conceg_doc_save(doc, argv[1]) != CONCEG_OK) {
    fprintf(stderr, "%s\n", conceg_ctx_error(ctx));
    return 1;
  }
  printf("cells %u faces %llu\n", s.cells, (unsigned long long)s.face_offset[s.cells]);
  conceg_doc_close(doc);
  conceg_ctx_free(ctx);
  shapes_free(&s);
  return 0;
}
