"""Tables of answers that are not a study: a CSV file of counts, a JSON file of palpa study analyse or compare, the paper's."""
import os
import re

from .reading import MOST_METHODS, MOST_NAME, MOST_SHAPES, read_study
from .statistics import PAPER, Confusion
from .text import bad_input, bytes_of, cells_of, counted, lines_of, parse_json, printable, read_text, whole, whole_in


# ---- a CSV file


def told_separator(line):
    """The separator of a first line such as "sep=;", which spreadsheets write."""
    if len(line) > 1 and line[0] == line[-1] == '"':
        line = line[1:-1]
    return line[4] if len(line) == 5 and line.startswith(("sep=", "Sep=", "SEP=")) else None


def cells_in(line, separator):
    cells = cells_of(line, separator, 1000)
    while len(cells) > 1 and not cells[-1]:
        cells.pop()
    return cells


def count_in(cell, name, line):
    count = whole_in(cell, 1_000_000_000)
    if count is None:
        raise bad_input(name, f"line {line}: '{printable(cell, 40)}' is not a count: give whole numbers of answers, 0 to 1000000000")
    return count


def answers_in(header, line, name):
    answers = []
    for place, answer in enumerate(header[1:], 1):
        # A file of another kind may be anything, so no message shows its bytes.
        if not answer or len(bytes_of(answer)) > MOST_NAME:
            raise bad_input(name, f"line {line}: name {place} is not a name of 1 to {MOST_NAME} letters")
        if answer in answers:
            raise bad_input(name, f"line {line}: name {place} is there twice")
        answers.append(answer)
    if not 2 <= len(answers) <= MOST_SHAPES:
        raise bad_input(name, f"line {line}: has {len(answers)} shapes, 2 to {MOST_SHAPES} are needed: the line has the answers, such "
                              "as actual,cube,prism")
    return answers


def leave_out_sums(answers, rows, name):
    """Removes a row and a column that are sums of the others, as spreadsheets, R and pandas add them, and returns a line
    about each. Numbers decide, not names: a column is left out if it is the sum of the others in each row, and not all 0;
    a row likewise. A name that is that of a row and of a column must be a sum in both, and two shapes must be left,
    because equal counts of two shapes look like sums."""
    if any(len(cells) != len(answers) for _, _, cells in rows):
        return []  # a fault that has a line of its own
    counts = [[count_in(cell, name, line) for cell in cells] for line, _, cells in rows]
    columns = list(zip(*counts))

    def is_sum(these, others):
        return sum(these) > 0 and all(2 * one == sum(other) for one, other in zip(these, others))

    def column_is_sum(c):
        return bool(rows) and is_sum(columns[c], counts)

    def row_is_sum(r):
        return is_sum(counts[r], columns)
    names, column, row = [shape for _, shape, _ in rows], None, None
    for c, answer in enumerate(answers):
        if column_is_sum(c) and (answer not in names or row_is_sum(names.index(answer))):
            column = c
    for r, shape in enumerate(names):
        if row_is_sum(r) and (shape not in answers or column == answers.index(shape)):
            row = r
    if len(answers) - (column is not None) < 2 or len(rows) - (row is not None) < 2:
        return []
    warnings = []
    if column is not None:
        warnings.append(f"{name}: the answer '{printable(answers[column], 40)}' is the sum of the others and left out")
        del answers[column]
        for _, _, cells in rows:
            del cells[column]
    if row is not None:
        warnings.append(f"{name}: line {rows[row][0]}: '{printable(rows[row][1], 40)}' is the sum of the other lines and left out")
        del rows[row]
    return warnings


