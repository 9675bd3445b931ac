/* SPDX-License-Identifier: BSD-3-Clause
 * An SWC file in pieces that fit the processor's cache, so that its whole text never is in memory. */
#define _GNU_SOURCE
#include "swc_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PIECE 262144

typedef struct pieces {
  FILE *file;
  char *text;
  size_t used, room; /* bytes of `text`: held, and there */
  uint64_t total;
  int is_last;
} pieces;

/* The next piece behind what is left of the one before. Returns 0, or why not. */
static int fill(pieces *in) {
  size_t got;
  if (in->used == in->room) {
    char *const grown = realloc(in->text, in->room ? 2 * in->room : PIECE);
    if (!grown) return ENOMEM;
    in->text = grown, in->room = in->room ? 2 * in->room : PIECE;
  }
  errno = 0;
  got = fread(in->text + in->used, 1, in->room - in->used, in->file);
  in->is_last = got < in->room - in->used;
  in->used += got, in->total += got;
  return ferror(in->file) ? errno ? errno : EIO : in->total >= UINT32_MAX ? EFBIG : 0;
}

static int read_pieces(pieces *in, swc_parser *parser) {
  struct stat about;
  int reason = 0;
  if (fstat(fileno(in->file), &about) == 0 && about.st_size >= (off_t)UINT32_MAX) return EFBIG;
  setvbuf(in->file, NULL, _IONBF, 0);
  while (!in->is_last && !parser->stopped && !parser->swc->out_of_memory && !reason) {
    reason = fill(in);
    if (!reason) {
      const size_t done = swc_parse_piece(parser, in->text, in->used, in->is_last);
      in->used -= done;
      memmove(in->text, in->text + done, in->used);
    }
  }
  return reason;
}

conceg_status swc_parse_file(conceg_ctx *ctx, const char *path, swc_parser *parser) {
  pieces in = {.file = fopen(path, "rb")};
  int reason;
  if (!in.file) return conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be opened: %s", path, strerror(errno));
  reason = read_pieces(&in, parser);
  fclose(in.file);
  free(in.text);
  if (reason == ENOMEM) return conceg_ctx_fail(ctx, CONCEG_E_NOMEM, "%s: out of memory", path);
  if (reason == EFBIG)
    return conceg_ctx_fail(ctx, CONCEG_E_RANGE, "%s: expected less than 4 GiB, got more", path);
  return reason ? conceg_ctx_fail(ctx, CONCEG_E_IO, "%s: cannot be read: %s", path, strerror(reason))
                : CONCEG_OK;
}
