#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Streams and files that fail: exit codes, one error line, nothing half-written, nothing left.  faults.sh BIN PLUGINS SPARSE
bin=$1 plugins=$2 sparse=$3
. "$(dirname "$0")/../cli/expect.sh"
t=$expect_folder
conceg=$bin/conceg
PATH=$bin:$PATH
CONCEG_STAGE_PATH=$plugins
export PATH CONCEG_STAGE_PATH
cd "$t" || exit 1
mkdir tmp
TMPDIR=$t/tmp
export TMPDIR
left() { find . -name '.conceg-*' -o -path './tmp/*' | grep -q .; }
printf 'conceg: 1\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\n' > toy.yaml
"$conceg" place -p toy.yaml -q -o a.cgx && "$conceg" relax --impl beads -q a.cgx -o b.cgx || exit 1
sum=$(sha256sum a.cgx)
"$sparse" wide.cgx 4 || exit 1

# Readers that go away.
for bytes in 0 1 100000 2000000; do
  expect 4 "Broken pipe" sh -c "{ '$conceg' strip x_small wide.cgx; echo \$? > code; } | head -c $bytes > /dev/null; exit \$(cat code)"
done
# Streams that were closed are not taken for files that are opened later.
expect 4 "standard input: cannot be read: Bad file descriptor" sh -c "exec '$conceg' relax --impl beads -o x.cgx <&-"
expect 4 "standard output: cannot be written: Bad file descriptor" sh -c "exec '$conceg' relax --impl beads a.cgx >&-"
expect 4 "Bad file descriptor" sh -c "exec '$conceg' info a.cgx >&-"
expect_true "without standard error the work is done" sh -c "exec '$conceg' relax -v --impl beads a.cgx -o c.cgx 2>&-"
expect_same b.cgx c.cgx
expect_true "with all three closed too" sh -c "exec '$conceg' relax -v --impl beads a.cgx -o d.cgx <&- >&- 2>&-"
expect_same b.cgx d.cgx

# Odd things on standard input.
expect 4 "" sh -c "'$conceg' relax --impl beads -o x.cgx < ."
expect 0 "" sh -c "'$conceg' relax --impl beads -o c.cgx < a.cgx"
expect_same b.cgx c.cgx
expect 0 "" sh -c "'$conceg' relax --impl beads -o c.cgx <> a.cgx"
expect_same b.cgx c.cgx
expect 0 "" sh -c "exec 3< a.cgx && rm -f moved.cgx && cp a.cgx gone.cgx && exec < gone.cgx && rm gone.cgx && '$conceg' relax --impl beads -o c.cgx"
expect_same b.cgx c.cgx
expect 3 "truncated" sh -c "head -c 3000 a.cgx | '$conceg' relax --impl beads -o x.cgx"
expect 3 "bytes after the end" sh -c "{ cat a.cgx; echo more; } | '$conceg' relax --impl beads -o x.cgx"
expect 3 "wrote nothing" sh -c "'$conceg' relax --impl beads -o x.cgx < /dev/null"

# Files that may not grow, as on a full disk: of the output, of the spool, of the document on its way to a pipe.
expect 4 "File too large" sh -c "ulimit -f 4; '$conceg' relax --impl beads a.cgx -o x.cgx"
expect 4 "File too large" sh -c "cat a.cgx | { ulimit -f 4; '$conceg' relax --impl beads -o x.cgx; }"
expect 4 "File too large" sh -c "{ ulimit -f 4; '$conceg' relax --impl beads a.cgx; echo \$? > code; } | cat > /dev/null; exit \$(cat code)"
expect_true "no output after these" test ! -e x.cgx
if [ "$(id -u)" = 0 ] && mkdir full && mount -t tmpfs -o size=64k none full 2> /dev/null; then
  expect 4 "No space left" "$conceg" relax --impl beads a.cgx -o full/x.cgx
  expect_true "nothing is left on the full disk" sh -c 'test -z "$(ls -A full)"'
  expect 4 "free space|No space left" sh -c "cat wide.cgx | TMPDIR=$t/full '$conceg' strip x_small -o x.cgx"
  expect 4 "No space left" sh -c "{ TMPDIR=$t/full '$conceg' strip x_small wide.cgx; echo \$? > code; } | cat > /dev/null; exit \$(cat code)"
  umount full
else
  echo "SKIPPED: the part on a full disk needs to mount a small file system"
fi
if [ -w /dev/full ]; then expect 4 "No space left" sh -c "'$conceg' relax --impl beads a.cgx > /dev/full"; fi

