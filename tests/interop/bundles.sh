#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# fastpli's .h5 as h5py writes them, where it is installed.  bundles.sh BIN
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2> /dev/null || { echo "SKIPPED: no Python with h5py: .h5 of fastpli are not read"; exit 77; }
exec "$python" "$(dirname "$0")/bundles.py" "$1"
