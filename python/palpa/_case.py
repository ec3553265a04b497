"""One case of a sweep: from the settings of a plan to a call of the module, and its result."""
import collections
import functools
import json
import platform
import time

from . import _engine  # type: ignore[attr-defined]  # it has no stub of its own
from ._plan import error, find, quantity

Task = collections.namedtuple("Task", "command functions results outside common")
# Options that several functions take.
SOUND = ("temperature", "sound_speed", "frequency")
AIR = (*SOUND, "humidity", "air_pressure", "no_absorption")


@functools.lru_cache(maxsize=4)
def kept(make, file, options=()):
    """A model, a skin or an array, which the next cases often use again."""
    return make(file, **dict(options))


@functools.lru_cache(maxsize=1)
def kept_finger(file, options):
    """The largest object, of which many may not fit into the memory."""
    return _engine.FingerBody(file, **dict(options))


def taken(options, *names):
    """Removes these options. Returns those that were there, as pairs of name and value."""
    return tuple((name, options.pop(name)) for name in names if name in options)


def copied(options, *names):
    return taken(dict(options), *names)


def lengths(text):
    values = [quantity(part, "LENGTH") for part in text.split(",")]
    if None in values:
        raise error(f"'{text}' is not lengths such as 0,0,10cm")
    return values


def points_of(option, texts, fourth, usual):
    """The points of texts "X,Y,Z" or with a fourth number, and these numbers."""
    points = [lengths(text) for text in texts]
    if any(len(point) not in (3, 4) for point in points):
        raise error(f"{option} must be X,Y,Z or X,Y,Z,{fourth}")
    return [point[:3] for point in points], [(point + [usual])[3] for point in points]


def solve(layout, focus, **options):
    return layout.solve(*points_of("focus", focus, "A", 1), **options)


def nulls_of(o):
    places, radii = points_of("null", o.pop("null", ()), "R", 0)
    return {"nulls": places, "null_radius": radii} if places else {}


def places(o):
    if "plane" in o:
        lists = {"size": None} | {name: lengths(text) for name, text in taken(o, "centre", "size", "pixels")}
        if "pixels" in lists:
            lists["pixels"] = [int(number) for number in lists["pixels"]]
        return _engine.plane(o.pop("plane"), **lists)
    if "line" in o:
        samples = {name: int(text) for name, text in taken(o, "samples")}
        return _engine.line(*map(lengths, o.pop("line")), **samples)
    return kept(_engine.read_ply, o.pop("points"))


def scene_of(o, outside):
    return kept(_engine.Scene, o.pop("scene"), outside + taken(o, "gltf_scene", "surface", "parts", "internal_faces"))


def touched(o, outside, common):
    scene = scene_of(o, outside)
    return scene.touch(kept(_engine.read_ply, o.pop("points")) if "points" in o else None, **o, **common)


def simulated(o, outside, common):
    scene = scene_of(o, outside)
    finger = kept_finger(o.pop("finger"), copied(o, *AIR) + taken(o, "force"))
    return _engine.simulate(scene, finger, **o, **common)


def driven(o, _, common):
    layout = kept(_engine.Layout, o.pop("layout"))
    if "touch" in o:
        return layout.solve_touch(o.pop("touch"), slot=int(o.pop("slot", 0)), **nulls_of(o), **o, **common)
    finger = kept(_engine.Mesh, o.pop("mesh")) if "mesh" in o else None
    return solve(layout, o.pop("focus"), finger=finger, **nulls_of(o), **o, **common)


def field_of(o, _, common):
    layout = kept(_engine.Layout, o.pop("layout"))
    where = places(o)
    if "drive" in o:
        return layout.field(layout.read_drive(o.pop("drive")), where, **o, **common)
    how = dict(taken(o, "amplitude", "solver", "constraint", "pressure") + copied(o, *SOUND, "directivity"))
    solved = solve(layout, o.pop("focus"), backend="cpu", **nulls_of(o), **how)
    return layout.field(solved, where, **o, **common)


# What each command calls, with the options, those of files outside a model's folder, and those of what computes. The
# module's functions refuse options that are left over.
CALLS = {"touch": touched, "simulate": simulated, "drive": driven, "field": field_of}


def text_of_fault(fault):
    return str(fault) if isinstance(fault, _engine.Error) else f"{type(fault).__name__}: {fault}"


def compute(task, settings):
    """The line of one case, without its id. A missing device is raised, because no further case could be computed."""
    begin = time.perf_counter()
    options = dict(settings)
    for name in ("solver", "method"):
        if name in options:
            options[name] = task.functions.get(options[name], options[name])
    try:
        result = json.loads(CALLS[task.command](options, task.outside, task.common).json())
        for name in ("timing_ms", "backend", "backend_why"):
            result.pop(name, None)
        if task.results:
            line = {"state": "done", "results": {path: find(result, path) for path in task.results}}
        else:
            line = {"state": "done", "json": result}
    except _engine.NoDevice:
        raise
    except (_engine.BadUsage, _engine.BadInput) as fault:
        line = {"state": "refused", "error": str(fault)}
    except Exception as fault:  # such as too little memory, or one of an own function
        line = {"state": "failed", "error": text_of_fault(fault)}
    return line | {"took_s": round(time.perf_counter() - begin, 6), "host": platform.node()}
