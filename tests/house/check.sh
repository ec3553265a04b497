#!/usr/bin/env bash
# check.sh [quick]: all checks of the sources that do not run them. quick: those that need no build; this takes seconds.
# Without quick, build/release must be built. The sources must be a git repository.
# shellcheck disable=SC2317  # the steps are called by name
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit
git rev-parse --is-inside-work-tree >/dev/null || exit

bad=0
step() { # NAME COMMAND...: runs all steps, so that one run shows all faults
  local begin=$SECONDS
  printf '== %s\n' "$1"
  if "${@:2}"; then
    printf '   fine, %d s\n' $((SECONDS - begin))
  else
    printf '   FAILED\n'
    bad=1
  fi
}

# The project's files, also those not yet committed. PATTERN...: git pathspecs
files() {
  git ls-files --cached --others --exclude-standard --deduplicate -- "$@" | while read -r file; do
    [[ -f $file ]] && printf '%s\n' "$file"
  done
}

# No line of these files matches.
without() { # EXPRESSION [GIT-PATHSPEC...]
  local hits
  hits=$(files "${@:2}" | xargs -r -d '\n' grep -nIE -e "$1" --)
  [[ -z $hits ]] && return
  printf '%s\n' "$hits"
  return 1
}

# One version of clang-format for everybody: versions differ in details.
format() {
  local version
  version=$(clang-format --version | grep -o '[0-9]\+' | head -n 1)
  if ((version != 14)); then
    echo "   clang-format $version; the project is formatted with 14: not checked"
    return 0
  fi
  files '*.cpp' '*.hpp' '*.c' '*.h' | xargs -r clang-format --dry-run -Werror
}

tidy() { python3 tests/house/tidy.py build/release; }

shell() {
  local scripts
  mapfile -t scripts < <(files '*.sh' dev '.ci/*')
  shellcheck "${scripts[@]}"
}

# Which library may include which: tests/house/arrows.awk.
arrows() { files 'engine/*.?pp' 'driver/*.?pp' 'viewer/*.?pp' 'assets/*.?pp' | xargs -r awk -f tests/house/arrows.awk; }

# The walks of docs/notes/forms.md match the sources.
walks() { python3 tests/house/walks.py; }

# Plain English.
words() {
  without "$(sed '/^#/d; s/\t.*//' tests/house/refused-words.txt)" ':!LICENSE' ':!tests/house/refused-words.txt' && return
  echo "   tests/house/refused-words.txt says what to write instead"
  return 1
}

# Each source includes what it uses: tests/house/includes.py.
includes() { files 'engine/*.?pp' 'driver/*.?pp' 'viewer/*.?pp' 'assets/*.?pp' 'python/*.?pp' 'tests/*.?pp' | xargs -r python3 tests/house/includes.py; }

# Files are opened only where the register of files sees it: tests/house/files.py.
registered() { files 'engine/*.?pp' 'driver/*.?pp' 'viewer/*.?pp' 'python/*.?pp' | xargs -r python3 tests/house/files.py; }

# A file is a subject: what is longer is several.
sizes() {
  files '*.cpp' '*.hpp' '*.h' '*.c' '*.comp' '*.vert' '*.frag' '*.glsl' '*.sh' '*.py' '*.cmake' dev | xargs -d '\n' wc -l |
    awk '$1 > 1200 && $2 != "total" { print "   " $2 " has " $1 " lines: it is more than one subject, divide it"; bad = 1 } END { exit bad }'
}

# Nothing may depend on one machine's folders.
paths() { without "(^|[^A-Za-z0-9_.<])/(work|home|tmp|root|mnt|Users)/"; }

# Two users may run the tests on one machine: a test writes only into folders that scratch_folder gives it.
scratch() { without 'TempDir\(|temp_directory_path|tmpnam' 'tests/*.?pp' ':!tests/support/shared_data*'; }

# A test of a refusal looks at its exit code and its words: EXPECT_ERROR and EXPECT_REFUSED of support/thrown.hpp.
refusals() { without '_(ANY_)?THROW\(.*(\bError\)|ANY_THROW)' 'tests/*.cpp'; }

