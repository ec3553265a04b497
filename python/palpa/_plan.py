"""Plans of sweeps: a command, its options, which of them vary, and the cases that this makes (docs/sweeps.md)."""
import difflib
import functools
import hashlib
import itertools
import json
import math
import os
import pathlib
import re
import typing
import urllib.parse

from . import _engine  # type: ignore[attr-defined]  # it has no stub of its own

MOST_CASES = 1_000_000
NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+))(?:[eE]([-+]?\d+))?([a-zA-Z/]*)"
# The units of each kind of number, as powers of ten of the SI unit.
UNITS = {
    "LENGTH": {"": 0, "m": 0, "cm": -2, "mm": -3, "um": -6},
    "TIME": {"": 0, "s": 0, "ms": -3, "us": -6},
    "N": {"": 0},
    "CELSIUS": {"": 0},
    "FREQUENCY": {"": 0, "Hz": 0, "kHz": 3, "MHz": 6},
    "SPEED": {"": 0, "m/s": 0},
    "PRESSURE": {"": 0, "Pa": 0, "kPa": 3},
}
SEVERAL = ("FILES", "POINTS")
OF_THE_SWEEP = {"gpu", "backend", "validation", "allow_outside"}


class Command(typing.NamedTuple):
    """What a command takes."""
    functions: tuple  # of the module, whose options it has
    arguments: dict  # what is an argument there -> its kind, or its words
    needs: tuple  # one option of each of these groups
    lacks: frozenset = frozenset()  # options of the functions that it does not have


COMMANDS = {
    "touch": Command(
        functions=("Scene", "Scene.touch"),
        arguments={"scene": "FILE", "points": "FILE", "depth": "FILES", "camera": "FILES", "rig": "FILE",
                   "penetration": "LENGTH"},
        needs=(("scene",), ("points", "depth"))),
    "drive": Command(
        functions=("Layout.solve",),
        arguments={"layout": "NAME|FILE", "focus": "POINTS", "null": "POINTS", "touch": "FILE", "slot": "N",
                   "mesh": "FILE", "force": "FLAG"},
        needs=(("layout",), ("focus", "touch"))),
    "field": Command(
        functions=("Layout.solve", "Layout.field"),
        arguments={"layout": "NAME|FILE", "focus": "POINTS", "null": "POINTS", "drive": "FILE",
                   "plane": ("xy", "xz", "yz"), "centre": "LIST", "size": "LIST", "pixels": "LIST",
                   "line": "POINTS", "samples": "N", "points": "FILE"},
        needs=(("layout",), ("focus", "drive"), ("plane", "line", "points")),
        lacks=frozenset({"transfer"})),
    "simulate": Command(
        functions=("Scene", "simulate"),
        arguments={"scene": "FILE", "finger": "FILE", "penetration": "LENGTH", "skin": ("vertices", "cameras"),
                   "noise_free": "FLAG", "force": "FLAG"},
        needs=(("scene",), ("finger",))),
}


def error(text, kind=_engine.BadUsage):
    """An error of palpa with its exit code, in one line."""
    made = kind(text.replace("\n", "\\n").replace("\0", "\\0"))
    made.exit_code = {_engine.BadUsage: 2, _engine.NoDevice: 3, _engine.BadInput: 4}.get(kind, 1)
    return made


def brief(value):
    try:
        return repr(value)[:80]
    except ValueError:  # Python writes no number of more than 4300 digits
        return "a number of very many digits"


def path_of(name, value):
    text = os.fsdecode(value)
    if not text or "\0" in text or not text.isprintable() and re.search("[\ud800-\udc7f\udd00-\udfff]", text):
        raise error(f"{name}: {brief(value)} is no path")
    return text


# The results of a plan that names none.
USUAL = {
    "touch": [
        "points", "contacts.count", "contacts.depths_m.max", "fingers.count", "fingers.0.indices.count",
        "fingers.0.centroid_m.0", "fingers.0.centroid_m.1", "fingers.0.centroid_m.2", "fingers.0.eigenvalues_m2.0",
        "fingers.0.eigenvalues_m2.1", "fingers.0.foci_m.count", "fingers.0.pressures_pa.min",
        "fingers.0.pressures_pa.max"],
    "drive": [
        "transducers", "sound_speed_m_s", "frequency_hz", "pressures_pa.min", "pressures_pa.max",
        "weakest_to_strongest", "amplitudes.min", "amplitudes.mean", "amplitudes.max"],
    "field": [
        "points", "peak_pa", "peak_m.0", "peak_m.1", "peak_m.2", "sound_speed_m_s", "density_kg_m3",
        "absorption_np_m"],
    "simulate": [
        "finger.faces", "langevin.peak_pa", "langevin.half_area_m2", "langevin.half_radius_m", "langevin.elongation",
        "squared.peak_pa", "squared.half_area_m2", "squared.half_radius_m", "squared.elongation", "force_N.0",
        "force_N.1", "force_N.2", "force_far_N.1", "torque_Nm.0", "torque_Nm.1", "torque_Nm.2"],
}
OF_LISTS = {"count": len, "min": min, "max": max, "sum": math.fsum,
            "mean": lambda values: math.fsum(values) / len(values)}


