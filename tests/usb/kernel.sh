#!/usr/bin/env bash
# kernel.sh: prints the folder with Debian's own kernel and udev, which it fetches if it is not there: vmlinux, USB's modules NAME.ko,
# `order`, the modules as they are to be loaded at the start, udevadm and the library that it needs. The packages are unpacked below
# build/ and not installed: nothing of this machine changes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

die() {
  printf 'kernel.sh: %s\n' "$*" >&2
  exit 1
}

# Each needs what stands before it.
modules=(usb-common usbcore usbip-core vhci-hcd
  mc videodev videobuf2-common videobuf2-memops videobuf2-v4l2 videobuf2-vmalloc uvcvideo)
# Those that a test loads itself.
later=(usbserial ftdi_sio)
all=build/usb/kernel

# The package's name has a version in it, and the archive keeps the newest only.
name() { apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image/ { print $2; exit }'; }

# Sets `package`; its file and udev's, or what has been made of them, are there then.
download() {
  package=$(name)
  [[ -n $package ]] || return
  [[ -f $all/$package/udevadm ]] && return
  (cd "$all" && apt-get -q -o APT::Sandbox::User=root download "$package" udev libkmod2 >/dev/null)
}

unpack() {
  local in=$all/unpacked module packed at
  rm -rf "$in" "${all:?}/$package"
  mkdir -p "$in/guest"
  dpkg-deb --fsys-tarfile "$all/$package"_*.deb | tar -x -C "$in" --wildcards './boot/vmlinuz*' \
    './lib/modules/*/kernel/drivers/usb/*' './lib/modules/*/kernel/drivers/media/*'
  for module in "${modules[@]}" "${later[@]}"; do
    find "$in/lib/modules" -name "$module.ko" -exec mv {} "$in/guest/" \;
    [[ -f $in/guest/$module.ko ]] || die "$package has no module $module"
  done
  # The kernel as it was before it was packed: a machine that is emulated takes two seconds to unpack it.
  packed=("$in"/boot/vmlinuz*)
  at=$(LC_ALL=C grep -abo $'\xfd7zXZ' "${packed[0]}" | head -n 1 | cut -d : -f 1) || true
  [[ -n $at ]] || die "$package's kernel is not packed with xz"
  # More follows than the kernel, which xz says and minds.
  tail -c +$((at + 1)) "${packed[0]}" | xz -dc --single-stream 2>/dev/null >"$in/guest/vmlinux" || true
  [[ -s $in/guest/vmlinux ]] || die "$package's kernel cannot be unpacked"
  dpkg-deb -x "$all"/udev_*.deb "$in"
  dpkg-deb -x "$all"/libkmod2_*.deb "$in"
  cp "$in/bin/udevadm" "$in"/usr/lib/*/libkmod.so.2 "$in/guest/"
  printf '%s\n' "${modules[@]}" >"$in/guest/order"
  mv "$in/guest" "$all/$package"
  rm -rf "$in" "$all"/*.deb
}

if ! command -v apt-get >/dev/null || ! command -v dpkg-deb >/dev/null; then
  die "the guest runs Debian's kernel (package linux-image-amd64), and there is no apt-get here to fetch it with"
fi
mkdir -p "$all"
# Package lists may be absent or outdated.
if ! download && ! { ((EUID == 0)) && apt-get -q update >&2 && download; }; then
  kept=$(find "$all" -mindepth 2 -maxdepth 2 -name udevadm -printf '%h\n' | sort -V | tail -n 1)
  [[ -n $kept ]] || die "apt-get cannot fetch the kernel (package linux-image-amd64): try apt-get update; is there a network?"
  package=${kept##*/}
fi
[[ -f $all/$package/udevadm ]] || unpack
echo "$all/$package"
