"""Sweeps: many cases of a plan, and their table; as a command, `python3 -m palpa.sweeps PLAN` (docs/sweeps.md)."""
import argparse
import collections
import contextlib
import csv
import fcntl
import io
import json
import multiprocessing.connection
import multiprocessing.resource_tracker
import os
import pathlib
import pickle
import re
import signal
import sys

from . import _engine  # type: ignore[attr-defined]  # it has no stub of its own
from ._case import Task, compute, text_of_fault
from ._plan import NUMBER, Plan, brief, error, find, path_of, shown, software

GOODNESS = {"done": 2, "refused": 1, "failed": 0}
# Where schedulers say which process this is, and how many there are.
RANKS = {"OMPI_COMM_WORLD_RANK": "OMPI_COMM_WORLD_SIZE", "PMI_RANK": "PMI_SIZE",
         "SLURM_PROCID": "SLURM_STEP_NUM_TASKS"}



# ---- many cases -----------------------------------------------------------------------------------------------------

@contextlib.contextmanager
def without_ctrl_c():
    """Ctrl-C comes only after this block. A process that starts in it does not get Ctrl-C at all before work()."""
    multiprocessing.resource_tracker.ensure_running()  # its first start would let Ctrl-C in
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def work(connection, task):
    """A process of the pool: gets settings and returns lines, until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    with contextlib.suppress(EOFError, OSError):
        connection.send(None)  # it has started
        while True:
            settings = connection.recv()
            try:
                connection.send(compute(task, settings))
            except _engine.NoDevice as fault:
                connection.send(str(fault))


def in_processes(task, todo, workers, gpus):
    """Yields the id and line of each case. Each process has a device of its own, the next of `gpus`."""
    context, waiting, tried, busy = multiprocessing.get_context("spawn"), collections.deque(todo), set(), {}

    def start(number):
        here, there = context.Pipe()
        own = task._replace(common=task.common | ({"gpu": gpus[number % len(gpus)]} if gpus else {}))
        process = context.Process(target=work, args=(there, own), daemon=True)
        with without_ctrl_c():
            process.start()
            busy[here] = process, number, None
        there.close()

    try:
        for number in range(min(workers, len(todo))):
            start(number)
        while busy:
            connection = multiprocessing.connection.wait(list(busy))[0]
            process, number, case = busy[connection]
            try:
                line, alive = connection.recv(), True
                if isinstance(line, str):
                    raise error(line, _engine.NoDevice)
            except (EOFError, OSError):  # killed; the case gets a second try
                process.join()
                if case is None:
                    raise error("a process cannot start: call palpa.sweep with workers under "
                                'if __name__ == "__main__":') from None
                line, alive = None, False
                if case in tried:
                    fault = f"its process ended twice, at last with exit code {process.exitcode}"
                    line = {"state": "failed", "error": fault}
                else:
                    tried.add(case)
                    waiting.appendleft(case)
            if line is not None:
                yield case, line
            del busy[connection]
            if waiting and alive:
                busy[connection] = process, number, waiting.popleft()
                with contextlib.suppress(OSError):  # it was killed just now, as recv will tell
                    connection.send(todo[busy[connection][2]])
                continue
            connection.close()
            if waiting:
                start(number)
    finally:
        for process, *_ in busy.values():
            process.terminate()


def with_dask(task, todo, client):
    """As in_processes. Dask itself tries the cases of a killed worker again."""
    import distributed  # type: ignore[import]
    futures = {client.submit(compute, task, settings, pure=False): case for case, settings in todo.items()}
    try:
        for future in distributed.as_completed(futures):
            try:
                yield futures[future], future.result()
            except _engine.NoDevice:
                raise
            except Exception as fault:  # such as KilledWorker
                yield futures[future], {"state": "failed", "error": text_of_fault(fault)}
    finally:
        client.cancel(list(futures))


def used_backend(common):
    """"gpu" or "cpu"."""
    if common.get("backend") in ("gpu", "cpu") and "gpu" not in common:
        return common["backend"]
    corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    scene = _engine.Scene((corners, faces))
    return json.loads(scene.touch([[2.0, 2.0, 2.0]], **common).json())["backend"]


def whole_number(variables, name):
    if not re.fullmatch(r"\d{1,9}", variables.get(name, "")):
        found = repr(variables[name]) if name in variables else "not set"
        raise error(f"shard env: {name} is {found}, but must be a whole number")
    return int(variables[name])


def shard_of_job_array(variables):
    """The shard of a task of Slurm."""
    names = ("SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX", "SLURM_ARRAY_TASK_COUNT")
    first, last, count = (whole_number(variables, name) for name in names)
    if last - first + 1 != count:
        raise error(f"shard env: the job array {first} to {last} has {count} tasks; "
                    f"give it the step 1 and no gaps, as --array=0-{count - 1}")
    if any(name in variables and whole_number(variables, name) > 1 for name in RANKS.values()):
        raise error("shard env: a task of a job array that starts several processes would compute each case several "
                    "times; start one")
    return whole_number(variables, "SLURM_ARRAY_TASK_ID") - first, count


def shard_of_rank(variables, rank):
    """The shard of a process that mpirun or srun started."""
    size = RANKS[rank]
    if size in variables or rank != "SLURM_PROCID":
        return whole_number(variables, rank), whole_number(variables, size)
    if variables.get("SLURM_NTASKS", "1") != "1":
        raise error("shard env: the job has several tasks, but this process was not started by srun: "
                    "use srun python3 -m palpa.sweeps")
    return 0, 1


def shard_of(shard, variables=os.environ):
    """(i, n) of a shard; "env" takes them from Slurm or mpirun."""
    if shard is None:
        return 0, 1
    if not isinstance(shard, str):
        shard = "/".join(map(brief, shard))
    if shard == "env":
        rank = next((name for name in RANKS if name in variables), None)
        if "SLURM_ARRAY_TASK_ID" in variables:
            index, count = shard_of_job_array(variables)
        elif rank:
            index, count = shard_of_rank(variables, rank)
        else:
            raise error(f"shard env: none of SLURM_ARRAY_TASK_ID, {', '.join(RANKS)} is set; "
                        "without a scheduler, give the shard yourself, such as 0/8")
    else:
        match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", shard)
        index, count = map(int, match.groups()) if match else (0, 0)
    if not 0 <= index < count:
        raise error(f"shard: {brief(shard)} is not a shard i/n with i from 0 to n - 1, such as 0/8 to 7/8, and not env")
    return index, count


def of_shard(cases, index, count):
    """The cases of a shard: some runs of neighbours, which often share a model or a finger. The order of the
    shards turns round after each turn, so that cases which cost more and more are shared out evenly."""
    size, mine = max(1, len(cases) // (8 * count)), []
    for at, case in enumerate(cases):
        turn, place = divmod(at // size, count)
        if index == (place if turn % 2 == 0 else count - 1 - place):
            mine.append(case)
    return mine


# ---- the folder of results ------------------------------------------------------------------------------------------

@contextlib.contextmanager
def told(name, what):
    """Faults of files in one line."""
    try:
        yield
    except OSError as fault:
        raise error(f"{name}: cannot be {what}: {fault.strerror}", _engine.Error) from None


def stored(out):
    """The best line of each id in the folder. A line that a killed process did not complete is left out."""
    found = {}
    with told(out, "read"), contextlib.suppress(FileNotFoundError):
        names = sorted(os.listdir(out)) if out is not None else []
        for name in names:
            lines = pathlib.Path(out, name).read_bytes().split(b"\n")[:-1] if name.endswith(".jsonl") else []
            for text in lines:
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
    with told(name, "written"):
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


def cell_of(text):
    """A number, unless the text has a unit or is none."""
    number = re.fullmatch(NUMBER, text)
    if not number or number[3]:
        return text
    return float(text) if re.search("[.eE]", text) else int(text)


def rows_of(plan, cases, ids, lines):
    """A dict for each case that has a line."""
    rows = []
    for settings, case in zip(cases, ids):
        if case not in lines:
            continue
        line = lines[case]
        row = {"id": line["id"]}
        for option in plan.varied:
            row[option] = cell_of(shown(settings.get(option, "")))
        for path in plan.results:
            row[path] = find(line["json"], path) if "json" in line else line.get("results", {}).get(path)
        rows.append(row | {"state": line["state"], "error": line.get("error")})
    return rows


# ---- what is called -------------------------------------------------------------------------------------------------

def sweep(plan, out=None, *, shard=None, workers=1, client=None, backend=None, gpu=None, allow_outside=False,
          after=None):
    """Compute the cases of a plan, or a shard of them (docs/sweeps.md).

    Cases that have a result in the folder are not computed again. A case that palpa refuses, or that fails, does not
    stop the others. Ctrl-C loses only what is being computed.

    Parameters
    ----------
    plan : path or dict
        A TOML file of the command, its options, and which of them vary; a Python file that makes the same as a dict
        `plan`; or such a dict.
    out : path, optional
        Folder of the results, for gather() and for other processes. Without it, results are only returned.
    shard : (int, int) or str, optional
        (i, n) or "i/n" computes shard i of n, counted from 0; "env" takes both from Slurm or mpirun.
    workers : int, optional
        Number of processes. The default is 1, which is this process.
    client : Any, optional
        A distributed.Client, which computes the cases with Dask instead.
    backend : {"auto", "gpu", "cpu"}, optional
        What computes.
    gpu : str, int, or list of these, optional
        Name or index of the GPU. Several are dealt to the processes in turn.
    allow_outside : bool, optional
        Also take files outside a model's folder that the model names.
    after : callable, optional
        Is called after each case, with the numbers of cases that were computed and that will be.

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
    index, count = shard_of(shard)
    out = None if out is None else path_of("out", out)
    gpus = list(gpu) if isinstance(gpu, (list, tuple)) else [] if gpu is None else [gpu]
    common = {} if backend is None else {"backend": backend}
    if gpus and gpus[0] is not None:
        common["gpu"] = gpus[0]
    if not isinstance(workers, int) or workers < 1 or not isinstance(allow_outside, bool):
        raise error("workers must be a whole number from 1, and allow_outside True or False")
    if client is not None and (workers > 1 or not hasattr(client, "submit")):
        raise error("client must be a distributed.Client; workers is left out with it")
    functions = {name: function for name, (function, _) in plan.functions.items()}
    try:
        pickle.dumps(functions if workers > 1 else None)
    except Exception as fault:
        raise error(f"functions: cannot be sent to other processes: {fault}; define them in a module") from None
    cases = of_shard(plan.cases(), index, count)
    used, lines = used_backend(common), stored(out)
    ids = [plan.id(settings, used) for settings in cases]
    open_cases = {case: settings for case, settings in zip(ids, cases)
                  if case not in lines or lines[case]["state"] == "failed"}
    todo = {case: plan.ready(settings) for case, settings in open_cases.items()}
    task = Task(plan.command, functions, results=() if plan.everything else tuple(plan.results),
                outside=(("allow_outside", True),) if allow_outside else (), common=common)
    if client is not None:
        outcomes = with_dask(task, todo, client)
    elif workers > 1:
        outcomes = in_processes(task, todo, workers, gpus)
    else:
        outcomes = ((case, compute(task, settings)) for case, settings in todo.items())
    with appended(out if todo else None, index, count) as append, contextlib.closing(outcomes):
        for done, (case, line) in enumerate(outcomes, 1):
            settings = {option: shown(value) for option, value in open_cases[case].items()}
            head = {"id": case, "state": line["state"], "case": settings, "backend": used, "palpa": software()}
            lines[case] = head | line
            append(lines[case])
            if after:
                after(done, len(todo))
    return rows_of(plan, cases, ids, lines)