def near(word, known):
    found = difflib.get_close_matches(str(word), known, n=1)
    return f"; did you mean {found[0]}?" if found else f"; there are {', '.join(known)}"


@functools.lru_cache
def paths_of(command):
    """The paths of all single values of the command's JSON; # stands for the index of an entry of a list."""
    return _engine._paths()[command]


def path_fault(command, path):
    """What is wrong with a path of `results`; empty if cases of this command may have it."""
    known, plain = paths_of(command), re.sub(r"(?<=\.)\d+(?=\.|$)", "#", str(path))
    before, _, last = plain.rpartition(".")
    entries = before + ("." if last == "count" else ".#")
    if plain in known or (last in OF_LISTS and any(entry.startswith(entries) for entry in known)):
        return ""
    if inside := [entry for entry in known if entry.startswith(plain + ".")]:
        kind = "a list" if inside[0].startswith(plain + ".#") else "an object"
        return f"{path} is {kind}; name one of its entries, such as {inside[0].replace('#', '0')}, or {path}.count"
    found = difflib.get_close_matches(plain, known, n=1)
    return f"a case of {command} has no {path}" + (f"; did you mean {found[0].replace('#', '0')}?" if found else "")


def find(document, path):
    """The single value that a path leads to; None if this case has none."""
    at = document
    for part in path.split("."):
        if isinstance(at, dict) and part in at:
            at = at[part]
        elif isinstance(at, list) and part.isdecimal():
            at = at[int(part)] if int(part) < len(at) else None
        elif isinstance(at, (dict, list)) and part in OF_LISTS:
            values = at if part == "count" else [value for value in at if isinstance(value, (int, float))]
            at = OF_LISTS[part](values) if values or part == "count" else None
        else:
            return None
    return None if isinstance(at, (dict, list)) else at


class Fault(Exception):
    """What is wrong with a plan, without its name."""


def quantity(text, kind):
    """The number in SI units that a text such as "1.5mm" means; None if the text is not of this kind."""
    match = re.fullmatch(NUMBER, text)
    power = UNITS[kind].get(match[3]) if match else None
    # The power is added to the exponent, so that the number is rounded once.
    return None if power is None else float(f"{match[1]}e{int(match[2] or 0) + power}")


@functools.lru_cache
def options_of(command):
    """Option -> (kind, words) of what a case of the command can have."""
    it = COMMANDS[command]
    found = {}
    for function in it.functions:
        for name, kind, _, _, words, flag in _engine._options()[function]:
            found[name] = ("FLAG" if flag else kind, tuple(words))
    for name, kind in it.arguments.items():
        found[name] = (kind, ()) if isinstance(kind, str) else ("WORD", kind)
    return {name: found[name] for name in sorted(found.keys() - OF_THE_SWEEP - it.lacks)}


def shown(value):
    """A flag or texts as in tables."""
    return str(value).lower() if isinstance(value, bool) else " ".join(value)


def text_of(where, value):
    """A value as it would stand on a command line."""
    if isinstance(value, (list, tuple)) and value:
        return ",".join(text_of(where, part) for part in value)
    if isinstance(value, (str, os.PathLike)) and os.fspath(value):
        return os.fspath(value)
    if isinstance(value, bool) or not hasattr(value, "__float__") or not math.isfinite(value):
        raise Fault(f"{where} must be a text or a finite number, not {brief(value)}")
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))


def digest_of(path):
    """The digests of a file and of those that it names: a model's buffers, and files beside a TOML file."""
    data, named = path.read_bytes(), []
    if path.suffix.lower() in (".gltf", ".glb"):
        text = data[20:20 + int.from_bytes(data[12:16], "little")] if data[:4] == b"glTF" else data
        try:
            uris = [buffer["uri"] for buffer in json.loads(text)["buffers"] if "uri" in buffer]
            named = [urllib.parse.unquote(uri).replace("\\", "/") for uri in uris]
        except (ValueError, TypeError, KeyError):
            pass  # a broken model, or one without buffers
    elif path.suffix.lower() == ".toml":
        named = re.findall(r"""["']([^"'\n]+)["']""", data.decode(errors="replace"))
    files = [path.parent / name for name in named if len(name) < 1000]
    digests = [f"{path.suffix}:{hashlib.sha256(data).hexdigest()}"]
    return ",".join(digests + [digest_of(file) for file in files if file.is_file() and file != path])


