#!/usr/bin/env bash
# jobs.sh WHAT MIB MOST: prints how many WHAT may run at the same time: MOST, but only as many as fit into memory if
# each takes MIB mebibytes. Says so if memory is the limit.
set -euo pipefail

what=$1 mib=$2 most=$3
room=$(awk '/^MemTotal:/ { print int($2 / 1024) }' /proc/meminfo)
# The limits of a container, in both versions of Linux's control groups.
for limit in /sys/fs/cgroup/memory.max /sys/fs/cgroup/memory/memory.limit_in_bytes; do
  [[ -r $limit ]] || continue
  bytes=$(<"$limit")
  # Without a limit, it is "max" or a meaningless number.
  if [[ $bytes =~ ^[0-9]{1,15}$ ]] && ((bytes >> 20 < room)); then room=$((bytes >> 20)); fi
done
fit=$((room / mib > 1 ? room / mib : 1))
if ((fit < most)); then
  echo "dev: $fit $what side by side instead of $most: each may take $mib MiB, and this machine has $room MiB" >&2
  most=$fit
fi
echo "$most"
