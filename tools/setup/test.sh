#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs plvo's packages on Debian 12 and runs all tests, in these steps:
# - installs the missing packages;
# - checks that emulated ARM boards give the same results as this machine bit for bit, and measures the code and the stack on the
#   boards;
# - builds with Clang, the address sanitizer and the undefined behaviour sanitizer: runs each fuzzer briefly and the tests of the core's
#   modules that read images; checks that the results are the same bit for bit;
# - runs the tests with threads under the thread sanitizer;
# - builds the release preset and runs its suite, which contains every test.
# `test.sh PRESET…` instead runs the suites of these presets in this order; `test.sh all` runs those of all presets. The script stops
# at the first failure.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/setup/packages.sh

presets=("$@")
if [ "${presets[*]}" = all ]; then presets=(clang debug asan tsan aarch64 armhf armhf-neon cortex-m7 release); fi

# shellcheck disable=SC2086  # lists of words
install_packages $PLVO_PACKAGES_BUILD $PLVO_PACKAGES_TEST $PLVO_PACKAGES_CROSS

# Lets GCC fill 1 GB before it collects garbage: builds take about 15 % less time. Clang does not know this option.
export CXXFLAGS="--param=ggc-min-heapsize=1000000"

started=$SECONDS
# Background jobs end with the script.
trap 'jobs -p | xargs -r kill 2>/dev/null || true' EXIT
build() {
  say "[$((SECONDS - started)) s] $1: building"
  if [ "$1" = clang ]; then env --unset=CXXFLAGS cmake --preset "$1" >&2; else cmake --preset "$1" >&2; fi
  cmake --build --preset "$1" --parallel "$(nproc)" "${@:2}" >&2
}
# suite PRESET TESTS OPTION…: runs the tests that the options select. All must pass. Each of TESTS, a list of words, must run, and only
# the tests in tests/allowed_skips.txt may be skipped.
suite() {
  say "[$((SECONDS - started)) s] $1: testing"
  # Some tests build projects of a user's, with his compiler and without flags.
  env --unset=CXXFLAGS ctest --preset "$1" --parallel "$(nproc)" --no-tests=error --output-junit ran.xml "${@:3}"
  # shellcheck disable=SC2086  # a list of words
  python3 tests/architecture/ran.py "build/$1/ran.xml" "$1" $2
}
# Names of the ctest entries that the fuzzers' files must produce.
fuzzers() { basename --multiple --suffix=.cpp tests/fuzz/fuzz_*.cpp; }

# Runs only the tests that need the other presets; `test.sh all` runs their complete suites.
briefly() {
  # The run of an emulated board takes minutes in a single thread: it continues during the next builds.
  local preset programs tests emulated=()
  for preset in cortex-m7 aarch64; do
    programs=(golden_test map_golden_test) tests="golden_test map_golden_test budget_text"
    if [ "$preset" = cortex-m7 ]; then programs+=(footprint stack_program) tests+=" budget_stack"; fi
    build "$preset" --target "${programs[@]}"
    suite "$preset" "$tests" --tests-regex "^(${tests// /|})$" >"build/$preset/golden.log" 2>&1 &
    emulated+=("$!:$preset")
  done
  build asan --target core_tests fuzzers
  suite asan "golden_test map_golden_test detector_test lsd_test odometry_states_test pose_graph_test $(fuzzers)" \
    --label-regex '^(core|golden|fuzz)$' --label-exclude '^unsanitized$'
  build tsan --target threaded_tests
  suite tsan "frame_ring_test pose_stream_test thread_pair_test live_view_test simulated_camera_test.threads" \
    --label-regex '^threads$'
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
  suite "$preset" golden_test
done
if [ "$last" = release ]; then
  # All libraries are installed, so every test file must have its ctest entry.
  cmake --preset release -DPLVO_ALL_TESTS=ON >&2
fi
build "$last"
if [ ${#presets[@]} -gt 0 ]; then tests/golden/compare_presets.sh "${presets[@]}" "$last"; fi
# Many tests of this suite wait for a stalled camera or a slow client: run more tests than there are processors.
suite "$last" golden_test --parallel "$((2 * $(nproc)))"
