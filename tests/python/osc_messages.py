"""OSC messages as raw datagrams, made by the description in docs/live-control.md."""
import struct


def padded(text):
    data = text.encode() + b"\0"
    return data + b"\0" * (-len(data) % 4)


def message(address, types="", *values):
    """One message: f and d are floats, i and h integers, s a text; T and F have no bytes."""
    data = padded(address) + padded("," + types)
    for kind, value in zip(types, values):
        data += padded(value) if kind == "s" else struct.pack(">" + {"h": "q"}.get(kind, kind), value)
    return data


def bundle(*packets):
    return b"#bundle\0" + b"\0" * 7 + b"\1" + b"".join(struct.pack(">i", len(packet)) + packet for packet in packets)
