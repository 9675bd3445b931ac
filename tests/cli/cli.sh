#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The command line, row by row: exit code, error line, command.  cli.sh BIN PLUGINS
bin=$1 plugins=$2
. "$(dirname "$0")/expect.sh"
t=$expect_folder
conceg=$bin/conceg
PATH=$bin:$PATH
CONCEG_STAGE_PATH=$plugins
export PATH CONCEG_STAGE_PATH
cd "$t" || exit 1
printf 'conceg: 1\ndomain:\n  size_um: [20, 20, 20]\nplace:\n  impl: toy\n  radius_um: 0.7\n' > toy.yaml

# Words and help.
expect 2 "which word" "$conceg"
expect 2 "unknown word nonsense" "$conceg" nonsense
expect 2 "expected a word before --json" "$conceg" --json
expect 0 "" "$conceg" help
expect_output "conceg run recipe.yaml --until mesh -o cube.cgx"
for word in run info validate dump diff strip stages params bench; do
  expect 0 "" "$conceg" help $word
  expect_output "usage: conceg $word"
  expect_output "^example:"
done
expect 0 "" "$conceg" version
expect_output "HDF5 [0-9.]+, libyaml [0-9.]+"
expect_output "licence of this program as built: (GPL-3.0-or-later|BSD-3-Clause)"

# Options.
expect 2 "unknown option --frob" "$conceg" info --frob
expect 2 "unknown option -Z" "$conceg" info -Z
expect 2 "unexpected word b.cgx" "$conceg" info a.cgx b.cgx
expect 2 "--threads x: expected a number" "$conceg" place -p toy.yaml --threads x -o a.cgx
expect 2 "--memory 4Q: expected a size" "$conceg" place -p toy.yaml --memory 4Q -o a.cgx
expect 2 "--seed -1: expected a whole number" "$conceg" place -p toy.yaml --seed -1 -o a.cgx
expect 2 "--progress bar: expected auto, json or none" "$conceg" place -p toy.yaml --progress bar -o a.cgx
expect 2 "--output: expected FILE" "$conceg" place -p toy.yaml -o
expect 2 "--quiet takes no value" "$conceg" place -p toy.yaml --quiet=3 -o a.cgx

# Recipes.
expect 2 "needs a recipe" "$conceg" place --impl toy -o a.cgx
expect 4 "nowhere.yaml: cannot open the recipe: No such file" "$conceg" place -p nowhere.yaml -o a.cgx
printf 'conceg: 1\nplace:\n  impl: toy\n  radius: 3\n' > unknown.yaml
expect 2 "unknown.yaml:4: unknown key place.radius; did you mean radius_um\?" "$conceg" place -p unknown.yaml -o a.cgx
expect 2 "unknown.yaml:4: unknown key place.radius" "$conceg" run unknown.yaml --until place -o a.cgx
printf 'conceg: 1\ndomain:\n  size_um: [20, 20\nplace: {}\n' > broken.yaml
expect 3 "broken.yaml:4: not valid YAML" "$conceg" place -p broken.yaml -o a.cgx
: > empty.yaml
expect 3 "empty.yaml:1: expected a recipe" "$conceg" place -p empty.yaml -o a.cgx
expect 2 "--set: unknown key place.radios_um; did you mean radius_um\?" "$conceg" place -p toy.yaml --radios-um 3 -o a.cgx
expect 2 "--set: place.radius_um: expected a number from 0.1" "$conceg" place -p toy.yaml --radius-um 30 -o a.cgx
expect 2 "--set 7: expected stage.key=value" "$conceg" place -p toy.yaml --set 7 -o a.cgx
expect 2 "takes no input, got x.cgx" "$conceg" place -p toy.yaml x.cgx -o a.cgx
expect 5 "no implementation is named nobody" "$conceg" place -p toy.yaml --impl nobody -o a.cgx
expect_true "no output after an error" test ! -e a.cgx

