#!/usr/bin/env bash
# What wait_for_apt.sh does while apt is locked, with an apt-get and a sleep of its own.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/apt-get" <<'END'
#!/bin/sh
echo >>"$0.calls"
[ "$1" = refuses ] && echo "E: Unable to locate package" >&2 && exit 100
[ "$(wc -l <"$0.calls")" -le 2 ] && echo "E: Could not get lock /var/lib/dpkg/lock-frontend. It is held by process 7 (unattended-upgr)" >&2 && exit 100
echo "done: $*"
END
printf '#!/bin/sh\n' >"$folder/sleep"
chmod +x "$folder"/*

# expect STATUS STDOUT STDERR ARGUMENT...
expect() {
  local status=0 out
  rm -f "$folder/apt-get.calls"
  out=$(PATH=$folder:$PATH ./wait_for_apt.sh apt-get "${@:4}" 2>"$folder/faults") || status=$?
  [[ $status == "$1" && $out == "$2" && $(<"$folder/faults") == "$3" ]] || {
    printf '%s: status %s, stdout:\n%s\nstderr:\n%s\n' "${*:4}" "$status" "$out" "$(<"$folder/faults")" >&2
    exit 1
  }
}
expect 0 "dev: apt is busy; waiting for it, ten minutes at most: /var/lib/dpkg/lock-frontend. It is held by process 7 (unattended-upgr)
done: install two words" "" install "two words"
expect 100 "" "E: Unable to locate package" refuses
[[ $(wc -l <"$folder/apt-get.calls") == 1 ]]
