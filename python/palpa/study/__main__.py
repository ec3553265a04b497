"""The commands: `python3 -m palpa.study analyse|compare|power ...`, with the options of `palpa study`."""
import argparse
import os
import stat
import sys
import tempfile
import types

if not __package__:
    # As a file, without the rest of the package palpa, whose engine the analysis does not need.
    folder = os.path.dirname(os.path.abspath(__file__))
    sys.path[:] = [path for path in sys.path if os.path.abspath(path or ".") != folder]  # its files are no modules for others
    sys.modules["palpa"] = types.ModuleType("palpa")
    sys.modules["palpa"].__path__ = [os.path.dirname(folder)]
    __package__ = "palpa.study"

from .text import BadInput, printable, shortened  # noqa: E402

# The exit codes of all commands.
FAILED, USAGE, BAD_INPUT, INTERRUPTED = 1, 2, 4, 130
PACKAGES = {"numpy": "python3-numpy", "scipy": "python3-scipy", "pandas": "python3-pandas", "matplotlib": "python3-matplotlib"}


class Usage(ValueError):
    """A command line that cannot be meant."""


# ---- names in reports


def names_in_reports(sources):
    """The last parts of each path that tell it from the others."""
    def name_of(source, parts):
        found = [part for part in os.path.normpath(source).split(os.sep) if part]
        return os.path.join(*found[-parts:]) if found and found != ["."] else source

    names = []
    for source in sources:
        parts = 1
        while parts < 64 and any(other != source and name_of(other, parts) == name_of(source, parts) for other in sources):
            parts += 1
        names.append(name_of(source, parts))
    return names


def lines_in_reports(lines, sources):
    """The lines with these names in the place of paths, which may name a person."""
    for source, name in zip(sources, names_in_reports(sources)):
        path, done = source.rstrip("/") or source[:1], []
        for line in lines:
            text, at = "", 0
            while (found := line.find(path, at)) >= 0:
                end = found + len(path)
                whole = (found == 0 or line[found - 1] == " ") and line[end:end + 1] in ("/", ":") and end < len(line)
                text += line[at:found] + (name if whole else path)
                at = end
            done.append(text + line[at:])
        lines = done
    return lines


# ---- outputs


def same_file(a, b):
    try:
        return os.path.samefile(a, b)
    except OSError:
        return os.path.realpath(a) == os.path.realpath(b)


def check_outputs(options, sources):
    """Refuses an output that is an input, that lies in the folder of a participant, or that is there twice."""
    outputs = [(option, target) for option, target in options if target and target != "-"]
    if sum(target == "-" for _, target in options) > 1:
        raise Usage("only one output can be - (stdout)")
    for place, (option, target) in enumerate(outputs):
        for other, before in outputs[:place]:
            if same_file(target, before):
                raise Usage(f"{option} {target}: is also the file of {other}; give another one")
        folder = os.path.dirname(os.path.abspath(target))
        if not os.path.isdir(folder):
            raise Usage(f"{option} {target}: there is no folder {folder}")
        if os.path.isdir(target):
            raise Usage(f"{option} {target}: is a folder; give a file")
        if option == "--script" and os.path.exists(target):
            raise Usage(f"{option} {target}: is there, and may have been changed; run it with Python, or give another name")
        for source in sources:
            if os.path.isfile(source) and same_file(source, target):
                raise Usage(f"{option} {target}: is read, too; give another file")
            within = os.path.relpath(os.path.realpath(target), os.path.realpath(source)) if os.path.isdir(source) else ".."
            if within.startswith("sub-") and os.sep in within:
                raise Usage(f"{option} {target}: is in the folder of a participant; give a file that is not in one")
            if within in ("trials.tsv", "trials.json", "participants.tsv", "dataset_description.json"):
                raise Usage(f"{option} {target}: is a file of the study; give another one")


def write(target, text):
    """Complete or not at all; with the mode of a file that it replaces."""
    data = text.encode("utf-8", "surrogateescape")
    if target == "-":
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return
    target = os.path.realpath(target)
    there = os.stat(target) if os.path.exists(target) else None
    if there and not stat.S_ISREG(there.st_mode):
        with open(target, "wb") as out:
            out.write(data)
        return
    mask = os.umask(0)
    os.umask(mask)
    descriptor, name = tempfile.mkstemp(prefix=".palpa-", dir=os.path.dirname(target))
    try:
        with open(descriptor, "wb") as out:
            out.write(data)
        os.chmod(name, stat.S_IMODE(there.st_mode) if there else 0o666 & ~mask)
        os.replace(name, target)
    except BaseException:
        os.unlink(name)
        raise


