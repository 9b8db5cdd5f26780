#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 to every test passed: installs what is missing; shows that Clang, sanitizers and emulated ARM
# boards compute the same bits as GCC, and what code and stack the boards take; runs each fuzzer briefly, the readers' suites
# and those of the core's rooms that read images under the address and undefined behaviour sanitizers, and what has threads
# under the thread sanitizer; builds the release preset and passes its suite, which holds every test. `test.sh PRESET…`
# passes the suites of those presets instead, the last one last; `test.sh all` those of each of them. Stops at the first
# failure.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh

presets=("$@")
if [ "${presets[*]}" = all ]; then presets=(clang debug asan tsan aarch64 armhf armhf-neon cortex-m7 release); fi

# shellcheck disable=SC2086  # lists of words
install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_TEST $PLVO_PACKAGES_CROSS

started=$SECONDS
# Whatever still runs ends with the script.
trap 'jobs -p | xargs -r kill 2>/dev/null || true' EXIT
build() {
  say "[$((SECONDS - started)) s] $1: building"
  cmake --preset "$1" >&2
  cmake --build --preset "$1" --parallel "$(nproc)" "${@:2}" >&2
}
suite() {
  say "[$((SECONDS - started)) s] $1: testing"
  ctest --preset "$1" --parallel "$(nproc)" --no-tests=error "${@:2}"
}

# What the other presets have to show, and no more: their whole suites take `test.sh all`.
briefly() {
  # An emulated board's run takes minutes in a single thread: it goes on beside what is built next.
  local preset programs emulated=()
  for preset in cortex-m7 aarch64 armhf; do
    programs=(golden_test)
    if [ "$preset" = cortex-m7 ]; then programs+=(footprint stack_program); fi
    build "$preset" --target "${programs[@]}"
    suite "$preset" --tests-regex '^(golden_test|budget_(text|stack))$' >"build/$preset/golden.log" 2>&1 &
    emulated+=("$!:$preset")
  done
  build clang --target golden_test fuzzers
  suite clang --tests-regex '^(golden_test|fuzz_.*)$'
  build asan --target core_and_reader_tests
  suite asan --label-regex '^(core|golden|reader)$' --label-exclude '^calculation$'
  build tsan --target threaded_tests
  suite tsan --label-regex '^threads$'
  local run passed
  for run in "${emulated[@]}"; do
    passed=yes
    wait "${run%%:*}" || passed=no
    cat "build/${run#*:}/golden.log"
    [ $passed = yes ]
  done
}

if [ ${#presets[@]} -eq 0 ]; then
  briefly
  presets=(release)
fi
last=${presets[-1]}
unset 'presets[-1]'
for preset in "${presets[@]}"; do
  build "$preset"
  suite "$preset"
done
build "$last"
if [ ${#presets[@]} -gt 0 ]; then tests/golden/compare_presets.sh "${presets[@]}" "$last"; fi
# Many of this suite's tests wait, for a camera that stalls or a client that is slow: more of them than processors.
suite "$last" --parallel "$((2 * $(nproc)))"
