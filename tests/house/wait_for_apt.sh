#!/usr/bin/env bash
# wait_for_apt.sh COMMAND...: runs a command of apt-get, again and again for up to ten minutes while another program has
# locked apt. (On a new machine, unattended upgrades do so for minutes.) apt-get's own DPkg::Lock::Timeout waits only
# for one of its three locks. On stdout, beside the command's own, it says that it waits.
set -euo pipefail

faults=$(mktemp)
trap 'rm -f "$faults"' EXIT
told=
while true; do
  status=0
  LC_ALL=C.UTF-8 "$@" 2>"$faults" || status=$?
  if ((status == 0)) || ! lock=$(grep -m 1 -o 'Could not get lock .*' "$faults") || ((SECONDS >= 600)); then break; fi
  [[ -n $told ]] || echo "dev: apt is busy; waiting for it, ten minutes at most: ${lock#Could not get lock }"
  told=yes
  sleep 3
done
cat "$faults" >&2
exit "$status"