def software():
    """Which palpa computes."""
    return f"{_engine.__version__} {_engine._commit}".strip()


class Plan:
    """A plan that was read from a file or a dict, and checked. Raises BadInput for what is wrong with it."""

    def __init__(self, plan):
        self.files, self.inputs = [], {}  # (option, text) -> the text with the file's whole path, and with its digest
        self.name = "the plan" if isinstance(plan, dict) else path_of("plan", plan)
        self.folder = pathlib.Path.cwd() if isinstance(plan, dict) else pathlib.Path(self.name).absolute().parent
        try:
            self._read(plan if isinstance(plan, dict) else self._loaded())
        except Fault as fault:
            made = error(f"{self.name}: {fault}", _engine.BadInput)
            made.file = self.name
            raise made from None

    def _loaded(self):
        import tomllib
        self.files.append(pathlib.Path(self.name))
        data = _engine._text_of(self.name)
        try:
            text = data.decode().replace("\r\n", "\n")
            if self.files[0].suffix != ".py":
                return tomllib.loads(text)
            names = {"__name__": "plan", "__file__": self.name}
            exec(compile(text, self.name, "exec"), names)  # the user's own program
            return names["plan"]
        except OSError as fault:
            raise Fault(fault.strerror) from None
        except (ValueError, SyntaxError) as fault:
            raise Fault(f"is not {'Python' if self.name.endswith('.py') else 'TOML'}: {fault}") from None
        except KeyError:
            raise Fault("makes no dict that is called plan") from None

    def _read(self, table):
        if not isinstance(table, dict):
            raise Fault("is not a table")
        for key in table:
            if key not in (keys := ("command", "results", "keep", "options", "vary", "functions")):
                raise Fault(f"unknown key {key}{near(key, keys)}")
            if key in keys[3:] and not isinstance(table[key], dict):
                raise Fault(f"{key} must be a table")
        self.command = table.get("command")
        if self.command not in COMMANDS:
            raise Fault(f"command is {brief(self.command)}, but must be one of {', '.join(COMMANDS)}")
        if table.get("keep", "results") not in ("results", "everything"):
            raise Fault('keep must be "results" or "everything"')
        self.everything = table.get("keep") == "everything"
        self.results = table.get("results", USUAL[self.command])
        if not isinstance(self.results, list) or not self.results:
            raise Fault("results must be a list of paths such as contacts.count, with at least one")
        for path in self.results:
            if fault := path_fault(self.command, path):
                raise Fault(f"results: {fault}")
            if self.results.count(path) > 1:
                raise Fault(f"results: {path} is there twice")
        self.functions, self.fixed, self.axes, places = {}, {}, [], {}
        for name, own in table.get("functions", {}).items():
            whole = isinstance(own, dict) and set(own) == {"function", "version"}
            if not whole or not callable(own["function"]) or own["version"] in ("", None):
                raise Fault(f'functions: {name} must be {{"function": a function, "version": "1"}}, '
                            "with another version whenever it changes")
            self.functions[name] = own["function"], str(own["version"])
        for key, value in table.get("options", {}).items():
            self.fixed |= self._setting(f"[options] {key}", key, value, places, "[options]")
        for key, value in table.get("vary", {}).items():
            self.axes.append(self._axis(f"[vary] {key}", key, value, places))
        self.varied = [option for option, place in places.items() if place != "[options]"]
        for needed in COMMANDS[self.command].needs:
            if places.keys().isdisjoint(needed):
                raise Fault(f"{self.command} needs {' or '.join(needed)}: set it in [options] or [vary]")
        if (count := math.prod(map(len, self.axes))) > MOST_CASES:
            factors = " x ".join(f"{len(axis):,} {' and '.join(axis[0])}" for axis in self.axes)
            raise Fault(f"has {count:,} cases ({factors}); a plan has at most {MOST_CASES:,}: vary less, or divide it")

    def _setting(self, where, key, value, places, place):
        """{option: a flag, or the texts that it would have on a command line}."""
        option, known = str(key).replace("-", "_"), options_of(self.command)
        if option not in known:
            raise Fault(f"{key} is not an option that a case of {self.command} can have{near(option, known)}")
        if places.setdefault(option, place) != place:
            raise Fault(f"{option} is set in {places[option]} and in {place}: set it in one place")
        kind, words = known[option]
        if kind == "FLAG":
            if not isinstance(value, bool):
                raise Fault(f"{where} must be true or false")
            return {option: value}
        is_list = isinstance(value, (list, tuple))
        if is_list and (not value or kind not in (*SEVERAL, "LIST")):
            raise Fault(f"{where} must be one value, not {brief(value)}" if value else f"{where} has an empty list")
        several = is_list and kind in SEVERAL and not all(hasattr(part, "__float__") for part in value)
        texts = tuple(text_of(where, one) for one in (value if several else [value]))
        words = (*words, *self.functions) if option in ("solver", "method") else words
        for text in texts:
            if words and text not in words:
                raise Fault(f"{where}: {text} is not one of its words{near(text, words)}")
            number = quantity(text, kind) if kind in UNITS else 0
            if number is None or (kind == "N" and number != int(number)):
                units = ", ".join(filter(None, UNITS[kind]))
                number = "whole number" if kind == "N" else "number"
                raise Fault(f"{where}: {text} is not a {number}" + (f", alone or with {units}" if units else ""))
            self._input(where, option, kind, text)
        return {option: texts}

    def _input(self, where, option, kind, text):
        """Remembers the file that a value names."""
        of_layout = kind == "NAME|FILE" and (text.endswith(".toml") or "/" in text)
        name = text if kind in ("FILE", "FILES") or of_layout else ""
        if option == "spread":
            of_position = [part[9:] for part in text.split(",") if part.startswith("position=")]
            name = next((part for part in of_position if not re.fullmatch(NUMBER, part)), "")
        if (option, text) in self.inputs:
            return
        try:
            if kind == "NAME|FILE" and not name:
                _engine.Layout(text)  # refuses names that it does not know
            if name:
                path = self.folder / name
                if path.exists() and not path.is_file():
                    raise Fault(f"{where}: {path}: is not a regular file")
                self.inputs[option, text] = text.replace(name, str(path)), text.replace(name, digest_of(path))
                self.files.append(path)
        except OSError as fault:
            raise Fault(f"{where}: {path}: {fault.strerror}") from None
        except _engine.Error as fault:
            raise Fault(f"{where}: {fault}") from None

    def _axis(self, where, key, value, places):
        """The choices of a key of [vary]; each sets one option, or some that belong together."""
        value = steps(where, value) if isinstance(value, dict) else value
        if not isinstance(value, (list, tuple)) or not value:
            raise Fault(f"{where} must be a list of values, or have from, to and count")
        together = all(isinstance(one, dict) for one in value)
        choices, known = [], set()
        for one in value:
            choice = {}
            for name, part in one.items() if together else [(key, one)]:
                choice |= self._setting(where, name, part, places, f"{key} of [vary]")
            if not choice:
                raise Fault(f"{where} has an empty table")
            if (frozen := frozenset(choice.items())) in known:
                raise Fault(f"{where} has a value twice: {', '.join(map(shown, choice.values()))}")
            known.add(frozen)
            choices.append(choice)
        return choices

    def cases(self):
        """The settings of each case; the last key of [vary] varies fastest."""
        return [functools.reduce(dict.__or__, chosen, self.fixed) for chosen in itertools.product(*self.axes)]

    def _replaced(self, settings, which):
        """The settings that are given, with paths (0) or digests (1) of their files."""
        def replaced(option, value):
            if isinstance(value, bool):
                return value
            return [self.inputs.get((option, text), (text, text))[which] for text in value]

        return {option: replaced(option, value) for option, value in settings.items() if value}

    def id(self, settings, backend):
        """The digest of what a case computes, and with what."""
        chosen = [shown(settings.get(option, "")) for option in ("solver", "method")]
        own = [self.functions[name][1] if name in self.functions else "" for name in chosen]
        kept = "everything" if self.everything else self.results
        text = json.dumps([software(), backend, self.command, kept, self._replaced(settings, 1), own], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    def ready(self, settings):
        """The settings for functions of the module: single values are no lists."""
        def is_single(option, value):
            return isinstance(value, list) and options_of(self.command)[option][0] not in SEVERAL

        return {option: value[0] if is_single(option, value) else value
                for option, value in self._replaced(settings, 0).items()}


def steps(where, table):
    """Equal steps from one value to another. They have twelve digits, so that they read as people write them."""
    if set(table) != {"from", "to", "count"}:
        raise Fault(f"{where} must have from, to and count, not {', '.join(table) or 'nothing'}")
    first, last = (re.fullmatch(NUMBER, text_of(where, table[end])) for end in ("from", "to"))
    if not first or not last or first[3] != last[3]:
        raise Fault(f'{where}: from and to must be numbers with the same unit, such as "1mm" and "3mm"')
    count, unit = table["count"], first[3]
    if not isinstance(count, int) or not 2 <= count <= MOST_CASES:
        raise Fault(f"{where}: count must be a whole number from 2 to {MOST_CASES:,}")
    begin, end = (float(match[0].removesuffix(unit)) for match in (first, last))
    return [text_of(where, float(f"{begin + (end - begin) * i / (count - 1):.12g}")) + unit for i in range(count)]
