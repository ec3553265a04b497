"""Plans of sweeps: a command, its options, which of them vary, and the cases that this makes (docs/sweeps.md)."""
import ast
import difflib
import functools
import hashlib
import itertools
import json
import math
import os
import pathlib
import random
import re
import urllib.parse

from . import _engine  # type: ignore[attr-defined]  # it has no stub of its own

MOST_CASES = 1_000_000
UNITS = {"LENGTH": {"": 0, "m": 0, "cm": -2, "mm": -3, "um": -6}, "TIME": {"": 0, "s": 0, "ms": -3, "us": -6}, "N": {"": 0}, "CELSIUS": {"": 0},
         "FREQUENCY": {"": 0, "Hz": 0, "kHz": 3, "MHz": 6}, "SPEED": {"": 0, "m/s": 0}, "PRESSURE": {"": 0, "Pa": 0, "kPa": 3}}
NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+))(?:[eE]([-+]?\d+))?([a-zA-Z/]*)"
SEVERAL = ("FILES", "POINTS")
# The functions that a command's options belong to, options that are arguments of these, and of which options it needs one.
COMMANDS = {
    "touch": (("Scene", "Scene.touch"),
              {"scene": "FILE", "points": "FILE", "depth": "FILES", "camera": "FILES", "rig": "FILE", "penetration": "LENGTH"},
              [("scene",), ("points", "depth")]),
    "drive": (("Layout.solve",),
              {"layout": "NAME|FILE", "focus": "POINTS", "touch": "FILE", "slot": "N", "mesh": "FILE", "force": "FLAG"},
              [("layout",), ("focus", "touch")]),
    "field": (("Layout.solve", "Layout.field"),
              {"layout": "NAME|FILE", "focus": "POINTS", "drive": "FILE", "plane": ("xy", "xz", "yz"), "centre": "LIST", "size": "LIST",
               "pixels": "LIST", "line": "POINTS", "samples": "N", "points": "FILE"},
              [("layout",), ("focus", "drive"), ("plane", "line", "points")]),
    "simulate": (("Scene", "simulate"),
                 {"scene": "FILE", "finger": "FILE", "penetration": "LENGTH", "skin": ("vertices", "cameras"), "noise_free": "FLAG",
                  "force": "FLAG"},
                 [("scene",), ("finger",)]),
}
OF_THE_SWEEP = {"gpu", "backend", "validation", "allow_outside"}
KEYS = ("command", "results", "keep", "options", "vary", "derive", "where", "functions")


# ---- results --------------------------------------------------------------------------------------------------------

def under(path, names):
    return " ".join(f"{path}.{name}" for name in names.split())


# The single values in the JSON of each command; # is any index of a list.
TUNE = "perimeter_m foci stride dwell_s field felt_share_before felt_share flutter_share_before flutter_share"
FELT = " ".join([under("fingers.#.tune", TUNE), under("fingers.#.spectrum", "perimeter_m period_s variance field felt_share flutter_share skin_m.#"),
                 under("fingers.#.spectrum.lines.#", "frequency_hz amplitude phase_rad around hold felt"), "fingers.#.solid"])
