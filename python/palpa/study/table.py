"""The tidy table of a study: one row per trial, as a DataFrame of pandas.

It is `trials.tsv` of the study's folder. Without that file, it is made from the logs of the participants.
"""
import os
import re
import warnings

from .reading import MOST_COLUMNS, TABLE, folders_of
from .text import CODING, NOT_AVAILABLE, bad_input, cells_of, counted, lines_of, number_in, parse_json, printable, read_text, whole_in

# What each row has, beside the answer of each question and its time, QUESTION and QUESTION_time.
COLUMNS = ("participant", "run", "block", "trial", "condition", "method", "void", "played_share", "thinned_frames")
WHOLE = ("participant", "run", "trial")
TRUTHS = ("void", "correct")
TRUTH = {"true": True, "false": False}
KINDS = ("scale", "choice", "yes-no", "number", "text", "pair", "staircase")


class StudyWarning(UserWarning):
    """Something that is left out."""


def played_share(row):
    """The share of a touch's frames that were felt as they should have been; None without a frame."""
    counts = [number_in(row.more.get(f"{name}_frames", "")) for name in ("skin", "outdated", "thinned", "left_out")]
    if None in counts or counts[0] == 0:
        return None
    return 1 - min(1.0, sum(counts[1:]) / counts[0])


def rows_of_logs(folder, left_out):
    """One dict per step of the participants' logs. The shape is the condition, and the only question is `answer`."""
    rows = []
    for one in folders_of([folder], left_out):
        left_out += one.left_out
        for number, log in enumerate(one.logs, 1):
            run = re.search(r"_run-(\d+)_", os.path.basename(log.name))
            for place, row in enumerate(log.rows, 1):
                rows.append({"participant": one.number, "run": int(run[1]) if run else number, "block": row.kind,
                             "trial": whole_in(row.more.get("step", "")) or place, "condition": row.shape or None, "method": row.method or None,
                             "answer": row.answer or None, "answer_time": row.response_s, "void": row.status == "void",
                             "played_share": played_share(row), "thinned_frames": number_in(row.more.get("thinned_frames", "")),
                             "correct": row.answer == row.shape if row.kind == "trial" and row.status == "answered" else None,
                             "onset": row.onset, "duration": row.duration})
    return rows


def rows_of_table(file, left_out):
    """One dict per row of trials.tsv. Rows that cannot be used are left out, with a line each that names the participant."""
    lines, cut = lines_of(read_text(file, 256 << 20))
    header = cells_of(lines[0], "\t", MOST_COLUMNS)
    for column in ("participant", "trial", "condition"):
        if column not in header:
            raise bad_input(file, f"line 1: the column {column} is missing: the line has {', '.join(map(printable, header[:20]))}")
    rows, numbers = [], [column for column in header if column.endswith("_time") or column in ("played_share", "thinned_frames")]
    for number, line in enumerate(lines[1:], 2):
        cells = cells_of(line, "\t", MOST_COLUMNS)
        if not line:
            continue
        row = {column: None if cell in ("", NOT_AVAILABLE) else cell for column, cell in zip(header, cells)}
        who, fault = row.get("participant") or NOT_AVAILABLE, None
        if cut and number == len(lines):
            fault = "the line has no end: the file is cut off here"
        elif len(cells) != len(header):
            fault = f"{counted(len(cells), 'cell')} where the first line has {len(header)}"
        for column in () if fault else (*WHOLE, *numbers, *TRUTHS):
            cell = row.get(column)
            if cell is None:
                if column in ("participant", "trial"):
                    fault = f"has no {column}"
                continue
            given = (whole_in(cell.removeprefix("sub-")) if column in WHOLE else TRUTH.get(cell.lower()) if column in TRUTHS else number_in(cell))
            if given is None:
                kind = "a whole number" if column in WHOLE else "true or false" if column in TRUTHS else "a number"
                fault = f"{column} '{printable(cell, 40)}' is not {kind}"
            row[column] = given
        if fault:
            left_out.append(f"{file}: line {number}: participant {printable(who, 20)}: {fault}; the row is left out")
        else:
            rows.append(row | {"void": row.get("void") or False})
    return rows, header if "void" in header else [*header, "void"]


def questions_beside(file):
    """What trials.json says of the columns that are questions: their kind, and more."""
    if not os.path.exists(file):
        return {}
    document = parse_json(read_text(file, 1 << 20))
    if not isinstance(document, dict):
        raise bad_input(file, "is not a JSON object")
    questions = {name: told for name, told in document.items() if isinstance(told, dict) and "Kind" in told}
    for name, told in questions.items():
        if told["Kind"] not in KINDS:
            raise bad_input(file, f"\"Kind\" of \"{printable(name, 40)}\" is not {', '.join(KINDS[:-1])} or {KINDS[-1]}")
    return questions


def load(*folders):
    """The tidy table of one or several folders. `table.attrs["left_out"]` has a line about everything that is left out,
    which is also a warning; `table.attrs["questions"]` what is known of the questions."""
    import pandas
    if not folders:
        raise TypeError("load() needs the folder of a study")
    rows, left_out, questions, order, seen = [], [], {}, [], {}
    for folder in map(os.fspath, folders):
        file = os.path.join(folder, TABLE)
        if os.path.isdir(folder) and os.path.exists(file):
            more, header = rows_of_table(file, left_out)
            questions |= questions_beside(os.path.join(folder, "trials.json"))
        else:
            more = rows_of_logs(folder, left_out)
            header = list(more[0]) if more else [*COLUMNS[:6], "answer", "answer_time", *COLUMNS[6:]]
            questions.setdefault("answer", {"Kind": "shape"})
        for number in sorted({row["participant"] for row in more}):
            if number in seen:
                raise bad_input(folder, f"participant {number} is also in {seen[number]}: give each participant a number of their own")
            seen[number] = folder
        rows += more
        order += [column for column in header if column not in order]
    table = pandas.DataFrame(rows, columns=order)
    for column in order:
        if column in WHOLE:
            table[column] = table[column].astype("Int64" if table[column].isna().any() else "int64")
        elif column == "void":
            table[column] = table[column].astype(bool)
        elif table[column].dtype == object and column not in ("block", "condition", "method", "correct"):
            # An answer that is a number in every row is a number.
            values = [number_in(value) if isinstance(value, str) else value for value in table[column]]
            told = questions.get(column, {}).get("Kind")
            if told not in ("text", "choice", "yes-no", "shape") and all(a is not None for a, b in zip(values, table[column]) if b is not None):
                table[column] = pandas.Series(values, dtype=float)
    table.attrs.update(left_out=left_out, questions=questions)
    for line in left_out:
        warnings.warn(line.encode(*CODING).decode("utf-8", "replace"), StudyWarning, stacklevel=2)
    return table
