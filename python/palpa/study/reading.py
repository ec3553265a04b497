"""The files of a study: participants' folders with logs, sidecars, journals and recordings of the finger.

Files and rows that cannot be used are left out, and `left_out` has a line about each.
"""
import dataclasses
import functools
import os
import re
import zlib

from .statistics import PAPER_SHAPES
from .text import (CODING, NOT_AVAILABLE, BadInput, bad_input, brief, bytes_of, cells_of, counted, lines_of, number_in,
                   parse_json, printable, read_bytes, read_text, whole, whole_in)

COLUMNS = ("onset", "duration", "trial_type", "method", "shape", "answer", "response_time", "status")
KINDS = ("familiarise", "free", "practice", "trial", "rest")
STATUSES = ("answered", "done", "void")
ENTRIES = {"start", "consent", "level", "begin", "touched", "choose", "answer", "done", "void", "pause", "resume", "stop", "finish"}
LOG_VERSION = JOURNAL_VERSION = 1
MOST_REPEATS = 2  # of a step that a machine broke off
TABLE = "trials.tsv"  # of the whole study, where its plan has questions of its own
EVENTS_END, JOURNAL_END, TOMBSTONE_END = "_events.tsv", "_journal.jsonl", "_withdrawn.json"
MOST_FILES, MOST_PARTICIPANTS, MOST_METHODS, MOST_SHAPES, MOST_NAME = 1000, 1000, 16, 64, 64
MOST_ROWS, MOST_COLUMNS, MOST_FAULTS = 100_000, 1000, 10
BIN_S, MOST_BINS = 0.25, 240  # of a finger's depth, from the start of a trial
BETWEEN_SAMPLES_S = 0.1


@dataclasses.dataclass(slots=True)
class Row:
    """One event of a log; None where the file has n/a. `more` has the columns of a sitting's own logs."""
    line: int
    onset: float
    duration: float | None
    kind: str
    status: str
    method: str
    shape: str
    answer: str
    response_s: float | None
    more: dict = dataclasses.field(default_factory=dict, compare=False)

    @property
    def counts(self):
        return self.kind == "trial" and self.status == "answered"


@dataclasses.dataclass
class Log:
    """A log, what the file beside it says, and the depths of the finger in each answered trial."""
    name: str
    rows: list = dataclasses.field(default_factory=list)
    shapes: list = dataclasses.field(default_factory=list)
    least_trials: int = 0
    plan_sha256: str = ""
    rehearsal: bool = False
    faults: list = dataclasses.field(default_factory=list)
    courses: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Folder:
    number: int
    path: str
    logs: list = dataclasses.field(default_factory=list)
    left_out: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Trial:
    """One answered trial. Numbers are places in the lists of Study."""
    method: int
    shape: int
    answer: int
    response_s: float | None = None

    @property
    def correct(self):
        return self.shape == self.answer


@dataclasses.dataclass
class Participant:
    number: int
    place: str = ""
    trials: list = dataclasses.field(default_factory=list)
    voids: list = dataclasses.field(default_factory=list)  # by method
    void_shapes: list = dataclasses.field(default_factory=list)  # by method, then shape
    asked: int = 0  # familiarisations after which it was asked
    unfelt: int = 0  # and those without a sensation
    depths: dict = dataclasses.field(default_factory=dict)  # by (method, shape): sums in metres and numbers of samples


@dataclasses.dataclass
class Study:
    """What is analysed: single-focus first, if it is there, then methods by name; participants by number."""
    methods: list
    shapes: list
    participants: list = dataclasses.field(default_factory=list)
    least_trials: int = 0
    left_out: list = dataclasses.field(default_factory=list)
    folders: list = dataclasses.field(default_factory=list)


# ---- a log


def place_of(header, column, name):
    """A column of that name; if there is none, one of that name in other letters, such as Onset."""
    places = [i for i, other in enumerate(header) if other == column]
    places = places or [i for i, other in enumerate(header) if re.sub("[A-Z]", lambda m: m[0].lower(), other) == column]
    if not places:
        columns = ", ".join(printable(other, 30) for other in header[:20]) + (", ..." if len(header) > 20 else "")
        raise bad_input(name, f"line 1: the column {column} is missing: the line has {columns}; the columns are "
                              f"{', '.join(COLUMNS)}, separated by tabs")
    if len(places) > 1:
        raise bad_input(name, f"line 1: the column {column} is there twice")
    return places[0]