PRESSURE = "peak_pa peak_m.# half_area_m2 half_radius_m elongation"
PRESSURES = "peak_pa.# peak_m.#.# half_area_m2.# half_radius_m.# elongation.#"
OUTCOMES = {
    "touch": "points contacts.count contacts.indices.# contacts.depths_m.# schedule.order.#.# schedule.dwell_s " + FELT + " " + under(
        "fingers.#", "indices.# centroid_m.# axes.#.# eigenvalues_m2.# foci_m.#.# focus_points.# gain asked_pa pressure_pa pressures_pa.# "
        "schedule.order.#.# schedule.dwell_s"),
    "drive": "layout transducers sound_speed_m_s frequency_hz foci_m.#.# aimed_m.#.# gains.# pressures_pa.# over_free_field.# "
             "weakest_to_strongest unresolved_pairs.#.# amplitudes.# phases_rad.# solution.iterations solution.residual " + under(
                 "spread", "draws seed pressures_pa.#.# weakest_to_strongest.#"),
    "field": "points peak_pa peak_m.# sound_speed_m_s density_kg_m3 absorption_np_m " + under("spread", "draws seed peak_pa.# peak_m.#.#"),
    "simulate": " ".join([
        "finger.faces finger.vertices method penetration_m foci_m.#.# aimed_m.#.# force_N.# force_far_N.# torque_Nm.# solution.iterations "
        "solution.residual spread.draws spread.seed spread.force_N.#.# spread.torque_Nm.#.#", FELT, under("langevin", PRESSURE),
        under("squared", PRESSURE), under("spread.langevin", PRESSURES), under("spread.squared", PRESSURES)]),
}
# The results of a plan that names none.
USUAL = {
    "touch": "points contacts.count contacts.depths_m.max fingers.count fingers.0.indices.count fingers.0.centroid_m.0 fingers.0.centroid_m.1 "
             "fingers.0.centroid_m.2 fingers.0.eigenvalues_m2.0 fingers.0.eigenvalues_m2.1 fingers.0.foci_m.count fingers.0.pressures_pa.min "
             "fingers.0.pressures_pa.max",
    "drive": "transducers sound_speed_m_s frequency_hz pressures_pa.min pressures_pa.max weakest_to_strongest amplitudes.min amplitudes.mean "
             "amplitudes.max",
    "field": "points peak_pa peak_m.0 peak_m.1 peak_m.2 sound_speed_m_s density_kg_m3 absorption_np_m",
    "simulate": "finger.faces langevin.peak_pa langevin.half_area_m2 langevin.half_radius_m langevin.elongation squared.peak_pa "
                "squared.half_area_m2 squared.half_radius_m squared.elongation force_N.0 force_N.1 force_N.2 force_far_N.1 torque_Nm.0 "
                "torque_Nm.1 torque_Nm.2",
}
OF_LISTS = {"count": len, "min": min, "max": max, "sum": math.fsum, "mean": lambda values: math.fsum(values) / len(values)}


def near(word, known):
    found = difflib.get_close_matches(str(word), known, n=1)
    return f"; did you mean {found[0]}?" if found else f"; there are {', '.join(known)}"


def path_fault(command, path):
    """What is wrong with a path of `results`; empty if cases of this command may have it."""
    known = OUTCOMES[command].split()
    plain = re.sub(r"(?<=\.)\d+(?=\.|$)", "#", str(path))
    before, _, last = plain.rpartition(".")
    if plain in known:
        return ""
    if any(entry.startswith(before + (".#" if last != "count" else ".")) for entry in known) and before and last in OF_LISTS:
        return ""
    if inside := [entry for entry in known if entry.startswith(plain + ".")]:
        kind = "a list" if inside[0].startswith(plain + ".#") else "an object"
        return f"{path} is {kind}; name one of its entries, such as {inside[0].replace('#', '0')}, or {path}.count"
    found = difflib.get_close_matches(plain, known, n=1, cutoff=0.5)
    return f"a case of {command} has no {path}" + (f"; did you mean {found[0].replace('#', '0')}?" if found else "")


def find(document, path):
    """The value that a path leads to; None if this case has none."""
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
    return at


# ---- values ---------------------------------------------------------------------------------------------------------

class Fault(Exception):
    """What is wrong with a plan, without its name."""


def quantity(text, kind):
    """The number in SI units that a text such as "1.5mm" is; None if it is none of this kind."""
    match = re.fullmatch(NUMBER, text)
    power = UNITS[kind].get(match[3]) if match else None
    # The power is added to the exponent, so that the number is rounded once.
    return None if power is None else float(f"{match[1]}e{int(match[2] or 0) + power}")


@functools.lru_cache
def options_of(command):
    """Option -> (kind, words) of what a case of the command can have."""
    found = {name: ("FLAG" if flag else kind, tuple(words)) for function in COMMANDS[command][0]
             for name, kind, _, _, words, flag in _engine._options()[function]}
    found |= {name: (kind, ()) if isinstance(kind, str) else ("WORD", kind) for name, kind in COMMANDS[command][1].items()}
    return {name: found[name] for name in sorted(found.keys() - OF_THE_SWEEP - ({"transfer"} if command == "field" else set()))}


def shown(value):
    """A flag or texts as in tables."""
    return ("true" if value else "false") if isinstance(value, bool) else " ".join(value)


