#!/usr/bin/env python3
"""bench_against.py BEFORE AFTER [--rounds N] [ARGUMENT...]: two builds of palpa, measured side by side.

BEFORE and AFTER are folders with the programs (build/release/bin); further arguments go to both `palpa bench`. The builds take turns,
N times (3), so that whatever else the machine does meets both alike; a row is the least of its medians on either side, and how
the two compare. Rows that only one of them has are named at the end. Exit code 1 where a row of more than 20 microseconds became
slower by more than 5 %: run those again by themselves before you believe it."""

import argparse
import json
import os
import subprocess
import sys

SLOWER = 1.05
SHORT_MS = 0.02  # shorter times depend more on the clock than on the work


def measure(binaries, arguments):
    """(suite, case, stage) -> median in milliseconds."""
    done = subprocess.run([os.path.join(binaries, "palpa"), "bench", *arguments, "--json", "-", "--quiet"], stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(f"bench_against: {binaries}/palpa bench {' '.join(arguments)}: exit code {done.returncode}")
    return {(row["suite"], row["case"], row["stage"]): row["median_ms"] for row in json.loads(done.stdout)["rows"]}


def least(seen, rows):
    for name, median in rows.items():
        seen[name] = min(median, seen.get(name, median))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--rounds", type=int, default=3)
    options, arguments = parser.parse_known_args()

    before, after = {}, {}
    for done in range(options.rounds):
        # The first build alternates, so that neither always runs on the warmer machine.
        order = [(options.before, before), (options.after, after)]
        for binaries, seen in order if done % 2 == 0 else reversed(order):
            least(seen, measure(binaries, arguments))

    slower = 0
    print(f"{'suite':10}{'case':44}{'stage':24}{'before ms':>12}{'after ms':>12}{'after/before':>14}")
    for name in [name for name in before if name in after]:
        suite, case, stage = name
        ratio = after[name] / before[name] if before[name] else 1.0
        counts = ratio > SLOWER and max(before[name], after[name]) > SHORT_MS
        slower += counts
        print(f"{suite:10}{case:44}{stage:24}{before[name]:12.4f}{after[name]:12.4f}{ratio:14.2f}{'  slower' if counts else ''}")
    for side, names in [("before", before.keys() - after.keys()), ("after", after.keys() - before.keys())]:
        if names:
            print(f"only {side}: {', '.join(sorted(' '.join(name) for name in names))}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