def one_of(words):
    return ", ".join(words[:-1]) + " or " + words[-1]


def row_of(cells, places, line):
    """The row of these cells, or the fault as text."""
    of = {column: cells[place] for column, place in places.items()}
    times = {}
    for column in ("onset", "duration", "response_time"):
        times[column] = number_in(of[column])
        missing = column != "onset" and of[column] == NOT_AVAILABLE
        if not missing and (times[column] is None or times[column] < 0):
            return f"{column} '{printable(of[column], 40)}' is not a time in seconds, such as 1.25"
    for column, words in (("trial_type", KINDS), ("status", STATUSES)):
        if of[column] not in words:
            return f"{column} '{printable(of[column], 40)}' is not {one_of(words)}"
    counts = of["trial_type"] == "trial" and of["status"] == "answered"
    names = {}
    for column in ("method", "shape", "answer"):
        cell = of[column]
        missing = cell in ("", NOT_AVAILABLE)
        if counts and missing:
            return f"an answered trial has no {column}"
        if len(bytes_of(cell)) > MOST_NAME:
            return f"{column} '{printable(cell, 40)}' is longer than {MOST_NAME} letters"
        names[column] = "" if missing else cell
    if of["trial_type"] == "trial" and of["status"] == "done":
        return "a trial has the status done, but only answered or void fit"
    return Row(line, times["onset"], times["duration"], of["trial_type"], of["status"], names["method"], names["shape"],
               names["answer"], times["response_time"])


def parse_log(text, name):
    """The rows of a log. Raises if the text is not a table with all columns, or has too many rows."""
    lines, cut = lines_of(text)
    if not lines:
        raise bad_input(name, "is empty")
    header = cells_of(lines[0], "\t", MOST_COLUMNS)
    if len(header) > MOST_COLUMNS:
        raise bad_input(name, f"line 1: has more than {MOST_COLUMNS} columns")
    places = {column: place_of(header, column, name) for column in COLUMNS}
    others = {column: place for place, column in enumerate(header) if column and column not in places}
    log, faulty = Log(name), 0
    for number, line in enumerate(lines[1:], 2):
        if not line:
            continue
        if number > MOST_ROWS:
            raise bad_input(name, f"has more than {MOST_ROWS} lines")
        cells = cells_of(line, "\t", MOST_COLUMNS)
        if cut and number == len(lines):
            row = "the line has no end: the file is cut off here"
        elif len(cells) != len(header):
            row = f"{counted(len(cells), 'cell')} where the first line has {len(header)}"
        else:
            row = row_of(cells, places, number)
        if isinstance(row, Row) and log.rows and row.onset <= log.rows[-1].onset:
            last = log.rows[-1].line
            row = (f"it has the same onset as line {last}" if row.onset == log.rows[-1].onset else
                   f"its onset {brief(row.onset)} lies before that of line {last}")
        if isinstance(row, Row):
            row.more = {column: cells[place] for column, place in others.items()}
            log.rows.append(row)
            continue
        faulty += 1
        if faulty <= MOST_FAULTS:
            log.faults.append(f"{name}: line {number}: {row}; the row is left out")
    if faulty > MOST_FAULTS:
        log.faults.append(f"{name}: {faulty - MOST_FAULTS} further rows are left out")
    return log


def read_object(file):
    document = parse_json(read_text(file, 1 << 20))
    if not isinstance(document, dict):
        raise bad_input(file, "is not a JSON object")
    return document


def levels_in(document, file):
    """The shapes that a sidecar names."""
    column = document.get("shape", {})
    if not isinstance(column, dict):
        raise bad_input(file, '"shape" is not an object')
    levels = column.get("Levels", {})
    if not isinstance(levels, dict):
        raise bad_input(file, '"Levels" of "shape" is not an object')
    for name in levels:
        if not name or len(bytes_of(name)) > MOST_NAME:
            raise bad_input(file, f"\"Levels\" of \"shape\": '{printable(name, 60)}' is not a name of 1 to {MOST_NAME} letters")
    if len(levels) > MOST_SHAPES:
        raise bad_input(file, f"has {len(levels)} shapes, at most {MOST_SHAPES} are analysed")
    return list(levels)


