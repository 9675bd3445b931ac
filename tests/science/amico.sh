#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# SANDI against AMICO's kernels.  amico.sh BIN.  Needs a Python with dmri-amico 2.1.1 (CONCEG_AMICO_PYTHON, else CONCEG_PYTHON); skipped without.
bin=$1
python=${CONCEG_AMICO_PYTHON:-${CONCEG_PYTHON:-python3}}
[ -x "$bin/conceg-fit" ] || { echo "SKIPPED: this build has no fit stage (libceres-dev)"; exit 77; }
"$python" -c "import amico" 2>/dev/null || { echo "SKIPPED: needs dmri-amico (pip install dmri-amico==2.1.1; CONCEG_AMICO_PYTHON names the Python that has it)"; exit 77; }
exec "$python" "$(dirname "$0")/amico_fit.py" "$bin"
