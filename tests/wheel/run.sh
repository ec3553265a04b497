#!/usr/bin/env bash
# run.sh [12|13]...: the wheel of ./dev wheel in a bare Debian, made here with debootstrap; in both versions if none is
# named. Each gets a wheel for its Python. It is made on this machine, if this is Debian, not a newer one, and has that
# Python; otherwise in a second system of that version, in which ./dev installs what it needs. In the bare one, which has
# no compiler and no library of palpa's:
#   1. The wheel is installed with pip, beside the newest NumPy and beside the oldest that pip has for this Python.
#      use.py tries sensations, models, scattering, a live run and the guard, with numbers that NumPy computes.
#   2. Every tutorial runs. With Mesa's lavapipe, use.py computes on the device.
# The sdist has the project's files and no word of this machine.
#
# Needs root (or sudo), Linux and a network. If one of them is missing, it says so and ends with exit code 0. Everything
# is in build/wheel-test/VERSION. PALPA_WHEEL_KEEP: if set, the systems stay there afterwards.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

who=wheel
source tests/bare/debian.sh
declare -A pythons=([12]=3.11 [13]=3.13) oldest=([12]=1.24.* [13]=2.1.*)

for version; do
  [[ -n ${suites[$version]-} ]] || {
    echo "wheel: there is no Debian $version here; known are ${!suites[*]}" >&2
    exit 2
  }
