#!/usr/bin/env bash
# land.sh [COMMIT]: moves main to COMMIT (HEAD) if .ci/run passes in a clean clone of it, build/land/palpa. build/ci-passed
# has the tree that passed last; the same tree is not tested again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

die() {
  printf 'land: %s\n' "$*" >&2
  exit 1
}

commit=$(git rev-parse --verify --quiet "${1:-HEAD}^{commit}") || die "there is no commit ${1:-HEAD}"
git merge-base --is-ancestor main "$commit" || die "main has commits that ${1:-HEAD} does not have: merge main first"
[[ -z $(git status --porcelain) ]] || die "there are changes here that no commit has"
tree=$(git rev-parse "$commit^{tree}")
mkdir -p build/logs
if [[ ! -f build/ci-passed || $(<build/ci-passed) != "$tree" ]]; then
  clone=build/land/palpa
  rm -rf "$clone"
  git clone --quiet --no-checkout . "$clone"
  git -C "$clone" checkout --quiet --detach "$commit"
  # The tests look for further data beside the checkout, and ccache for paths that begin with the checkout.
  [[ ! -d ../shared ]] || export PALPA_SHARED=${PALPA_SHARED:-$(cd ../shared && pwd)}
  (cd "$clone" && env -u CCACHE_BASEDIR CI=true bash .ci/run) </dev/null 2>&1 | tee build/logs/land.log ||
    die "main stays where it is: .ci/run failed, see build/logs/land.log"
  echo "$tree" >build/ci-passed
  rm -rf "$clone"
fi
if [[ $(git symbolic-ref --quiet --short HEAD) == main ]]; then
  git merge --quiet --ff-only "$commit"
else
  git branch --force main "$commit"
fi
echo "land: main is $(git log -1 --format='%h %s' "$commit")"