def read_log(path):
    """PREFIX_events.tsv and PREFIX_events.json. A missing sidecar, and a log that was changed later, are only reported."""
    text = read_text(path, 16 << 20)
    beside = path.removesuffix(".tsv") + ".json"
    if not os.path.exists(beside):
        log = parse_log(text, path)
        log.faults.append(f"{path}: there is no {os.path.basename(beside)} beside it; it is read as version {LOG_VERSION}")
        return log
    document = read_object(beside)
    version = document.get("PalpaStudyVersion")
    if not whole(version):
        raise bad_input(beside, f'"PalpaStudyVersion" is missing or not a whole number: it should be {LOG_VERSION}')
    if version != LOG_VERSION:
        raise bad_input(beside, f"the log has version {version}, this palpa reads version {LOG_VERSION}")
    shapes = levels_in(document, beside)
    least = document.get("LeastTrials", 0)
    if not whole(least, 1_000_000):
        raise bad_input(beside, '"LeastTrials" is not a whole number from 0 to 1000000')
    told = document.get("EventsCrc32", "00000000")
    if not isinstance(told, str) or not re.fullmatch("[0-9a-f]{8}", told):
        raise bad_input(beside, '"EventsCrc32" is not eight digits from 0 to f')
    log = parse_log(text, path)
    plan = document.get("PlanSha256")
    log.shapes, log.least_trials, log.plan_sha256 = shapes, least, plan if isinstance(plan, str) else ""
    log.rehearsal = document.get("Rehearsal") is True
    if log.rehearsal:
        log.faults.append(f"{path}: is a rehearsal: no person gave these answers; it is analysed all the same")
    checksum = f"{zlib.crc32(bytes_of(text)):08x}"
    if "EventsCrc32" in document and told != checksum:
        log.faults.append(f"{path}: was changed after its session ended (its CRC-32 is {checksum}, "
                          f"{os.path.basename(beside)} says {told}); it is analysed as it is")
    return log


# ---- the finger


def unpacked(path):
    """The bytes of a gzip file, and whether it was cut off."""
    packed, most = read_bytes(path, 64 << 20), 256 << 20
    out, rest = [], packed
    while True:
        member = zlib.decompressobj(wbits=31)
        before = sum(map(len, out))
        try:
            out.append(member.decompress(rest, most + 1 - before))
        except zlib.error:
            # Byte by byte, because an error keeps what came before it.
            member, size = zlib.decompressobj(wbits=31), before
            for at in range(len(rest)):
                try:
                    size += len(member.decompress(rest[at:at + 1]))
                except zlib.error:
                    break
            raise bad_input(path, f"is damaged after {size} unpacked bytes" if size else
                            "is not a gzip file, or it is damaged") from None
        if before + len(out[-1]) > most:
            raise bad_input(path, f"has more than {most} bytes unpacked")
        if not member.eof:
            return b"".join(out), True
        rest = member.unused_data
        # Zeros at the end are no data: tapes, disks and copies are filled with them. Otherwise, another packed file
        # follows, which counts as the rest of this one.
        if not rest.strip(b"\0"):
            return b"".join(out), False


def finger_sidecar(file):
    """Rows per second, the time of the first, the number of columns, and the place of the depth."""
    document = read_object(file)
    numbers = {}
    for key in ("SamplingFrequency", "StartTime"):
        value = document.get(key)
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            raise bad_input(file, f'"{key}" is missing or not a number')
        numbers[key] = float(value)
    rate = numbers["SamplingFrequency"]
    if not 0 < rate <= 10e3:
        raise bad_input(file, f'"SamplingFrequency" {brief(rate)} is not above 0 and at most 10000 Hz')
    columns = document.get("Columns")
    if not isinstance(columns, list):
        raise bad_input(file, '"Columns" is missing or not an array')
    if "depth" not in columns:
        raise bad_input(file, '"Columns" has no "depth"')
    return rate, numbers["StartTime"], len(columns), len(columns) - 1 - columns[::-1].index("depth")