# A run, its bytes and its options.
expect 0 "" "$conceg" place -p toy.yaml -o a.cgx
expect 0 "" "$conceg" validate a.cgx
expect_output "valid: [0-9]+ arrays and attributes checked"
expect_true "validate -q says nothing of a valid document" sh -c "test -z \"\$('$conceg' validate -q a.cgx)\""
expect 0 "" "$conceg" dump /cells a.cgx --rows 1
expect_output "^/cells/id u64"
expect 0 "" sh -c "'$conceg' place -p toy.yaml --threads 2 > b.cgx"
expect_same a.cgx b.cgx
expect 0 "" "$conceg" run toy.yaml --until place -o c.cgx
expect_same a.cgx c.cgx
expect 0 "" "$conceg" place -p toy.yaml --seed 2 -o d.cgx
expect 1 "" sh -c "'$conceg' diff a.cgx d.cgx || { echo 'error: differ' >&2; exit 1; }"
expect_output "/cells/soma: 6 of 6 values differ"
expect 0 "" "$conceg" diff a.cgx b.cgx --exact
expect 0 "" "$conceg" diff a.cgx d.cgx --ignore /cells/soma,skeleton/position,recipe
expect 0 "counter toy.cells: worker 0: 2" "$conceg" place -v -p toy.yaml -o b.cgx
expect 0 "took [0-9.]+ s of wall time, [0-9.]+ s of CPU time; peak memory [0-9]+ MiB" "$conceg" place -v -p toy.yaml -o b.cgx
expect 0 "" "$conceg" place -p toy.yaml --label 'a: "b", c' --table x.csv --smooth --steps=3 -o e.cgx
expect 0 "" "$conceg" dump -g /provenance/parameters e.cgx
expect_output 'radius_um: 0.7, steps: 3, smooth: true, mode: first, label: .*a: .*b.*, c'
expect 0 "" "$conceg" dump -g /recipe e.cgx
expect_true "paths stay out of the document" sh -c "! '$conceg' dump e.cgx | grep -q x.csv"

# Precedence: --set > own -p > /recipe > default; overriding is said and written back.
printf 'conceg: 1\nrelax: {impl: beads, radius_um: 3}\n' > own.yaml
expect 0 "" "$conceg" relax -p own.yaml a.cgx -o f.cgx
expect 0 "relax.radius_um: 2 overrides 3 of the document's /recipe" "$conceg" relax f.cgx --set relax.radius_um=2 -o g.cgx
expect 0 "" "$conceg" dump -g /provenance/parameters g.cgx
expect_output '^  "\{radius_um: 3'
expect_output '^  "\{radius_um: 2'
expect 0 "" "$conceg" dump -g /recipe g.cgx
expect_output 'relax:.n  impl: beads.n  radius_um: 2'
expect 2 "relax does not read domain" "$conceg" relax f.cgx --set domain.size_um=[9,9,9] -o x.cgx

# Documents that are not what they should be.
expect 4 "absent.cgx" "$conceg" info absent.cgx
expect 3 "" "$conceg" info toy.yaml
head -c 2000 a.cgx > cut.cgx
expect 3 "" "$conceg" info cut.cgx
expect 3 "program before this one wrote nothing" sh -c ": | '$conceg' relax --impl beads -o x.cgx"
expect 3 "volumes: the document does not have it" "$conceg" strip volumes a.cgx -o x.cgx
expect 0 "" "$conceg" strip skeleton a.cgx -o s.cgx
expect 0 "" "$conceg" info s.cgx
expect_true "strip took the skeleton away" sh -c "! '$conceg' dump s.cgx | grep -q /skeleton"

# Output that cannot be written.
expect 4 "folder .*nowhere is not there" "$conceg" place -p toy.yaml -o nowhere/a.cgx
expect 4 "is a folder" "$conceg" place -p toy.yaml -o .
if [ -w /dev/full ]; then
  expect 4 "No space left" sh -c "'$conceg' place -p toy.yaml > /dev/full"
  expect 4 "No space left" sh -c "'$conceg' info a.cgx > /dev/full"
else
  echo "SKIPPED: no /dev/full here"
