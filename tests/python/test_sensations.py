"""Sensations: values, and what plays while other threads change it."""
import threading
import time

import numpy as np
import pytest

import palpa
from commands import ROOT, drives_in, run


def circle(times):
    turn = 2 * np.pi * 100 * times
    return np.stack([0.01 * np.cos(turn), 0.01 * np.sin(turn), np.full_like(times, 0.15)], axis=1), np.full_like(times, 0.5)


def test_a_pattern_is_where_the_command_says(tmp_path):
    table = run(["play", "heartbeat", "--duration", "500ms", "--param", "rate=90", "--csv", "-", "--quiet"])
    rows = np.genfromtxt(table.splitlines(), delimiter=",", names=True)
    beat = palpa.Sensation("heartbeat", rate=90)
    assert beat.parameters == {"loop": 1.0, "rate": 90.0}
    times = np.arange(0, 0.5, 0.05e-3)
    places, gains = beat.evaluate(times)
    assert places.shape == (10000, 3) and gains.shape == (10000,)
    steps = np.rint(rows["time_s"] / 0.05e-3).astype(int)
    met = np.isclose(steps * 0.05e-3, rows["time_s"], atol=1e-12)
    assert met.sum() >= 390
    assert np.allclose(places[steps[met]], np.stack([rows["x_m"], rows["y_m"], rows["z_m"]], axis=1)[met], atol=1e-12)
    assert np.allclose(gains[steps[met]], rows["gain"][met], atol=1e-12)


def test_where_there_is_no_place_there_is_silence():
    ring = palpa.Sensation("circle")
    text = (ROOT / "assets/sensations/circle.adaptics").read_text(encoding="utf-8")
    zero = '{"type": "constant", "value": 0}'
    ring.set_pattern(text.replace('{"type": "param", "value": "radius"}',
                                  '{"type": "formula", "value": {"type": "divide", "value": [%s, %s]}}' % (zero, zero)))
    places, gains = ring.evaluate([0, 0.1])
    assert not np.isfinite(places).all(axis=1).any() and gains.tolist() == [0, 0]


def test_parameters_are_those_that_were_given_last():
    beat = palpa.Sensation("heartbeat", rate=90)
    beat.set(rate=45)
    assert beat.parameters == {"loop": 1.0, "rate": 45.0}
    beat.set(loop=0)
    assert beat.parameters == {"loop": 0.0, "rate": 70.0}


def test_parameters_may_differ_from_time_to_time_and_details_are_raw():
    ring = palpa.Sensation("circle")
    got = ring.evaluate([0, 0.1], {"radius": [5, 20]}, details=True)
    assert np.allclose(got["places"][:, 0], [5e-3, 20e-3])
    assert got["stops"].tolist() == [False, False] and np.allclose(got["pattern_times"], [0, 0.1])
    assert np.allclose(got["intensities"], 1)
    assert np.allclose(ring.evaluate([0])[0][0, 0], 0.01)  # the usual radius again
    with pytest.raises(palpa.BadUsage, match="radius has 3 values for 2 times"):
        ring.evaluate([0, 0.1], {"radius": [1, 2, 3]})
    with pytest.raises(palpa.BadUsage, match="no parameter 'width'; it has radius"):
        palpa.Sensation("circle", width=3)


def test_a_matrix_need_not_be_rigid():
    point = palpa.Sensation("point")
    for matrix, height in ((np.eye(4), 0.2), (np.diag([2, 2, 2, 1.0]), 0.4), (np.diag([1, 1, 1, 2.0]), 0.1)):
        point.set_matrix(matrix)
        assert np.allclose(point.evaluate([0])[0], [[0, 0, height]])
    point.set_matrix(np.diag([1, 1, 1, 0.0]))
    with pytest.warns(palpa.PalpaWarning, match="not a finite number: silence there"):
        point.play(layout="openmpd", link="record:/dev/null", duration=0.01)
    with pytest.raises(palpa.BadUsage, match="not all of its numbers are finite"):
        point.set_matrix(np.diag([1, 1, 1, np.nan]))


def test_its_speed_is_that_of_the_command(tmp_path):
    files = tmp_path / "own.bin", tmp_path / "command.bin"
    palpa.Sensation("sweep").play(speed=2, layout="openmpd", link=f"record:{files[0]}", duration=0.05)
    run(["play", "sweep", "--speed", "2", "--layout", "openmpd", "--link", f"record:{files[1]}", "--duration", "50ms"])
    assert files[0].read_bytes() == files[1].read_bytes()
    with pytest.raises(palpa.BadUsage, match="speed is for a pattern"):
        palpa.Sensation(circle).play(speed=2, layout="openmpd", duration=0.01)


def test_the_next_play_has_options_of_its_own(tmp_path):
    def play(sensation, name, **options):
        sensation.play(layout="openmpd", link=f"record:{tmp_path / name}", **({"duration": 0.05} | options))
        return (tmp_path / name).read_bytes()
    used = palpa.Sensation("sweep")
    usual = play(palpa.Sensation("sweep"), "usual.bin")
    for options in ({"speed": 2}, {"at": (0.01, 0, 0.1)}, {"dwell": 0.5e-3}, {"duration": 0.02}, {"ceiling": 0.5}):
        assert play(used, "other.bin", **options) is not None
        assert play(used, "again.bin") == usual, options


def test_a_function_plays_and_is_recorded(tmp_path):
    file = tmp_path / "drives.bin"
    own = palpa.Sensation(circle)
    places, gains = own.evaluate([0, 0.0025])
    assert np.allclose(places, [[0.01, 0, 0.15], [0, 0.01, 0.15]]) and np.allclose(gains, 0.5)
    stats = own.play(layout="openmpd", link=f"record:{file}", duration=0.02, dwell=0.5e-3)
    assert stats == {"drives": 40, "silent_drives": 0, "skipped_slots": 0, "lost": 0}
    drives = drives_in(file)
    assert drives.shape == (41, 256) and np.allclose(drives[:-1], 0.5) and not drives[-1].any()


def test_what_a_function_raises_ends_it():
    def broken(times):
        if times[-1] > 0.15:
            raise RuntimeError("the function's own")
        return circle(times)
    with pytest.raises(RuntimeError, match="the function's own"):
        palpa.Sensation(broken).play(layout="openmpd", duration=5)
    with pytest.raises(palpa.BadUsage, match="must return places"):
        palpa.Sensation(lambda times: times).evaluate([0])


def wait_for(condition):
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_other_threads_change_it_while_it_plays():
    ring = palpa.Sensation("circle")
    ring.pause()
    stats = []
    thread = threading.Thread(target=lambda: stats.append(ring.play(layout="openmpd", ends=False, paused=True)))
    thread.start()
    radius = lambda: round(1e3 * np.hypot(*ring.newest(1)[0]["place"][:2]), 6)  # noqa: E731
    try:
        assert not ring.newest() and not ring.playing
        for _ in range(2):
            ring.start(time=3)
            wait_for(ring.newest)
            assert ring.newest(1)[0]["pattern_time"] >= 3
            ring.set(radius=20)
            wait_for(lambda: radius() == 20)
            ring.set()
            wait_for(lambda: radius() == 10)
            with pytest.raises(palpa.BadUsage):
                ring.play(layout="openmpd")
            with pytest.raises(palpa.BadInput):
                ring.set_pattern("{}")
            assert ring.playing
            ring.pause()
            assert not ring.playing
    finally:
        ring.stop()
        thread.join()
    assert stats[0]["drives"] > 0
    assert ring.play(layout="openmpd", duration=0.02)["drives"] > 0  # again