def read_finger(path, trials):
    """The depths in each trial (onset and duration): by bin, their sum in metres and their number. Also what is wrong
    with the recording, if only its end is."""
    rate, start, columns, column = finger_sidecar(path.removesuffix(".tsv.gz") + ".json")
    data, cut = unpacked(path)
    fault = None
    if cut:
        seconds = start + data.count(b"\n") / rate
        fault = f"{path}: is cut off; depths are read up to {seconds:.1f} s"
    lines = data.decode(*CODING).removeprefix("\ufeff").split("\n")[:-1]  # what follows the last end is cut off
    step = max(1, int(BETWEEN_SAMPLES_S * rate))
    courses = []
    for number, (onset, duration) in enumerate(trials):
        sums, samples = [], []
        courses.append((sums, samples))
        length = min(duration, BIN_S * MOST_BINS)
        if number + 1 < len(trials):
            length = min(length, trials[number + 1][0] - onset)
        at = max(0, -int(-((onset - start) * rate) // 1))
        while (time := start + at / rate - onset) < length:
            if at >= len(lines):
                return courses + [([], [])] * (len(trials) - len(courses)), fault
            cells = cells_of(lines[at].removesuffix("\r"), "\t", columns)
            if len(cells) != columns:
                raise bad_input(path, f"line {at + 1}: {counted(len(cells), 'cell')} where {counted(columns, 'column')} "
                                      f"{'is' if columns == 1 else 'are'} named")
            cell = cells[column]
            at += step
            if cell == NOT_AVAILABLE:
                continue
            depth = number_in(cell)
            if depth is None or abs(depth) > 10:
                raise bad_input(path, f"line {at - step + 1}: '{printable(cell, 40)}' is not a depth in metres, such as 0.0031")
            if not 0 <= time < BIN_S * MOST_BINS:
                continue
            place = int(time / BIN_S)
            if place >= len(samples):
                sums.extend([0.0] * (place + 1 - len(samples)))
                samples.extend([0] * (place + 1 - len(samples)))
            sums[place] += depth
            samples[place] += 1
    return courses, fault


# ---- a participant


def participant_number(name):
    """The number in "sub-7"; None for another name."""
    return whole_in(name.removeprefix("sub-")) if name.startswith("sub-") else None


def entries_of(folder):
    try:
        return sorted(os.listdir(folder), key=os.fsencode)
    except OSError as error:
        raise bad_input(folder, f"cannot be read: {error.strerror}") from None


def compared_names(a, b):
    """Which of two names comes first, if digits in them count as numbers: run-99 before run-100."""
    def signed(byte):
        return byte ^ 0x80
    a, b = os.fsencode(a), os.fsencode(b)
    while a and b:
        if not (a[:1].isdigit() and b[:1].isdigit()):
            if a[0] != b[0]:
                return signed(a[0]) - signed(b[0])
            a, b = a[1:], b[1:]
            continue
        one, other = re.match(rb"0*(\d+)", a), re.match(rb"0*(\d+)", b)
        one_number, other_number = one[0].lstrip(b"0") or b"0", other[0].lstrip(b"0") or b"0"
        if one_number != other_number:
            return -1 if (len(one_number), one_number) < (len(other_number), other_number) else 1
        a, b = a[one.end():], b[other.end():]
    return len(a) - len(b)


def read_courses(path, log, left_out):
    recording = path.removesuffix(EVENTS_END) + "_recording-finger_physio.tsv.gz"
    times = [(row.onset, row.duration or 0.0) for row in log.rows if row.counts]
    if not times or not os.path.exists(recording):
        return
    try:
        log.courses, fault = read_finger(recording, times)
    except BadInput as error:
        left_out.append(f"{error}; the recording of the finger is left out")
        return
    if fault:
        left_out.append(fault)


def read_journal(path):
    """The entries of a journal, each a dict. Raises for a line that was changed, or is no entry."""
    text, last, entries = read_bytes(path, 64 << 20), b"", []
    for number, line in enumerate(text.split(b"\n")[:-1], 1):
        json_text, tab, digits = line.rpartition(b"\t")
        if not tab or f"{zlib.crc32(json_text, zlib.crc32(last)):08x}".encode() != digits:
            raise bad_input(path, f"line {number} is damaged or was changed: its checksum does not fit. palpa does not "
                                  "continue this participant; what was written before can be analysed")
        last = digits
        entry = parse_json(json_text.decode(*CODING))
        fault = f"line {number} is not an entry of a journal"
        if not isinstance(entry, dict):
            raise bad_input(path, fault)
        if number == 1:
            version = entry.get("palpa_journal")
            if whole(version) and version != JOURNAL_VERSION:
                raise bad_input(path, f"has version {version}, this palpa reads version {JOURNAL_VERSION}")
            if not whole(version) or not whole(entry.get("participant")) or not isinstance(entry.get("plan_sha256"), str):
                raise bad_input(path, fault)
            continue
        if not isinstance(entry.get("what"), str) or not isinstance(entry.get("at_ns"), (int, float)) or not whole(entry.get("step", 0)):
            raise bad_input(path, fault)
        if entry["what"] not in ENTRIES:
            raise bad_input(path, fault + ": what happened is unknown")
        entries.append(entry)
    return entries


def compare_with_journal(folder):
    """Names what the journal of a sitting has and no log does, because the program was killed between the two."""
    name = os.path.basename(folder.path)
    file = os.path.join(folder.path, name + JOURNAL_END)
    if not os.path.isfile(file) or os.path.getsize(file) == 0:
        return
    try:
        entries = read_journal(file)
    except BadInput as error:
        folder.left_out.append(f"{error}; its answers are not compared with the logs")
        return
    runs, by_machine, stay_void = [], {}, []
    for entry in entries:
        step = entry.get("step", 0) + 1
        if entry["what"] == "start":
            runs.append([])
        if entry["what"] == "answer" and runs:
            runs[-1].append(step)
        if entry["what"] == "void" and entry.get("by_machine") is True:
            by_machine[step] = by_machine.get(step, 0) + 1
            if by_machine[step] > MOST_REPEATS:
                stay_void.append(step)
    for number, steps in enumerate(runs, 1):
        end = f"_run-{number:02}{EVENTS_END}"
        log = next((log for log in folder.logs if log.name.endswith(end)), None)
        if log is None and os.path.exists(os.path.join(folder.path, "beh", f"{name}_task-shapes{end}")):
            continue  # it is left out, and a line says why
        logged = 0
        if log is not None:
            # Rows that cannot be used have lines of their own.
            logged = sum(row.status == "answered" for row in log.rows) + sum(line.endswith(" left out") for line in log.faults)
        missing = steps[logged:]
        if not missing:
            continue
        one = len(missing) == 1
        folder.left_out.append(
            f"{file}: {'the answer' if one else 'the answers'} of run {number} to step {', '.join(map(str, missing))} "
            f"{'is' if one else 'are'} in no log, because the program was killed before it wrote {'it' if one else 'them'}: "
            f"the same palpa study run or rehearse writes {'it' if one else 'them'}; until then "
            f"{'it is' if one else 'they are'} left out")
    if stay_void:
        one = len(stay_void) == 1
        folder.left_out.append(
            f"{file}: {'step' if one else 'steps'} {', '.join(map(str, stay_void))} {'stays' if one else 'stay'} void, because "
            f"{'its' if one else 'their'} stimulus was missing, or the array failed, each time; the log has the reasons")
    if runs and not any(entry["what"] == "finish" for entry in entries):
        folder.left_out.append(f"{file}: the sitting is not finished: the same palpa study run or rehearse continues it; what was "
                               "answered so far is analysed all the same")


def read_participant(folder):
    inside, name, number = os.path.join(folder.path, "beh"), os.path.basename(folder.path), folder.number
    if os.path.exists(os.path.join(folder.path, name + TOMBSTONE_END)):
        folder.left_out.append(f"{folder.path}: the participant withdrew")
        return
    if not os.path.isdir(inside):
        folder.left_out.append(f"{inside}: there is no such folder; the participant is left out")
        return
    files = 0
    for entry in sorted(entries_of(inside), key=functools.cmp_to_key(compared_names)):
        if not entry.endswith(EVENTS_END):
            continue
        path, files = os.path.join(inside, entry), files + 1
        if files > MOST_FILES:
            raise bad_input(inside, f"has more than {MOST_FILES} logs")
        if participant_number(entry.partition("_")[0]) != number:
            folder.left_out.append(f"{path}: the name is not that of a log of participant {number}, such as "
                                   f"sub-{number}_task-shapes_events.tsv; it is left out")
            continue
        try:
            log = read_log(path)
        except BadInput as error:
            folder.left_out.append(f"{error}; the log is left out")
            continue
        copied = next((other for other in folder.logs if log.rows and other.rows == log.rows), None)
        if copied:
            folder.left_out.append(f"{log.name}: has the same rows as {copied.name}; the log is left out")
            continue
        folder.left_out += log.faults
        read_courses(path, log, folder.left_out)
        folder.logs.append(log)
    compare_with_journal(folder)
    if files == 0:
        folder.left_out.append(f"{inside}: has no log, such as sub-{number}_task-shapes_events.tsv; the participant is left out")


# ---- a study


def participants_in(place, left_out):
    if not os.path.isdir(place):
        raise bad_input(place, "is not a folder: give the folder of a study" if os.path.exists(place) else "no such folder")
    found = []
    for name in entries_of(place):
        path = os.path.join(place, name)
        if not name.startswith("sub-") or not os.path.isdir(path):
            continue
        number = participant_number(name)
        if number is None:
            left_out.append(f"{path}: is not a participant with a number, such as sub-7; it is left out")
        else:
            found.append(Folder(number, path))
    if not found:
        raise bad_input(place, "has no participants: their logs are in folders such as sub-1/beh, sub-2/beh")
    return found


def folders_of(places, left_out):
    """The participants' folders with their logs, by number."""
    folders, seen = [folder for place in places for folder in participants_in(place, left_out)], {}
    for folder in folders:
        if folder.number in seen:
            raise bad_input(folder.path, f"participant {folder.number} is also in {seen[folder.number]}: give each participant a "
                                         "number of their own")
        seen[folder.number] = folder.path
    if len(folders) > MOST_PARTICIPANTS:
        raise bad_input(places[0], f"has {len(folders)} participants, at most {MOST_PARTICIPANTS} are analysed")
    folders.sort(key=lambda folder: folder.number)
    for folder in folders:
        read_participant(folder)
    leave_out_copies(folders)
    return folders


def leave_out_copies(folders):
    """Leaves out logs with the same rows as a log of an earlier participant: onsets are measured. Those of rehearsals are
    not, and logs without times of answers may have planned ones, so these are only reported."""
    seen, copies = {}, set()
    for folder in folders:
        for log in folder.logs:
            if not any(row.counts for row in log.rows):
                continue
            alike = seen.setdefault((len(log.rows), log.rows[-1].onset), [])
            original = next((other for other in alike if other[0] != folder.number and other[1].rows == log.rows), None)
            if original is None:
                alike.append((folder.number, log))
                continue
            is_copy = not log.rehearsal and any(row.counts and row.response_s is not None for row in log.rows)
            if is_copy:
                copies.add(id(log))
            folder.left_out.append(
                f"{log.name}: has the same rows as {original[1].name} of participant {original[0]}; "
                + ("the log is left out" if is_copy else "it is analysed all the same: see whether it is a copy"))
    for folder in folders:
        folder.logs = [log for log in folder.logs if id(log) not in copies]


def ordered(names, first):
    """The names in the order of `first`, then by name."""
    def place(name):
        return (first.index(name) if name in first else len(first), bytes_of(name))
    return sorted(set(names), key=place)


def agree_on_shapes(folders):
    """The shapes of the study: those that most sidecars name, the first of them if there are as many of others; otherwise
    all that were shown. Logs of other shapes are left out."""
    told, shown = {}, []
    for folder in folders:
        for log in folder.logs:
            if log.shapes:
                told.setdefault(tuple(ordered(log.shapes, [])), []).append(log)
            shown += [row.shape for row in log.rows if row.counts]
    if not told:
        return ordered(shown, PAPER_SHAPES)
    most = max(told, key=lambda names: len(told[names]))
    teller, shapes = told[most][0].name, told[most][0].shapes

    def only_in(some, others):
        return ", ".join(name for name in some if name not in others) or "none"
    for folder in folders:
        kept = []
        for log in folder.logs:
            names = tuple(ordered(log.shapes, []))
            if not names or names == most:
                kept.append(log)
                continue
            folder.left_out.append(
                f"{log.name}: its shapes are {', '.join(log.shapes)}, but those of {teller} are {', '.join(shapes)} (only here: "
                f"{only_in(names, most)}; missing here: {only_in(most, names)}); the log is left out")
        folder.logs = kept
    return shapes


def differing_plans(folders):
    """A line if the logs name more than one plan."""
    plans = {}
    for folder in folders:
        for log in folder.logs:
            numbers = plans.setdefault(log.plan_sha256, []) if log.plan_sha256 else [folder.number]
            if not numbers or numbers[-1] != folder.number:
                numbers.append(folder.number)
    if len(plans) < 2:
        return []

    def text(numbers):
        some = numbers[:9 if len(numbers) > 10 else 10]
        more = f" and {len(numbers) - len(some)} more" if len(numbers) > len(some) else ""
        return f"{'participant' if len(numbers) == 1 else 'participants'} {', '.join(map(str, some))}{more}"
    named = "; ".join(f"{bytes_of(plan)[:8].decode(*CODING)}: {text(numbers)}" for plan, numbers in plans.items())
    return [f"the participants had different plans, by PlanSha256 of their logs ({named}); they are analysed as one study all the same"]


def participant_of(folder, study):
    """What of a folder is analysed. Appends what is not."""
    methods = {name: place for place, name in enumerate(study.methods)}
    shapes = {name: place for place, name in enumerate(study.shapes)}
    person = Participant(folder.number, folder.path, voids=[0] * len(methods), void_shapes=[[0] * len(shapes) for _ in methods])
    for log in folder.logs:
        course = -1
        for row in log.rows:
            if row.kind == "trial" and row.status == "void" and row.method in methods:
                person.voids[methods[row.method]] += 1
                if row.shape in shapes:
                    person.void_shapes[methods[row.method]][shapes[row.shape]] += 1
            if row.kind == "familiarise" and row.status == "answered":
                person.asked += 1
                person.unfelt += row.answer == "no"
            if not row.counts:
                continue
            course += 1
            if row.shape not in shapes or row.answer not in shapes:
                wrong = "answer" if row.shape in shapes else "shape"
                folder.left_out.append(f"{log.name}: line {row.line}: the {wrong} '{printable(getattr(row, wrong), 40)}' is not one of "
                                       f"{', '.join(study.shapes)}; the row is left out")
                continue
            method, shape = methods[row.method], shapes[row.shape]
            person.trials.append(Trial(method, shape, shapes[row.answer], row.response_s))
            if course < len(log.courses) and log.courses[course][1]:
                sums, samples = person.depths.setdefault((method, shape), ([], []))
                more_sums, more_samples = log.courses[course]
                longer = len(more_samples) - len(samples)
                sums.extend([0.0] * longer)
                samples.extend([0] * longer)
                for place, (value, number) in enumerate(zip(more_sums, more_samples)):
                    sums[place] += value
                    samples[place] += number
    if not person.trials and folder.logs:
        planned = any(row.kind == "trial" for log in folder.logs for row in log.rows)
        folder.left_out.append(f"{folder.path}: {'' if planned else chr(39).join(['has no row of a block ', 'trial', ', so it '])}"
                               "has no answered trial; the participant is left out")
    return person


def read_study(places):
    """One or several folders as one study."""
    left_out = []
    folders = folders_of(places, left_out)
    shapes = agree_on_shapes(folders)
    left_out += differing_plans(folders)
    logs = [log for folder in folders for log in folder.logs]
    methods = ordered((row.method for log in logs for row in log.rows if row.counts), ["single-focus"])
    study = Study(methods, shapes, least_trials=max((log.least_trials for log in logs), default=0), left_out=left_out, folders=folders)
    if len(methods) > MOST_METHODS or len(shapes) > MOST_SHAPES:
        raise bad_input(places[0], f"has {len(methods)} methods and {len(shapes)} shapes; at most {MOST_METHODS} and {MOST_SHAPES} "
                                   "are analysed")
    for folder in folders:
        person = participant_of(folder, study)
        left_out += folder.left_out
        if person.trials:
            study.participants.append(person)
    if not study.participants:
        # The first line says what is wrong with the only, or the first, log, unless that is analysed all the same.
        reason = next((line for line in left_out if "analysed all the same" not in line), None)
        raise bad_input(places[0], f"nothing can be analysed: {reason}" if reason else "has no answered trial")
    return study
