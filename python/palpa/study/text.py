"""Text of files and of messages: lines, cells and numbers as spreadsheets write them, and what a person may see of them.

Bytes that are not UTF-8 are surrogates here (`surrogateescape`), so names keep their bytes.
"""
import errno
import json
import os
import re
import stat

CODING = ("utf-8", "surrogateescape")
NOT_AVAILABLE = "n/a"
NUMBER = re.compile(r"[+]?-?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
WHOLE = re.compile(r"[+]?[0-9]+")


class BadInput(ValueError):
    """A file that cannot be used: one line that names it."""


def bad_input(file, fault):
    return BadInput(f"{file}: {fault}")


# ---- files


def read_bytes(path, most):
    """The bytes of a regular file that is not empty and has at most that many."""
    try:
        # Opening a pipe without a writer would wait.
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    except OSError as error:
        raise bad_input(path, "no such file" if error.errno == errno.ENOENT else f"cannot be opened: {error.strerror}") from None
    with open(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        fault = ("is a folder, a file is needed" if stat.S_ISDIR(status.st_mode) else
                 "is not a regular file" if not stat.S_ISREG(status.st_mode) else
                 "is empty" if status.st_size == 0 else
                 f"has {status.st_size} bytes, at most {most} are expected" if status.st_size > most else None)
        if fault:
            raise bad_input(path, fault)
        try:
            return file.read()
        except OSError as error:
            raise bad_input(path, f"cannot be read: {error.strerror}") from None


def read_text(path, most):
    """The same as text, without a byte order mark."""
    data = read_bytes(path, most)

    def has_zeros(zero):
        # Without a mark, the zero bytes beside Western letters tell.
        return len(data) >= 4 and data[zero] == data[2 + zero] == 0 and all(9 <= data[i - zero] <= 126 for i in (1, 3))
    if has_zeros(0) or has_zeros(1) or data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise bad_input(path, "is text in UTF-16; save it as UTF-8")
    return data.removeprefix(b"\xef\xbb\xbf").decode(*CODING)


def parse_json(text):
    """The document, or None if it is not JSON as its standard has it."""
    def finite(number):
        value = float(number)
        if value in (float("inf"), float("-inf")):
            raise ValueError
        return value

    def refuse(_):
        raise ValueError
    try:
        document = json.loads(text, parse_float=finite, parse_constant=refuse)
        text.encode()
        json.dumps(document, ensure_ascii=False).encode()  # a lone surrogate is no letter
    except (ValueError, RecursionError):
        return None
    return document


def whole(value, most=2 ** 64 - 1):
    """Whether a value of JSON is a whole number from 0 to `most`."""
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= most


# ---- lines and cells


def lines_of(text):
    """The lines without their ends (LF or CRLF), and whether the last has no end."""
    text = text.removeprefix("\ufeff")
    if not text:
        return [], False
    lines = text.split("\n")
    cut = lines[-1] != ""
    if not cut:
        lines.pop()
    return [line.removesuffix("\r") for line in lines], cut


def cells_of(line, separator, most):
    """The cells without spaces around them and without quotes, within which a separator is a letter and two quotes are
    one. A quote that does not end is a letter. At most `most` + 1 cells: further ones are not listed."""
    if '"' not in line:
        return [cell.strip(" ") for cell in line.split(separator, most + 1)[:most + 1]]
    cells = []
    while len(cells) <= most:
        cell, line = quoted_cell(line, separator) or plain_cell(line, separator)
        cells.append(cell.strip(" "))
        if not line:
            break
        line = line[1:]
    return cells


def plain_cell(line, separator):
    cell, found, rest = line.partition(separator)
    return cell, found + rest


def quoted_cell(line, separator):
    """A cell in quotes at the beginning, and the text that follows; None if the quotes do not end before a separator."""
    line = line.lstrip(" ")
    if not line.startswith('"'):
        return None
    cell, at = "", 1
    while at < len(line):
        if line[at] != '"':
            cell += line[at]
        elif line[at + 1:at + 2] == '"':
            cell += '"'
            at += 1
        else:
            rest = line[at + 1:].lstrip(" ")
            return (cell, rest) if not rest or rest[0] == separator else None
        at += 1
    return None


def number_in(cell):
    """The finite number that the whole cell is, else None."""
    if not NUMBER.fullmatch(cell):
        return None
    value = float(cell.removeprefix("+"))
    if value in (float("inf"), float("-inf")) or (value == 0 and re.search("[1-9]", re.split("[eE]", cell)[0])):
        return None
    return value


def whole_in(cell, most=2 ** 32 - 1):
    """The whole number from 0 to `most` that the whole cell is, else None."""
    return int(cell) if WHOLE.fullmatch(cell) and int(cell) <= most else None


def bytes_of(text):
    """What names are sorted and measured by."""
    return text.encode(*CODING)


# ---- messages


def is_unseen(code):
    """Controls, separators of lines and paragraphs, characters that change the writing direction, the byte order mark."""
    return (code < 0x20 or 0x7f <= code < 0xa0 or code in (0x200e, 0x200f, 0xfeff) or 0x2028 <= code <= 0x202e
            or 0x2066 <= code <= 0x2069)


def printable(text, most=None):
    """The text with unseen characters escaped, cut off after that many bytes."""
    shown, size = [], 0
    for letter in text:
        code = ord(letter)
        if 0xdc80 <= code <= 0xdcff:
            piece = f"\\x{code - 0xdc00:02x}"
        elif is_unseen(code):
            piece = {10: "\\n", 13: "\\r", 9: "\\t"}.get(code, f"\\x{code:02x}" if code < 0x80 else f"\\u{code:04x}")
        else:
            piece = letter
        size += len(bytes_of(piece))
        if most is not None and size > most:
            return "".join(shown) + "..."
        shown.append(piece)
    return "".join(shown)


def shortened(text, most):
    """At most that many bytes, with dots in the place of what is left out."""
    data = bytes_of(text)
    if len(data) <= most:
        return text
    tail = (most - 3) // 3
    start, end = len(data) - tail, most - 3 - tail
    while start < len(data) and data[start] & 0xc0 == 0x80:
        start += 1
    while end > 0 and data[end] & 0xc0 == 0x80:
        end -= 1
    return data[:end].decode(*CODING) + "..." + data[start:].decode(*CODING)


def plural(number, word):
    if number == 1:
        return word
    if word.endswith("y") and not word.endswith(("ay", "ey")):
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "ch", "sh")) else "s")


def counted(number, word):
    return f"{number} {plural(number, word)}"


def brief(number):
    """A number without the zero that Python puts behind whole ones."""
    return str(number).removesuffix(".0")