def gather(plan, out, file=None, *, partial=False, backend=None):
    """Read all results of a plan, and write them as a CSV table.

    The table has the same bytes, however the cases were divided.

    Parameters
    ----------
    plan : path or dict
    out : path
        The folder of the results.
    file : path, optional
        The CSV file.
    partial : bool, optional
        Also if cases have no result yet.
    backend : {"gpu", "cpu"}, optional
        Which results, if the folder has those of both.

    Returns
    -------
    list of dict
        As sweep() returns them.

    Raises
    ------
    BadUsage
        The table would replace an input of the plan or the results, or the folder has results of both backends.
    Error
        Cases have no result yet, or the table cannot be written.
    """
    plan, out = Plan(plan), path_of("out", out)
    cases, lines = plan.cases(), stored(out)
    found = {}
    for used in ("cpu", "gpu"):
        ids = [plan.id(settings, used) for settings in cases] if backend in (None, used) else []
        if not lines.keys().isdisjoint(ids):
            found[used] = ids
    if len(found) > 1:
        raise error(f"{out}: has results of cpu and of gpu: say which backend")
    if not found:
        raise error(f"{out}: has no result of this plan by palpa {software()}; compute it first", _engine.Error)
    rows = rows_of(plan, cases, *found.values(), lines)
    if len(rows) < len(cases) and not partial:
        raise error(f"{out}: {len(cases) - len(rows)} of {len(cases)} cases have no result yet; "
                    "run the sweep again, or ask for a partial table", _engine.Error)
    if file is not None:
        write_table(pathlib.Path(path_of("file", file)), rows, plan, out)
    return rows


