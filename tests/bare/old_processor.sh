#!/usr/bin/env bash
# old_processor.sh: checks that the twins compute the same on an emulated processor of 2008, without AVX, as on this
# one. Needs a built build/release and qemu-x86_64 (Debian: qemu-user).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

old=(qemu-x86_64 -cpu Nehalem) bin=build/release/bin
out=build/bare/old-processor
mkdir -p "$out"
export PALPA_ASSETS=$PWD/assets OPENBLAS_NUM_THREADS=1

# The cases of the passes' twins, and the kernels of the boundary elements, which have separate code for processors with
# AVX2 and AVX-512. Left out is what takes minutes there.
"${old[@]}" "$bin/tests_touch" --gtest_brief=1 --gtest_filter='*/cpu:-*Many*:*Deep*'
"${old[@]}" "$bin/tests_acoustics" --gtest_brief=1 --gtest_filter='NearPairs.Memory*:NearRules.*:TriangleRules.*:SplitKernels.*:BlockGmres.*:FarForce.SeveralWaves*:BodyMesh.*:Incident.*'

# same NAME ARGUMENT...: runs one command on both processors. Its output in OUT must be the same, byte for byte.
same() {
  local name=$1 here=$out/$1-here there=$out/$1-there
  shift
  "$bin/palpa" "${@//OUT/$here}" --backend cpu --quiet
  "${old[@]}" "$bin/palpa" "${@//OUT/$there}" --backend cpu --quiet
  cmp "$here" "$there"
  echo "$name: the same bytes"
}

press=(--points assets/finger.ply --penetration 3mm)
same contacts touch --scene assets/semi-sphere.glb "${press[@]}" --csv OUT
same drive drive --layout paper --focus 0,0,0 --focus 2cm,0,0 --solver gs-pat --csv OUT
same field field --layout openmpd --focus 0,0,15cm --plane xz --centre 0,0,12cm --size 12cm,16cm --pixels 60,80 --csv OUT