def warn(line):
    text = shortened(f"palpa: warning: {printable(line)}", 500) + "\n"
    sys.stderr.write(text.encode("utf-8", "surrogateescape").decode("utf-8", "replace"))


# ---- commands

SCRIPT = '''#!/usr/bin/env python3
"""The report of {names}. `palpa study {command}` wrote this script: change it as you like.

docs/python/study.md says what is in `table` and `result`.
"""
import sys

try:
    import palpa.study as study
except ImportError:
    sys.path.append({place!r})
    import palpa.study as study

{body}
# A figure of your own goes here, as in:
#
#     axes = table.groupby("condition")["answer_time"].median().plot.bar()
#     page.heading("Times of answers")
#     page.figure(axes.figure, "The median time of an answer, by condition.")

page.write({html!r})
'''
BODIES = {
    "analyse": '''FOLDERS = {sources!r}

table = study.load(*FOLDERS)  # one row per trial, a DataFrame of pandas
result = study.analyse(FOLDERS, seed={seed})  # all numbers, as in --json
page = study.analysis_page(result)
''',
    "counts": '''COUNTS = {sources[0]!r}

table, warnings = study.read_counts(COUNTS)
result = study.compare_tables([(COUNTS, table)], warnings)  # all numbers, as in --json
page = study.comparison_page(result)
''',
    "compare": '''SOURCES = {sources!r}

result = study.compare(SOURCES)  # all numbers, as in --json
page = study.comparison_page(result)
''',
}


def script_of(command, options, sources):
    """A program that makes the same report."""
    place = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    body = BODIES[command].format(sources=[os.path.abspath(source) if os.path.exists(source) else source for source in sources],
                                  seed=getattr(options, "seed", 0))
    if command != "analyse":
        body = body.rstrip("\n") + "\n"
    return SCRIPT.format(names=", ".join(names_in_reports(sources)), command=command.replace("counts", "analyse"), body=body, place=place,
                         html=os.path.basename(options.html) if options.html and options.html != "-" else "report.html")


def write_reports(options, result, text, csv, page):
    from .pages import as_json
    if options.json:
        write(options.json, as_json(result))
    if options.html:
        write(options.html, page().text())
    if options.csv:
        write(options.csv, csv(result))
    if not options.quiet and "-" not in (options.json, options.html, options.csv):
        write("-", text(result))


def analyse(options):
    from . import analysis, counts, pages
    sources = options.what
    check_outputs(outputs_of(options), sources)
    if len(sources) == 1 and not os.path.isdir(sources[0]):
        table, left_out = counts.read_counts(sources[0])
        result = analysis.compare_tables([(names_in_reports(sources)[0], table)], left_out)
        kind, page = "counts", lambda: pages.comparison_page(result)
        texts = pages.comparison_text, pages.comparison_csv
    else:
        result = analysis.analyse(sources, options.seed)
        left_out, kind, page = result["left_out"], "analyse", lambda: pages.analysis_page(result)
        texts = pages.analysis_text, pages.analysis_csv
    for line in left_out:
        warn(line)
    result["left_out"] = lines_in_reports(left_out, sources)
    write_reports(options, result, *texts, page)
    if options.script:
        write(options.script, script_of(kind, options, sources))


def compare(options):
    from . import analysis, pages
    from .counts import tables_of
    sources = options.what
    check_outputs(outputs_of(options), sources)
    tables, left_out = [], []
    for source, name in zip(sources, names_in_reports(sources)):
        more, lines = tables_of(source)
        tables += [(name + full[len(source):], table) for full, table in more]
        left_out += lines
        if len(tables) > 100:
            raise Usage("these are more than 100 tables: give fewer")
    if len(tables) < 2:
        raise Usage("one table alone cannot be compared: give palpa study compare at least two, such as the word paper")
    result = analysis.compare_tables(tables, left_out)
    for line in result["left_out"]:
        warn(line)
    result["left_out"] = lines_in_reports(result["left_out"], sources)
    write_reports(options, result, pages.comparison_text, pages.comparison_csv, lambda: pages.comparison_page(result))
    if options.script:
        write(options.script, script_of("compare", options, sources))


