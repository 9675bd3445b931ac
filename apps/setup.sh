# SPDX-License-Identifier: BSD-3-Clause
# Shared by apps/quickstart and tests/run: find the checkout, install what is missing, configure, build.
# Sourced with `set -eu`; expects `install` (yes|no) and `build` (folder) to be set.

root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)

say() { printf '%s\n' "$*" >&2; }
die() { say "error: $1"; exit "${2:-1}"; }

# What the build needs, by Debian 12 package.
packages="g++ cmake ninja-build pkg-config libhdf5-dev libyaml-dev libcgal-dev libembree-dev libopenvdb-dev libglm-dev libvtk9-dev libtbb-dev libqhull-dev libcairo2-dev libceres-dev libeigen3-dev libjsoncpp-dev zlib1g-dev"

missing_packages() {
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || printf '%s ' "$package"
  done
}

install_packages() {
  command -v dpkg-query >/dev/null 2>&1 || { say "not a Debian machine: taking the libraries as they are"; return 0; }
  missing=$(missing_packages "$@")
  [ -n "$missing" ] || return 0
  [ "$install" = yes ] || die "these packages are missing and --no-install was given: $missing" 5
  as_root=
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null 2>&1 || die "need root to install: $missing(run as root, or install them and use --no-install)" 5
    as_root=sudo
  fi
  say "installing with apt-get: $missing"
  $as_root apt-get update -q >/dev/null || die "apt-get update failed" 5
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing >"${TMPDIR:-/tmp}/conceg-apt.$$" 2>&1 || {
    tail -n 20 "${TMPDIR:-/tmp}/conceg-apt.$$" >&2
    die "apt-get could not install: $missing" 5
  }
  rm -f "${TMPDIR:-/tmp}/conceg-apt.$$"
}

configure_and_build() { # extra cmake options as arguments
  mkdir -p "$build"
  say "configuring in $build"
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" >"$build/configure.log" 2>&1 || {
    tail -n 30 "$build/configure.log" >&2
    die "configuring failed; the whole log is $build/configure.log"
  }
  sed -n 's/^-- stage /  stage /p' "$build/configure.log" >&2
  say "building (the first time takes some minutes)"
  if [ -t 2 ]; then ninja -C "$build" >&2 || die "the build failed"
  else
    ninja -C "$build" >"$build/build.log" 2>&1 || { grep -n -m 20 -A 12 'error\|FAILED' "$build/build.log" >&2; die "the build failed; the whole log is $build/build.log"; }
  fi
}
