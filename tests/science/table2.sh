#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# apps/examples/table2.py on fits of golden signals of exact spheres and sticks: the exact kernel gives the truth back, and what
# it shows of the others is what the tables say.  table2.sh BIN SOURCE
bin=$1 root=$2
[ -x "$bin/conceg-fit" ] || { echo "SKIPPED: this build has no fit stage (libceres-dev)"; exit 77; }
command -v python3 > /dev/null || { echo "SKIPPED: needs python3"; exit 77; }
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
PATH=$bin:$PATH
# Golden signals: exact sphere of 7 um and sticks, D 2, at f_s = 0.25 and 0.41.
awk 'BEGIN {
  split("0 0.5 1 2 3 5 8 10 12 15", b); n = split("1 0.82185833 0.67152741 0.43960064 0.27908709 0.09969699 0.01414930 0.00546397 0.00770362 0.01258087", sphere)
  split("1 0.74682413 0.59814401 0.44104070 0.36160815 0.28024739 0.22155673 0.19816636 0.18090031 0.16180216", stick)
  for (k = 1; k <= 2; k++) { f = k == 1 ? 0.25 : 0.41; file = k == 1 ? "three.csv" : "four.csv"
    print "compartment,b,signal" > file
    for (i = 1; i <= n; i++) printf "intra,%s,%.8f\n", b[i], f * sphere[i] + (1 - f) * stick[i] > file
    for (i = 1; i <= n; i++) printf "all,%s,%.8f\n", b[i], 0.3 * exp(-b[i]) + 0.7 * (f * sphere[i] + (1 - f) * stick[i]) > file } }'
for layer in three four; do
  conceg import signal $layer.csv --pulse-duration-ms 5 --pulse-separation-ms 20 | conceg fit -q --variants --soma-diffusivity 2 --csv $layer -o $layer.cgx || exit 1
done
failed=0
line() { # <words> <command>...: the table has such a line
  words=$1
  shift
  "$@" > table 2>&1
  grep -qE -e "$words" table || { failed=$((failed + 1)); echo "FAILED: expected $words from $*"; cat table; }
}
table=$root/apps/examples/table2.py
shown() { # <layer> <column> <scale> <digits>: of the first fit, intracellular, gpd, D_in free
  awk -F, -v c="$2" -v scale="$3" -v digits="$4" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i } NR == 2 { printf "%.*f", digits, scale * $k }' "$1/sandi.csv"
}
line "^  3 +25 -> 28 \\| - -> $(shown three f_soma 100 1) +7.0 -> 7.8 \\| - -> $(shown three radius_um 1 2)\$" python3 "$table" three four -
line "^  4 +41 -> 46 \\| - -> $(shown four f_soma 100 1) " python3 "$table" three four -
line '^  5 +26 -> 24 \| - -> -  ' python3 "$table" three four -
line '^  3 +25 -> 28 \| - -> 25\.0 +7.0 -> 7.8 \| - -> 7\.00$' python3 "$table" three four - --kernel exact
line '^  4 +42 -> 57 \| - -> 41\.3 +28 -> 31 \| - -> 28\.7 +30 -> 13 \| - -> 30\.0 +7\.2 -> 8\.2 \| - -> 7\.00$' python3 "$table" three four - --kernel exact --neurite held
line 'error: .*nowhere/sandi.csv: expected a table of conceg fit --csv' python3 "$table" nowhere four -
printf 'name,value,value_unit\nsoma_share_of_cells,0.25,1\nf_neurite,0.525,1\nf_soma,0.175,1\nf_extracellular,0.3,1\nradius_mean,7,um\nradius_volume_weighted,7.2,um\nradius_effective,7.3,um\n' > three/sandi_truth.csv
line '^  3 +25 -> 28 \| 25.0 -> 25.0 +7.0 -> 7.8 \| 7.00 -> 7.00$' python3 "$table" three four - --kernel exact
line 'layer 3: true radii: mean 7.00, volume-weighted 7.20, effective 7.30 um' python3 "$table" three four -
line '^  3 +25 -> 28 \| 25.0 -> 25.0 \+- [0-9.]+ +7.0 -> 7.8 \| 7.00 -> 7.00 \+- [0-9.]+$' python3 "$table" three four - --kernel exact --errors
# --run, with a program in conceg's place that notes its words and gives the tables of above.
cat > stub << 'END'
#!/bin/sh
echo "$*" >> words
for word; do [ "$last" = -o ] && : > "$word"; [ "$last" = --csv ] && mkdir -p "$word"; last=$word; done
[ "$1" = fit ] || exit 0
cp three/*.csv "made/layer$(grep -c ^fit words | awk '{ print $1 + 2 }')"
END
chmod +x stub
line '^  5 +26 -> 24 \| 25.0 -> 25.0 ' python3 "$table" --run made --side-um 30 --walkers 70 --margin-um 4 --conceg ./stub --kernel exact
line '^run made/layer4.yaml --until mesh -q -o made/layer4.cgx$' cat words
line '^simulate made/layer4.cgx --walkers 70 --margin_um 4.0 --checkpoint made/layer4.checkpoint --csv made/layer4 -o made/simulated.cgx$' cat words
line 'size_um: \[30, 30, 30\]' cat made/layer5.yaml
line 'error: expected three folders, or --run FOLDER' python3 "$table" three four
line 'error: conceg run: expected it to succeed' python3 "$table" --run other --conceg false
[ "$failed" = 0 ] && echo "15 checks, 0 failed"
exit "$failed"
