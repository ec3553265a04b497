"""Sweeps: many cases of a plan, computed here, in processes, with Dask or in shards, and their table (docs/sweeps.md).

`python3 -m palpa.sweeps PLAN` is the same as a command.
"""
import argparse
import collections
import contextlib
import csv
import fcntl
import functools
import io
import json
import multiprocessing.connection
import os
import pathlib
import pickle
import platform
import re
import sys
import time

from . import _engine  # type: ignore[attr-defined]  # it has no stub of its own
from ._plan import NUMBER, Plan, find, quantity, shown, software

Task = collections.namedtuple("Task", "command functions results outside common")
GOODNESS = {"done": 2, "refused": 1, "failed": 0}
# Where schedulers say which process this is, and how many there are.
RANKS = (("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), ("PMI_RANK", "PMI_SIZE"), ("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"))


def error(text, kind=_engine.BadUsage):
    """An error of palpa with its exit code."""
    made = kind(text)
    made.exit_code = {_engine.BadUsage: 2, _engine.NoDevice: 3}.get(kind, 1)
    return made


# ---- one case -------------------------------------------------------------------------------------------------------

@functools.lru_cache(maxsize=4)
def kept(make, file, options=()):
    """A model, a skin or an array, which the next cases often use again."""
    return make(file, **dict(options))


@functools.lru_cache(maxsize=1)
def kept_finger(file, options):
    """The largest object, of which many may not fit into the memory."""
    return _engine.FingerBody(file, **dict(options))


def taken(options, *names):
    return tuple((name, options.pop(name)) for name in names if name in options)


def lengths(text):
    values = [quantity(part, "LENGTH") for part in text.split(",")]
    if None in values:
        raise error(f"'{text}' is not lengths such as 0,0,10cm")
    return values


def solve(layout, focus, **more):
    points = [lengths(text) for text in focus]
    if any(len(point) not in (3, 4) for point in points):
        raise error("focus must be X,Y,Z or X,Y,Z,A")
    return layout.solve([point[:3] for point in points], [(point + [1])[3] for point in points], **more)


def places(options):
    if "plane" in options:
        made = {name: lengths(text) for name, text in taken(options, "centre", "size", "pixels")}
        if "pixels" in made:
            made["pixels"] = [int(number) for number in made["pixels"]]
        return _engine.plane(options.pop("plane"), **{"size": None} | made)
    if "line" in options:
        return _engine.line(*map(lengths, options.pop("line")), **{name: int(text) for name, text in taken(options, "samples")})
    return kept(_engine.read_ply, options.pop("points"))


def result_of(command, o, outside, common):
    """What the command's function returns. Options that are left over are refused by that function."""
    layout = kept(_engine.Layout, o.pop("layout")) if command in ("drive", "field") else None
    if command in ("touch", "simulate"):
        scene = kept(_engine.Scene, o.pop("scene"), outside + taken(o, "gltf_scene", "surface", "parts", "internal_faces"))
    if command == "touch":
        return scene.touch(kept(_engine.read_ply, o.pop("points")) if "points" in o else None, **o, **common)
    if command == "simulate":
        air = [(name, o[name]) for name in ("temperature", "sound_speed", "frequency", "humidity", "air_pressure", "no_absorption") if name in o]
        return _engine.simulate(scene, kept_finger(o.pop("finger"), (*air, *taken(o, "force"))), **o, **common)
    if command == "drive":
        if "touch" in o:
            return layout.solve_touch(o.pop("touch"), slot=int(o.pop("slot", 0)), **o, **common)
        finger = kept(_engine.Mesh, o.pop("mesh")) if "mesh" in o else None
        return solve(layout, o.pop("focus"), finger=finger, **o, **common)
    where = places(o)
    if "drive" in o:
        return layout.field(layout.read_drive(o.pop("drive")), where, **o, **common)
    air = {name: o[name] for name in ("temperature", "sound_speed", "frequency", "directivity") if name in o}
    solved = dict(taken(o, "amplitude", "solver", "constraint", "pressure"))
    return layout.field(solve(layout, o.pop("focus"), backend="cpu", **air, **solved), where, **o, **common)


def compute(task, settings):
    """The line of one case, without its id. A missing device is raised, because no further case could be computed."""
    begin = time.perf_counter()
    options = {name: task.functions.get(value, value) if name in ("solver", "method") else value for name, value in settings.items()}
    try:
        result = json.loads(result_of(task.command, options, task.outside, task.common).json())
        for name in ("timing_ms", "backend", "backend_why"):
            result.pop(name, None)
        line = {"state": "done"} | ({"results": {path: find(result, path) for path in task.results}} if task.results else {"json": result})
    except _engine.NoDevice:
        raise
    except (_engine.BadUsage, _engine.BadInput) as fault:
        line = {"state": "refused", "error": str(fault)}
    except Exception as fault:  # such as too little memory, or one of an own function
        line = {"state": "failed", "error": str(fault) if isinstance(fault, _engine.Error) else f"{type(fault).__name__}: {fault}"}
    return line | {"took_s": round(time.perf_counter() - begin, 6), "host": platform.node()}


# ---- many cases -----------------------------------------------------------------------------------------------------

def work(connection, task):
    """A process of the pool: gets settings and returns lines, until the other end is closed."""
    import signal
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    with contextlib.suppress(EOFError, OSError):
        connection.send("ready")
        while True:
            settings = connection.recv()
            try:
                connection.send(compute(task, settings))
            except _engine.NoDevice as fault:
                connection.send(str(fault))


def in_processes(task, todo, workers, gpus):
    """Yields the id and line of each case. Each process has a device of its own, the next of `gpus`."""
    context, waiting, busy, tried = multiprocessing.get_context("spawn"), collections.deque(todo), {}, set()

    def start(number):
        here, there = context.Pipe()
        own = task._replace(common=task.common | ({"gpu": gpus[number % len(gpus)]} if gpus else {}))
        process = context.Process(target=work, args=(there, own), daemon=True)
        process.start()
        there.close()
        busy[here] = process, number, None

    try:
        for number in range(min(workers, len(todo))):
            start(number)
        while busy:
            connection = multiprocessing.connection.wait(list(busy))[0]
            process, number, case = busy[connection]
            try:
                line = connection.recv()
                if case is None:
                    line = None
                elif isinstance(line, str):
                    raise error(line, _engine.NoDevice)
            except (EOFError, OSError):  # killed
                del busy[connection]
                process.join()
                if case is None:
                    raise error("a process cannot start: call palpa.sweep with workers under if __name__ == \"__main__\":") from None
                line = {"state": "failed", "error": f"its process ended twice, the exit code is {process.exitcode}"} if case in tried else None
                if line is None:
                    waiting.appendleft(case)
                    tried.add(case)
                if waiting:
                    start(number)
                connection = None
            if line is not None:
                yield case, line
            if connection and waiting:
                busy[connection] = process, number, waiting.popleft()
                with contextlib.suppress(OSError):  # it was killed just now, as recv will tell
                    connection.send(todo[busy[connection][2]])
            elif connection:
                del busy[connection]
                connection.close()
    finally:
        for process, *_ in busy.values():
            process.terminate()


def with_dask(task, todo, client):
    """As in_processes. Dask itself retries the cases of a killed worker."""
    import distributed
    futures = {client.submit(compute, task, settings, pure=False): case for case, settings in todo.items()}
    try:
        for future in distributed.as_completed(futures):
            try:
                yield futures[future], future.result()
            except _engine.NoDevice:
                raise
            except Exception as fault:  # such as KilledWorker
                yield futures[future], {"state": "failed", "error": f"{type(fault).__name__}: {fault}"}
    finally:
        client.cancel(list(futures))


def used_backend(common):
    """"gpu" or "cpu"."""
    if common.get("backend") in ("gpu", "cpu") and "gpu" not in common:
        return common["backend"]
    scene = _engine.Scene(([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    return json.loads(scene.touch([[2.0, 2.0, 2.0]], **common).json())["backend"]


def shard_of(text, variables=os.environ):
    """(i, n) of a shard: "env" takes them from Slurm or mpirun."""
    def whole(name):
        if not re.fullmatch(r"\d{1,9}", variables.get(name, "")):
            raise error(f"shard env: {name} is {repr(variables[name]) if name in variables else 'not set'}, and no whole number")
        return int(variables[name])
    if text is None:
        return 0, 1
    if text == "env" and "SLURM_ARRAY_TASK_ID" in variables:
        first, last, count = map(whole, ("SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX", "SLURM_ARRAY_TASK_COUNT"))
        if last - first + 1 != count:
            raise error(f"shard env: the job array {first} to {last} has {count} tasks; give it the step 1 and no gaps, as --array=0-{count - 1}")
        for _, size in RANKS:
            if size in variables and whole(size) > 1:
                raise error(f"shard env: a task of a job array that starts {whole(size)} processes would compute each case so often; start one")
        index = whole("SLURM_ARRAY_TASK_ID") - first
    elif text == "env":
        rank, size = next((names for names in RANKS if names[0] in variables), (None, None))
        if rank is None:
            raise error("shard env: none of SLURM_ARRAY_TASK_ID, OMPI_COMM_WORLD_RANK, PMI_RANK and SLURM_PROCID is set; without a scheduler, "
                        "give the shard yourself, such as 0/8")
        if rank == "SLURM_PROCID" and size not in variables and whole("SLURM_NTASKS" if "SLURM_NTASKS" in variables else rank) > 1:
            raise error("shard env: the job has several tasks, but this process was not started by srun: use srun python3 -m palpa.sweeps")
        index, count = (whole(rank), whole(size)) if size in variables else (0, 1)
    else:
        match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text if isinstance(text, str) else "/".join(map(str, text)))
        index, count = map(int, match.groups()) if match else (1, 0)
    if index < 0 or index >= count:
        raise error(f"shard: {text!r} is not a shard i/n with i from 0 to n - 1, such as 0/8 to 7/8, and not env")
    return index, count


# ---- the folder of results ------------------------------------------------------------------------------------------

def stored(out):
    """The best line of each id in the folder. A line that a killed process did not complete is left out."""
    found = {}
    for file in sorted(pathlib.Path(out).glob("*.jsonl")) if out is not None else []:
        for text in file.read_bytes().split(b"\n")[:-1]:
            with contextlib.suppress(ValueError, KeyError, TypeError):
                line = json.loads(text)
                if GOODNESS[line["state"]] > GOODNESS.get(found.get(line["id"], {}).get("state"), -1):
                    found[line["id"]] = line
    return found


@contextlib.contextmanager
def appended(out, index, count):
    """A function that appends a line to the file of this shard."""
    if out is None:
        yield lambda line: None
        return
    name = pathlib.Path(out) / f"shard-{index}-of-{count}.jsonl"
    try:
        name.parent.mkdir(parents=True, exist_ok=True)
        with open(name, "a+b") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise error(f"{name}: another process computes this shard; wait until it has ended") from None
            file.seek(max(file.seek(0, os.SEEK_END) - 1, 0))
            if file.read(1) not in (b"", b"\n"):
                file.write(b"\n")  # behind the line of a killed process

            def append(line):
                file.write(json.dumps(line).encode() + b"\n")
                file.flush()
            yield append
    except OSError as fault:
        raise error(f"{fault.filename or name}: cannot be written: {fault.strerror}", _engine.Error) from None


def rows_of(plan, cases, ids, lines):
    rows = []
    for settings, case in zip(cases, ids):
        if line := lines.get(case):
            texts = [shown(settings[option]) if option in settings else "" for option in plan.varied]
            values = [text if not (match := re.fullmatch(NUMBER, text)) or match[3] else float(text) if re.search("[.eE]", text) else int(text)
                      for text in texts]
            found = [find(line["json"], path) if "json" in line else line.get("results", {}).get(path) for path in plan.results]
            rows.append({"id": case} | dict(zip(plan.varied, values)) | dict(zip(plan.results, found))
                        | {"state": line["state"], "error": line.get("error")})
    return rows


def csv_of(plan, rows):
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["id", *plan.varied, *plan.results, "state", "error"])
    table.writerows([str(cell).lower() if isinstance(cell, bool) else cell for cell in row.values()] for row in rows)
    return text.getvalue()


# ---- what is called -------------------------------------------------------------------------------------------------

def sweep(plan, out=None, *, shard=None, workers=1, client=None, backend=None, gpu=None, validation=None, allow_outside=False, after=None):
    """Compute the cases of a plan, or a shard of them (docs/sweeps.md).

    Cases that have a result in the folder are not computed again. A case that palpa refuses, or that fails, does not stop
    the others. Ctrl-C loses only what is being computed.

    Parameters
    ----------
    plan : path or dict
        TOML file of the command, its options, and which of them vary; or the same as a dict, in which `functions` names own
        solvers and methods.
    out : path, optional
        Folder of the results, for gather() and for other processes. Without it, results are only returned.
    shard : (int, int) or str, optional
        (i, n) or "i/n" computes shard i of n, counted from 0; "env" takes both from Slurm or mpirun.
    workers : int, optional
        Number of processes. The default is 1, which is this process.
    client : distributed.Client, optional
        Computes the cases with Dask instead.
    backend, gpu, validation : str, optional
        As the options of the command line. A list of GPUs is dealt to the processes in turn.
    allow_outside : bool, optional
        Also take files outside a model's folder that the model names.
    after : callable, optional
        Is called after each case, with the number of computed cases and of all that are computed.

    Returns
    -------
    list of dict
        One for each case that has a result, in the plan's order: `id`, the options that vary, the results that the plan
        names, `state` ("done", "refused" or "failed"), and `error`. pandas.DataFrame(rows) is a table.

    Raises
    ------
    BadInput
        The plan or one of its files is missing or broken.
    BadUsage
        Arguments do not go together, or another process computes this shard.
    NoDevice
        There is no usable GPU, but one was asked for.
    """
    plan = Plan(plan)
    gpus = list(gpu) if isinstance(gpu, (list, tuple)) else [] if gpu is None else [gpu]
    common = {name: value for name, value in (("backend", backend), ("gpu", (gpus or [None])[0]), ("validation", validation)) if value is not None}
    index, count = shard_of(shard)
    if not isinstance(workers, int) or workers < 1 or (client is not None and workers > 1):
        raise error("workers must be a whole number from 1, and is left out with client")
    cases = list(plan.cases())
    if not cases:
        raise plan.error("where leaves no case")
    cases = cases[len(cases) * index // count:len(cases) * (index + 1) // count]
    used = used_backend(common)
    ids = [plan.id(settings, used) for settings in cases]
    lines = stored(out)
    settings_of = {case: settings for case, settings in zip(ids, cases) if lines.get(case, {"state": "failed"})["state"] == "failed"}
    todo = {case: plan.ready(settings) for case, settings in settings_of.items()}
    functions = {name: function for name, (function, _) in plan.functions.items()}
    task = Task(plan.command, functions, () if plan.everything else tuple(plan.results), (("allow_outside", True),) * bool(allow_outside), common)
    if workers > 1:
        try:
            pickle.dumps(functions)
        except Exception as fault:
            raise error(f"functions: cannot be sent to other processes: {fault}; define them in a module") from None
    outcomes = (with_dask(task, todo, client) if client is not None else in_processes(task, todo, workers, gpus) if workers > 1 else
                ((case, compute(task, settings)) for case, settings in todo.items()))
    with appended(out if todo else None, index, count) as append, contextlib.closing(outcomes):
        for done, (case, line) in enumerate(outcomes, 1):
            settings = {option: shown(value) for option, value in settings_of[case].items()}
            lines[case] = {"id": case, "state": line.pop("state"), "case": settings, "backend": used, "palpa": software()} | line
            append(lines[case])
            if after:
                after(done, len(todo))
    return rows_of(plan, cases, ids, lines)


def gather(plan, out, file=None, *, partial=False, backend=None):
    """Read all results of a plan, and write them as a CSV table. It has the same bytes, however the cases were divided.

    Parameters
    ----------
    plan : path or dict
    out : path
        The folder of the results.
    file : path, optional
        The CSV file.
    partial : bool, optional
        Also if cases have no result yet.
    backend : str, optional
        "gpu" or "cpu", if the folder has results of both.

    Returns
    -------
    list of dict
        As sweep() returns them.

    Raises
    ------
    BadUsage
        The table would replace an input of the plan, or the folder has results of both backends.
    Error
        Cases have no result yet, or the table cannot be written.
    """
    plan = Plan(plan)
    cases, lines = list(plan.cases()), stored(out)
    ids = {used: [plan.id(settings, used) for settings in cases] for used in ("cpu", "gpu") if backend in (None, used)}
    ids = {used: of_backend for used, of_backend in ids.items() if not lines.keys().isdisjoint(of_backend)}
    if len(ids) > 1:
        raise error(f"{out}: has results of cpu and of gpu: say which backend")
    if not ids:
        raise error(f"{out}: has no result of this plan by palpa {software()}; compute it first", _engine.Error)
    rows = rows_of(plan, cases, *ids.values(), lines)
    if len(rows) < len(cases) and not partial:
        raise error(f"{out}: {len(cases) - len(rows)} of {len(cases)} cases have no result yet; run the sweep again, or ask for a partial table",
                    _engine.Error)
    if file is not None:
        table = pathlib.Path(file)
        if any(table.exists() and table.samefile(other) for other in plan.files):
            raise error(f"{file}: is an input of the plan; give another name")
        beside = table.with_name(f".{table.name}.{os.getpid()}")
        try:
            beside.write_text(csv_of(plan, rows), encoding="utf-8")
            beside.replace(table)
        except OSError as fault:
            raise error(f"{file}: cannot be written: {fault.strerror}", _engine.Error) from None
    return rows


class Parser(argparse.ArgumentParser):
    """Faults in one line."""

    def error(self, message):
        raise error(message)


def main(arguments=None):
    """The command `python3 -m palpa.sweeps`; returns its exit code."""
    parser = Parser("python3 -m palpa.sweeps", description="Computes the cases of a plan (docs/sweeps.md). The same command continues.")
    parser.add_argument("plan", metavar="PLAN", help="TOML file of the command, its options, and which of them vary")
    parser.add_argument("--out", metavar="DIR", help="folder of the results; cases that have one there are not computed again")
    parser.add_argument("--shard", metavar="I/N|env", help="computes shard I of N, counted from 0; env takes both from Slurm or mpirun")
    parser.add_argument("--workers", metavar="N", type=int, default=1, help="number of processes [1]")
    parser.add_argument("--dask", metavar="ADDRESS", help="computes with the workers of this Dask scheduler")
    parser.add_argument("--backend", choices=("auto", "gpu", "cpu"), help="what computes")
    parser.add_argument("--gpu", metavar="NAME|INDEX", nargs="+", help="the GPU; several are dealt to the processes in turn")
    parser.add_argument("--allow-outside", action="store_true", help="also takes files outside a model's folder that the model names")
    parser.add_argument("--list", action="store_true", help="instead of computing: prints the cases as CSV")
    parser.add_argument("--gather", metavar="FILE", help="instead of computing: writes all results as one CSV table")
    parser.add_argument("--partial", action="store_true", help="with --gather: also if cases have no result yet")
    parser.add_argument("--quiet", action="store_true", help="prints no progress and no summary")
    try:
        return run(parser.parse_args(arguments))
    except _engine.Error as fault:
        print(f"palpa.sweeps: {fault}", file=sys.stderr)
        return getattr(fault, "exit_code", 1)
    except KeyboardInterrupt:
        print("palpa.sweeps: interrupted; the same command continues", file=sys.stderr)
        return 130


def run(o):
    if o.list:
        plan = Plan(o.plan)
        print(",".join(plan.varied))
        for settings in plan.cases():
            csv.writer(sys.stdout, lineterminator="\n").writerow([shown(settings[option]) if option in settings else "" for option in plan.varied])
        return 0
    if not o.out:
        raise error("--out is missing: give a folder for the results")
    if o.gather:
        rows = gather(o.plan, o.out, o.gather, partial=o.partial, backend=None if o.backend == "auto" else o.backend)
    else:
        def progress(done, of):
            if sys.stderr.isatty() and not o.quiet:
                print(f"\r{done} of {of} cases", end="\n" if done == of else "", file=sys.stderr, flush=True)
        with contextlib.ExitStack() as stack:
            client = None
            if o.dask:
                import distributed
                client = stack.enter_context(distributed.Client(o.dask))
            rows = sweep(o.plan, o.out, shard=o.shard, workers=o.workers, client=client, backend=o.backend, gpu=o.gpu,
                         allow_outside=o.allow_outside, after=progress)
    states = collections.Counter(row["state"] for row in rows)
    if not o.quiet:
        print(f"{len(rows)} cases: " + ", ".join(f"{count} {state}" for state, count in sorted(states.items())))
    worst = "failed" if states["failed"] else "refused"
    if first := next((row["error"] for row in rows if row["state"] == worst), None):
        print(f"palpa.sweeps: {states[worst]} of {len(rows)} cases {worst}; the first: {first}", file=sys.stderr)
    return 0 if o.gather or not rows or states["done"] and not states["failed"] else 1


if __name__ == "__main__":
    from palpa import sweeps  # processes must find its functions in the module of this name
    sys.exit(sweeps.main())
