#!/usr/bin/env bash
# run.sh [GTEST ARGUMENT...]: boots Debian's kernel in an emulated machine and runs test_usb in it. There, this build's
# programs use the real USB core, libusb and uvcvideo, with emulated devices at the kernel's ports. The guest's only
# file system is made here with the files that the tests need. It has no disk and no network, and needs no privileges on
# this machine. PALPA_USB_SECONDS: the time limit [290].
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
most_s=${PALPA_USB_SECONDS:-290}

die() {
  printf 'test usb: %s\n' "$*" >&2
  exit 1
}

missing=()
for tool in qemu-system-x86_64:qemu-system-x86 busybox:busybox-static xz:xz-utils ldd:libc-bin; do
  command -v "${tool%:*}" >/dev/null || missing+=("${tool#*:}")
done
((${#missing[@]} == 0)) || die "this machine lacks ${missing[*]}: ./dev deps installs them"
kernel=$(tests/usb/kernel.sh)

guest=build/usb/guest
rm -rf "$guest"
mkdir -p "$guest"/{bin,dev,etc,lib/systemd,lib/udev/rules.d,proc,run,sys,tmp,guest/modules}
chmod 755 "$guest"
cp "$(command -v busybox)" "$guest/bin/busybox"
install -m 755 tests/usb/init.sh "$guest/init"
cp "$kernel"/*.ko "$kernel/order" "$guest/guest/modules/"
cp driver/70-palpa.rules "$guest/lib/udev/rules.d/"
cp "$kernel/udevadm" "$kernel/libkmod.so.2" "$guest/bin/"
ln -s /bin/udevadm "$guest/lib/systemd/systemd-udevd"
echo "nobody:x:65534:65534::/tmp:/bin/sh" >"$guest/etc/passwd"
printf '%s\n' nogroup:x:65534: plugdev:x:46: >"$guest/etc/group"

# Programs and files have the same paths as on this machine, because the tests know them by these names.
programs=("$PWD"/build/release/bin/{test_usb,palpa,palpa-guard})
ldd "${programs[@]}" "$kernel"/{udevadm,libkmod.so.2} | awk '/=> \// { print $3 } /^\t\// { print $1 }' | sort -u |
  xargs cp -L --parents -t "$guest"
cp --parents -rt "$guest" "${programs[@]}" "$PWD/assets"
printf 'exec %q' "${programs[0]}" >"$guest/guest/command"
printf ' %q' --gtest_color=no "$@" >>"$guest/guest/command"
(cd "$guest" && find . | busybox cpio -o -H newc 2>/dev/null) >build/usb/guest.cpio

# Two machines side by side, each with half of the tests. The kernel puts unknown words of its command line into the
# environment of the first process. The machines' clocks count instructions, one per nanosecond, and advance at once
# while a guest waits. So the load of this machine changes nothing in them, and most of their time is waiting.
boot() { # NUMBER
  local status=0 out=build/usb/guest-$1
  : >"$out.console"
  timeout "$most_s" qemu-system-x86_64 -accel tcg -icount shift=0,sleep=off -rtc clock=vm -cpu max -smp 1 -m 512 -nodefaults -display none -no-reboot \
    -kernel "$kernel/vmlinux" -initrd build/usb/guest.cpio \
    -append "console=ttyS0 quiet panic=-1 GTEST_TOTAL_SHARDS=2 GTEST_SHARD_INDEX=$1" \
    -serial "file:$out.console" -serial "file:$out.txt" -device isa-debug-exit,iobase=0xf4,iosize=4 </dev/null || status=$?
  cat "$out.txt"
  case $status in
    33) return ;;
    35) echo "test usb: a test failed" ;;
    124) tail -n 60 "$out.console" && echo "test usb: the guest did not end within $most_s s" ;;
    *) tail -n 60 "$out.console" && echo "test usb: the guest ended by itself: qemu's status is $status" ;;
  esac
  return 1
}
begin=$SECONDS
boot 0 >build/usb/first.txt 2>&1 &
failed=0
boot 1 || failed=1
wait $! || failed=1
cat build/usb/first.txt
((failed == 0)) || exit 1
echo "test usb: passed in $((SECONDS - begin)) s, on ${kernel##*/}"
