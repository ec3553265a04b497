"""Scenes that differ a little from those in assets/."""
import json
import struct


def with_node(glb, **keys):
    """A .glb whose first node has these keys."""
    (length,) = struct.unpack_from("<I", glb, 12)
    document = json.loads(glb[20:20 + length])
    document["nodes"][0].update(keys)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[20 + length:]
    return glb[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text)) + glb[16:20] + text + rest
