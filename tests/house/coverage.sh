#!/usr/bin/env bash
# coverage.sh [CTEST ARGUMENT...]: which lines of engine, driver, viewer and python the tests run, by folder. Builds the
# preset coverage. build/coverage/lines.csv has a row per file, build/coverage/lines.txt the lines that no test runs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

out=build/coverage
find "$out" -name '*.gcda' -delete
# A test that fails has run its lines all the same. Lines of a program that is killed, such as the guard, are not counted.
tests/house/suite.sh coverage "$@" >"$out/tests.log" 2>&1 || echo "coverage: some tests fail, see $out/tests.log"
gcovr --root . --object-directory "$out" -j "$(nproc)" --exclude-unreachable-branches --exclude-throw-branches \
  --filter 'engine/' --filter 'driver/' --filter 'viewer/' --filter 'python/' \
  --csv "$out/lines.csv" --txt "$out/lines.txt"
awk -F, '
  NR > 1 {
    split($1, part, "/")
    folder = part[1] == "engine" ? part[1] "/" part[2] : part[1]
    lines[folder] += $2; covered[folder] += $3; lines["all"] += $2; covered["all"] += $3
  }
  END {
    for (folder in lines) printf "%-20s %6d lines %6.2f %%\n", folder, lines[folder], 100 * covered[folder] / lines[folder]
  }' "$out/lines.csv" | sort
