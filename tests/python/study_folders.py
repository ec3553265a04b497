"""Folders of studies that a program generates, with what people and programs do to them: both programs must say
the same about each."""
import gzip
import json
import random
import zlib

SHAPES = ["cube", "semi-sphere", "pyramid", "prism"]
HEADER = "onset duration trial_type method shape answer response_time status".split()
CHANCE = {"single-focus": 0.39, "cross-section": 0.65, "multi-focus": 0.5}


class Maker:
    """Writes one study; the same seed gives the same bytes."""

    def __init__(self, folder, seed=0, shapes=SHAPES, methods=("single-focus", "cross-section"), repeats=3, **sidecar):
        self.folder, self.random, self.shapes, self.methods, self.repeats = folder, random.Random(seed), list(shapes), list(methods), repeats
        self.sidecar = {"PalpaStudyVersion": 1, "shape": {"Levels": dict.fromkeys(self.shapes, "")}} | sidecar
        folder.mkdir(parents=True, exist_ok=True)

    def trials(self, method, skill=0.0, shapes=None, repeats=None):
        """Rows of a block of trials, without onsets."""
        shapes = shapes or self.shapes
        order = shapes * (repeats or self.repeats)
        self.random.shuffle(order)
        rows = []
        for shape in order:
            right = self.random.random() < CHANCE.get(method, 0.5) + skill
            answer = shape if right else self.random.choice(shapes)
            rows.append([f"{self.random.uniform(4, 10):.3f}", "trial", method, shape, answer, f"{self.random.lognormvariate(0.3, 0.5):.3f}", "answered"])
        return rows

    def person(self, number, *blocks, name=None, sidecar=None, finger=False, **more):
        """One log per block of rows."""
        name = name or f"sub-{number}"
        beh = self.folder / name / "beh"
        beh.mkdir(parents=True, exist_ok=True)
        for run, rows in enumerate(blocks, 1):
            onset, lines = 0.5 + self.random.random(), ["\t".join(HEADER)]
            for row in rows:
                lines.append("\t".join([f"{onset:.6f}", *row]))
                onset += 12 + self.random.random()
            stem = f"{name}_task-shapes_run-{run:02}"
            text = ("\n".join(lines) + "\n").encode()
            (beh / f"{stem}_events.tsv").write_bytes(text)
            told = self.sidecar | (sidecar or {}) | more
            (beh / f"{stem}_events.json").write_text(json.dumps({"EventsCrc32": f"{zlib.crc32(text):08x}"} | told))
            if finger:
                self.finger(beh / stem, onset)
        return beh

    def finger(self, stem, seconds):
        """Depths, 30 times a second, that miss here and there."""
        rows = []
        for k in range(int(30 * seconds)):
            depth = "n/a" if k % 17 == 0 else f"{0.004 + 0.003 * self.random.random():.6f}"
            rows.append(f"{depth}\t0.1\t0.2\t0.3")
        (stem.parent / f"{stem.name}_recording-finger_physio.tsv.gz").write_bytes(gzip.compress(("\n".join(rows) + "\n").encode(), mtime=0))
        (stem.parent / f"{stem.name}_recording-finger_physio.json").write_text(
            json.dumps({"SamplingFrequency": 30, "StartTime": 0.2, "Columns": ["depth", "x", "y", "z"]}))

    def people(self, count, first=1, **more):
        """Each with a skill of their own; the first half begins with the first method."""
        for number in range(first, first + count):
            methods = self.methods if number < first + (count + 1) // 2 else self.methods[::-1]
            skill = self.random.gauss(0, 0.1)
            self.person(number, *(self.trials(method, skill) for method in methods), **more)
        return self


def paper(folder):
    Maker(folder, 1, repeats=10, LeastTrials=30).people(10)


def one_participant(folder):
    Maker(folder, 2, repeats=5).people(1)


def one_method(folder):
    Maker(folder, 3, methods=["cross-section"]).people(4)


def three_methods(folder):
    Maker(folder, 4, methods=["multi-focus", "cross-section", "single-focus"], repeats=4).people(6)


def ties(folder):
    """Everybody gains the same, or nothing."""
    maker = Maker(folder, 5)
    for number in range(1, 9):
        blocks = []
        for method, right in (("single-focus", 6), ("cross-section", 6 + 2 * (number % 3))):
            rows = maker.trials(method)
            for place, row in enumerate(rows):
                row[4] = row[3] if place < right else next(shape for shape in SHAPES if shape != row[3])
            blocks.append(rows)
        maker.person(number, *blocks[::1 if number % 2 else -1])


def all_right(folder):
    maker = Maker(folder, 6)
    for number in range(1, 7):
        blocks = [maker.trials(method) for method in maker.methods]
        for row in blocks[1]:
            row[4] = row[3]
        maker.person(number, *blocks)


def nothing_right(folder):
    maker = Maker(folder, 7, shapes=["a", "b"], methods=["m"])
    for number in (1, 2, 3):
        rows = maker.trials("m")
        for row in rows:
            row[4] = "b" if row[3] == "a" else "a"
        maker.person(number, rows)


