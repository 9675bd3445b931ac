#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Makes dist/viewer.html anew, byte for byte (node 18 or newer, npm). Only for changing the viewer: builds of ConCeG take dist/ as it is.
set -eu
cd -- "$(dirname -- "$0")"
npm ci --ignore-scripts --no-audit --no-fund --silent
node build.mjs
