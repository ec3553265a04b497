"""mutate.py: good files made bad, by what they are; for fuzz.py. The same random numbers make the same bytes."""
import json
import re
import sqlite3
import struct
import zlib

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
BAD_NUMBERS = [b"nan", b"inf", b"-inf", b"1e300", b"-1e300", b"1e39", b"1e-40", b"1e-300", b"-1", b"0", b"-0", b"1", b"2", b"65536", b"2147483647",
               b"2147483648", b"4294967295", b"4294967296", b"9223372036854775807", b"18446744073709551615", b"9" * 400, b"1e", b"0x1", b"1.0.0"]
NAMES = ["../secret.txt", "..%2fsecret.txt", "%2e%2e/secret.txt", "/etc/hostname", "out-of.bin", "../../in/../secret.txt", "/dev/zero", "", ".", "..",
         "data:application/octet-stream;base64,AAAA", "data:,", "a\x00b", "\x1b[2J", "\u202egnp", "x" * 5000, "file:///etc/passwd", "%zz"]
WORDS = [0, 1, 2, 0x7f, 0x80, 0xff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000, 0xff800000, 0x00000001, 0x7149f2ca]
GARBAGE = [b"\xff\xfe", b"\x00", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"\r", b"\x1b]0;x\x07", "\u202e".encode(), b'"', b"[", b"]", b"{", b"\n\n"]


def mutated(draw, name, data):
    """One mutation of a file's bytes; the name's ending says what it is."""
    if not data:
        return draw.choice(GARBAGE)
    how = draw.random()
    if name.endswith(".glb") and how < 0.8:
        return glb_mutated(draw, data)
    if name.endswith(".png") and how < 0.7:
        return png_mutated(draw, data)
    if name.endswith(".json") and how < 0.6:
        return json_mutated(draw, data)
    if name.endswith(".wav") and how < 0.6:
        return wav_mutated(draw, data)
    if name.endswith((".toml", ".csv", ".json", ".txt", ".tsv")) and how < 0.95:
        return text_mutated(draw, data)
    if name.endswith(".ply"):
        head = data.find(b"end_header\n") + 11
        if how < 0.4:
            return text_mutated(draw, data[:head]) + data[head:]
        if b"format ascii" in data[:head] and how < 0.9:
            return data[:head] + text_mutated(draw, data[head:])
    return bytes_mutated(draw, data)


def wav_mutated(draw, data):
    """One field of the header: sizes, format, channels, rates, bits."""
    at, size = draw.choice([(4, 4), (16, 4), (20, 2), (22, 2), (24, 4), (28, 4), (32, 2), (34, 2), (40, 4)])
    return data[:at] + struct.pack("<I", draw.choice([*WORDS, 2, 3, 8, 17, 24, 32, 100000000]))[:size] + data[at + size:]


def bytes_mutated(draw, data):
    data, at = bytearray(data), draw.randrange(max(1, len(data)))
    how = draw.randrange(7)
    if how == 0 and data:
        for _ in range(draw.choice([1, 1, 8, 64])):
            data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    elif how == 1:
        del data[at:]
    elif how == 2:
        del data[at:at + draw.choice([1, 4, 100])]
    elif how == 3:
        data[at:at] = data[:draw.choice([1, 4, 512])]
    elif how == 4:
        data += bytes(draw.choice([1, 4, 70000]))
    elif how == 5:
        data[at:at + 64] = draw.choice(GARBAGE)
    else:
        for _ in range(draw.choice([1, 3])):
            at = draw.randrange(max(1, len(data))) & ~3
            data[at:at + 4] = struct.pack("<I", draw.choice(WORDS))
    return bytes(data)


def text_mutated(draw, data):
    how = draw.randrange(9)
    numbers = [match.span() for match in NUMBER.finditer(data)]
    lines = data.split(b"\n")
    if how < 4 and numbers:
        begin, end = draw.choice(numbers)
        return data[:begin] + draw.choice(BAD_NUMBERS) + data[end:]
    line = draw.randrange(len(lines))
    if how == 4:
        lines.insert(line, lines[line])
    elif how == 5:
        del lines[line]
    elif how == 6:
        deep = draw.choice([10, 129, 1000, 100000])
        begin, end = draw.choice(numbers) if numbers else (0, 0)
        return data[:begin] + b"[" * deep + b"]" * draw.choice([deep, 0]) + data[end:]
    elif how == 7:
        quoted = [match.span(1) for match in re.finditer(rb'"([^"\n]*)"', data)]
        if quoted:
            begin, end = draw.choice(quoted)
            return data[:begin] + draw.choice(NAMES).encode() + data[end:]
    else:
        at = draw.randrange(len(data) + 1)
        return data[:at] + draw.choice(GARBAGE) + data[at:]
    return b"\n".join(lines)


