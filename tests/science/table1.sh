#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# apps/examples/table1.py: who is held back and who is grown from, what it refuses, the commands that it starts; where there are real
# cells, two folds of a few of them from start to end.  table1.sh BIN SOURCE
. "$(dirname -- "$0")/../pipe/common.sh"
command -v python3 >/dev/null || skip "needs python3"
table1() { python3 "$root/apps/examples/table1.py" "$@"; }
line() { # <words> <file>: it has such a line
  grep -qE -e "$1" "$2" || { echo "expected $1 in $2:"; cat "$2"; return 1; }
}
refuses() { # <words> <command>...: it fails and says so
  words=$1; shift
  if "$@" >said 2>&1; then echo "expected a failure of $*"; return 1; fi
  line "$words" said
}

# A program in conceg's place notes its words and makes empty files.
cat >stub <<'END'
#!/bin/sh
echo "$*" >>words
for word; do [ "$last" = -o ] && : >"$word"; [ "$last" = --structure_dir ] && mkdir -p "$word" && echo the table >"$word/structure.txt"; last=$word; done
END
chmod +x stub
cat >cells.csv <<'END'
# a comment
file,entry,class,donor_id,fold,frame
,L4_pyramidal,pyramidal,,,
a.swc,L4_pyramidal,pyramidal,a,0,apical
b.swc,L4_pyramidal,pyramidal,b,1,apical
c.swc,L4_pyramidal,pyramidal,c,1,apical
b.swc,other,pyramidal,b,1,apical
d.swc,astrocyte,astrocyte,d,1,unknown
END
run() { table1 --run made --root cells --table cells.csv --entries L4_pyramidal,other,astrocyte --cells 4 --conceg ./stub "$@"; }
check "two folds" run --folds 0,1 >shown
check "the table is printed" line '^the table$' shown
check "the other fold is held back" line '^b.swc,L4_pyramidal' made/validation-1.csv
check "all of it" test "$(grep -c swc made/validation-1.csv)" = 3
check "barcodes are not held back" line '^d.swc,astrocyte' made/synthesis-1.csv
check_not "donors held back are not grown from" grep -q '^[bc].swc' made/synthesis-1.csv
check "an entry without donors is not grown" test "$(grep -c 'name:' made/recipe-1.yaml)" = 2
check "grown from the others alone" line '^dictionary: made/synthesis-1.cgx' made/recipe-1.yaml
check "at cortical density" line 'size_um: \[45.428, 45.428, 45.428\]' made/recipe-0.yaml # (12 / 1.28e-4)^(1/3)
check "a seed for each fold" line '^seed: 2' made/recipe-1.yaml
check "held against those" line '^analyse made/grown-1.cgx --structure made/validation-1.cgx ' words
check "folds are pooled" line '^analyse made/analysed-0.cgx --structure made/validation-0.cgx --structure_pool made/analysed-1.cgx --structure_dir made/table1 ' words
before=$(wc -l <words)
check "what is there is not made again" run --folds 0,1 >shown
check "but pooled" test "$(wc -l <words)" = $((before + 1))
check "a fold without donors" refuses 'fold 3: expected donors to hold back, got none' run --folds 3
check "an entry that is not there" refuses 'cells.csv: expected donors of nowhere, got none' run --entries nowhere
check "no table" refuses 'absent.csv: expected a table of characterise' run --table absent.csv
check "a stage that fails" refuses 'conceg characterise: expected it to succeed' table1 --run other --root cells --table cells.csv --entries L4_pyramidal --conceg false
sed 's/^b.swc,other,pyramidal,b,1/x.swc,other,pyramidal,b,0/' cells.csv >both.csv
check "a donor in two folds" refuses 'fold 0: expected donors on one side alone, got b' run --table both.csv --folds 0

cells=${CONCEG_SHARED:-}/morphologies
if [ -d "$cells/mouse_vis_L6a_int" ]; then
  two() { table1 --run real --root "$cells" --entries L6_interneuron,astrocyte --folds 0,1 --cells 2 >real.txt; }
  check "two folds of real cells" two
  check "donors are named" line 'set 1: grown from .*; held back 323452196$' real.txt
  check "and few" line '^L6_interneuron: 2 donors: wide' real.txt
  check "the paper stands beside" line 'paper, real +21 +3.10 \+- 0.42' real.txt
  check "the figure is there" test -s real/table1/structure.csv
  # Planted: cells of a fold against a donor that they were grown from.
  leak() { conceg analyse real/analysed-0.cgx --structure real/validation-1.cgx --points 0 --field_step_um 4 -o leak.cgx; }
  check "a donor on both sides" refuses 'expected no donor on both sides, got ' leak
  check "and nothing is written" test ! -e leak.cgx
else
  echo "no real cells in CONCEG_SHARED: two folds are not run"
fi
done_checking
