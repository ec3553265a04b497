"""journals.py: what is left of a study that was killed, read without palpa's own code: the journal and the logs that
are written from it (docs/study.md); for kill_study.py."""
import csv
import gzip
import json
import zlib


def entries_of(text):
    """The entries of the whole lines of a journal (bytes), after its head. Raises ValueError for a broken chain."""
    whole, _, _ = text.rpartition(b"\n")
    digits, entries = b"", []
    for number, line in enumerate(whole.split(b"\n") if whole else [], 1):
        content, _, own = line.rpartition(b"\t")
        if f"{zlib.crc32(digits + content):08x}".encode() != own:
            raise ValueError(f"line {number} of the journal has a wrong checksum")
        digits = own
        entries.append(json.loads(content))
    return entries[1:]


def rounds_of(order):
    """For each step of sub-N_order.csv the number of its round: its block with its method."""
    rounds, last = [], None
    for row in csv.DictReader(order.splitlines()):
        if last != (row["kind"], row["method"]):
            last = (row["kind"], row["method"])
            rounds.append(rounds[-1] + 1 if rounds else 0)
        else:
            rounds.append(rounds[-1])
    return rounds


class Walk:
    """Goes through a journal as docs/study.md describes a sitting: `faults` are sentences, `answers` the answer of each
    complete step, `left` the steps that are still to be done, in their order, `stay_void` those that were given up."""

    def __init__(self, order, entries):
        self.rounds = rounds_of(order)
        self.left, self.open = list(range(len(self.rounds))), False
        self.answers, self.faults, self.voids, self.starts, self.finished = {}, [], 0, 0, False
        self.by_machine, self.stay_void = {}, []  # a step that a machine broke off is repeated twice
        for entry in entries:
            self.take(entry)

    def put_back(self):
        step = self.left.pop(0)
        at = next((i for i, other in enumerate(self.left) if self.rounds[other] != self.rounds[step]), len(self.left))
        self.left.insert(at, step)
        self.open, self.voids = False, self.voids + 1

    def take(self, entry):
        what, step = entry["what"], entry.get("step")
        if what == "start":
            self.starts += 1
            if self.open:
                self.put_back()
        elif what == "begin":
            if self.open or not self.left or step != self.left[0]:
                self.faults.append(f"step {step} begins where {self.left[:1]} is next")
            self.open = True
        elif what in ("answer", "done"):
            if step in self.answers:
                self.faults.append(f"step {step} is complete twice")
            elif not self.open or not self.left or step != self.left[0]:
                self.faults.append(f"step {step} is complete where {self.left[:1]} is under way")
            else:
                self.left.pop(0)
            self.answers[step] = entry.get("text")
            self.open = False
        elif what == "void":
            count = self.by_machine[step] = self.by_machine.get(step, 0) + entry.get("by_machine", False)
            if entry.get("by_machine") and count > 2:
                self.stay_void.append(self.left.pop(0))
                self.open, self.voids = False, self.voids + 1
            else:
                self.put_back()
        elif what == "finish":
            self.finished = True
            if self.left:
                self.faults.append(f"the sitting ends with {len(self.left)} steps left")


def faults_of_files(beh, walk, complete):
    """What is wrong with the files in `beh`. After a kill, the last log may not have the last entry yet; `complete`: the
    sitting has ended."""
    faults, answered = [], {}
    for path in sorted(beh.iterdir()):
        if path.name.startswith(".palpa"):  # of a program that was killed while it replaced a file; the next one removes it
            faults += [f"{path.name} is left"] if complete else []
            continue
        if path.suffix == ".json":
            try:
                content = json.loads(path.read_text())
            except ValueError as fault:
                faults.append(f"{path.name} is no JSON: {fault}")
                continue
            for touch in content["touches"] if path.name.endswith("_stimuli.json") else []:
                if "foci_file" in touch and not (beh / touch["foci_file"]).exists():
                    faults.append(f"{path.name} names {touch['foci_file']}, which is missing")
        elif path.name.endswith(".tsv.gz"):
            try:
                gzip.decompress(path.read_bytes())
            except (OSError, EOFError, zlib.error) as fault:
                if complete:
                    faults.append(f"{path.name} cannot be unpacked: {fault}")
        elif path.name.endswith("_events.tsv"):
            for row in csv.DictReader(path.read_text().splitlines(), delimiter="\t", quoting=csv.QUOTE_NONE):
                if row["status"] != "void":
                    answered.setdefault(int(row["step"]) - 1, []).append(row["answer"])
            sidecar = json.loads(path.with_suffix(".json").read_text())
            if complete and sidecar.get("EventsCrc32") != f"{zlib.crc32(path.read_bytes()):08x}":
                faults.append(f"{path.name} does not have the checksum of its sidecar")
    for step, answers in answered.items():
        wanted = walk.answers.get(step)
        if len(answers) > 1:
            faults.append(f"step {step} is complete {len(answers)} times in the logs")
        elif step not in walk.answers or answers[0] != (wanted or "n/a"):
            faults.append(f"step {step} has the answer {answers[0]} in a log, but {wanted} in the journal")
    if complete and len(answered) != len(walk.answers):
        faults.append(f"{len(walk.answers) - len(answered)} steps are missing in the logs")
    return faults


def results_of(analysis):
    """The results in a JSON of `palpa study analyse`, without what depends on when trials took place."""
    timely = {"answer_times", "answer_time_s", "learning", "depth", "left_out", "void", "void_by_shape"}

    def without(value):
        if isinstance(value, dict):
            return {key: without(item) for key, item in value.items() if key not in timely}
        return [without(item) for item in value] if isinstance(value, list) else value

    return without(analysis)