def voids(folder):
    """Broken off, repeated, and never answered; parts without an answer."""
    maker = Maker(folder, 8, methods=["single-focus", "cross-section"])
    for number in range(1, 6):
        blocks = []
        for method in maker.methods:
            rows = [["10", "familiarise", method, shape, "no" if number == 2 else "yes", "1.5", "answered"] for shape in SHAPES]
            rows += [["180", "free", method, "n/a", "n/a", "n/a", "done"], ["10", "practice", method, "semi-sphere", "cube", "2", "answered"]]
            rows += [["60", "rest", "n/a", "n/a", "n/a", "n/a", "done"]]
            for row in maker.trials(method):
                if maker.random.random() < 0.2:
                    rows.append([*row[:4], "n/a", "n/a", "void"])
                rows.append(row)
            blocks.append(rows)
        maker.person(number, *blocks)


def only_voids(folder):
    maker = Maker(folder, 9).people(2)
    maker.person(3, [[*row[:4], "n/a", "n/a", "void"] for row in maker.trials("single-focus")])
    maker.person(4, [])


def halves(folder):
    """Who came only to one method, or broke off; with at least so many trials."""
    maker = Maker(folder, 10, repeats=5, LeastTrials=15).people(7)
    maker.person(8, maker.trials("single-focus"))
    maker.person(9, maker.trials("single-focus"), maker.trials("cross-section", repeats=2))
    maker.person(10, maker.trials("cross-section")[:3])


def all_too_few(folder):
    Maker(folder, 11, repeats=2, LeastTrials=30).people(3)


def faulty_rows(folder):
    """What spreadsheets, cables and people do to a log."""
    maker = Maker(folder, 12).people(4)
    log = folder / "sub-1/beh/sub-1_task-shapes_run-01_events.tsv"
    lines = log.read_text().splitlines()
    lines[2] = lines[2].replace("trial", "trail")
    lines[3] = lines[3].rpartition("\t")[0]
    lines[4], lines[5] = lines[5], lines[4]
    lines[7] = lines[6]
    lines[8] = "x" + lines[8]
    lines[9] = lines[9].replace("answered", "done")
    log.write_text("\ufeff" + "\r\n".join(lines))
    quoted = folder / "sub-2/beh/sub-2_task-shapes_run-01_events.tsv"
    quoted.write_text("".join("\t".join(f' "{cell}" ' for cell in line.split("\t")) + "\n" for line in quoted.read_text().replace("onset", "Onset").splitlines()))
    (folder / "sub-3/beh/sub-3_task-shapes_run-01_events.json").unlink()
    (folder / "sub-4/beh/sub-4_task-shapes_run-02_events.tsv").write_text("onset\tduration\n1\t2\n")
    maker.person(5, [[*row[:3], "cube" if place else "ball", row[4] if place != 1 else "egg\x07", *row[5:]] for place, row in enumerate(maker.trials("single-focus"))])


def foreign_files(folder):
    maker = Maker(folder, 13).people(3)
    (folder / "sub-x/beh").mkdir(parents=True)
    (folder / "sub-7").mkdir()
    (folder / "sub-8/beh").mkdir(parents=True)
    (folder / "notes.txt").write_text("x")
    (folder / "sub-1/beh/sub-2_task-shapes_events.tsv").write_text("x\n")
    (folder / "sub-1/beh/.sub-1_task-shapes_run-01_events.tsv.swp").write_text("x\n")
    (folder / "sub-2/beh/sub-2_task-shapes_run-03_events.tsv").write_bytes("onset\n".encode("utf-16"))
    (folder / "sub-2/beh/sub-2_task-shapes_run-04_events.tsv").write_text("")
    maker.person(9, maker.trials("single-focus"), sidecar={"PalpaStudyVersion": 2})
    maker.person(10, maker.trials("single-focus"), sidecar={"shape": {"Levels": {"cube": "", "ball": ""}}})
    maker.person(11, maker.trials("single-focus"), sidecar={"LeastTrials": -1})
    maker.person(12, maker.trials("single-focus"), sidecar={"EventsCrc32": "00000000"})


def copies(folder):
    """A log twice, another's log, and equal logs without times of answers."""
    maker = Maker(folder, 14).people(3)
    one = folder / "sub-1/beh/sub-1_task-shapes_run-01_events.tsv"
    one.with_name("sub-1_task-shapes_run-10_events.tsv").write_bytes(one.read_bytes())
    other = folder / "sub-4/beh/sub-4_task-shapes_run-01_events.tsv"
    other.parent.mkdir(parents=True)
    other.write_bytes(one.read_bytes())
    state = maker.random.getstate()
    for number in (5, 6):
        maker.random.setstate(state)
        maker.person(number, [[*row[:5], "n/a", row[6]] for row in maker.trials("single-focus")])


