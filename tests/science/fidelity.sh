#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Cells grown alone have the barcode, the length and the fork angles that were drawn. Arguments after the checkout: entries (none = all).
. "$(dirname -- "$0")/../pipe/common.sh"
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2>/dev/null || skip "no Python with h5py and numpy: grown cells are not compared with what was drawn"
shift 2
check "grown alone, cells are what was drawn" "$python" "$root/tests/science/growth_fidelity.py" "$bin" "$root" "$@"
# A planted defect: forks that come 3 um early must be found, or the check above means nothing.
sed 's/lambda_per_um: 20/lambda_per_um: 0.2/' "$root/tests/science/growth_fidelity.py" >planted.py
check_not "early forks are found" sh -c "'$python' planted.py '$bin' '$root' microglia >/dev/null"
done_checking
