#!/bin/busybox sh
# shellcheck shell=dash
# The guest's first process: loads modules, runs the tests that /guest/command names, and ends the machine with their
# status. The tests' output goes to the second serial port; the first has the kernel's own messages.
/bin/busybox --install -s /bin
export PATH=/bin TMPDIR=/tmp HOME=/tmp
mount -t proc none /proc
mount -t sysfs none /sys
mount -t devtmpfs none /dev
chmod 1777 /tmp # mounting something there would hide a project that is built below it
exec >/dev/ttyS1 2>&1

# Ends the machine: qemu exits with 33 if the status is 0.
leave() {
  # shellcheck disable=SC2059  # the byte itself
  printf "\\$(printf %o $((16 + ($1 != 0))))" | dd of=/dev/port bs=1 seek=244 conv=notrunc 2>/dev/null
}

while read -r module; do
  if ! insmod "/guest/modules/$module.ko"; then
    echo "guest: the module $module does not load"
    leave 1
  fi
done </guest/modules/order
ip link set lo up
sh /guest/command
status=$?
if [ $status != 0 ]; then
  echo "guest: status $status; the kernel's last messages:"
  dmesg | tail -n 40
fi
leave $status