def rehearsals(folder):
    Maker(folder, 15, Rehearsal=True, PlanSha256="1" * 64).people(3)
    Maker(folder, 16, PlanSha256="2" * 64).people(12, first=4)


def journal_of(entries, head=True):
    text, last = "", ""
    lines = [{"palpa_journal": 1, "participant": 1, "plan_sha256": "0"}] if head else []
    for entry in lines + entries:
        line = json.dumps(entry)
        last = f"{zlib.crc32((last + line).encode()):08x}"
        text += f"{line}\t{last}\n"
    return text


def journals(folder):
    """Killed before the log was written; steps that stay void; damaged; finished; without any log."""
    maker = Maker(folder, 17).people(4)
    steps = [{"what": "start", "at_ns": 0}] + [{"what": "answer", "at_ns": k, "step": k, "text": "cube"} for k in range(15)]
    (folder / "sub-1/sub-1_journal.jsonl").write_text(journal_of(steps) + "cut off")
    machine = [{"what": "void", "at_ns": k, "step": 3, "by_machine": True} for k in range(4)]
    (folder / "sub-2/sub-2_journal.jsonl").write_text(journal_of([{"what": "start", "at_ns": 0}, *machine, {"what": "finish", "at_ns": 9}]))
    (folder / "sub-3/sub-3_journal.jsonl").write_text(journal_of(steps).replace("cube", "cone", 1))
    (folder / "sub-4/sub-4_journal.jsonl").write_text(journal_of([{"what": "sneezed", "at_ns": 1}]))
    (folder / "sub-5/beh").mkdir(parents=True)
    (folder / "sub-5/sub-5_journal.jsonl").write_text(journal_of(steps))
    maker.person(6, maker.trials("single-focus"))
    (folder / "sub-6/sub-6_journal.jsonl").write_text("")


def withdrawn(folder):
    Maker(folder, 18, repeats=2).people(3)
    (folder / "sub-2/sub-2_withdrawn.json").write_text("{}")


def fingers(folder):
    """Recordings: whole, cut off, damaged, not gzip, in two members, without a depth."""
    Maker(folder, 19, repeats=2).people(6, finger=True)
    at = [folder / f"sub-{n}/beh/sub-{n}_task-shapes_run-01_recording-finger_physio.tsv.gz" for n in range(1, 7)]
    data = at[1].read_bytes()
    at[1].write_bytes(data[:len(data) // 2])
    data = at[2].read_bytes()
    at[2].write_bytes(data[:-6] + b"\0" * 6)
    at[3].write_bytes(b"no gzip")
    text = gzip.decompress(at[4].read_bytes())
    half = text.index(b"\n", len(text) // 2) + 1
    at[4].write_bytes(gzip.compress(text[:half], mtime=0) + gzip.compress(text[half:], mtime=0) + bytes(512))
    beside = at[5].with_name(at[5].name.replace(".tsv.gz", ".json"))
    beside.write_text(beside.read_text().replace("depth", "height"))


def many(folder):
    """More people than exact tests take, with umlauts and a void of every kind."""
    Maker(folder, 20, shapes=["Würfel", "Kugel, groß", "Keil <b>"], methods=["größer", "single-focus"], repeats=2).people(205)


STUDIES = [paper, one_participant, one_method, three_methods, ties, all_right, nothing_right, voids, only_voids, halves, all_too_few, faulty_rows,
           foreign_files, copies, rehearsals, journals, withdrawn, fingers, many]

COUNTS = {
    "plain": "actual,a,b,c\na,5,2,3\nb,1,9,0\nc,4,4,2\n",
    "margins": "sep=;\nactual;a;b;Total\nb;1;9;10\na;5;2;7\nTotal;6;11;17\n",
    "tabs": '\ufeff"x"\t"a"\t"b ""c"" d"\r\n"b ""c"" d"\t1\t2\t\r\na\t 3 \t0\t\r\n\r\n',
    "zeros": "actual,a,b,c\na,10,0,0\nb,0,0,10\nc,0,5,5\n",
    "equal": "actual,a,b\na,5,5\nb,5,5\n",
    "cut": "actual,a,b\na,5,5\nb,3,5",
    "latin": "actual,a,b\xfc\na,5,5\nb\xfc,3,5\n",
    "big": "actual,a,b,c,d\na,1000000,3,1,0\nb,2,900000,7,7\nc,0,1,500000,9\nd,4,4,4,4\n",
}
BAD_COUNTS = ["", "a\n", "actual,a,a\n", "actual,a,b\na,1\nb,1,2\n", "actual,a,b\na,1,x\nb,1,2\n", "actual,a,b\na,1,2\n", "actual,a,b\na,1,2\na,1,2\n",
              "actual,a,b\nc,1,2\nb,1,2\n", "actual,a,b\na,0,0\nb,0,0\n", "actual,a,b\na,-1,0\nb,0,0\n", "actual,,b\na,0,0\nb,0,0\n", "actual,a,b\na,2000000000,0\nb,0,0\n"]
