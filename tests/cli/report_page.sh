#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The page of conceg report in a browser, by Python with h5py.  report_page.sh BIN SOURCE
python=${CONCEG_PYTHON:-python3}
"$python" -c "import h5py, numpy" 2> /dev/null || { echo "SKIPPED: no Python with h5py for the page of conceg report"; exit 77; }
exec "$python" "$(dirname "$0")/report_page.py" "$@"
