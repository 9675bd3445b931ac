# SPDX-License-Identifier: BSD-3-Clause
# Shared by the pipe tests: arguments are the folder of the programs and the checkout; work happens in a scratch folder.
set -eu
bin=$1 root=$2
PATH=$bin:$PATH
export PATH
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT INT TERM
cd "$scratch"
checks=0 failed=0
check() { # check "what" command...
  what=$1; shift
  checks=$((checks + 1))
  if "$@"; then :; else failed=$((failed + 1)); printf 'failed: %s\n' "$what" >&2; fi
}
check_not() { what=$1; shift; if "$@"; then check "$what" false; else check "$what" true; fi; }
skip() { printf 'SKIPPED: %s\n' "$1"; exit 77; }
done_checking() { printf '%d checks, %d failed\n' "$checks" "$failed"; [ "$failed" = 0 ] && [ "$checks" -gt 0 ]; }
# A pipeline whose every member must succeed, in shells without pipefail.
pipeline() { # pipeline OUTPUT RECIPE [stage options]
  pipe_output=$1 pipe_recipe=$2
  {
    { conceg place -q -p "$pipe_recipe" || echo place >failed; } |
      { conceg triangulate -q || echo triangulate >>failed; } |
      { conceg grow -q || echo grow >>failed; } |
      { conceg relax -q || echo relax >>failed; } |
      { conceg mesh -q || echo mesh >>failed; }
  } >"$pipe_output"
  [ ! -s failed ] || { printf 'pipeline: failed: %s\n' "$(cat failed)" >&2; return 1; }
}
