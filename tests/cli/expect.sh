# SPDX-License-Identifier: BSD-3-Clause
# Sourced by tests: rows of  expect CODE "REGEX" COMMAND...  check the exit code and the standard error of a command, and
# that a failure is one line (usage lines apart). A missing regex is "". Ends with: expect_done.
expect_count=0
expect_failed=0
expect_folder=$(mktemp -d) || exit 1
trap 'rm -rf "$expect_folder"' EXIT

expect_report() {
  expect_failed=$((expect_failed + 1))
  echo "FAILED: $1"
  echo "  command: $2"
  sed 's/^/  stderr: /' "$expect_folder/stderr"
}

expect() {
  code=$1 regex=$2
  shift 2
  expect_count=$((expect_count + 1))
  "$@" > "$expect_folder/stdout" 2> "$expect_folder/stderr"
  got=$?
  if [ "$got" -ne "$code" ]; then
    expect_report "expected exit code $code, got $got" "$*"
  elif [ -n "$regex" ] && ! grep -qE -e "$regex" "$expect_folder/stderr"; then
    expect_report "expected a line like $regex" "$*"
  elif [ "$code" -ne 0 ] && [ "$(grep -c 'error: ' "$expect_folder/stderr")" -ne 1 ]; then
    expect_report "expected one error line" "$*"
  fi
}

# Standard output of the last command matches.
expect_output() {
  expect_count=$((expect_count + 1))
  grep -qE -e "$1" "$expect_folder/stdout" && return
  expect_failed=$((expect_failed + 1))
  echo "FAILED: expected output like $1, got:"
  head -20 "$expect_folder/stdout" | sed 's/^/  /'
}

# expect_same A B: two files with the same bytes.
expect_same() {
  expect_count=$((expect_count + 1))
  cmp "$1" "$2" && return
  expect_failed=$((expect_failed + 1))
  echo "FAILED: expected the same bytes in $1 and $2"
}

# expect_true "what" COMMAND...
expect_true() {
  what=$1
  shift
  expect_count=$((expect_count + 1))
  "$@" > /dev/null 2>&1 && return
  expect_failed=$((expect_failed + 1))
  echo "FAILED: $what"
}

expect_done() {
  echo "$expect_count checks, $expect_failed failed"
  [ "$expect_count" -gt 0 ] && [ "$expect_failed" -eq 0 ]
  exit $?
}