done
(($#)) || set -- 12 13
needs_root PALPA_WHEEL_KEEP,PATH "$PWD/tests/wheel/run.sh" "$@"

say() { printf 'wheel %s: %s\n' "$version" "$*"; }
# step NAME COMMAND...: runs it with a separate log.
step() {
  local begin=$SECONDS log=$base/$1.log
  if ! "${@:2}" >"$log" 2>&1 </dev/null; then
    tail -n 40 "$log"
    say "$1 failed after $((SECONDS - begin)) s; all that it said is in $log"
    exit 1
  fi
  say "$1: passed in $((SECONDS - begin)) s"
}

# The wheel and the sdist of this Debian, in $base/wheels.
make_here() {
  local before
  before=$(ls -A)
  ./dev wheel "$1"
  if [[ $(ls -A) != "$before" ]]; then
    echo "making a wheel leaves something beside the sources"
    return 1
  fi
  rm -rf "$base/wheels"
  cp -r build/wheels "$base/wheels"
}
make_there() {
  local maker=$base/maker settings=(CCACHE_DIR=/srv/ccache)
  fresh_debian "$version" "$maker"
  mkdir -p "$maker/srv/palpa" "$base/ccache"
  pack "$base/palpa.tar"
  tar -C "$maker/srv/palpa" -xf "$base/palpa.tar"
  mv "$base/ccache" "$maker/srv/ccache" # what was compiled last time
  # pip there trusts whom pip here does.
  ! cp -L /etc/ssl/certs/ca-certificates.crt "$maker/srv/" || settings+=(PIP_CERT=/srv/ca-certificates.crt)
  local made=0
  inside "$maker" "${settings[@]}" sh -c 'apt-get -q update && cd /srv/palpa && ./dev wheel' || made=1
  mv "$maker/srv/ccache" "$base/ccache"
  rm -rf "$base/wheels"
  ((made)) || cp -r "$maker/srv/palpa/build/wheels" "$base/wheels"
  [[ -n ${PALPA_WHEEL_KEEP-} ]] || rm -rf "$maker" "$base/palpa.tar"
  return $made
}

# An sdist has the project's own files, and no word of the machine that made it.
look_at_sdist() {
  local sdist word
  sdist=$(echo "$base"/wheels/palpa-*.tar.gz)
  tar --numeric-owner -tvzf "$sdist" | awk '$2 != "0/0" || $1 ~ /^l/ { print "not like the others: " $0; bad = 1 } END { exit bad }'
  tar -tzf "$sdist" | sed 's,^[^/]*/,,' | grep -vx PKG-INFO | sort >"$base/sdist-files"
  if [[ -e .git ]]; then
    git -c safe.directory="$PWD" ls-files --cached --others --exclude-standard | sort >"$base/own-files"
    if comm -23 "$base/sdist-files" "$base/own-files" | grep .; then
      echo "the sdist has these files, which are not the project's"
      return 1
    fi
  fi
  # A short name may be in any file.
  for word in "$PWD" "$HOME/" "$(hostname)" /srv/palpa; do
    ((${#word} > 4)) || continue
    if tar -xzOf "$sdist" | grep -aFo -- "$word"; then
      echo "the sdist has this word of the machine that made it"
      return 1
    fi
  done
  return 0
}

# Packages of pip that the bare system gets, fetched here: it needs no network for them.
fetch() { # FOLDER PACKAGE...
  local tools=build/wheel-tools/fetch
  [[ -x $tools/bin/pip ]] || python3 -m venv "$tools"
  "$tools/bin/pip" download --quiet --dest "$1" --only-binary=:all: --python-version "${pythons[$version]}" \
    --platform manylinux_2_28_x86_64 --platform manylinux_2_27_x86_64 --platform manylinux_2_17_x86_64 --platform manylinux2014_x86_64 "${@:2}"
}

in_debian() {
  version=$1
  base=$PWD/build/wheel-test/$version root=$PWD/build/wheel-test/$version/root
  local begin=$SECONDS
  mkdir -p "$base"
  local python here
  here=$(sed -n 's/^VERSION_ID="\([0-9]*\)"$/\1/p' /etc/os-release)
  for python in /usr/bin/python3 "python${pythons[$version]}" ''; do
    [[ $("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) != "${pythons[$version]}" ]] || break
  done
  if [[ -n $python ]] && grep -qx ID=debian /etc/os-release && ((here <= version)); then
    step make make_here "$python"
  else
    step make make_there
  fi
  step sdist look_at_sdist
  mkdir -p "$base/newest" "$base/oldest"
  step fetch fetch "$base/newest" numpy matplotlib pandas
  step fetch-oldest fetch "$base/oldest" "numpy==${oldest[$version]}"

  fresh_debian "$version" "$root"
  step bare inside "$root" DEBIAN_FRONTEND=noninteractive sh -euc '
    apt-get -q update
    apt-get -q -y install --no-install-recommends python3 python3-venv
    ! command -v cc && ! command -v g++ && useradd --create-home --home-dir /srv/ada ada'
  cp -r "$base/wheels" "$base/newest" "$base/oldest" "$root/srv/"
  mkdir "$root/srv/tutorials"
  cp docs/python/*.py tests/wheel/use.py "$root/srv/tutorials/"
  by_ada() { inside "$root" setpriv --reuid ada --regid ada --init-groups env HOME=/srv/ada MPLBACKEND=Agg "$@"; }
  # shellcheck disable=SC2016  # expanded by the shell that is started
  local install='cd; for numpy in newest oldest; do
      python3 -m venv $numpy
      $numpy/bin/pip install --quiet --no-index --find-links /srv/$numpy /srv/wheels/*.whl
    done
    newest/bin/pip install --quiet --no-index --find-links /srv/newest matplotlib pandas' \
    use='cd; for numpy in oldest newest; do $numpy/bin/python -W error /srv/tutorials/use.py; done' \
    tutorials='mkdir ~/work; cd ~/work; for file in /srv/tutorials/[0-9]*.py; do echo "== $file"; ../newest/bin/python "$file"; done' \
    gpu='cd; newest/bin/python -W error /srv/tutorials/use.py gpu'
  step install by_ada sh -euc "$install"
  step use by_ada sh -euc "$use"
  step tutorials by_ada sh -euc "$tutorials"
  step driver inside "$root" DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends mesa-vulkan-drivers
  step gpu by_ada sh -euc "$gpu"
  say "all of it: $((SECONDS - begin)) s"
  [[ -n ${PALPA_WHEEL_KEEP-} ]] || rm -rf "$root"
}

for debian; do in_debian "$debian"; done
