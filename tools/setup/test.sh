#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 to every test passed: installs what is missing; shows that Clang, debug, sanitizers and emulated ARM
# boards compute the same bits as GCC; builds the release preset and passes its suite, which holds every test.
# `test.sh PRESET…` passes the suites of those presets instead, the last one last; `test.sh all` those of each of them.
# Stops at the first failure.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh

others=(clang debug asan aarch64 armhf cortex-m7)
presets=("$@")
bits=()
if [ ${#presets[@]} -eq 0 ]; then
  presets=(release)
  bits=("${others[@]}")
fi
if [ "${presets[*]}" = all ]; then presets=("${others[@]}" release); fi

# shellcheck disable=SC2086  # lists of words
install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_TEST $PLVO_PACKAGES_CROSS

started=$SECONDS
build() {
  local preset=$1 generator=()
  say "[$((SECONDS - started)) s] $preset: building"
  if [ ! -f "build/$preset/CMakeCache.txt" ]; then generator=(-G Ninja); fi
  # An earlier demo may have left the tests out of this folder.
  cmake --preset "$preset" "${generator[@]}" -DPLVO_BUILD_TESTS=ON >&2
  cmake --build --preset "$preset" --parallel "$(nproc)" "${@:2}" >&2
}
suite() {
  say "[$((SECONDS - started)) s] $1: testing"
  ctest --preset "$1" --parallel "$(nproc)" "${@:2}"
}

for preset in "${bits[@]}"; do
  build "$preset" --target golden_test
  suite "$preset" --tests-regex '^golden_test$'
done
last=${presets[-1]}
unset 'presets[-1]'
for preset in "${presets[@]}"; do
  build "$preset"
  suite "$preset"
done
build "$last"
if [ ${#presets[@]} -gt 0 ]; then tests/golden/compare_presets.sh "${presets[@]}" "$last"; fi
suite "$last"