def text_of(where, value):
    if isinstance(value, (list, tuple)) and value:
        return ",".join(text_of(where, part) for part in value)
    if isinstance(value, (str, os.PathLike)) and os.fspath(value):
        return os.fspath(value)
    if isinstance(value, bool) or not hasattr(value, "__float__") or not math.isfinite(value):
        raise Fault(f"{where} must be a text or a finite number, not {value!r}")
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))


def digest_of(path):
    """The digests of a file and of those that it names: a model's buffers, and files beside a TOML file."""
    data, named = path.read_bytes(), []
    if path.suffix.lower() in (".gltf", ".glb"):
        text = data[20:20 + int.from_bytes(data[12:16], "little")] if data[:4] == b"glTF" else data
        try:
            named = [urllib.parse.unquote(buffer["uri"]) for buffer in json.loads(text)["buffers"] if "uri" in buffer]
        except (ValueError, TypeError, KeyError):
            pass  # a broken model, or one without buffers
    elif path.suffix.lower() == ".toml":
        named = re.findall(r"""["']([^"'\n]+)["']""", data.decode(errors="replace"))
    files = [path.parent / name for name in named if len(name) < 1000]
    return ",".join([f"{path.suffix}:{hashlib.sha256(data).hexdigest()}"] + [digest_of(file) for file in files if file.is_file() and file != path])


# ---- expressions ----------------------------------------------------------------------------------------------------

MATHS = {name: getattr(math, name) for name in ("gcd", "sqrt", "floor", "ceil", "exp", "log", "log10", "sin", "cos", "radians", "pi")} | {
    "abs": abs, "min": min, "max": max, "round": round}
DRAWS = ("uniform", "gauss", "randint", "choice")
ALLOWED = (ast.Expression, ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.Call, ast.Name, ast.Load, ast.Constant, ast.List,
           ast.operator, ast.unaryop, ast.boolop, ast.cmpop)


def expression(text, option, known):
    """The function of a case's values that "gcd(stride, foci) == 1" is. Random numbers depend on the case's seed and the option."""
    if callable(text):
        return text
    try:
        tree = ast.parse(str(text).strip(), mode="eval")
    except (SyntaxError, ValueError):
        raise Fault(f"{text!r} is no expression such as gcd(stride, foci) == 1") from None
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    if not all(isinstance(node, ALLOWED) and not (isinstance(node, ast.Call) and not isinstance(node.func, ast.Name)) for node in ast.walk(tree)):
        raise Fault(f"{text!r} has more than options, numbers, texts, operators and the functions {', '.join([*MATHS, *DRAWS])}")
    for name in sorted(names - set(known) - set(MATHS) - set(DRAWS)):
        raise Fault(f"{name} is not set in the plan{near(name, list(known))}")
    code = compile(tree, "plan", "eval")

    def evaluate(values):
        numbers = random.Random(f"{values.get('seed', 0)} {option}")
        try:
            return eval(code, {"__builtins__": {}}, MATHS | {name: getattr(numbers, name) for name in DRAWS} | values)
        except (ArithmeticError, TypeError, ValueError, NameError, IndexError) as error:
            raise Fault(f"{option}: {text!r}: {error}") from None
    return evaluate


# ---- plans ----------------------------------------------------------------------------------------------------------