def places_of(value, found):
    """All (container, key) of a JSON value."""
    waiting = [value]
    while waiting:
        one = waiting.pop()
        for key in list(one) if isinstance(one, dict) else range(len(one)):
            found.append((one, key))
            if isinstance(one[key], (dict, list)):
                waiting.append(one[key])
    return found


def json_mutated(draw, data):
    try:
        value = json.loads(data)
    except (ValueError, RecursionError):
        return text_mutated(draw, data)
    places = places_of(value, []) if isinstance(value, (dict, list)) else []
    if not places:
        return text_mutated(draw, data)
    # The short lists and objects are more interesting than a thousandth index.
    place = draw.choice(places)
    for _ in range(3):
        if isinstance(place[0], list) and len(place[0]) > 20:
            place = draw.choice(places)
    inside, key = place
    how = draw.randrange(8)
    number = draw.choice([-1, 0, 1, 2, 3, 7, 1e300, -1e300, 1e39, 1e-40, 1e-7, 1e30, 65536, 2**31, 2**32, 2**63, 2**64, 0.5, True, None])
    if how < 3:
        inside[key] = number
    elif how == 3:
        del inside[key]
    elif how == 4:
        inside[key] = draw.choice([[], {}, "", "x", [number] * 3, {"a": number}, draw.choice(NAMES)])
    elif how == 5:
        if isinstance(inside, list):
            inside += [inside[key]] * draw.choice([1, 1, 100, 3000])
        else:
            inside[key] = [inside[key]] * draw.choice([2, 100])
    elif how == 6:
        strings = [(one, name) for one, name in places if isinstance(one[name], str)]
        if strings:
            one, name = draw.choice(strings)
            one[name] = draw.choice(NAMES)
    text = json.dumps(value).encode()
    if how == 7:  # a key twice, or something nested
        match = draw.choice(list(re.finditer(rb'"\w+": ', text)) or [None])
        if match:
            deep = draw.choice([1, 127, 200, 20000])
            nested = draw.choice([draw.choice(BAD_NUMBERS), b"[" * deep + b"]" * deep, b'{"a":' * deep + b"1" + b"}" * deep])
            text = text[:match.start()] + match.group() + nested + b", " + text[match.start():]
    return text


