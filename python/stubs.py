#!/usr/bin/env python3
"""stubs.py FILE: writes the stubs of the module `palpa` from the module: its signatures, docstrings and options."""
import inspect
import pathlib
import re
import sys

# This folder, which comes first, has the package's sources, without the built module; FILE is beside the module.
sys.path[0] = str(pathlib.Path(sys.argv[1]).resolve().parents[1])
import palpa  # noqa: E402  pylint: disable=wrong-import-position

PATH = "_Path"
WORDS = {  # the types in docstrings, and in stubs; the first that fits a part of a text counts
    "array_like": "ArrayLike", "dict": "dict[str, Any]", "(vertices, faces)": "tuple[ArrayLike, ArrayLike]",
    "(float, float)": "tuple[float, float]", "(int, int)": "tuple[int, int]", "path": PATH, "float": "float",
    "int": "int", "bool": "bool | np.bool_", "str": "str", "callable": "Callable[..., Any]",
}
ARRAYS = {name: f"np.{name}" for name in ("float64", "complex128", "uint32", "uint16", "int64")}
NUMBERS = {"LENGTH", "TIME", "FREQUENCY", "SPEED", "PRESSURE", "CELSIUS", "PERCENT"}


def literal(words):
    return "Literal[" + ", ".join(f'"{word}"' for word in words) + "]"


def given_type(text):
    """The type of a parameter, from a docstring such as "array_like, shape (n, 3), or path, optional"."""
    if text.startswith("{"):
        return literal(re.findall(r'"([^"]+)"', text)) + " | str"
    text = re.sub(r",? shape \([^)]*\)( or \([^)]*\))?|of shape \([^)]*\)|of (complex|int)\b", "", text)
    kinds = []
    if "list of these" in text or "list of path" in text:
        kinds.append("Sequence[Any]")
    if "ndarray" in text:
        kinds.append("NDArray[Any]")
    for word, kind in WORDS.items():
        if re.search(rf"(?<!\w){re.escape(word)}(?!\w)", text) and kind not in kinds:
            kinds.append(kind)
            text = text.replace(word, "")
    kinds += [name for name in re.findall(r"\b[A-Z]\w+\b", text) if hasattr(palpa, name)]
    return " | ".join(kinds) or "Any"


def shown_type(doc):
    """The type of a property or a result, from "ndarray of float64, shape (n,), or None: ..."."""
    head = re.split(r":(?: |$)", doc, maxsplit=1)[0].strip()
    # Who asked for it knows that it is there, and need not say so to a type checker.
    none = " | Any" if head.endswith("or None") else ""
    head = re.sub(r",? or None$", "", head)
    if match := re.match(r"ndarray of (\w+)", head):
        return f"NDArray[{ARRAYS[match[1]]}]{none}"
    if head.startswith("list of ("):
        inner = head[len("list of ("):head.index(")")]
        return f"list[tuple[{inner}]]{none}"
    if match := re.match(r"list of (\w+)", head):
        return f"list[{match[1] if match[1] != 'dict' else 'dict[str, Any]'}]{none}"
    if head.startswith("dict"):
        return f"dict[str, {'float' if 'to float' in head else 'Any'}]{none}"
    if head.startswith("("):
        return f"tuple[{head.strip('()')}]{none}"
    if head.startswith("tuple"):
        return f"tuple[{head.rsplit(' ', 1)[-1]}, ...]{none}"
    name = head.split(",")[0].split(" ")[0]
    return (name if name in {"str", "float", "int", "bool", "None"} or hasattr(palpa, name) else "Any") + none


