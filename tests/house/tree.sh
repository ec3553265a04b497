#!/usr/bin/env bash
# tree.sh: prints git's hash of the project's files as they are in this folder, committed or not; outside of a git
# repository, nothing. The same hash means the same sources.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
git rev-parse --is-inside-work-tree >/dev/null 2>&1 || exit 0
mkdir -p build
# A copy of the index, so that the user's own stays as it is.
index=$PWD/build/tree.index
cp "$(git rev-parse --git-path index)" "$index"
GIT_INDEX_FILE=$index git add --all
GIT_INDEX_FILE=$index git write-tree
rm "$index"
