#!/usr/bin/env bash
# deb.sh: the packages that ./dev package has made, in build/package. lintian reports no errors, the completions are scripts
# that their shells read, and in a bare Debian 12, made with debootstrap, palpa and palpa-viewer are installed, tried, used by
# a program (libpalpa-dev) and from Python (python3-palpa), and purged. Nothing of them is left then.
#
# The last part needs root (or sudo), Linux and a network. If one of them is missing, it says so and ends with exit code 0.
# Everything is in build/package-test. PALPA_PACKAGE_KEEP: if set, the system stays there afterwards.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

base=$PWD/build/package-test root=$base/root
mkdir -p "$base"
say() { printf 'package: %s\n' "$*"; }
die() {
  say "$*"
  exit 1
}
who=package
source tests/bare/debian.sh

version=$(sed -n 's/^project(palpa VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
debs=()
for name in palpa palpa-viewer libpalpa-dev python3-palpa; do
  file=$(find build/package -maxdepth 1 -name "${name}_${version}_*.deb")
  [[ -n $file ]] || die "there is no package of $name $version in build/package: ./dev package"
  debs+=("$file")
done

if command -v lintian >/dev/null; then
  lintian --fail-on error --profile debian --no-tag-display-limit "${debs[@]}" >"$base/lintian.log" 2>&1 || {
    grep '^E:' "$base/lintian.log"
    die "lintian reports errors; all of its output is in $base/lintian.log"
  }
  say "lintian: no errors, $(grep -c '^W:' "$base/lintian.log") warnings"
else
  say "lintian: skipped: it is not installed"
fi

# What is in the packages, unpacked.
rm -rf "$base/files"
for deb in "${debs[@]}"; do dpkg-deb -x "$deb" "$base/files"; done
bash -n "$base/files/usr/share/bash-completion/completions/palpa" || die "bash cannot read its completion"
complete=$(bash -c "source '$base/files/usr/share/bash-completion/completions/palpa'
  COMP_WORDS=(palpa touch --meth) COMP_CWORD=2; _palpa; echo \"\${COMPREPLY[*]}\"
  COMP_WORDS=(palpa touch --method cr) COMP_CWORD=3; _palpa; echo \"\${COMPREPLY[*]}\"
  COMP_WORDS=(palpa study an) COMP_CWORD=2; _palpa; echo \"\${COMPREPLY[*]}\"")
[[ $complete == $'--method\ncross-section\nanalyse' ]] || die "bash completes: $complete"
for shell in zsh fish; do
  command -v "$shell" >/dev/null || continue
  for script in "$base"/files/usr/share/"$shell"/vendor*/*; do "$shell" -n "$script" || die "$shell cannot read $script"; done
done
for page in "$base"/files/usr/share/man/man1/*.gz; do
  ! command -v man >/dev/null || man --warnings -l "$page" 2>&1 >/dev/null | { ! grep .; } || die "man warns of $page"
done
for option in palpa-touch:csv palpa-study-analyse:html palpa-viewer:screenshot; do
  zgrep -q "^.fB.*${option#*:}" "$base/files/usr/share/man/man1/${option%:*}.1.gz" || die "the page for man of ${option%:*} lacks --${option#*:}"
done
! command -v desktop-file-validate >/dev/null || desktop-file-validate --no-hints "$base/files/usr/share/applications/palpa-viewer.desktop"
! command -v appstreamcli >/dev/null || appstreamcli validate --no-net "$base"/files/usr/share/metainfo/*.xml >/dev/null || die "AppStream's metadata are faulty"
rm -rf "$base/files"
say "completion, pages for man, desktop file and metadata: read"

needs_root PALPA_PACKAGE_KEEP "$PWD/tests/package/deb.sh" "$@"

step() { # NAME COMMAND
  local begin=$SECONDS
  inside "$root" DEBIAN_FRONTEND=noninteractive sh -euc "$2" >"$base/$1.log" 2>&1 </dev/null || {
    tail -n 30 "$base/$1.log"
    die "$1 failed; all that it said is in $base/$1.log"
  }
  say "$1: passed in $((SECONDS - begin)) s"
}

fresh_debian 12 "$root"
mkdir "$root/debs"
cp "${debs[@]}" "$root/debs/"
cp -r tests/package/consumer docs README.md "$root/srv/"

step install 'apt-get -q update; apt-get -q -y install --no-install-recommends mesa-vulkan-drivers libopenblas0 /debs/palpa_*.deb /debs/palpa-viewer_*.deb
  test -f /usr/lib/udev/rules.d/70-palpa.rules; test -x /usr/libexec/palpa/palpa-guard; palpa --version; palpa-viewer --version'
step touch 'cd /usr/share/palpa/assets; palpa touch --scene cube.glb --points finger.ply --penetration 3mm --json /var/tmp/t.json
  grep -q "\"count\": 199" /var/tmp/t.json; palpa drive --backend gpu --layout paper --focus 0,0,0 --csv /var/tmp/d.csv; palpa simulate --scene cube.glb --finger finger.ply'
step viewer 'cd /usr/share/palpa/assets; palpa-viewer --scene cube.glb --points finger.ply --penetration 3mm --headless --screenshot /var/tmp/t.png
  test -s /var/tmp/t.png'
step consumer 'apt-get -q -y install --no-install-recommends /debs/libpalpa-dev_*.deb cmake g++ make
  cmake -S /srv/consumer -B /var/tmp/consumer -DCMAKE_BUILD_TYPE=Debug -DWANTED_VERSION='"$version"' -DPAGES=/srv
  cmake --build /var/tmp/consumer --target feel --parallel
  /var/tmp/consumer/feel /usr/share/palpa/assets/cube.glb /usr/share/palpa/assets/finger.ply'
step python 'apt-get -q -y install --no-install-recommends /debs/python3-palpa_*.deb; cd /var/tmp; test -d /usr/lib/python3/dist-packages/palpa/__pycache__
  python3 -W error -c "
import numpy as np, palpa
assert palpa.__version__ == \"'"$version"'\"
touch = palpa.Scene(\"/usr/share/palpa/assets/cube.glb\").touch(palpa.read_ply(\"/usr/share/palpa/assets/finger.ply\"), penetration=3e-3)
assert len(touch.contacts) == 199 and touch.fingers[0].foci.shape == (10, 3)
assert abs(palpa.Layout(\"openmpd\").drive([0, 0, 0.15])).max() <= 1
palpa.Session(palpa.Scene(\"/usr/share/palpa/assets/cube.glb\"), source=\"synthetic\").run(frames=3)
"'
# shellcheck disable=SC2016  # expanded in the new system
step purge 'dpkg -L palpa palpa-viewer libpalpa-dev python3-palpa | sort -u | grep -i palpa >/var/tmp/files; apt-get -q -y purge palpa palpa-viewer libpalpa-dev python3-palpa
  while read -r file; do ! test -e "$file" || { echo "$file is left"; exit 1; }; done </var/tmp/files'
say "all of it: $SECONDS s"
[[ -n ${PALPA_PACKAGE_KEEP-} ]] || rm -rf "$root"
