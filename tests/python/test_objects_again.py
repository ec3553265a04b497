"""What outlives a call of an object: after all other calls, each call gives what it gives on a new object."""
import json

import numpy as np
import pytest

import palpa
from commands import ROOT, drives_in, same_but_times

pytestmark = pytest.mark.filterwarnings("ignore::palpa.PalpaWarning")
TAKE = f"recording:{ROOT}/assets/depth/take"
FOCI = [[0, 0, 0.1], [0.02, 0, 0.12]]


def solve(**options):
    return lambda layout: same_but_times(layout.solve(FOCI, backend="cpu", **options).json())


def field(**options):
    return lambda layout: np.asarray(layout.field(layout.drive(FOCI[0], backend="cpu"), FOCI, backend="cpu", **options).pressure).view(float).tolist()


def touch(**options):
    return lambda scene: same_but_times(scene.touch(options.get("skin", "assets/finger.ply"), backend="cpu", **{key: options[key] for key in options if key != "skin"}).json())


def export(**options):
    return lambda scene: {key: np.asarray(value).tolist() for key, value in palpa.export(scene, TAKE, backend="cpu", **options).foci.items()}


def run(**options):
    """What a run of this scene gives, without what depends on when."""
    def told(scene, folder):
        return of_a_run(palpa.Session(scene, **SOURCE, **outputs(folder), **options), folder)
    return told


SOURCE = {"source": TAKE, "every_frame": True, "hold": "500ms", "layout": "openmpd", "backend": "cpu"}


def outputs(folder):
    return {"link": f"record:{folder}/drives.bin", "events": folder / "events.jsonl", "event_move": 0}


def of_a_run(session, folder):
    stats = session.run(frames=6)
    return stats.frames, stats.touching, round(float(drives_in(folder / "drives.bin").max()), 5), (folder / "events.jsonl").read_text()


def played(**options):
    def of(sensation, folder):
        sensation.play(duration="30ms", link=f"record:{folder}/drives.bin", layout="openmpd", **options)
        kinds = np.unique(drives_in(folder / "drives.bin").round(5), axis=0)
        return len(kinds) > 1, kinds[-1].tolist()
    return of


def evaluated(**parameters):
    return lambda sensation: [np.asarray(one).tolist() for one in sensation.evaluate(np.arange(20) * 1e-3, parameters)]


CASES = {
    "a layout": (lambda: palpa.Layout("openmpd"), [solve(), solve(solver="greedy"), solve(temperature=30), solve(frequency=41e3), solve(directivity="piston"), solve(nulls=[[0, 0.03, 0.1]]),
                                                   solve(spread="phase=0.1", draws=20), solve(spread="phase=0.1", draws=20, seed=3), field(), field(humidity=20), field(temperature=30)]),
    "a scene": (lambda: palpa.Scene("assets/cube.glb"), [touch(penetration=3e-3), touch(penetration=1e-3), touch(penetration=3e-3, delta=1e-3), touch(penetration=3e-3, method="single-focus"),
                                                         touch(penetration=3e-3, layout="openmpd"), touch(penetration=3e-3, layout="autd3", pressure=200), touch(penetration=2e-3, foci=7), export(), export(delta=1e-3), export(predict_latency="20ms", hysteresis="off")]),
    "a sensation": (lambda: palpa.Sensation("heartbeat"), [evaluated(), evaluated(rate=80.0), evaluated()])}


@pytest.mark.parametrize("kind", CASES)
def test_a_call_does_not_depend_on_those_before(kind):
    make, calls = CASES[kind]
    fresh = [call(make()) for call in calls]
    warm = make()
    for _ in range(2):
        assert [call(warm) for call in calls] == fresh
    assert [call(warm) for call in calls[::-1]] == fresh[::-1]
    assert len({json.dumps(one) for one in fresh}) >= len(fresh) - 1, "the calls differ"


def test_runs_do_not_depend_on_those_before(tmp_path):
    scene = palpa.Scene("assets/cube.glb")
    runs = [run(), run(ceiling=0.5, delta=1e-3)]
    fresh = [one(palpa.Scene("assets/cube.glb"), tmp_path) for one in runs]
    assert [one(scene, tmp_path) for one in runs] == fresh and runs[0](scene, tmp_path) == fresh[0]
    session = palpa.Session(scene, **SOURCE)
    told = []
    for _ in range(2):
        events = []
        stats = session.run(frames=6, on_event=lambda event: events.append((event.kind, event.solid, event.depth, event.centroid.tolist())))
        told.append((stats.frames, stats.touching, events))
    assert told[0][:2] == fresh[0][:2] and told[0][2] and told[1] == told[0]


def test_sensations_do_not_depend_on_those_before(tmp_path):
    plays = [played(), played(ceiling=0.5), played(at="0,0,0.1")]
    fresh = [one(palpa.Sensation("heartbeat"), tmp_path) for one in plays]
    warm = palpa.Sensation("heartbeat")
    for one, wanted in zip(plays + plays, fresh + fresh):
        sounds, loudest = one(warm, tmp_path)
        assert sounds == wanted[0] and np.allclose(max(loudest), max(wanted[1]), atol=1e-3)