fi
expect 4 "Broken pipe" sh -c "{ '$conceg' place -p toy.yaml; echo \$? > code; } | true; exit \$(cat code)"

# impl: exec:PROG, only when it is allowed.
cat > double.sh <<'S'
#!/bin/sh
exec conceg relax --impl beads -q
S
chmod +x double.sh
printf 'conceg: 1\nstages: [place, relax]\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\nrelax: {impl: "exec:./double.sh"}\n' > exec.yaml
expect 2 "relax: the recipe asks to run the program ./double.sh .*--allow-exec" "$conceg" run exec.yaml -o x.cgx
expect 0 "" "$conceg" run exec.yaml --allow-exec -q -o x.cgx
expect 0 "" "$conceg" dump -g /spheres/radius x.cgx
printf '#!/bin/sh\ncat\n' > cat.sh && chmod +x cat.sh
expect 0 "" "$conceg" run exec.yaml --set relax.impl=exec:./cat.sh --allow-exec -o x.cgx
expect 0 "" "$conceg" validate x.cgx
expect 1 "false ended with exit code 1" "$conceg" run exec.yaml --set relax.impl=exec:false --allow-exec -o y.cgx
expect 5 "no-such-program: cannot be run" "$conceg" run exec.yaml --set relax.impl=exec:no-such-program --allow-exec -o y.cgx
expect 1 "true wrote no valid document" "$conceg" run exec.yaml --set relax.impl=exec:true --allow-exec -o y.cgx
expect_true "no output of a failed run" test ! -e y.cgx

# A program in PATH stands for a word.
mkdir mine && printf '#!/bin/sh\necho mine: "$@"\n' > mine/conceg-relax && chmod +x mine/conceg-relax
expect 0 "" sh -c "PATH=$t/mine:\$PATH '$conceg' relax a b"
expect_output "^mine: a b$"

# Checkpoints: resumed bytes = uninterrupted bytes; another recipe is refused.
printf 'conceg: 1\nstages: [place, relax]\ndomain:\n  size_um: [20, 20, 20]\nplace: {impl: toy}\nrelax: {impl: beads}\n' > two.yaml
expect 0 "" "$conceg" run two.yaml -o whole.cgx --checkpoint saved
expect_true "a checkpoint per stage" test -f saved/01-place.cgx -a -f saved/02-relax.cgx
rm saved/02-relax.cgx
expect 0 "" "$conceg" run two.yaml -o resumed.cgx --checkpoint saved --resume
expect_same whole.cgx resumed.cgx
expect 2 "was made from another recipe" "$conceg" run two.yaml --seed 5 -o x.cgx --checkpoint saved --resume
expect 2 "--resume needs --checkpoint" "$conceg" run two.yaml -o x.cgx --resume
expect 0 "" "$conceg" run two.yaml saved/01-place.cgx --from relax -o from.cgx
expect_same whole.cgx from.cgx
expect 2 "relax needs a document" "$conceg" run two.yaml --from relax -o x.cgx
expect 2 "--until mesh: not among the stages of this run: place relax" "$conceg" run two.yaml --until mesh -o x.cgx
expect 0 "" "$conceg" run two.yaml --print-pipe -o out.cgx
expect_output "^conceg place -p two.yaml \| conceg relax > out.cgx$"

# Cancelling: exit 6, one line, nothing left.
"$conceg" relax --impl waiting a.cgx -o never.cgx 2> cancel.log & child=$!
sleep 1
kill -TERM $child
wait $child
code=$?
expect_true "SIGTERM ends with exit code 6, got $code" test "$code" -eq 6
expect_true "one error line" grep -q "error: .*cancel" cancel.log
expect_true "nothing is left" sh -c "! ls | grep -q never"
mkfifo silent && { sleep 5 > silent & }
"$conceg" relax --impl beads -o never.cgx < silent 2> cancel.log & child=$!
sleep 1
kill -TERM $child
wait $child
code=$?
expect_true "SIGTERM while waiting for input ends with exit code 6, got $code" test "$code" -eq 6
expect_true "and one error line" grep -q "error: cancelled while waiting" cancel.log
expect_done