# What -o may name.
ln -s real.cgx link.cgx
expect 0 "" "$conceg" relax --impl beads a.cgx -o link.cgx
expect_true "a dangling link is not followed into nowhere" test -e link.cgx
echo old > target.cgx && rm -f link.cgx && ln -s target.cgx link.cgx
expect 0 "" "$conceg" relax --impl beads a.cgx -o link.cgx
expect_true "a link stays a link" test -L link.cgx
expect_same b.cgx target.cgx
expect 4 "is a folder" "$conceg" relax --impl beads a.cgx -o tmp
expect 0 "" "$conceg" relax --impl beads a.cgx -o /dev/null
cp a.cgx self.cgx
expect 0 "" "$conceg" relax --impl beads self.cgx -o self.cgx
expect_same b.cgx self.cgx
expect 0 "" sh -c "umask 027; '$conceg' relax --impl beads a.cgx -o mode.cgx"
expect_true "a new file obeys the umask" sh -c 'test "$(stat -c %a mode.cgx)" = 640'
chmod 604 mode.cgx
expect 0 "" "$conceg" relax --impl beads a.cgx -o mode.cgx
expect_true "a replaced one keeps its mode" sh -c 'test "$(stat -c %a mode.cgx)" = 604'
if [ "$(id -u)" = 0 ] && command -v setpriv > /dev/null; then
  mkdir locked && chmod 755 "$t" locked tmp && cp toy.yaml locked
  expect 4 "Permission denied" setpriv --reuid=65534 --clear-groups env TMPDIR=/tmp "$conceg" relax --impl beads a.cgx -o locked/x.cgx
  expect 4 "TMPDIR" sh -c "cat a.cgx | setpriv --reuid=65534 --clear-groups env TMPDIR=$t/locked '$conceg' relax --impl beads -o /dev/null"
fi

# Two runs at once: one temporary folder, one target.
for k in 1 2 3 4; do "$conceg" relax --impl beads -q -o same.cgx < a.cgx & done
wait
expect_same b.cgx same.cgx
for k in 1 2 3 4; do cat a.cgx | "$conceg" relax --impl beads -q > out$k.cgx & done
wait
for k in 1 2 3 4; do expect_same b.cgx out$k.cgx; done
expect_true "nothing is left of all this" sh -c '! find . -name ".conceg-*" -o -path "./tmp/*" | grep -q .'

# What killed runs leave, and conceg clean.
mkdir -p dirty/sub
echo x > dirty/.conceg-1-2.tmp && echo x > dirty/.conceg-other.tmp && echo x > dirty/keep.tmp
(flock -x 9; sleep 3) 9> dirty/.conceg-1-3.tmp & holder=$!
sleep 0.3
expect 0 "" "$conceg" clean dirty --dry-run
expect_output "^left behind dirty/.conceg-1-2.tmp"
expect_output "1 unfinished files of killed runs found"
expect_true "a dry run removes nothing" test -e dirty/.conceg-1-2.tmp
expect 0 "" "$conceg" clean dirty
expect_output "^removed dirty/.conceg-1-2.tmp"
expect_true "what a running program holds stays" test -e dirty/.conceg-1-3.tmp
expect_true "other files stay" test -e dirty/.conceg-other.tmp -a -e dirty/keep.tmp
kill $holder 2> /dev/null; wait $holder 2> /dev/null
pkill -P $holder 2> /dev/null
echo x > dirty/.conceg-9-9.tmp
expect 0 "" "$conceg" relax --impl beads a.cgx -o dirty/x.cgx
expect_true "the next run into the folder removes it too" test ! -e dirty/.conceg-9-9.tmp
expect 4 "nowhere: cannot be listed" "$conceg" clean nowhere
expect 0 "" "$conceg" clean

# A document of 3 GiB that is a hole on the disk, within 600 MiB of memory.
"$sparse" big.cgx 3072 || exit 1
expect_true "it is sparse" sh -c 'test "$(du -m big.cgx | cut -f1)" -lt 50'
expect 0 "" sh -c "ulimit -v 2000000; '$conceg' info --memory 256M big.cgx"
expect_output "x_big"
expect 0 "" sh -c "ulimit -v 2000000; '$conceg' validate --memory 256M big.cgx"
expect 0 "" sh -c "ulimit -v 2000000; '$conceg' strip x_small --memory 256M big.cgx -o stripped.cgx && rm stripped.cgx"
expect 0 "" sh -c "ulimit -v 2000000; '$conceg' strip x_small --memory 256M big.cgx | '$conceg' info --memory 256M"
expect_output "x_big"
rm -f big.cgx
expect_true "the input was never touched" sh -c "test \"\$(sha256sum a.cgx)\" = '$sum'"
expect_true "nothing is left at the end" sh -c 'test -z "$(ls -A tmp)"'
expect_done