def glb_of(document, binary):
    """A .glb of a JSON chunk (bytes) and a binary one."""
    document += b" " * (-len(document) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<II", len(document), 0x4e4f534a) + document
    if binary:
        chunks += struct.pack("<II", len(binary), 0x4e4942) + binary
    return struct.pack("<III", 0x46546c67, 2, 12 + len(chunks)) + chunks


def glb_mutated(draw, data):
    if len(data) < 20:
        return bytes_mutated(draw, data)
    size = struct.unpack_from("<I", data, 12)[0]
    document, binary = data[20:20 + size], data[28 + size:]
    if draw.random() < 0.25:
        return glb_of(document, bytes_mutated(draw, binary) if binary else b"")
    return glb_of(json_mutated(draw, document), binary)


def png_mutated(draw, data):
    """A chunk is changed and gets its checksum, so that what is behind it is reached."""
    chunks, at = [], 8
    while at + 12 <= len(data):
        size = struct.unpack_from(">I", data, at)[0]
        chunks.append([data[at + 4:at + 8], data[at + 8:at + 8 + size]])
        at += 12 + size
    if not chunks:
        return bytes_mutated(draw, data)
    how, chunk = draw.randrange(6), draw.choice(chunks)
    if how == 0:
        chunks.remove(chunk)
    elif how == 1:
        chunks.insert(draw.randrange(len(chunks)), chunk)
    elif how == 2:
        chunk[0] = draw.choice([b"tRNS", b"PLTE", b"gAMA", b"IDAT", b"IEND", b"\xff\x00\x1b[", b"iTXt"])
    elif how == 3 and chunks[0][1]:
        head = bytearray(chunks[0][1])
        field = draw.randrange(7)
        if field < 2:
            head[4 * field:4 * field + 4] = struct.pack(">I", draw.choice(WORDS))
        else:
            head[6 + field:7 + field] = bytes([draw.randrange(256)])
        chunks[0][1] = bytes(head)
    else:
        chunk[1] = bytes_mutated(draw, chunk[1]) if chunk[1] else b"\x00" * 100
    out = data[:8]
    for name, body in chunks:
        out += struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
    return out


# ---- made up ---------------------------------------------------------------------------------------------------------

CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def octahedron_ply(radius):
    points = [(radius, 0, 0), (-radius, 0, 0), (0, radius, 0), (0, -radius, 0), (0, 0, radius), (0, 0, -radius)]
    return ply_of(points, [(a, c, e) if (a + c + e) % 2 == 0 else (c, a, e) for a in (0, 1) for c in (2, 3) for e in (4, 5)])


def ply_of(points, faces):
    head = ("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(points), len(faces)))
    lines = ["%.9g %.9g %.9g" % tuple(point) for point in points] + ["3 %d %d %d" % tuple(face) for face in faces]
    return (head + "\n".join(lines) + "\n").encode()


def boxes(draw):
    """Boxes: beside each other, within each other, thin and tilted, tiny and huge ones together."""
    count, kind = draw.choice([1, 2, 3, 30, 300, 1500]), draw.randrange(5)
    scale = draw.choice([1, 1, 1, 1e-3, 1e-40, 1e-18, 1e3, 1e20])
    points, faces = [], []
    for i in range(count):
        size, place, tilt = [0.002] * 3, [draw.uniform(-0.05, 0.05) for _ in range(3)], 0
        if kind == 1:
            size, place = [0.05 * (i + 1) / count] * 3, [0, 0, 0]
        elif kind == 2:
            size, tilt = [0.05, 0.0001, 0.0001], 1
        elif kind == 3:
            size = [0.002 * 10 ** draw.uniform(-16, 1)] * 3
        elif kind == 4:
            place = [0.001 * (i % 40), 0.001 * (i // 40), 0]
        for corner in CORNERS:
            x, y, z = (corner[k] * size[k] for k in range(3))
            if tilt:
                x, y, z = 0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y, z + 0.5 * x
            points.append([scale * (value + place[k]) for k, value in enumerate((x, y, z))])
        faces += [[8 * i + corner for corner in face] for face in FACES]
    return points, faces


def boxes_ply(draw):
    return ply_of(*boxes(draw))


def boxes_glb(draw):
    """A scene of boxes as one mesh, which some nodes show."""
    points, faces = boxes(draw)
    big = 3.0e38
    points = [[max(-big, min(big, value)) for value in point] for point in points]
    vertices = b"".join(struct.pack("<3f", *point) for point in points)
    corners = b"".join(struct.pack("<3I", *face) for face in faces)
    nodes = [{"mesh": 0}]
    for _ in range(draw.choice([0, 0, 0, 2, 100, 2000])):
        node = {"mesh": 0, "translation": [draw.uniform(-0.2, 0.2) for _ in range(3)]}
        if draw.random() < 0.1:
            node["scale"] = [draw.choice([1, 2, -1, 1e-6, 1e-20])] * 3
        nodes.append(node)
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                "buffers": [{"byteLength": len(vertices) + len(corners)}],
                "bufferViews": [{"buffer": 0, "byteLength": len(vertices)},
                                {"buffer": 0, "byteOffset": len(vertices), "byteLength": len(corners)}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                               "min": [min(point[k] for point in points) for k in range(3)],
                               "max": [max(point[k] for point in points) for k in range(3)]},
                              {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"}]}
    return glb_of(json.dumps(document).encode(), vertices + corners)


def small_database():
    """A recording of ROS 2 with a depth camera and one image of 16 x 8 pixels."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    def text(value):
        return struct.pack("<I", len(value) + 1) + value + b"\0"

    png = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 16, 8, 16, 0, 0, 0, 0)) +
           chunk(b"IDAT", zlib.compress((b"\0" + b"\2\x58" * 16) * 8)) + chunk(b"IEND", b""))
    head = bytes(8) + text(b"Depth") + bytes(2) + text(b"16UC1; compressedDepth png") + bytes(1)
    said = ((b"camera_info", "String", text(b"width=16;height=8;fx=40;ppx=8;fy=41;ppy=4;model=Brown Conrady;coeffs=0,0,0,0,0")),
            (b"info", "String", text(b"encoding=Z16;fps=30")),
            (b"image/data/compressedDepth", "CompressedImage", head + struct.pack("<I", 12 + len(png)) + bytes(12) + png))
    base = sqlite3.connect(":memory:")
    base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL)")
    base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    for number, (name, kind, data) in enumerate(said, 1):
        package = "std_msgs" if kind == "String" else "sensor_msgs"
        base.execute("INSERT INTO topics VALUES(?, ?, ?)", (number, f"/device_0/sensor_0/Depth_0/{name.decode()}", f"{package}/msg/{kind}"))
        base.execute("INSERT INTO messages VALUES(?, ?, 0, ?)", (number, number, b"\0\1\0\0" + data))
    base.commit()
    return base.serialize()


def small_bag():
    """The beginning of a bag, and a chunk that is not whole."""
    def record(fields, data):
        head = b"".join(struct.pack("<I", len(field)) + field for field in fields)
        return struct.pack("<I", len(head)) + head + struct.pack("<I", len(data)) + data

    return (b"#ROSBAG V2.0\n" + record([b"op=\x03", b"index_pos=" + bytes(8), b"conn_count=" + bytes(4), b"chunk_count=\x01\0\0\0"], b" " * 4027) +
            record([b"op=\x05", b"compression=none", b"size=\x64\0\0\0"], bytes(100)))
