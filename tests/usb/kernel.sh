#!/usr/bin/env bash
# kernel.sh: prints the folder with Debian's own kernel and udev, and fetches them if they are missing. The folder has
# vmlinux, USB's modules NAME.ko, `order` (the modules in the order in which they are loaded at the start), udevadm and
# the library that it needs. The packages are unpacked below build/ and not installed: nothing on this machine changes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

die() {
  printf 'kernel.sh: %s\n' "$*" >&2
  exit 1
}

modules=(vhci-hcd uvcvideo)
# Modules that a test loads itself.
later=(usbserial ftdi_sio)
all=build/usb/kernel

# The package's name contains a version, and the archive keeps the newest only.
name() { apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image/ { print $2; exit }'; }

# Sets `package`. Afterwards, its file and udev's, or the results made from them, exist.
download() {
  package=$(name)
  [[ -n $package ]] || return
  [[ -f $all/$package/udevadm ]] && return
  (cd "$all" && apt-get -q -o APT::Sandbox::User=root download "$package" udev libkmod2 >/dev/null)
}

# need MODULE LIST: puts it and its dependencies into the guest. The list gets all of them, each after its dependencies.
# Dependencies differ between kernels; each module names its own.
need() {
  local name=${1//-/_} list=$2 found other
  grep -qsx "$name" "$list" && return
  found=$(find "$in" -name '*.ko*' | awk -v wanted="$name" '{ base = $0; gsub(/.*\/|[.]ko.*/, "", base); gsub(/-/, "_", base) } base == wanted' | head -n 1)
  [[ -n $found ]] || die "$package has no module $1"
  case $found in
    *.xz) xz -dc "$found" >"$in/guest/$name.ko" ;;
    *.zst) zstd -dcq "$found" >"$in/guest/$name.ko" ;;
    *) cp "$found" "$in/guest/$name.ko" ;;
  esac
  for other in $(LC_ALL=C grep -az '^depends=' "$in/guest/$name.ko" | tr -d '\0' | sed 's/^depends=//' | tr ',' ' '); do
    need "$other" "$list"
  done
  echo "$name" >>"$list"
}

# The kernel as it was before it was packed: an emulated machine takes two seconds to unpack it. There is more data
# after the kernel, which the unpackers report, but which is no error here.
unpack_kernel() { # FROM TO
  local at
  at=$(LC_ALL=C grep -abo $'\xfd7zXZ' "$1" | head -n 1 | cut -d : -f 1) || true
  if [[ -n $at ]]; then
    tail -c +$((at + 1)) "$1" | xz -dc --single-stream 2>/dev/null >"$2" || true
  else
    at=$(LC_ALL=C grep -abo $'\x28\xb5\x2f\xfd' "$1" | head -n 1 | cut -d : -f 1) || true
    [[ -n $at ]] || die "$package's kernel is packed with neither xz nor zstd"
    tail -c +$((at + 1)) "$1" | zstd -dcq 2>/dev/null >"$2" || true
  fi
  [[ -s $2 ]] || die "$package's kernel cannot be unpacked"
}

unpack() {
  local in=$all/unpacked module library
  rm -rf "$in" "${all:?}/$package"
  mkdir -p "$in/guest"
  dpkg-deb -x "$all/$package"_*.deb "$in"
  for module in "${modules[@]}"; do need "$module" "$in/guest/order"; done
  for module in "${later[@]}"; do need "$module" "$in/guest/later"; done
  unpack_kernel "$(echo "$in"/boot/vmlinuz*)" "$in/guest/vmlinux"
  dpkg-deb -x "$all"/udev_*.deb "$in"
  dpkg-deb -x "$all"/libkmod2_*.deb "$in"
  # On Debian 13, all of them are below /usr.
  library=$(find "$in" -name libkmod.so.2)
  cp "$(find "$in" -path '*/bin/udevadm')" "$library" "$in/guest/"
  mv "$in/guest" "$all/$package"
  rm -rf "$in" "$all"/*.deb
}

if ! command -v apt-get >/dev/null || ! command -v dpkg-deb >/dev/null; then
  die "the guest runs Debian's kernel (package linux-image-amd64), and there is no apt-get here to fetch it with"
fi
mkdir -p "$all"
# Package lists may be missing or out of date.
if ! download && ! { ((EUID == 0)) && tests/house/wait_for_apt.sh apt-get -q update >&2 && download; }; then
  kept=$(find "$all" -mindepth 2 -maxdepth 2 -name udevadm -printf '%h\n' | sort -V | tail -n 1)
  [[ -n $kept ]] || die "apt-get cannot fetch the kernel (package linux-image-amd64): try apt-get update; is there a network?"
  package=${kept##*/}
fi
[[ -f $all/$package/udevadm ]] || unpack
echo "$all/$package"
