#!/usr/bin/env python3
"""files.py FILE...: palpa opens, makes, moves and removes files in a few places only, each of which asks whether it may
(engine/base/files/outputs.hpp) or touches nothing that is anybody's. Whatever else does is reported.
"""
import re
import sys

# Place: its purpose, and the reason if it need not ask.
PLACES = {
    "engine/base/files/output_file.cpp": "the one place that opens what is written; asks whether it may",
    "engine/base/files/input_file.cpp": "the one place that opens what is read; asks whether it may",
    "engine/base/files/cache_file.cpp": "the cache, palpa's own: never a user's file",
    "engine/base/system/memory.cpp": "/proc", "engine/base/system/memory_limits.cpp": "/proc and /sys", "engine/base/system/real_time.cpp": "/proc", "engine/base/system/start_thread.cpp": "/proc and /sys",
    "engine/gpu/patience.cpp": "/proc", "engine/bench/bench.cpp": "/proc", "engine/bench/surface.cpp": "/proc",
    "engine/geometry/parts/convex_hull.cpp": "/dev/null",
    "engine/sensing/recording_writer.cpp": "makes its folder, and removes what it made and the recording that it replaces",
    "engine/setup/process/program.cpp": "/dev/null",
    "engine/study/sitting/participant_folder.cpp": "makes the folders of a participant, and removes temporary files from them", "engine/study/sitting/withdrawal.cpp": "erases a participant who withdraws",
    "viewer/run/film.cpp": "makes its folder", "viewer/options/preferences.cpp": "makes the folder of the settings, palpa's own",
    "driver/guard/channel.cpp": "memory without a name, shared with the guard", "driver/guard/process.cpp": "/dev/null",
    "driver/rosbag/bag.cpp": "reads a bag as a stream; asks itself",
    "driver/sonicsurface/line.cpp": "a serial port", "driver/sonicsurface/emulated/pty.cpp": "a terminal of its own",
    "driver/usb/libusb.cpp": "/sys", "driver/usb/local_server.cpp": "sockets of its own, and their lock",
    "driver/v4l2/kernel.cpp": "a camera", "driver/v4l2/nodes.cpp": "/sys",
}
WAYS = re.compile(
    r"\b(?:basic_)?(?:[io]?fstream|filebuf)\b|\b(?:fopen|freopen|creat|mkstemps?|mkostemps?|tmpfile|posix_openpt|open_memstream)\s*\(|"
    r"\bO_(?:RDONLY|WRONLY|RDWR|CREAT|TRUNC|TMPFILE|PATH)\b|"
    r"(?<![\w.>])(?:::)?(?:rename|renameat2?|linkat|symlinkat|unlinkat|truncate|ftruncate|mkdirat?|rmdir|copy_file_range)\s*\(|"
    r"(?<!\w)::(?:link|symlink|unlink|remove|mkfifo|mknod)\s*\(|"
    r"\b(?:fs|filesystem)::(?:rename|copy|copy_file|resize_file|remove|remove_all|create_\w+|permissions|last_write_time\([^)]*,[^)]*,)\s*\(")
# Comments and strings, which may mention anything; "/dev/null" and the like are not checked.
SPOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|^[ \t]*#[ \t]*include[^\n]*', re.S | re.M)


def faults(name, text):
    """(line, way) of each way to a file that has no reason there."""
    bare = SPOKEN.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)
    return [(bare.count("\n", 0, found.start()) + 1, found.group().strip()) for found in WAYS.finditer(bare)]


def main():
    bad, seen = 0, set()
    for name in sys.argv[1:]:
        with open(name, encoding="utf-8") as file:
            found = faults(name, file.read())
        if name in PLACES:
            seen.add(name)
        elif name.replace(".hpp", ".cpp") not in PLACES:
            for line, way in found:
                print(f"   {name}:{line}: {way}: open files through base/files/input_file.hpp and base/files/output_file.hpp or stream_writer.hpp, "
                      "or list the place with its reason in tests/house/files.py")
                bad = 1
    for name in PLACES.keys() - seen:
        print(f"   tests/house/files.py lists {name}, which is not there")
        bad = 1
    return bad


if __name__ == "__main__":
    sys.exit(main())
