"""fuzz_study.py: what fuzz.py gives the commands of studies: plans, journals, logs, tables of counts, masking sounds."""
import io
import json
import random
import re
import shutil
import wave
import zlib

from mutate import mutated

COMMANDS = {"study plan": 3, "study level": 2, "study rehearse": 3, "study withdraw": 1, "study analyse": 4, "study compare": 1.5, "study power": 0.2,
            "study run": 0.4}
# As in fuzz.py.
LINES = {"study plan": [["<plan --participant @number"]], "study level": [["<plan"]], "study power": [[""]],
         # An unbroken plan is the plan of the pool's study, which goes on.
         "study rehearse": [["@own_plan|@own_plan|<plan --participant @number --out @study"]], "study withdraw": [["@number --out @erased"]],
         "study run": [["@run_plan --participant 1 --out @new --rehearse 0.5 --size 320x200 --backend cpu"]],
         "study analyse": [["@analysed"]], "study compare": [["@analysed"], ["paper", "<counts", "x paper"]]}
COUNTS = [b"actual,cube,prism\ncube,50,30\nprism,17,38\n",
          b"actual;cube;semi-sphere;pyramid;prism\ncube;50;30;9;11\nsemi-sphere;23;42;16;19\npyramid;13;37;26;24\nprism;17;18;27;38\n",
          b"\"actual\"\t\"a b\"\t\"\xc3\xa4\"\r\na b\t1\t0\r\n\xc3\xa4\t0\t1000000000\r\n"]


def sounds():
    """WAV files: 8 bits and one channel; 16 bits and two."""
    files = []
    for channels, width, rate in ((1, 1, 8000), (2, 2, 44100)):
        data = io.BytesIO()
        with wave.open(data, "wb") as file:
            file.setnchannels(channels)
            file.setsampwidth(width)
            file.setframerate(rate)
            file.writeframes(random.Random(rate).randbytes(400 * channels * width))
        files.append(("sea.wav", data.getvalue()))
    return files


def chained(lines):
    """A journal of these lines (bytes, without checksums), with checksums that fit."""
    digits, text = b"", b""
    for line in lines:
        digits = f"{zlib.crc32(digits + line):08x}".encode()
        text += line + b"\t" + digits + b"\n"
    return text


def journal_mutated(draw, data):
    """One mutation of a journal: cut, edited, of another version, with other lines; with checksums that fit or not."""
    lines = data.splitlines(keepends=True)
    how = draw.randrange(8)
    at = draw.randrange(len(lines))
    if how == 0:
        return data[:draw.randrange(len(data) + 1)]
    if how == 1:
        return mutated(draw, "j.txt", data)
    if how == 2:
        del lines[at]
        return b"".join(lines)
    if how == 3:
        draw.shuffle(lines)
        return b"".join(lines)
    # The same by somebody who writes the checksums again.
    bare = [line.rpartition(b"\t")[0] for line in lines]
    if how == 4:
        entry = json.loads(bare[0])
        entry.update(draw.choice([{"palpa_journal": draw.choice([0, 2, -1, "1", None, 1e300])}, {"participant": draw.choice([2, -1, 1e10, "x"])},
                                  {"plan_sha256": "0"}]))
        bare[0] = json.dumps(entry).encode()
    elif how == 5:
        bare[at] = mutated(draw, "entry.json", bare[at]).replace(b"\n", b" ")
    elif how == 6:
        bare.insert(draw.randrange(len(bare) + 1), bare[at])
    else:
        other = draw.randrange(len(bare))
        bare[at], bare[other] = bare[other], bare[at]
    return chained(bare)


def study_folder(case):
    """A folder of a study, which the command may change: one with a participant, some file of it broken; or none."""
    draw, folder = case.random, case.folder / "study"
    if draw.random() < 0.15:
        return draw.choice([str(case.folder / "none"), str(case.folder / "in"), "/nonexistent/x", "/dev/null", ""])
    shutil.copytree(case.pool.study, folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    for path in draw.sample(files, draw.choice([0, 0, 1, 2])):
        path.write_bytes(mutated(draw, path.name, path.read_bytes()))
    journal = folder / "sub-01/sub-01_journal.jsonl"
    if draw.random() < 0.6:
        for _ in range(draw.choice([1, 1, 2])):
            data = journal.read_bytes()
            if data:
                try:
                    journal.write_bytes(journal_mutated(draw, data))
                except ValueError:  # the lines of one that is broken already are no JSON
                    pass
    if draw.random() < 0.15:  # two participants with one number
        shutil.copytree(folder / "sub-01", folder / draw.choice(["sub-1", "sub-001", "sub-0001"]))
    case.journal = journal.read_bytes()
    return str(folder)


def read_only(case, place):
    """No file that an analysis reads may change. Others are the user's to overwrite."""
    case.journal = None
    for path in sorted((case.folder / "study").rglob("*")) if place == str(case.folder / "study") else []:
        if path.is_file() and path.name.endswith(("_events.tsv", "_events.json", "_physio.tsv.gz", "_physio.json")):
            case.read(path)
    return place


def run_plan(case):
    """A short plan whose only broken file is the sound in the headphones."""
    text = next(data for _, data in case.pool.files["plan"] if b"cube" in data).decode()
    shapes = re.findall(r'\[\[shape\]\]\nname = "[\w-]+"\nmodel = "[^"]+"\n', text)[:2]
    sound = case.file("wav", 0.85)
    return case.keep("plan.toml", ('title = "Fuzz"\n' + "".join(shapes) + '[[method]]\nname = "single-focus"\nlayout = "openmpd"\n[study]\nparticipants = 2\n'
                                   f"trials_per_shape = 1\ntouch_s = 0.02\n[run]\nmasking = {json.dumps(sound)}\n[level]\nlimit_db = 140\n"
                                   '[[block]]\nkind = "trial"\n').encode())


def given(case, name):
    """What @NAME of a line stands for."""
    if name == "own_plan":
        return str(case.pool.study_plan)
    if name == "new":
        return str(case.folder / "new")
    if name == "run_plan":
        case.environment = {"DISPLAY": case.pool.display or "", "WAYLAND_DISPLAY": "", "SDL_AUDIODRIVER": "dummy", "XDG_CONFIG_HOME": "/dev/null"}
        return run_plan(case)
    if name == "analysed":
        return read_only(case, study_folder(case)) if case.random.random() < 0.6 else case.file("counts", 0.6)
    case.may_erase = name == "erased"
    return study_folder(case)


def faults_of_study(case):
    """What is wrong with the journal that a command was given."""
    if case.journal is None or case.may_erase:
        return []
    path = case.folder / "study/sub-01/sub-01_journal.jsonl"
    whole = case.journal[:case.journal.rfind(b"\n") + 1]
    if not path.exists() or not path.read_bytes().startswith(whole):
        return ["the journal has lost lines"]
    return []