def section(doc, title):
    """The lines of a section of a numpydoc docstring."""
    match = re.search(rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", doc, re.M | re.S)
    return match[1].splitlines() if match else []


def parameters(doc):
    """Name -> type."""
    found = {}
    for line in section(doc, "Parameters"):
        if match := re.match(r"(\*{0,2}\w+(?:, \w+)*) : (.+)", line):
            for name in match[1].split(", "):
                found[name] = given_type(match[2])
    return found


def option_lines(name, known):
    """`known`: the parameters of the docstring; an option that may also be a function is among them."""
    lines = []
    for keyword, kind, _, _, words, flag in palpa._engine._options().get(name, []):
        if flag:
            given = "bool | np.bool_"
        elif words:
            given = literal(words) + " | str"  # a variable of a loop over words is a str
        elif kind in NUMBERS or kind == "NUMBER":
            given = "float | str"
        elif kind in {"COUNT", "INTEGER", "N"}:
            given = "int | str"
        else:
            given = "Any"
        if "Callable" in known.get(keyword, ""):
            given += " | Callable[..., Any]"
        lines.append(f"{keyword}: {given} | None = ...")
    return lines


def signature(name, target):
    """As pybind11 writes it before a docstring."""
    parts = []
    for part in inspect.signature(target).parameters.values():
        parts += ["*"] * (part.kind is part.KEYWORD_ONLY and "*" not in parts)
        parts.append(f"{part.name}: object" + ("" if part.default is part.empty else f" = {part.default}"))
    return f"{name}({', '.join(parts)})"


def function(name, target, indent, owner=None):
    doc = inspect.getdoc(target) or ""
    if inspect.isfunction(target):
        doc = f"{signature(name, target)}\n\n{doc}"
    head, _, body = doc.partition("\n")
    match = re.match(r"(\w+)\((.*)\)(?: -> (.*))?$", head)
    known = parameters(body)
    arguments, keywords = [], False
    for part in re.split(r", (?=\*|\w+:)", match[2]) if match and match[2] else []:
        part_name = part.split(":")[0].split("=")[0].strip()
        if part_name in {"self", "*"}:
            arguments.append(part_name)
            keywords = keywords or part_name == "*"
            continue
        if part_name.startswith("**"):
            continue
        default = " = ..." if " = " in part else ""
        default = " | None" * (inspect.isfunction(target) and part.endswith(" = None")) + default
        arguments.append(f"{part_name}: {known.get(part_name, given_type(part.partition(':')[2]))}{default}")
    full = f"{owner}.{name}" if owner else name
    options = option_lines(owner if name == "__init__" else full, known)
    if options:
        arguments += ([] if keywords else ["*"]) + options
    elif "**kwargs" in head:
        arguments.append("**options: Any")
    result = "None" if name == "__init__" else None
    if result is None and match and match[3] in ("None", "int", "str"):
        result = match[3]
    returned = section(body, "Returns")
    if returned:
        result = shown_type(returned[0])
    elif result is None and match and match[3] and (found := re.match(r"palpa\._engine\.(\w+)$", match[3])):
        result = found[1]
    elif result is None or (body.strip() and not returned and name != "__init__"):
        first = body.strip().split("\n")[0]
        result = shown_type(first) if ":" in first else result or "Any"
    line = f"{indent}def {name}({', '.join(arguments)}) -> {result}: ..."
    if len(line) > 120:
        inner = f",\n{indent}    ".join(arguments)
        line = f"{indent}def {name}(\n{indent}    {inner},\n{indent}) -> {result}: ..."
    return line


SPECIAL = {
    "__len__": "def __len__(self) -> int: ...", "__repr__": "def __repr__(self) -> str: ...",
    "__array__": "def __array__(self, *args: Any, **kwargs: Any) -> NDArray[Any]: ...",
    "__enter__": "def __enter__(self) -> {0}: ...", "__exit__": "def __exit__(self, *args: Any) -> None: ...",
}
ITEMS = {"Scene": "def __getitem__(self, key: str | int) -> Solid: ...",
         "Figure6": "def __getitem__(self, index: int) -> tuple[str, Simulation]: ..."}


def class_lines(name, cls):
    bases = ", ".join(base.__name__ for base in cls.__bases__ if base.__name__ not in {"pybind11_object", "object"})
    lines = [f"class {name}{f'({bases})' if bases else ''}:"]
    if issubclass(cls, BaseException):
        return lines + ["    file: str | None", "    exit_code: int"] if name == "Error" else [lines[0] + " ..."]
    for member in sorted(vars(cls)):
        value = vars(cls)[member]
        if member in SPECIAL:
            lines.append("    " + SPECIAL[member].format(name))
        elif member == "__getitem__":
            lines.append("    " + ITEMS[name])
        elif member == "__init__" and "Initialize self" not in (value.__doc__ or "") and value.__doc__:
            text = (value.__doc__ or "") + "\n" + (cls.__doc__ or "")
            lines.append(function(member, type("Doc", (), {"__doc__": text}), "    ", name))
        elif member.startswith("_"):
            continue
        elif isinstance(value, property):
            lines += ["    @property", f"    def {member}(self) -> {shown_type(inspect.getdoc(value) or '')}: ..."]
        elif isinstance(value, staticmethod):
            lines += ["    @staticmethod", function(member, getattr(cls, member), "    ", name)]
        else:
            lines.append(function(member, getattr(cls, member), "    ", name))
    return lines if len(lines) > 1 else [lines[0] + " ..."]


def text():
    lines = ['"""Made by python/stubs.py from the module itself."""',
             "from collections.abc import Callable, Sequence", "from os import PathLike",
             "from typing import Any, Literal, Union", "", "import numpy as np",
             "from numpy.typing import ArrayLike, NDArray", "",
             "_Path = Union[str, PathLike[str]]", "__version__: str", ""]
    public = palpa.__all__
    lines += ["__all__ = ["] + [f'    "{name}",' for name in public] + ["]", ""]
    classes = [name for name in public if inspect.isclass(getattr(palpa, name))]

    def place(name):  # errors first, bases before what is derived from them
        cls = getattr(palpa, name)
        return (0, len(cls.__mro__), name) if issubclass(cls, Exception) else (1, 0, name)

    classes.sort(key=place)
    for name in classes:
        lines += class_lines(name, getattr(palpa, name)) + [""]
    for name in public:
        if name not in classes:
            lines.append(function(name, getattr(palpa, name), ""))
    return "\n".join(lines).rstrip() + "\n"


def main():
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(text())


if __name__ == "__main__":
    main()
