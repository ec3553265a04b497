// The docstrings of Session.
#pragma once

namespace palpa::python {

inline constexpr const char* session_doc =
    R"(A scene and its fingers over time: frame by frame, or live from cameras to a link.

Without `source`, give the frames yourself with touch(). With source="points", push_points() gives frames to a run. With
`source`, run() or start() take frames from it and play the drives to `link`, each part on its own thread. The last thing
that the link gets is always silence: at the end, after an exception in a callback, a method or a solver, after Ctrl-C,
and when the interpreter ends. Fingers keep their ids from frame to frame.

Parameters
----------
scene : Scene
depth : bool, optional
    Frames are depth images of the rig's cameras, or of `camera`, and not points.
camera : Camera, path or list of these, optional
    These cameras, or their TOML files.
nulls : array_like, shape (n, 3) or (3,), optional
    Places that stay silent, in metres, world. The solver is then gs-pat.
null_radius : float or array_like, shape (n,), optional
    The radius of each null, metres, up to 5 mm. The default, 0, is the place alone.
method : str or callable, optional
    `method` may also be a function: it gets a Finger and returns its foci, an array_like of shape (n, 3), metres, world.
solver : str or callable, optional
    `solver` may also be a function: it gets the transfer matrix (n, M) of Layout.transfer for the n foci that sound
    together, and their gains (n,), and returns a complex vector (M,) of amplitudes up to 1. It is called for each slot
    of a frame's schedule, on the thread that computes, so it should take less than a millisecond.

Raises
------
BadUsage
    Options do not go together.
BadInput
    A file is missing or broken.
NoDevice
    There is no usable GPU, but one was asked for.)";

inline constexpr const char* start_doc = R"(Start the live loop, and return at once.

Parameters
----------
frames : int, optional
    Stop after this many frames. The default, 0, runs until the source ends or stop() is called.
on_frame : callable, optional
    Called with the Touch of each frame, on the session's thread. It must return quickly; False ends the run.
on_event : callable, optional
    Called with each Event in the same way.)";

inline constexpr const char* run_doc = R"(Run the live loop until it ends, and return what it measured.

Ctrl-C ends it in silence and raises KeyboardInterrupt; a second one leaves a callback that does not return. An exception
of a callback, a method or a solver ends it in silence at once, without a ramp, and is raised here. Afterwards, the
process is as before: its limits, its handler of SIGXCPU, its locked memory, the priority of its threads.

Parameters
----------
frames : int, optional
    Stop after this many frames. The default, 0, runs until the source ends or stop() is called.
on_frame : callable, optional
    Called with the Touch of each frame, on the session's thread. It must return quickly; False ends the run.
on_event : callable, optional
    Called with each Event in the same way.

Returns
-------
RunStats)";

}  // namespace palpa::python
