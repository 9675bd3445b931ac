#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Volumes of labels as NumPy writes them, where it is installed.  labels.sh BIN
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2> /dev/null || { echo "SKIPPED: no Python with h5py and NumPy: labels are not read"; exit 77; }
exec "$python" "$(dirname "$0")/labels.py" "$1"
