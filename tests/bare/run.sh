#!/usr/bin/env bash
# run.sh [12|13]...: palpa on a bare Debian, made here with debootstrap; on both versions if none is named. In each:
#   1. An ordinary user with sudo runs the README's two commands in a fresh copy of the project, with nothing installed
#      before. Between them come the commands of the first hour in a lab (first_hour.sh).
#   2. Another user, without sudo and without a writable home folder, builds a second copy beside the first one with
#      clang, with every warning an error, and runs the tests: without a network, in 4 GiB of memory, with a locale that
#      is not UTF-8 and a umask of 077.
#   3. The tests of the twins run on an emulated processor without AVX2.
# No step has a terminal, and the path of both copies has a space and a letter that is not ASCII. A compiler
# warning in the first copy is a failure, too: it would be an error for developers of palpa.
#
# Needs root (or sudo), Linux and a network. If one of them is missing, it says so and ends with exit code 0. Everything
# is in build/bare/VERSION, including logs. PALPA_BARE_LEGS: which of the three to run ["1 2 3"]; walk: 1 without the
# tests. PALPA_BARE_KEEP: if set, the system stays there afterwards. PALPA_BARE_CCACHE: a folder of ccache's with which
# the first user begins, for a quick second run; what it has was compiled with every warning an error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

who=bare
source tests/bare/debian.sh
declare -A clangs=([12]=14 [13]=19)
folder='/srv/Prüfstand eins' # holds both copies

say() { printf 'bare %s: %s\n' "$version" "$*"; }

for version; do
  [[ -n ${suites[$version]-} ]] || {
    echo "bare: there is no Debian $version here; known are ${!suites[*]}" >&2
    exit 2
  }
done
(($#)) || set -- 12 13

needs_root PALPA_BARE_LEGS,PALPA_BARE_KEEP,PALPA_BARE_CCACHE "$PWD/tests/bare/run.sh" "$@"

# by USER FOLDER COMMAND: runs it as that user, without a terminal.
by() {
  inside "$root" setpriv --reuid "$1" --regid "$1" --init-groups env "${environment[@]}" bash -c "cd '$folder/$2' && $3"
}

# Puts this shell and its children into a group of at most 4 GiB of memory.
take_4_gib() {
  local limit
  for limit in /sys/fs/cgroup/memory/palpa-bare/memory.limit_in_bytes /sys/fs/cgroup/palpa-bare/memory.max; do
    mkdir "${limit%/*}" 2>/dev/null || [[ -d ${limit%/*} ]] || continue
    echo $((4 << 30)) 2>/dev/null >"$limit" && echo "$BASHPID" 2>/dev/null >"${limit%/*}/cgroup.procs" && return
  done
  echo "this machine limits no memory by groups: all of it is used"
}

# offline USER FOLDER COMMAND: runs it as that user, without a network, in 4 GiB.
offline() (
  take_4_gib
  namespaces+=(--net)
  by "$@"
)

# step NAME COMMAND...: runs it with a separate log.
step() {
  local begin=$SECONDS log=$base/$1.log
  if ! "${@:2}" >"$log" 2>&1 </dev/null; then
    tail -n 60 "$log"
    say "$1 failed after $((SECONDS - begin)) s; all that it said is in $log"
    exit 1
  fi
  say "$1: passed in $((SECONDS - begin)) s"
}

bootstrap() {
  fresh_debian "$version" "$root"
  # A person with a user account and this project on the disk has sudo, and the program that unpacked the project.
  inside "$root" sh -euc '
    apt-get -q update
    DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends sudo
    useradd --create-home --home-dir /srv/ada --shell /bin/bash ada
    useradd --no-create-home --home-dir /nonexistent --shell /bin/bash ben
    echo "ada ALL=(ALL) NOPASSWD: ALL" >/etc/sudoers.d/ada
    ' >"$base/users.log" 2>&1
}

# copy USER NAME: makes another copy of the project.
copy() {
  local to=$root$folder/$2
  mkdir -p "$to"
  tar -C "$to" -xf "$base/palpa.tar"
  inside "$root" chown -R "$1:$1" "$folder/$2"
}

# Checks that the commands did their work, whatever their exit codes say.
ran() { # STEP WORDS
  grep -q "$2" "$base/$1.log" && return
  say "$1 ended well, but its log has no line with '$2'"
  exit 1
}

no_warnings() {
  local warned
  warned=$(grep -hE 'warning:' "$base"/readme-*.log | sort -u | head -n 20) || return 0
  printf '%s\n' "$warned"
  say "the compiler warned"
  exit 1
}

in_debian() {
  version=$1
  base=$PWD/build/bare/$version root=$base/root
  local legs=" ${PALPA_BARE_LEGS:-1 2 3} " environment begin=$SECONDS
  mkdir -p "$base"
  pack "$base/palpa.tar"
  bootstrap
  if [[ $legs == *' 1 '* || $legs == *' walk '* ]]; then
    copy ada palpa
    environment=(HOME=/srv/ada USER=ada)
    if [[ -n ${PALPA_BARE_CCACHE-} ]]; then
      environment+=(PALPA_WERROR=ON CCACHE_DIR=/srv/ada/ccache)
      cp -r "$PALPA_BARE_CCACHE" "$root/srv/ada/ccache"
      inside "$root" chown -R ada:ada /srv/ada/ccache
    fi
    step readme-demo by ada palpa './dev demo'
    ran readme-demo 'pictures, foci and drives are in'
    step first-hour by ada palpa tests/bare/first_hour.sh
    ran first-hour 'first touch [0-9]* s after the build'
    no_warnings
  fi
  if [[ $legs == *' 1 '* ]]; then
    step readme-test by ada palpa './dev test'
    ran readme-test '100% tests passed'
    no_warnings
  fi
  if [[ $legs == *' 2 '* || $legs == *' 3 '* ]]; then
    local clang=clang-${clangs[$version]}
    copy ben 'second palpa'
    step packages inside "$root" sh -c "
      cd '$folder/second palpa' && ./dev deps &&
      DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends $clang locales qemu-user &&
      localedef -i de_DE -f ISO-8859-1 de_DE.ISO-8859-1"
  fi
  if [[ $legs == *' 2 '* ]]; then
    environment=(HOME=/nonexistent USER=ben LC_ALL=de_DE.ISO-8859-1 PALPA_WERROR=ON "CC=$clang" "CXX=clang++-${clangs[$version]}")
    step second-demo offline ben 'second palpa' 'umask 077 && ./dev demo'
    step second-test offline ben 'second palpa' 'umask 077 && ./dev test'
    ran second-test '100% tests passed'
  fi
  if [[ $legs == *' 3 '* ]]; then
    environment=(HOME=/nonexistent USER=ben)
    step no-avx2 by ben 'second palpa' tests/bare/old_processor.sh
  fi
  say "all of it: $((SECONDS - begin)) s"
  [[ -n ${PALPA_BARE_KEEP-} ]] || rm -rf "$root" "$base/palpa.tar"
}

for debian; do in_debian "$debian"; done
