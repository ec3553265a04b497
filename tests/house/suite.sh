#!/usr/bin/env bash
# suite.sh PRESET [CTEST ARGUMENT...]: runs the tests of a built preset.
#
# As many tests run side by side as there are cores. Two tests that mostly wait count as one (WAITS in
# cmake/Library.cmake). With lavapipe, each test has one rasterizer thread: two tests of one thread keep two cores busier
# than one test of two threads. The matrix tests what depends on the number of threads, and sets LP_NUM_THREADS itself.
# Drivers and layers have their caches in the build directory; lavapipe's compiled code depends only on the vectors'
# width.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

preset=$1
shift
export PALPA_BACKEND=gpu  # also where the only device is lavapipe
export LP_NUM_THREADS=${LP_NUM_THREADS:-1} LP_NATIVE_VECTOR_WIDTH=${LP_NATIVE_VECTOR_WIDTH:-256}
export OPENBLAS_NUM_THREADS=1  # those of numpy: further threads look for work in a loop while they have none
cache=$PWD/build/cache/$LP_NATIVE_VECTOR_WIDTH
mkdir -p "$cache"
export MESA_SHADER_CACHE_DIR=$cache/mesa XDG_CACHE_HOME=$cache

# For the presets asan and tsan; other presets ignore them. Reports name the ten innermost calls of an allocation: a
# program that stores thirty for each takes a quarter longer to start.
export ASAN_OPTIONS=handle_sigill=1:malloc_context_size=10 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=print_suppressions=0:suppressions=$PWD/tests/house/lsan.supp
export TSAN_OPTIONS=halt_on_error=1:suppressions=$PWD/tests/house/tsan.supp
run=()
if [[ $preset == tsan ]] && setarch --addr-no-randomize true 2>/dev/null; then
  # Kernels that randomise many bits of addresses put code where GCC 12's ThreadSanitizer needs its shadow memory.
  run=(setarch --addr-no-randomize)
fi

# The test times of the release build predict which tests are long here, so that no long test starts last.
costs=Testing/Temporary/CTestCostData.txt
if [[ -f build/release/$costs && ! -f build/$preset/$costs ]]; then
  mkdir -p "build/$preset/${costs%/*}"
  cp "build/release/$costs" "build/$preset/$costs"
fi

jobs=${PALPA_JOBS:-$(tests/house/jobs.sh tests 1200 "$(nproc)")}
exec "${run[@]}" ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$((2 * jobs))" "$@"