# Each shader has a user.
shaders() {
  local shader name found=0
  while read -r shader; do
    name=${shader##*/}
    grep -rqw --include=CMakeLists.txt "${name//./\\.}" engine viewer driver tests && continue
    echo "   no library compiles $shader"
    found=1
  done < <(files 'shaders/*.comp' 'shaders/*.vert' 'shaders/*.frag')
  return "$found"
}

# PAGE N FILE: the page's N-th piece of C++ must be that file of the package's test.
shows() {
  awk -v wanted="$2" '/^```/ { inside = /cpp/ && ++seen == wanted; next } inside' "$1" |
    diff - "tests/package/consumer/$3" && return
  echo "   $1 shows another $3 than the one that is tested"
  return 1
}

# PAGE: prints the anchors of its headings, one per line.
anchors() {
  # shellcheck disable=SC2016  # the pages' backquotes
  sed '/^```/,/^```/d' "$1" | grep -E '^#+ ' | sed -E 's/^#+ +//' | tr '[:upper:]' '[:lower:]' | tr -cd 'a-z0-9_ \n-' | tr ' ' '-'
}

# Pages link to files, headings and tests that exist, and all examples that they show are compiled.
docs() {
  local page target found=0
  # shellcheck disable=SC2016  # the pages' backquotes
  while read -r target; do
    if ! grep -rqE --include='*.cpp' "^TEST(_F|_P)?\\(${target/./, }\\)" tests; then
      echo "   docs/safety.md names a test $target, which does not exist"
      found=1
    fi
  done < <(grep -oE '`[A-Z][A-Za-z]+\.[A-Z][A-Za-z0-9]+`' docs/safety.md | tr -d '`' | sort -u)
  while read -r page; do
    while read -r target; do
      if [[ ! -e ${page%"${page##*/}"}$target ]]; then
        echo "   $page points to $target, which does not exist"
        found=1
      fi
    done < <(grep -o '](\([^)#:]*\)[^):]*)' "$page" | sed 's/^](//; s/[#)].*//' | grep .)
    while IFS='#' read -r target heading; do
      [[ -n $target ]] && target=${page%"${page##*/}"}$target
      if ! anchors "${target:-$page}" | grep -qxF -- "$heading"; then
        echo "   $page points to #$heading of ${target:-$page}, which has no such heading"
        found=1
      fi
    done < <(grep -oE '\]\([^):]*\.md#[^)]*\)|\]\(#[^)]*\)' "$page" | sed 's/^](//; s/)$//')
  done < <(files '*.md')
  shows docs/add-a-link.md 1 byte_link.hpp || found=1
  shows docs/cpp-api.md 3 live.hpp || found=1
  while IFS=: read -r page pieces; do
    for ((piece = 1; piece <= pieces; piece++)); do
      grep -qE "(shows |piece\()$page $piece " tests/house/check.sh tests/package/consumer/CMakeLists.txt && continue
      echo "   nothing compiles piece $piece of $page"
      found=1
    done
  done < <(files '*.md' | xargs grep -c '^```cpp')
  return "$found"
}

# The tree in docs/architecture.md is the tree of the folders.
tree() {
  awk '/^    [a-z]/ && !done { inside = 1 } inside && !/^ / { done = 1; inside = 0 }
       inside { match($0, /^ +/); depth = (RLENGTH - 4) / 2; folder[depth] = $1; path = ""
                for (i = 0; i <= depth; i++) path = path folder[i]; print path }' docs/architecture.md | sort |
    diff - <(files 'engine/*' 'viewer/*' 'driver/*' 'python/*' 'shaders/*' 'assets/*' 'examples/*' 'tests/*' | tree_of) && return
  echo "   the tree in docs/architecture.md (left) is not that of the folders (right)"
  return 1
}

# Every folder above the files on stdin. Left out are folders of tests that mirror other folders, and folders with
# pictures only.
tree_of() {
  awk -F/ '{ path = ""; for (i = 1; i < NF; i++) { path = path $i "/"; print path } }' | sort -u | while read -r folder; do
    case $folder in
      tests/ | tests/cli/ | tests/tools/ | tests/support/ | tests/house/ | tests/bare/ | tests/usb/ | tests/package/*) printf '%s\n' "$folder" ;;
      tests/*) mirrored "${folder#tests/}" || echo "$folder" ;;
      *) printf '%s\n' "$folder" ;;
    esac
  done
}

mirrored() { [[ -d $1 || -d engine/$1 || $1 == viewer/references/ ]]; }

step "clang-format" format
step "tree of folders" tree
step "walks" walks
step "docs" docs
step "words" words
step "arrows between libraries" arrows
step "includes" includes
step "register of files" registered
step "file sizes" sizes
step "machine paths" paths
step "scratch folders" scratch
step "refusals in tests" refusals
step "shaders in use" shaders
step "shellcheck" shell
[[ ${1-} == quick ]] || step "clang-tidy" tidy
exit $bad
