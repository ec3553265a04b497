"""Files: what is read is not overwritten, and a Scene that is read again is read as before."""
import json
import shutil
import struct

import numpy as np
import pytest

import palpa
from commands import begins

TAKE = "assets/depth/take"


def two_scenes(file):
    """The cube, and in a second glTF scene the same cube one metre lower."""
    data = open("assets/cube.glb", "rb").read()
    length, = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20:20 + length])
    document["scenes"].append({"nodes": [1]})
    document["nodes"].append({"name": "low", "mesh": 0, "translation": [0, -1, 0]})
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + data[20 + length:]
    file.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


def test_a_scene_that_is_read_again_is_read_as_before(tmp_path):
    file = tmp_path / "two.glb"
    two_scenes(file)
    low = palpa.Scene(file, gltf_scene=1)
    assert [solid.name for solid in low] == ["low"]
    assert [one["solid"] for one in palpa.decompose(low, parts=1).solids] == ["low"]
    assert len(palpa.export(low, f"recording:{TAKE}", backend="cpu").foci["x"]) == 0
    assert len(palpa.export(palpa.Scene(file), f"recording:{TAKE}", backend="cpu").foci["x"]) > 50
    parts = palpa.Scene("assets/cube.glb", surface="parts", parts=2)
    assert palpa.export(parts, f"recording:{TAKE}", backend="cpu").json() == palpa.export(
        "assets/cube.glb", f"recording:{TAKE}", surface="parts", parts=2, backend="cpu").json()
    for keyword in ({"gltf_scene": 0}, {"surface": "mesh"}):
        with pytest.raises(palpa.BadUsage, match="goes with the path of a scene"):
            palpa.export(low, f"recording:{TAKE}", backend="cpu", **keyword)
    with pytest.raises(palpa.BadUsage, match="goes with the path of a scene"):
        palpa.decompose(low, gltf_scene=0)


@pytest.mark.parametrize("output", ["drives", "foci", "events"])
def test_an_export_replaces_no_input(tmp_path, output):
    # The ending decides nothing about a model; the foci's file must end in .csv or .json.
    scene = tmp_path / "cube.json"
    shutil.copy("assets/cube.glb", scene)
    before = scene.read_bytes()
    with pytest.raises(palpa.BadUsage, match="cube.json is read by this command"):
        palpa.export(scene, f"recording:{TAKE}", backend="cpu", **{output: str(scene)})
    assert scene.read_bytes() == before


@pytest.mark.parametrize("source", ["points", "synthetic"])
def test_a_run_replaces_no_input(tmp_path, source):
    file = tmp_path / "cube.glb"
    shutil.copy("assets/cube.glb", file)
    before = file.read_bytes()
    session = palpa.Session(palpa.Scene(file), source=source, layout="openmpd", link=f"record:{file}", backend="cpu")
    with pytest.raises(palpa.BadUsage, match="cube.glb is read by this command"):
        session.run(frames=1)
    assert file.read_bytes() == before


def test_an_export_writes_its_files(tmp_path):
    palpa.export("assets/cube.glb", f"recording:{TAKE}", foci=tmp_path / "foci.csv", drives=tmp_path / "drives.bin",
                 events=tmp_path / "events.jsonl", layout="openmpd", backend="cpu")
    table = np.genfromtxt(tmp_path / "foci.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert len(table) > 50 and (tmp_path / "drives.bin").read_bytes()[:8] == b"palpadrv"
    assert json.loads((tmp_path / "events.jsonl").read_text().splitlines()[0])


@pytest.mark.parametrize("options", [{"link": "record:{}"}, {"events": "{}"}, {"source": "points", "link": "record:{}"}])
def test_a_run_does_not_replace_the_file_of_an_earlier_one(cube, tmp_path, options):
    file = tmp_path / "kept"
    options = {"source": "synthetic", "layout": "openmpd", "backend": "cpu", **options}
    session = palpa.Session(cube, **{name: value.format(file) for name, value in options.items()})

    def run():
        session.start(frames=5)
        if options["source"] == "points":
            begins(lambda: file.exists() and not file.read_bytes().startswith(b"replaced"))
            session.stop()
        session.wait()

    file.write_text("replaced by the first run, as on the command line")
    run()
    kept = file.read_bytes()
    assert not kept.startswith(b"replaced")
    with pytest.raises(palpa.BadUsage, match=f"an earlier run of this session wrote {file}.*another file, or delete"):
        session.start(frames=5)
    assert not session.running and file.read_bytes() == kept
    file.unlink()
    run()
    assert file.is_file()
