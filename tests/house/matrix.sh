#!/usr/bin/env bash
# matrix.sh [LEG...]: the tests under sanitizers, Vulkan validation, thread counts, vector widths and memory modes, and
# with meshes of every size. Without arguments, it runs all legs; `matrix.sh list` names them. It stops at the first leg
# that fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export PALPA_BACKEND=gpu  # also where the only device is lavapipe

# Name, preset, the tests (a ctest label, - for all), environment. The faults that only this leg can show:
#   threads-2     races between a dispatch's workgroups; subgroups of 16 lanes; memory that is shared, and read before it is
#                 written. Runs one test at a time, so that its threads have the cores. Nothing is drawn: Mesa 22 cannot.
#   sync          violations of Vulkan's rules, which core validation alone would show, too, and missing barriers;
#                 subgroups of 4 lanes; separate host and device memory, with copies between them, as on a discrete GPU,
#                 and read before they are written
#                 Not seen with Debian 12's layer: a missing barrier before a kernel that reads and writes one buffer, or
#                 that reads texels.
#   gpu-assisted  accesses outside of a buffer; violations of Vulkan's rules with shared memory
#   corpus        meshes of every size, and more samples of other legs' tests (tests/support/exhaustive.hpp)
#   asan          errors in the host's memory and undefined behaviour, in all tests
#   tsan          races between the host's threads
# tests/house/suite.sh and ./dev test use one driver thread and subgroups of 8 lanes unless a leg sets something else.
# Other drivers ignore lavapipe's variables.
legs() {
  # The legs of the label gpu test the driver: the cases of a pass's twin run in ./dev test and under asan.
  local filter='GTEST_FILTER=-*/cpu'
  # Instrumented kernels are compiled again for every pass that is created; a solver's takes most of a minute. So a
  # single test of test_solver_pass, which runs each kernel once, is the only one that solves.
  local solvers='Backends/SolverOn.*:Solvers.*:SolverPass.*AtEverySize:SolverPass.TheSameBytes*'
  cat <<END
threads-2    release gpu     $filter LP_NUM_THREADS=2 PALPA_JOBS=1 LP_NATIVE_VECTOR_WIDTH=512 LVP_POISON_MEMORY=1
sync         release gpu     $filter PALPA_VALIDATION=sync LP_NATIVE_VECTOR_WIDTH=128 PALPA_FORCE_STAGING=1 LVP_POISON_MEMORY=1
gpu-assisted release gpu     $filter:$solvers PALPA_VALIDATION=gpu-assisted
corpus       release corpus  PALPA_EXHAUSTIVE=1
asan         asan    -
tsan         tsan    threads
END
}

if [[ ${1:-} == list ]]; then
  legs
  exit
fi

for name; do
  if ! legs | grep -q "^$name "; then
    echo "matrix: there is no leg $name; matrix list names them" >&2
    exit 2
  fi
done

# What the legs of an earlier run computed from the same sources is compared, too.
digests=build/digests
tree=$(tests/house/tree.sh)
[[ -n $tree && -f $digests/tree && $(<"$digests/tree") == "$tree" ]] || rm -rf "$digests"
mkdir -p "$digests" build/logs
echo "$tree" >"$digests/tree"

# The targets of the tests of a label. They have the tests' names. A sanitizer thus builds only what it runs.
targets_of() { # PRESET LABEL
  ctest --test-dir "build/$1" -N -L "^$2\$" | sed -n 's/^ *Test *#[0-9]*: //p'
}

build_leg() { # PRESET LABEL
  local targets=()
  cmake --preset "$1" --log-level=WARNING >/dev/null
  if [[ $2 != - ]]; then
    mapfile -t targets < <(targets_of "$1" "$2")
  fi
  cmake --build --preset "$1" ${targets[0]+--target "${targets[@]}"}
}

run_leg() { # NAME PRESET LABEL [VARIABLE=VALUE...]
  local name=$1 preset=$2 label=$3 filter=() begin=$SECONDS built log=build/logs/matrix-$1.log
  shift 3
  echo "== $name: ${*:+$* }tests $label, preset $preset"
  if ! build_leg "$preset" "$label" >"$log" 2>&1; then
    cat "$log"
    echo "matrix: $name does not build"
    return 1
  fi
  built=$((SECONDS - begin))
  [[ $label == - ]] || filter=(-L "^$label\$")
  rm -rf "${digests:?}/$name"
  mkdir "$digests/$name"
  if ! env "$@" PALPA_DIGESTS="$PWD/$digests/$name" tests/house/suite.sh "$preset" "${filter[@]}" \
    >"$log" 2>&1; then
    rm -r "${digests:?}/$name"
    cat "$log"
    echo "matrix: $name fails"
    return 1
  fi
  # The final lines of ctest: passed and failed, labels, time.
  sed -n '/tests passed/,$p' "$log"
  printf '== %s: passed, %d s of which build %d s\n' "$name" $((SECONDS - begin)) "$built"
}

# The same input gives the same bytes: one file per leg and result (tests/support/digest.hpp).
compare_digests() {
  local file name leg
  local -A first=() legs=()
  for file in "$digests"/*/*; do
    [[ -f $file ]] || continue
    name=${file##*/} leg=${file%/*} leg=${leg##*/}
    legs[$name]+=" $leg"
    if [[ -z ${first[$name]:-} ]]; then
      first[$name]=$file
    elif ! diff "${first[$name]}" "$file"; then
      echo "matrix: $leg computes another $name than${legs[$name]% *}"
      return 1
    fi
  done
  for name in "${!legs[@]}"; do
    [[ ${legs[$name]} != *' '*' '* ]] || echo "== the same $name, byte for byte, in${legs[$name]}"
  done
}

while read -r name preset label environment; do
  ((!$#)) || [[ " $* " == *" $name "* ]] || continue
  read -ra variables <<<"$environment"
  run_leg "$name" "$preset" "$label" "${variables[@]}" </dev/null
done < <(legs)
compare_digests