def write_table(table, rows, plan, out):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0])
    for row in rows:
        writer.writerow([str(cell).lower() if isinstance(cell, bool) else cell for cell in row.values()])
    inputs = {"an input of the plan": plan.files, "one of the results": pathlib.Path(out).glob("*.jsonl")}
    with told(table, "written"):
        for what, files in inputs.items():
            if table.exists() and any(table.samefile(other) for other in files):
                raise error(f"{table}: is {what}; give another name")
        beside = table.with_name(f".{table.name}.{os.getpid()}")
        beside.write_text(text.getvalue(), encoding="utf-8")
        beside.replace(table)


class Parser(argparse.ArgumentParser):
    """Tells faults in one line."""

    def error(self, message):
        raise error(message)


def parser_of_command():
    parser = Parser("python3 -m palpa.sweeps",
                    description="Computes the cases of a plan (docs/sweeps.md). The same command continues.")
    add = parser.add_argument
    add("plan", metavar="PLAN",
        help="TOML file of the command, its options, and which of them vary; or a Python file")
    add("--out", metavar="DIR", required=True,
        help="folder of the results; cases that have one there are not computed again")
    add("--shard", metavar="I/N|env",
        help="computes shard I of N, counted from 0; env takes both from Slurm or mpirun")
    add("--workers", metavar="N", type=int, default=1, help="number of processes [1]")
    add("--backend", choices=("auto", "gpu", "cpu"), help="what computes; with --gather, whose results")
    add("--gpu", metavar="NAME|INDEX", action="append",
        help="the GPU; several are dealt to the processes in turn")
    add("--allow-outside", action="store_true",
        help="also takes files outside a model's folder that the model names")
    add("--gather", metavar="FILE", help="instead of computing: writes all results as one CSV table")
    add("--partial", action="store_true", help="with --gather: also if cases have no result yet")
    add("--quiet", action="store_true", help="prints no progress and no summary")
    return parser