class Plan:
    """A plan that was read from a TOML file or a dict, and checked. Raises BadInput for what is wrong with it."""

    def __init__(self, plan):
        self.files, self.inputs = [], {}  # (option, text) -> the text with the file's whole path, and with its digest
        self.name = "the plan" if isinstance(plan, dict) else os.fspath(plan)
        self.folder = pathlib.Path.cwd() if isinstance(plan, dict) else pathlib.Path(plan).absolute().parent
        try:
            self._read(plan if isinstance(plan, dict) else self._table())
        except Fault as fault:
            raise self.error(fault) from None

    def error(self, fault):
        """BadInput with the name of the plan."""
        error = _engine.BadInput(f"{self.name}: {fault}")
        error.file, error.exit_code = self.name, 4
        return error

    def _table(self):
        import tomllib
        self.files.append(pathlib.Path(self.name))
        try:
            return tomllib.loads(self.files[0].read_text(encoding="utf-8"))
        except OSError as error:
            raise Fault(error.strerror) from None
        except ValueError as error:
            raise Fault(f"is not TOML: {error}") from None

    def _read(self, table):
        for key in table:
            if key not in KEYS:
                raise Fault(f"unknown key {key}{near(key, KEYS)}")
        for key in ("options", "vary", "derive", "functions"):
            if not isinstance(table.setdefault(key, {}) if isinstance(table, dict) else {}, dict):
                raise Fault(f"{key} must be a table")
        self.command = table.get("command")
        if self.command not in COMMANDS:
            raise Fault(f"command is {self.command!r}, but must be one of {', '.join(COMMANDS)}")
        self._read_results(table)
        self.functions = {}
        for name, own in table["functions"].items():
            if not isinstance(own, dict) or set(own) != {"function", "version"} or not callable(own["function"]) or own["version"] in ("", None):
                raise Fault(f'functions: {name} must be {{"function": a function, "version": "1"}}, with another version whenever it changes')
            self.functions[name] = own["function"], str(own["version"])
        self.fixed, self.axes, self.derived, places = {}, [], {}, {}

        def once(option, place):
            if option in places:
                raise Fault(f"{option} is set in {places[option]} and in {place}: set it in one place")
            places[option] = place
        for key, value in table["options"].items():
            self.fixed |= self._setting(f"[options] {key}", key, value)
            once(self._option(key), "[options]")
        for key, value in table["vary"].items():
            self.axes.append(self._axis(f"[vary] {key}", key, value))
            for option in dict.fromkeys(itertools.chain.from_iterable(self.axes[-1])):
                once(option, f"{key} of [vary]")
        for key, value in table["derive"].items():
            self.derived[self._option(key)] = expression(value, self._option(key), places)
            once(self._option(key), "[derive]")
        self.varied = [option for option, place in places.items() if place != "[options]"]
        where = table.get("where", [])
        self.where = [expression(one, "where", places) for one in (where if isinstance(where, list) else [where])]
        for needed in COMMANDS[self.command][2]:
            if not any(option in places for option in needed):
                raise Fault(f"{self.command} needs {' or '.join(needed)}: set it in [options] or [vary]")
        count = math.prod(len(axis) for axis in self.axes)
        if count > MOST_CASES:
            factors = " x ".join(f"{len(axis):,} {' and '.join(axis[0])}" for axis in self.axes)
            raise Fault(f"has {count:,} cases ({factors}); a plan has at most {MOST_CASES:,}: vary less, or divide it")

    def _read_results(self, table):
        if table.get("keep", "results") not in ("results", "everything"):
            raise Fault('keep must be "results" or "everything"')
        self.everything = table.get("keep") == "everything"
        self.results = table.get("results", USUAL[self.command].split())
        if not isinstance(self.results, list) or not self.results:
            raise Fault("results must be a list of paths such as contacts.count, with at least one")
        for path in self.results:
            if fault := path_fault(self.command, path) or (f"{path} is there twice" if self.results.count(path) > 1 else ""):
                raise Fault(f"results: {fault}")

    def _option(self, key):
        option, known = str(key).replace("-", "_"), options_of(self.command)
        if option not in known:
            raise Fault(f"{key} is not an option that a case of {self.command} can have{near(option, known)}")
        return option

    def _setting(self, where, key, value):
        """{option: a flag, or the texts that it would have on a command line}."""
        option = self._option(key)
        kind, words = options_of(self.command)[option]
        if kind == "FLAG":
            if not isinstance(value, bool):
                raise Fault(f"{where} must be true or false")
            return {option: value}
        is_list = isinstance(value, (list, tuple))
        if is_list and (not value or kind not in (*SEVERAL, "LIST")):
            raise Fault(f"{where} " + (f"must be one value, not {value!r}" if value else "has an empty list"))
        several = is_list and kind in SEVERAL and not all(hasattr(part, "__float__") for part in value)
        texts = tuple(text_of(where, one) for one in (value if several else [value]))
        for text in texts:
            if option in ("solver", "method"):
                words = (*words, *self.functions)
            if words and text not in words:
                raise Fault(f"{where}: {text} is not one of its words{near(text, words)}")
            number = quantity(text, kind) if kind in UNITS else 0
            if number is None or (kind == "N" and number != int(number)):
                raise Fault(f"{where}: {text} is no {'whole ' * (kind == 'N')}number, alone or with a unit of {', '.join(filter(None, UNITS[kind]))}"
                            .removesuffix(", alone or with a unit of "))
            self._input(where, option, kind, text)
        return {option: texts}

    def _input(self, where, option, kind, text):
        """Remembers the file that a value names."""
        name = text if kind in ("FILE", "FILES") or (kind == "NAME|FILE" and (text.endswith(".toml") or "/" in text)) else ""
        if option == "spread":
            name = next((part[9:] for part in text.split(",") if part.startswith("position=") and not re.fullmatch(NUMBER, part[9:])), "")
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
        except OSError as error:
            raise Fault(f"{where}: {path}: {error.strerror}") from None
        except _engine.Error as error:
            raise Fault(f"{where}: {error}") from None

    def _axis(self, where, key, value):
        """The choices of a key of [vary]; each sets one option, or some that belong together."""
        if isinstance(value, dict):
            value = self._steps(where, value)
        if not isinstance(value, (list, tuple)) or not value:
            raise Fault(f"{where} must be a list of values, or have from, to and count")
        choices = []
        for one in value:
            choice = {}
            for name, part in one.items() if all(isinstance(other, dict) for other in value) else [(key, one)]:
                choice |= self._setting(where, name, part)
            if choice in choices or not choice:
                raise Fault(f"{where} has " + (f"a value twice: {', '.join(map(shown, choice.values()))}" if choice else "an empty table"))
            choices.append(choice)
        return choices

    @staticmethod
    def _steps(where, table):
        if set(table) != {"from", "to", "count"}:
            raise Fault(f"{where} must have from, to and count, not {', '.join(table) or 'nothing'}")
        first, last = (re.fullmatch(NUMBER, text_of(where, table[end])) for end in ("from", "to"))
        if not first or not last or first[3] != last[3]:
            raise Fault(f'{where}: from and to must be numbers with the same unit, such as "1mm" and "3mm"')
        count, unit = table["count"], first[3]
        if not isinstance(count, int) or not 2 <= count <= MOST_CASES:
            raise Fault(f"{where}: count must be a whole number from 2 to {MOST_CASES:,}")
        first, last = (float(end[0].removesuffix(unit)) for end in (first, last))
        # Twelve digits, so that they read as people write them.
        return [text_of(where, float(f"{first + (last - first) * i / (count - 1):.12g}")) + unit for i in range(count)]

    def cases(self):
        """The settings of each case; the last key of [vary] varies fastest."""
        def number(option, value):
            kind = options_of(self.command)[option][0]
            found = quantity(value[0], kind if kind in UNITS else "N") if not isinstance(value, bool) and len(value) == 1 else None
            return int(found) if kind == "N" and found is not None else found if found is not None else value if value in (True, False) else shown(value)
        try:
            for chosen in itertools.product(*self.axes):
                settings = functools.reduce(dict.__or__, chosen, self.fixed)
                if self.derived or self.where:
                    values = {option: number(option, value) for option, value in settings.items()}
                    for option, evaluate in self.derived.items():
                        made = evaluate(values)
                        settings = settings | self._setting(f"[derive] {option}", option, float(f"{made:.12g}") if isinstance(made, float) else made)
                        values[option] = number(option, settings[option])
                    if not all(evaluate(values) for evaluate in self.where):
                        continue
                yield settings
        except Fault as fault:
            raise self.error(fault) from None

    def id(self, settings, backend):
        """The digest of what a case computes, and with what."""
        canonical = {option: value if isinstance(value, bool) else [self.inputs.get((option, text), (text, text))[1] for text in value]
                     for option, value in settings.items() if value}
        own = {option: self.functions.get(shown(settings[option]), ("", ""))[1] for option in ("solver", "method") if option in settings}
        kept = "everything" if self.everything else self.results
        text = json.dumps(["a case of palpa.sweep", software(), backend, self.command, kept, canonical, own], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    def ready(self, settings):
        """The settings for functions of the module: files with whole paths, and no lists of single values."""
        made = {option: value if isinstance(value, bool) else [self.inputs.get((option, text), (text, text))[0] for text in value]
                for option, value in settings.items() if value}
        return {option: value[0] if isinstance(value, list) and options_of(self.command)[option][0] not in SEVERAL else value
                for option, value in made.items()}


def software():
    """Which palpa computes."""
    return f"{_engine.__version__} {_engine._commit}".strip()
