# shellcheck shell=bash
# debian.sh: what the tests in a bare Debian share; they source it with `who` set to their name in messages. Each system
# is made once with debootstrap and kept in build/debian.
who=${who:?}
declare -A suites=([12]=bookworm [13]=trixie)

skip() {
  printf '%s: skipped: %s\n' "$who" "$*"
  exit 0
}

# needs_root VARIABLES SCRIPT ARGUMENT...: skips where no bare Debian can be made; starts the script again with sudo, which
# keeps these variables of the environment, if this is not root.
needs_root() {
  [[ $(uname -s) == Linux ]] || skip "debootstrap needs Linux"
  if ((EUID != 0)); then
    if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then exec sudo --preserve-env="$1" "${@:2}"; fi
    skip "this needs root, or sudo without a password"
  fi
  command -v debootstrap >/dev/null || skip "there is no debootstrap here: apt-get install debootstrap"
  unshare --mount --pid --fork --kill-child true 2>/dev/null || skip "this machine allows no mounts of one's own (unshare)"
}

# fresh_debian VERSION ROOT: a bare Debian in that folder, with the network of this machine.
fresh_debian() {
  local kept=$PWD/build/debian/$1
  rm -rf "$2"
  mkdir -p "$2" build/debian
  if [[ ! -f $kept.tar ]]; then
    rm -rf "$kept"
    debootstrap --variant=minbase "${suites[$1]}" "$kept" >"$kept.log" 2>&1 || {
      tail -n 5 "$kept.log"
      skip "debootstrap could not make Debian $1: is there a network?"
    }
    rm -f "$kept"/var/cache/apt/archives/*.deb
    tar -C "$kept" -cf "$kept.tar.part" .
    mv "$kept.tar.part" "$kept.tar"
    rm -rf "$kept"
  fi
  tar -C "$2" -xf "$kept.tar"
  cp -L /etc/resolv.conf "$2/etc/resolv.conf"
  printf '127.0.0.1 localhost\n' >"$2/etc/hosts"
}

# Separate namespaces: everything that is mounted or started in them ends with them.
namespaces=(--mount --pid --fork --kill-child)

# inside ROOT COMMAND...: runs it in that system as root, with the environment that programs expect there.
inside() {
  # shellcheck disable=SC2016  # expanded by the shell that is started
  unshare "${namespaces[@]}" bash -euc '
    root=$1
    mkdir -p "$root/dev/pts" "$root/dev/shm"
    mount -t proc proc "$root/proc"
    mount -t devpts -o newinstance,ptmxmode=0666 devpts "$root/dev/pts"
    ln -sf pts/ptmx "$root/dev/ptmx"
    mount -t tmpfs -o mode=1777 shm "$root/dev/shm"
    [[ ! -x $root/bin/busybox ]] || chroot "$root" busybox ip link set lo up # down in a new namespace
    exec chroot "$root" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root "${@:2}"
    ' inside "$@"
}

# pack FILE: the project's files as they are, also those not yet committed.
pack() {
  git -c safe.directory="$PWD" ls-files --cached --others --exclude-standard --deduplicate -z |
    while IFS= read -r -d '' file; do [[ -e $file ]] && printf '%s\0' "$file"; done | tar -c --null -T - -f "$1"
}
