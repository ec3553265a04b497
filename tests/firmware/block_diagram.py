#!/usr/bin/env python3
"""block_diagram.py DIAGRAM.bdf ENTITY: a block diagram of Quartus as VHDL, on stdout.

Two points of a diagram are one signal if a line connects them, or if their lines have the same name. Names do not depend on
case, and NAME[3] is a part of NAME[7..0].
"""
import re
import sys

PRIMITIVES = {"GND": "{OUT} <= '0';", "NOT": "{OUT} <= not {IN};", "AND2": "{OUT} <= {IN1} and {IN2};"}


def expressions(text):
    """The nested lists that the parentheses make."""
    stack = [[]]
    for word in re.findall(r'"[^"]*"|[()]|[^\s()"]+', re.sub(r"/\*.*?\*/", "", text, flags=re.S)):
        if word == "(":
            stack.append([])
        elif word == ")":
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(word.strip('"'))
    return stack[0]


def parts(node, name):
    return [part for part in node if isinstance(part, list) and part and part[0] == name]


def point(node, base=(0, 0)):
    x, y = parts(node, "pt")[0][1:3]
    return base[0] + int(x), base[1] + int(y)


def corner(node):
    return tuple(map(int, parts(node, "rect")[0][1:3]))


def texts(node):
    return [part[1] for part in parts(node, "text")]


def split_name(name, parameters=None):
    """NAME[7..0] as (name, 7, 0), NAME[3] as (name, 3, 3), NAME as (name, None, None). Bounds may be parameters less 1."""
    found = re.fullmatch(r"(\w+)(?:\[(\w+)(-1)?(?:\.\.(\w+))?\])?", name.lower())
    if not found:
        raise ValueError(f"the name {name} is not understood")
    known = {key.lower(): value for key, value in (parameters or {}).items()}
    base, high, less, low = found.groups()
    if high is None:
        return base, None, None
    high = int(known.get(high, high)) - bool(less)
    return base, high, high if low is None else int(low)


class Nets:
    """Which points are connected, and the names of the connections."""

    def __init__(self):
        self.parent, self.names = {}, {}

    def root(self, at):
        self.parent.setdefault(at, at)
        while self.parent[at] != at:
            at = self.parent[at]
        return at

    def join(self, a, b):
        self.parent[self.root(a)] = self.root(b)

    def name(self, at, name):
        self.names.setdefault(at, set()).add(name.lower())

    def names_at(self, at):
        root = self.root(at)
        return {name for where, names in self.names.items() if self.root(where) == root for name in names}


def on_line(at, line):
    (ax, ay), (bx, by) = line
    return min(ax, bx) <= at[0] <= max(ax, bx) and min(ay, by) <= at[1] <= max(ay, by)


def read(file):
    """Pins (direction, name, point), symbols (entity, instance, parameters, ports) and the nets."""
    with open(file, encoding="latin1") as stream:
        nodes = expressions(stream.read())
    nets, pins, symbols, lines = Nets(), [], [], []
    for node in nodes:
        if node[0] in ("pin", "symbol") and any(parts(node, turn) for turn in ("flipx", "flipy", "rotate90", "rotate180", "rotate270")):
            raise ValueError(f"{file} has a turned symbol, which is not understood")
        if node[0] == "pin":
            direction = next(word[0] for word in node if isinstance(word, list) and word[0] in ("input", "output", "bidir"))
            pins.append((direction, texts(node)[1], point(node, corner(node))))
        elif node[0] == "symbol":
            ports = []
            for port in parts(node, "port"):
                direction = next(word[0] for word in port if isinstance(word, list) and word[0] in ("input", "output", "bidir"))
                ports.append((direction, texts(port)[0], point(port, corner(node))))
            parameters = {part[1]: part[2] for part in parts(node, "parameter")}
            entity, instance = texts(node)[:2]
            symbols.append((entity, instance, parameters, ports))
        elif node[0] == "connector":
            ends = [(int(part[1]), int(part[2])) for part in parts(node, "pt")]
            lines.append(ends)
            nets.join(*ends)
            for name in texts(node):
                nets.name(ends[0], name)
    ends = [at for line in lines for at in line] + [at for _, _, at in pins] + [at for symbol in symbols for _, _, at in symbol[3]]
    junctions = [point(node) for node in nodes if node[0] == "junction"]
    for line in lines:
        for at in ends:
            if at in line:
                nets.join(at, line[0])
        for at in junctions:
            if on_line(at, line):
                nets.join(at, line[0])
    return pins, symbols, nets


