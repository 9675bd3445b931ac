#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Signals of other programs as a user brings them: import, fit, pictures, and what is refused.  fit.sh BIN
bin=$1
. "$(dirname "$0")/expect.sh"
PATH=$bin:$PATH
export PATH
[ -x "$bin/conceg-fit" ] || { echo "SKIPPED: this build has no fit stage (libceres-dev)"; exit 77; }
cd "$expect_folder" || exit 1

# Three quarters sticks, one quarter Gaussian spheres of 7 um, D 2 in both: the model's own signal.
bs="0 500 1000 2000 3000 4000 5000 6000 8000 10000 12000 15000"
signals="1 0.76614914 0.61840316 0.44610210 0.34953029 0.28817778 0.24631541 0.21641228 0.17748692 0.15384624 0.13808383 0.12210622"
echo $bs > bvals
for k in 1 2 3; do for b in $bs; do printf '%s ' $([ $k = 3 ] && [ $b != 0 ] && echo 1 || echo 0); done; echo; done > bvecs
for s in $signals; do awk -v s=$s 'BEGIN { printf "%.8f ", 812 * s }'; done > signals.txt
{
  echo "compartment,b_s/mm2,signal,pulse_duration_ms,pulse_separation_ms"
  set -- $signals
  for b in $bs; do echo "intra,$b,$1,5,20"; shift; done
} > signals.csv
pulses="--pulse-duration-ms 5 --pulse-separation-ms 20"

expect 0 "" conceg import signal signals.csv -o table.cgx
expect 0 "" conceg import signal signals.txt --bval bvals --bvec bvecs --compartment intra $pulses -o fsl.cgx
sed '1s/.*/compartment,b_s\/mm2,signal,delta_ms,Delta_ms/' signals.csv > simulated.csv # names of conceg simulate --csv
expect 0 "" conceg import signal simulated.csv -o simulated.cgx
expect 0 "" cmp simulated.cgx table.cgx
for document in table.cgx fsl.cgx; do
  expect 0 "" conceg validate -q $document
  expect 0 "f_neurite 0.750 .*f_soma 0.250" conceg fit $document --soma-diffusivity 2 -o fitted.cgx
  expect 0 "radius 7.00 " conceg fit $document --soma-diffusivity 2 -o fitted.cgx
  expect 0 "" conceg validate -q fitted.cgx
done
expect 0 "" sh -c "conceg import signal signals.csv | conceg fit -q --soma-diffusivity 2 > piped.cgx"
expect 0 "" conceg fit table.cgx -q --soma-diffusivity 2 -o named.cgx
expect 0 "" cmp piped.cgx named.cgx
expect 0 "" conceg fit table.cgx -q --csv tables --pictures pictures -o x.cgx
expect 0 "" test -s tables/sandi.csv -a -s tables/sandi_shell.csv -a -s tables/sandi_covariance.csv
expect 0 "" grep -q '</svg>' pictures/sandi-intra.svg

# Files that cannot be meant. Each line is refused with exit 3, a place and a remedy.
bad() { # <words> <sed program> <file> options...
  words=$1 program=$2 file=$3
  shift 3
  sed "$program" "$file" > bad-"$file"
  expect 3 "$words" conceg import signal "$@" -o bad.cgx
  expect 0 "" test ! -e bad.cgx
}
bad "bad-signals.csv:5: b: expected at most 100 ms/um.2, got 2e.06" 's/,2000,/,2e9,/' signals.csv bad-signals.csv
bad "bad-signals.csv:4: signal: expected a finite number, got 'nan'" 's/0.61840316/nan/' signals.csv bad-signals.csv
bad "bad-signals.csv:3: expected 5 columns as in the header, got 4" '3s/,5,20/,5/' signals.csv bad-signals.csv
bad "bad-signals.csv:1: expected a column b, b_ms/um2 or b_s/mm2" '1s/b_s/c_s/' signals.csv bad-signals.csv
bad "bad-signals.csv:1: expected a column signal" '1s/signal/sygnal/' signals.csv bad-signals.csv
bad "expected pulses of some duration.*give --pulse-duration-ms" 's/,5,20$/,0,0/' signals.csv bad-signals.csv
bad "expected the same measurements in the same order as in intra" '$s/intra/all/' signals.csv bad-signals.csv
bad "bad-signals.csv: expected rows of signals below the header" '2,$d' signals.csv bad-signals.csv
bad "expected a header and rows, got nothing" 'd' signals.csv bad-signals.csv
bad "expected 12 signals, one for each value of b" 's/812.00000000//' signals.txt bad-signals.txt --bval bvals $pulses
bad "the largest b is 15; bval files hold s/mm.2" 's/000//g; s/500/0.5/' bvals signals.txt --bval bad-bvals $pulses
bad "bad-bvals:1: b: expected at most 100 ms/um.2" 's/1000 /1e9 /' bvals signals.txt --bval bad-bvals $pulses
bad "bad-bvecs: expected 3 lines of 12 numbers, got 24 numbers on 2 lines" '1d' bvecs signals.txt --bval bvals --bvec bad-bvecs $pulses
bad "direction: expected length 1, got 2" '3s/1 1/1 2/' bvecs signals.txt --bval bvals --bvec bad-bvecs $pulses
expect 4 "nowhere.csv: cannot open" conceg import signal nowhere.csv -o bad.cgx
expect 2 "expected one file of signals, got 2" conceg import signal a.csv b.csv -o bad.cgx
expect 2 "bvec: expected a file in bval too" conceg import signal signals.txt --bvec bvecs -o bad.cgx
sed '/,0,1,/d' signals.csv > no-zero.csv
expect 3 "no measurement with b = 0" sh -c "conceg import signal no-zero.csv | conceg fit -o bad.cgx"
sed '5,$d' signals.csv > few.csv
expect 3 "expected 3 values of b above 0 or more to fit soma_share, radius, neurite_diffusivity, got 2" sh -c "conceg import signal few.csv | conceg fit -o bad.cgx"
expect 3 "needs /signals" sh -c "conceg import signal signals.csv | conceg strip signals | conceg fit -o bad.cgx"
expect 0 "" test ! -e bad.cgx
expect_done
