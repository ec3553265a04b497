#!/usr/bin/env bash
# all.sh [STAGE...]: everything that .ci/run does not run, or these stages of it; `all.sh list` names them. It goes on after
# a failure. A stage that has passed on the same sources is not run again. build/all.md has the table: stage, result,
# seconds, and the first test that failed. build/logs/all-STAGE.log has all that a stage printed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Name, command
stages() {
  cat <<END
check        ./dev check
live         ./dev test live
usb          ./dev test usb
firmware     ./dev test firmware
autd3        ./dev test autd3
$(tests/house/matrix.sh list | awk '{ printf "%-12s ./dev test matrix %s\n", $1, $1 }')
fuzz         ./dev test fuzz 60 1
kill         ./dev test kill 60 1
soak         ./dev soak 10
soak-faults  ./dev soak 10 1
package      ./dev test package
wheel        ./dev test wheel
cluster      ./dev test cluster
bare-12      ./dev test bare 12
bare-13      ./dev test bare 13
END
}

if [[ ${1:-} == list ]]; then
  stages
  exit
fi
for name; do
  if ! stages | grep -q "^$name "; then
    echo "all: there is no stage $name; ./dev test all list names them" >&2
    exit 2
  fi
done

# The first test that failed, as ctest, GoogleTest or pytest names it; otherwise the last line.
first_failure() { # LOG
  grep -m 1 -oE '^(\[  FAILED  \] [^ ,]+|FAILED [^ ]+|.*Test +#[0-9]+: [^ ]+ .*(Failed|Timeout|Exception)|matrix: .*)' "$1" |
    sed -E 's/^\[  FAILED  \] //; s/^.*Test +#[0-9]+: ([^ ]+) .*/\1/; s/^FAILED //' | grep . || tail -n 1 "$1"
}

results=build/all
mkdir -p "$results" build/logs
tree=$(tests/house/tree.sh)
# shellcheck disable=SC2086  # a command's words
while read -r name command; do
  ((!$#)) || [[ " $* " == *" $name "* ]] || continue
  if [[ -n $tree && -f $results/$name ]] && grep -q "^$tree|passed|" "$results/$name"; then
    echo "== $name: has passed on these sources"
    continue
  fi
  echo "== $name: $command"
  begin=$SECONDS result=passed first=
  if ! $command </dev/null >"build/logs/all-$name.log" 2>&1; then
    result=FAILED
    first=$(first_failure "build/logs/all-$name.log")
  elif grep -qE '^(bare|firmware|package|wheel): skipped' "build/logs/all-$name.log"; then
    result=skipped first=$(grep -m 1 'skipped' "build/logs/all-$name.log")
  fi
  echo "$tree|$result|$((SECONDS - begin))|$first" >"$results/$name"
  echo "   $result, $((SECONDS - begin)) s${first:+: $first}"
done < <(stages)

# The table has the newest result of each stage; what other sources gave is old.
failed=0
{
  printf '# ./dev test all\n\nCommit %s, tree %s, %s cores.\n\n' "$(git log -1 --format=%h 2>/dev/null || echo none)" "${tree:-none}" "$(nproc)"
  printf '| stage | result | seconds | first failed test |\n|---|---|---|---|\n'
  while read -r name _; do
    of=- result='not run' seconds=- first=
    [[ ! -f $results/$name ]] || IFS='|' read -r of result seconds first <"$results/$name"
    [[ $result == 'not run' || $of == "$tree" ]] || result="$result, on tree ${of:0:8}"
    printf '| %s | %s | %s | %s |\n' "$name" "$result" "$seconds" "$first"
  done < <(stages)
} >build/all.md
cat build/all.md
while read -r name _; do
  ((!$#)) || [[ " $* " == *" $name "* ]] || continue
  grep -q '|FAILED|' "$results/$name" && failed=1
done < <(stages)
exit $failed
