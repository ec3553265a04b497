#!/usr/bin/env bash
# first_hour.sh: the commands with which a person begins in a lab who has one board, one camera and the README, in a
# folder of the project where `./dev demo` has built it. Camera, finger and board are simulated. Says how long each
# command took, and fails if one fails, or if nothing touched or reached the board.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
export PATH=$PWD/build/release/bin:$PATH

out=out/first-hour rig=assets/rigs/openmpd-one.toml board=FIRST$$ begin=$SECONDS
rm -rf "$out"
mkdir -p "$out"

# does WHAT COMMAND...: runs it, and says how long it took.
does() {
  local began=$SECONDS log=$out/$((++steps)).log
  printf '\n%s\n    %s\n' "$1" "${*:2}"
  "${@:2}" >"$log" 2>&1 || {
    cat "$log"
    echo "first-hour: failed: ${*:2}"
    exit 1
  }
  sed 's/^/    | /' "$log" | tail -n 12
  printf '    %d s\n' "$((SECONDS - began))"
}
# says FILE WORDS: the file has a line with these words.
says() {
  grep -qE "$2" "$1" && return
  echo "first-hour: $1 has no line with '$2'"
  exit 1
}
steps=0

does "What is there" palpa doctor
does "Where the camera stands: what it will see (docs/cameras.md, beside one board)" palpa doctor --rig "$rig"
palpa emulate openmpd --serial "$board" >"$out/board.log" 2>&1 &
emulator=$!
trap 'kill "$emulator" 2>/dev/null || true' EXIT
until grep -q sock "$out/board.log"; do
  kill -0 "$emulator"
  sleep 0.1
done
does "The board answers (docs/boards.md)" palpa link test --link "openmpd:$board" --last 7 --each 100ms
keys=
for ((i = 0; i < 8; i++)); do keys+="wait*20 enter "; done
does "Calibrated by touch (docs/calibration.md): eight foci, a simulated finger, Enter" \
  palpa calibrate --by-touch --rig "$rig" --link "openmpd:$board" --ceiling 0.3 --keys "$keys" --out "$out/touched.toml"
says "$out/4.log" ': 8 touches, '
does "The first touch" palpa run --scene assets/cube.glb --rig "$out/touched.toml" --source synthetic \
  --link "openmpd:$board" --ceiling 0.3 --frames 200 --json "$out/run.json"
says "$out/5.log" '[1-9][0-9]* were completed'
says "$out/5.log" '^200 frames, [1-9][0-9]* with a touch'
does "The same as a picture" palpa-viewer --scene assets/cube.glb --rig "$out/touched.toml" --source synthetic \
  --headless --screenshot "$out/touch.png"
kill -INT "$emulator"
trap - EXIT
wait "$emulator" || {
  cat "$out/board.log"
  echo "first-hour: the emulator saw a fault"
  exit 1
}
sed 's/^/    | /' "$out/board.log"
printf '\nfirst-hour: first touch %d s after the build\n' "$((SECONDS - begin))"
