#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs parameters.py; with a planted stage it must fail, naming each parameter without an effect.  parameters.sh BIN SOURCE PLUGINS [STAGE:IMPL]
python=${CONCEG_PYTHON:-}
[ -x "$python" ] || python=$(command -v python3) || { echo "SKIPPED: no Python 3: parameters are not flipped"; exit 77; }
[ -n "${4:-}" ] || exec "$python" "$(dirname -- "$0")/parameters.py" "$1" "$2"
log=$(CONCEG_STAGE_PATH=$3 "$python" "$(dirname -- "$0")/parameters.py" "$1" "$2" --plant "$4")
status=$?
echo "$log" | sed "s,^,planted: ,"
[ "$status" -eq 1 ] && echo "$log" | grep -q "FAILED: relax.radius_um: .*: no byte of the output changes"