def width(low_high):
    return "std_logic" if low_high[1] is None else f"std_logic_vector({low_high[1]} downto {low_high[2]})"


def actual(nets, at, signals, shape):
    """The VHDL name of what is at a point; declares it."""
    names = sorted(nets.names_at(at))
    if not names:
        root = nets.root(at)
        names = [f"net_{root[0]}_{root[1]}".replace("-", "m")]
        if shape[1] is not None:
            names = [f"{names[0]}[{shape[1]}..{shape[2]}]"]
    if len(names) > 1:
        raise ValueError(f"a line has the names {names}")
    base, high, low = split_name(names[0])
    known = signals.setdefault(base, [False, 0])
    if high is not None:
        known[0], known[1] = True, max(known[1], high)
    base = f"s_{base}"
    if high is None:
        return base
    return f"{base}({high})" if shape[1] is None else f"{base}({high} downto {low})"


def to_vhdl(file, entity):
    pins, symbols, nets = read(file)
    signals, components, body = {}, {}, []
    declared = []
    for direction, name, at in pins:
        base, high, low = shape = split_name(name)
        if high is not None and high == low:  # one bit of a name, such as LED[1], is a pin of its own
            base, shape = f"{base}_{high}", (base, None, None)
        wire = actual(nets, at, signals, shape)
        declared.append(f"    {base} : {'in' if direction == 'input' else 'out'} {width(shape)}")
        body.append(f"  {wire} <= {base};" if direction == "input" else f"  {base} <= {wire};")
    for name, instance, parameters, ports in symbols:
        wires = {port: actual(nets, at, signals, split_name(port, parameters)) for _, port, at in ports}
        if name in PRIMITIVES:
            body.append("  " + PRIMITIVES[name].format(**({"OUT": next(iter(wires.values()))} if name == "GND" else wires)))
            continue
        shapes = [(direction, *split_name(port, parameters)) for direction, port, _ in ports]
        generics = "".join(f" generic ({'; '.join(f'{key} : integer' for key in parameters)});" if parameters else "")
        components[name.lower()] = (f"  component {name} is{generics} port (" + "; ".join(
            f"{base} : {'in' if direction == 'input' else 'out'} {width((base, high, low))}" for direction, base, high, low in shapes) +
            "); end component;")
        generics = f" generic map ({', '.join(f'{key} => {value}' for key, value in parameters.items())})" if parameters else ""
        body.append(f"  u_{instance} : {name}{generics} port map (" +
                    ", ".join(f"{shape[1]} => {wire}" for shape, wire in zip(shapes, wires.values())) + ");")
    print("library ieee;\nuse ieee.std_logic_1164.all;\n")
    print(f"entity {entity} is\n  port (\n" + ";\n".join(declared) + ");\nend entity;\n")
    print(f"architecture diagram of {entity} is")
    print("\n".join(components.values()))
    for base, (bus, high) in signals.items():
        print(f"  signal s_{base} : {f'std_logic_vector({high} downto 0)' if bus else 'std_logic'};")
    print("begin\n" + "\n".join(body) + "\nend architecture;")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: block_diagram.py DIAGRAM.bdf ENTITY")
    to_vhdl(sys.argv[1], sys.argv[2])