def power(options):
    from . import analysis, pages
    check_outputs(outputs_of(options), [])
    if options.studies * options.people * options.trials > 400_000_000:
        raise Usage("--studies times --people times --trials is more than 400 million: give less of one")
    for option, accuracy in (("--baseline", options.baseline), ("--accuracy", options.accuracy)):
        simulated = analysis.mean_within_bounds(accuracy, options.spread)
        if abs(simulated - accuracy) >= 0.002:
            above = accuracy > 0.5
            warn(f"{option} {accuracy:g}: with --spread {options.spread:g}, some participants would have an accuracy "
                 f"{'above 1' if above else 'below 0'}; they get {int(above)}, so the simulated mean is {simulated:.3f}: give a smaller --spread")
    result = analysis.power(accuracies=[options.baseline, options.accuracy], **{
        key: getattr(options, key) for key in ("spread", "correlation", "trials", "alpha", "power", "studies", "people", "seed")})
    write_reports(options, result, pages.power_text, pages.power_csv, lambda: pages.power_page(result))


def outputs_of(options):
    return [(f"--{name}", getattr(options, name)) for name in ("json", "html", "csv", "script") if getattr(options, name, None)]


def within(kind, low, high, open_low=False):
    """A number of an option, from `low` (or above it) to `high`."""
    def number(text):
        value = kind(text)
        if not low <= value <= high or (open_low and value == low):
            raise argparse.ArgumentTypeError(f"{text} is not {'above' if open_low else 'from'} {low} {'and at most' if open_low else 'to'} {high}")
        return value
    number.__name__ = "number"
    return number


def parser_of():
    parser = argparse.ArgumentParser("palpa study", description=__doc__, allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", required=True)

    def command(name, summary, run, rows):
        one = commands.add_parser(name, help=summary, description=summary, allow_abbrev=False)
        one.set_defaults(run=run)
        one.add_argument("--json", metavar="FILE|-", help="writes all numbers as JSON")
        one.add_argument("--html", metavar="FILE|-", help="writes a report with figures: one file, without scripts, for print, too")
        one.add_argument("--csv", metavar="FILE|-", help=f"writes a table: {rows}")
        one.add_argument("--seed", metavar="NUMBER", type=within(int, 0, 2 ** 64 - 1), default=0, help="of what is drawn at random (0)")
        one.add_argument("--quiet", action="store_true", help="prints no summary")
        return one
    one = command("analyse", "the results of an experiment: can people tell the shapes apart?", analyse, "one row per participant and method")
    one.add_argument("what", nargs="+", metavar="DIR|COUNTS.csv", help="folders of a study, or one table of counts")
    one.add_argument("--script", metavar="FILE", help="writes a Python program that makes the report, for changes of your own")
    one = command("compare", "compares results with each other, and with the paper's", compare, "one row per table")
    one.add_argument("what", nargs="+", metavar="WHAT", help="the word paper, folders of studies, CSV files of counts, JSON files of analyse or compare")
    one.add_argument("--script", metavar="FILE", help="writes a Python program that makes the report, for changes of your own")
    one = command("power", "how many participants an experiment needs, by simulation", power, "one row per number of participants")
    for name, default, limits, text in (
            ("baseline", 0.39, (float, 0, 1), "mean accuracy with the first method"), ("accuracy", 0.6525, (float, 0, 1), "mean accuracy with the second"),
            ("spread", 0.1, (float, 0, 0.5), "standard deviation of participants' accuracies, without the chance in their trials"),
            ("correlation", 0.77, (float, -1, 1), "of a participant's accuracies with both methods"),
            ("trials", 40, (int, 1, 1000), "of each participant with each method"), ("alpha", 0.05, (float, 0, 0.5, True), "a difference is found if p is at most this"),
            ("power", 0.8, (float, 0, 1, True), "share of studies that are to find the difference"),
            ("people", 200, (int, 2, 200), "the most participants that are tried"), ("studies", 2000, (int, 100, 20_000), "simulated for each number")):
        one.add_argument(f"--{name}", metavar="NUMBER", type=within(*limits), default=default, help=f"{text} ({default})")
    return parser


def main(words=None):
    """The exit code of a command line."""
    options = parser_of().parse_args(words)
    try:
        options.run(options)
        return 0
    except Usage as error:
        line, code = str(error), USAGE
    except BadInput as error:
        line, code = str(error), BAD_INPUT
    except OSError as error:
        line, code = f"{error.filename or 'output'}: {error.strerror}", FAILED
    except ModuleNotFoundError as error:
        if error.name not in PACKAGES:
            raise
        line = (f"{sys.executable} has no {error.name}, which the analysis of studies needs: apt install {' '.join(PACKAGES.values())}, or in an "
                f"environment pip install {' '.join(PACKAGES)}")
        code = FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    sys.stderr.write(f"palpa: error: {printable(line)}\n".encode("utf-8", "surrogateescape").decode("utf-8", "replace"))
    return code


if __name__ == "__main__":
    sys.exit(main())
