"""judged.py: what a program of palpa may say and how it may end, whatever it is given; for fuzz.py and kill.py."""
import re
import signal

# Messages of sanitizers, the C++ library and the C library about something broken.
BROKEN = re.compile(r"Sanitizer|runtime error:|terminate called|what\(\):|bad optional|bad variant|bad_alloc|std::|"
                    r"vector::|basic_string|stack smashing|buffer overflow|[Aa]ssert(ion)? |corrupted|double free|"
                    r"Segmentation|not validated:|VUID|invalid_argument|out_of_range|stoi|stod")
LONGEST_LINE = 500  # bytes, as in docs/limits.md
# Control characters, marks of direction, and characters without a width.
UNSEEN = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]")


def faults_of_messages(stderr, code):
    """What is wrong with what was written to stderr (bytes); code: the exit code, negative after a signal."""
    faults = []
    try:
        text = stderr.decode()
    except UnicodeDecodeError as error:
        faults.append(f"stderr is not UTF-8: {error}")
        text = stderr.decode(errors="replace")
    if UNSEEN.search(text):
        faults.append(f"stderr has the character {UNSEEN.search(text).group()!r}")
    if BROKEN.search(text):
        faults.append(f"stderr says {BROKEN.search(text).group()!r}")
    lines = text.splitlines()
    errors = [line for line in lines if ": error: " in line]
    strange = [line for line in lines if not line.startswith(("palpa", "WARNING: lavapipe"))]
    if len(errors) > 1:
        faults.append(f"{len(errors)} error lines")
    if code > 0 and not errors:
        faults.append(f"exit code {code} without an error line")
    if code == 0 and errors:
        faults.append("an error line, and exit code 0")
    if strange:
        faults.append(f"a line that does not begin with the program's name: {strange[0]!r}")
    if any(len(line.encode()) > LONGEST_LINE for line in lines):
        faults.append(f"a line of more than {LONGEST_LINE} bytes")
    return faults


def name_of_signal(number):
    """Those of the system have names, others numbers."""
    return next((known.name for known in signal.Signals if known == number), f"signal {number}")


def name_of_end(code):
    """An exit code in words."""
    return name_of_signal(-code) if code < 0 else f"exit code {code}"