def progress(done, of):
    print(f"\r{done} of {of} cases", end="\n" if done == of else "", file=sys.stderr, flush=True)


def run(arguments):
    o = parser_of_command().parse_args(arguments)
    if o.gather:
        rows = gather(o.plan, o.out, o.gather, partial=o.partial, backend=None if o.backend == "auto" else o.backend)
    else:
        rows = sweep(o.plan, o.out, shard=o.shard, workers=o.workers, backend=o.backend, gpu=o.gpu,
                     allow_outside=o.allow_outside, after=progress if sys.stderr.isatty() and not o.quiet else None)
    states = collections.Counter(row["state"] for row in rows)
    if not o.quiet:
        print(f"{len(rows)} cases: " + ", ".join(f"{count} {state}" for state, count in sorted(states.items())))
    for state in ("failed", "refused"):
        if states[state] and not o.gather:
            first = next(row["error"] for row in rows if row["state"] == state)
            print(f"palpa.sweeps: {states[state]} of {len(rows)} cases {state}; the first: {first}", file=sys.stderr)
    return 0 if o.gather or not rows or (states["done"] and not states["failed"]) else 1


def main(arguments=None):
    """The command `python3 -m palpa.sweeps`; returns its exit code."""
    try:
        return run(arguments)
    except _engine.Error as fault:
        print(f"palpa.sweeps: {fault}", file=sys.stderr)
        return getattr(fault, "exit_code", 1)
    except KeyboardInterrupt:
        print("palpa.sweeps: interrupted; the same command continues", file=sys.stderr)
        return 130


if __name__ == "__main__":
    from palpa import sweeps  # other processes look for its functions there
    sys.exit(sweeps.main())