def parse_counts(text, name):
    """The confusion matrix of a table of counts, and warnings."""
    lines, cut = lines_of(text)
    first = lines[0] if lines else ""
    told = told_separator(first)
    begin = 2 if told else 1
    first = (lines[1] if len(lines) > 1 else "") if told else first
    separator = told or next((one for one in "\t;," if one in first), ",")
    answers = answers_in(cells_in(first, separator), begin, name)
    rows, warnings = [], []
    for number, line in enumerate(lines[begin:], begin + 1):
        cells = cells_in(line, separator)
        if cells == [""]:
            continue
        if cut and number == len(lines):
            warnings.append(f"{name}: line {number} has no end: check that the file is complete")
        if len(cells) != len(answers) + 1:
            raise bad_input(name, f"line {number}: {counted(len(cells) - 1, 'count')} where line {begin} has "
                                  f"{counted(len(answers), 'answer')}")
        rows.append((number, cells[0], cells[1:]))
    warnings += leave_out_sums(answers, rows, name)
    counts = {}
    for line, shape, cells in rows:
        if shape not in answers:
            raise bad_input(name, f"line {line}: the shape '{printable(shape, 40)}' is not among the answers {', '.join(answers)}")
        if shape in counts:
            raise bad_input(name, f"line {line}: shape '{printable(shape, 40)}' already has a line")
        counts[shape] = [count_in(cell, name, line) for cell in cells]
    for shape in answers:
        if shape not in counts:
            raise bad_input(name, f"has no line of the shape '{printable(shape, 40)}'")
    table = Confusion(answers, [counts[shape] for shape in answers])
    if table.total == 0:
        raise bad_input(name, "all counts are 0")
    line = next((number for number, one in enumerate(text.split("\n"), 1) if re.search("[\udc80-\udcff]", one)), 0)
    if line:
        warnings.append(f"{name}: line {line} has bytes that are not UTF-8: save the table as UTF-8")
    return table, warnings


def read_counts(path):
    return parse_counts(read_text(path, 1 << 20), path)


# ---- earlier results


def read_results(path):
    """Names and tables of a JSON file of palpa study analyse or compare, and what that warned of."""
    def refuse(fault):
        return bad_input(path, f"{fault}: a JSON file of palpa study analyse or compare is needed")

    def shapes_in(document):
        shapes = document.get("shapes")
        if not isinstance(shapes, list) or not 2 <= len(shapes) <= MOST_SHAPES:
            raise refuse(f'"shapes" is not a list of 2 to {MOST_SHAPES} names')
        for place, shape in enumerate(shapes):
            if not isinstance(shape, str):
                raise refuse('"shapes" has something that is not a name')
            if shape in shapes[:place]:
                raise refuse('"shapes" has a name twice')
        return shapes

    def table_in(entry, shapes):
        counts = entry.get("counts")
        if not isinstance(counts, list) or len(counts) != len(shapes):
            raise refuse(f'"counts" does not have {len(shapes)} rows')
        for number, row in enumerate(counts, 1):
            if not isinstance(row, list) or len(row) != len(shapes):
                raise refuse(f'row {number} of "counts" does not have {len(shapes)} counts')
            if not all(whole(count, 1_000_000_000) for count in row):
                raise refuse(f'row {number} of "counts" has something that is not a count')
        table = Confusion(list(shapes), counts)
        if table.total == 0:
            raise refuse('all "counts" are 0')
        return table
    document = parse_json(read_text(path, 64 << 20))
    document = document if isinstance(document, dict) else {}
    kind, compared = document.get("kind"), "tables" in document
    # Earlier versions wrote no kind for a table of counts.
    if kind != "palpa study analyse" and not (compared and kind in ("palpa study compare", None)):
        raise refuse('"kind" is not that of such a file')
    shapes = None if compared else shapes_in(document)  # a study has the same in all tables
    key, most = ("tables", 100) if compared else ("methods", MOST_METHODS)
    entries = document.get(key)
    if not isinstance(entries, list) or not 1 <= len(entries) <= most:
        raise refuse(f'"{key}" is not a list of 1 to {most} tables')
    tables = []
    for entry in entries:
        if not isinstance(entry, dict) or not isinstance(entry.get("name"), str):
            raise refuse(f'"{key}" has something without a "name"')
        tables.append((entry["name"], table_in(entry, shapes or shapes_in(entry))))
    left_out = document.get("left_out", [])
    return tables, [printable(line, 1000) for line in left_out if isinstance(line, str)] if isinstance(left_out, list) else []


def tables_of(source):
    """The tables of one source, each with its name, and what was left out: a folder of a study, one table per method; a
    .json of palpa study analyse or compare; the word "paper"; any other file as counts."""
    if source == "paper" and not os.path.exists(source):
        return [(f"paper: {method}", table) for method, table in PAPER.items()], []
    if os.path.isdir(source):
        study = read_study([source])
        pooled = [Confusion(study.shapes) for _ in study.methods]
        for person in study.participants:
            for trial in person.trials:
                pooled[trial.method].counts[trial.shape][trial.answer] += 1
        return [(f"{source}: {method}", table) for method, table in zip(study.methods, pooled)], study.left_out
    if os.path.splitext(source)[1] == ".json":
        tables, left_out = read_results(source)
        return [(f"{source}: {name}", table) for name, table in tables], left_out
    table, warnings = read_counts(source)
    return [(source, table)], warnings
