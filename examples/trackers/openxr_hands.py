#!/usr/bin/env python3
"""Sends the hands of an OpenXR runtime to palpa, without a picture.

    openxr_hands.py [PORT]
    palpa run --scene assets/cube.glb --source joints:udp:9000

Needs Linux, pyopenxr (pip install pyopenxr), and a runtime with XR_EXT_hand_tracking, XR_MND_headless and
XR_KHR_convert_timespec_time, such as Monado's. Untried with a headset.
"""
import argparse
import ctypes
import sys
import time

import palpa_lines

try:
    import xr
except ModuleNotFoundError:
    xr = None  # --help needs none

RATE_HZ = 90
JOINTS = 26


def now():
    """The monotonic clock in seconds, and in whole seconds and nanoseconds."""
    ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    return ns * 1e-9, xr.timespec(tv_sec=ns // 10**9, tv_nsec=ns % 10**9)


class Hands:
    """The two hands of a session. The runtime writes their joints into buffers that are kept here."""

    def __init__(self, instance, session):
        local = xr.ReferenceSpaceCreateInfo(reference_space_type=xr.ReferenceSpaceType.LOCAL)
        self.space = xr.create_reference_space(session, local)
        locate = xr.get_instance_proc_addr(instance, "xrLocateHandJointsEXT")
        self.locate = ctypes.cast(locate, xr.PFN_xrLocateHandJointsEXT)
        self.hands = []
        for side, which in (("left", xr.HandEXT.LEFT), ("right", xr.HandEXT.RIGHT)):
            info = xr.HandTrackerCreateInfoEXT(hand=which, hand_joint_set=xr.HandJointSetEXT.DEFAULT)
            tracker = xr.create_hand_tracker_ext(session, info)
            joints = (xr.HandJointLocationEXT * JOINTS)()
            self.hands.append((side, tracker, joints, xr.HandJointLocationsEXT(joint_locations=joints)))

    def seen_at(self, xr_time):
        """The hands whose joints are all tracked, not guessed."""
        info = xr.HandJointsLocateInfoEXT(base_space=self.space, time=xr_time)
        tracked = int(xr.SpaceLocationFlags.POSITION_TRACKED_BIT)
        seen = []
        for side, tracker, joints, locations in self.hands:
            if self.locate(tracker, ctypes.byref(info), ctypes.byref(locations)) < 0 or not locations.is_active:
                continue
            if not all(joint.location_flags & tracked for joint in joints):
                continue
            places = [(j.pose.position.x, j.pose.position.y, j.pose.position.z) for j in joints]
            seen.append(palpa_lines.hand(side, places, [j.radius for j in joints]))
        return seen


def states(instance):
    """The states that the session has entered since the last call."""
    while True:
        try:
            event = xr.poll_event(instance)
        except xr.EventUnavailable:
            return
        if event.type == xr.StructureType.EVENT_DATA_SESSION_STATE_CHANGED:
            changed = ctypes.cast(ctypes.byref(event), ctypes.POINTER(xr.EventDataSessionStateChanged)).contents
            yield xr.SessionState(changed.state)


def main(port):
    if not xr:
        sys.exit("openxr_hands.py: pyopenxr is missing: pip install pyopenxr")
    instance = xr.create_instance(
        xr.InstanceCreateInfo(
            enabled_extension_names=[
                xr.EXT_HAND_TRACKING_EXTENSION_NAME,
                xr.MND_HEADLESS_EXTENSION_NAME,
                xr.KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME,
            ]
        )
    )
    system = xr.get_system(instance, xr.SystemGetInfo(form_factor=xr.FormFactor.HEAD_MOUNTED_DISPLAY))
    session = xr.create_session(instance, xr.SessionCreateInfo(system_id=system))
    hands = Hands(instance, session)
    sender = palpa_lines.Sender(port)
    begun = False
    while True:
        for state in states(instance):
            if state == xr.SessionState.READY:
                stereo = xr.ViewConfigurationType.PRIMARY_STEREO
                xr.begin_session(session, xr.SessionBeginInfo(primary_view_configuration_type=stereo))
                begun = True
            elif state in (xr.SessionState.STOPPING, xr.SessionState.LOSS_PENDING, xr.SessionState.EXITING):
                return
        if begun:
            t_s, timespec = now()
            sender.send(t_s, hands.seen_at(xr.convert_timespec_time_to_time_khr(instance, timespec)))
        time.sleep(1 / RATE_HZ)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", type=palpa_lines.port, nargs="?", default=9000)
    try:
        main(parser.parse_args().port)
    except KeyboardInterrupt:
        pass
