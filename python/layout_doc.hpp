// The docstrings of Layout.
#pragma once

namespace palpa::python {

inline constexpr const char* solve_doc = R"(The drive for foci that sound together, in free air or on a finger.

For one focus f, the transducer at distance d has the amplitude d / max d and the phase -k d (the paper's q_k, with
the time factor exp(-i w t)). docs/notes/gs-pat.md has the equations for several foci.

Parameters
----------
foci : array_like, shape (n, 3) or (3,)
    Metres, in the layout's own frame.
gains : array_like, shape (n,), optional
    The loudness of each focus, above 0 to 1. The default is 1.
finger : Mesh, path, (vertices, faces) or FingerSound, optional
    With transfer="finger" or solver="adjoint": a closed mesh in the layout's own frame. A FingerSound keeps the
    finger's equations, so that further drives take less time.
force : bool, optional
    Also take a finger whose faces are too coarse for the wavelength.
nulls : array_like, shape (n, 3) or (3,), optional
    Places that stay silent, in metres, in the layout's own frame. The solver is then gs-pat.
null_radius : float or array_like, shape (n,), optional
    The radius of each null, metres, up to 5 mm. The default, 0, is the place alone.
solver : str or callable, optional
    `solver` may also be a function: it gets the transfer matrix (n, M) of Layout.transfer and the gains (n,), and
    returns a complex vector (M,) of amplitudes up to 1.

Returns
-------
Drive

Raises
------
BadUsage
    A focus is at a transducer or farther than 100 m away, options do not go together, or the foci are known to be in
    another frame, as Finger.foci are in the world.
NoDevice
    There is no usable GPU, but one was asked for.)";

inline constexpr const char* transfer_doc = R"(The sound between transducers and points as the solvers use it.

G[i, t] = level D(angle) exp(i k d) / max(d, radius): the pressure at point i from transducer t at full amplitude and
phase 0, in free air without absorption. `G @ drive` is the complex pressure at the points.

Parameters
----------
points : array_like, shape (n, 3)
    Metres, in the layout's own frame.

Returns
-------
ndarray of complex128, shape (n, M)
    Pascals, peak; the time factor is exp(-i w t).)";

inline constexpr const char* from_world_doc = R"(Points of the world in the layout's own frame.

Parameters
----------
points : array_like, shape (n, 3)
    Metres, world, such as Finger.foci.
pose : array_like, shape (4, 4), optional
    From the layout's own frame to the world. The default is `default_pose`; a rig may give another.

Returns
-------
ndarray of float64, shape (n, 3)
    Metres, in the layout's own frame.)";

inline constexpr const char* field_doc = R"(The sound of a drive at places, in free air.

p = level * sum over transducers of amplitude exp(i phase) D(angle) exp((i k - alpha) r) / r

Parameters
----------
drive : Drive or array_like of complex, shape (M,)
    Amplitudes are 0 to 1.
where : Places, array_like of shape (n, 3), Mesh or (vertices, faces)
    plane() and line() make Places. Metres, in the layout's own frame.

Returns
-------
Field

Raises
------
BadUsage
    A drive of another layout, or places that are not finite or farther than 100 m away.
NoDevice
    There is no usable GPU, but one was asked for.)";

inline constexpr const char* drive_doc = R"(The complex vector of Layout.solve, which has the same arguments.

Parameters
----------
foci : array_like, shape (n, 3) or (3,)
    Metres, in the layout's own frame.
gains : array_like, shape (n,), optional
    The loudness of each focus, above 0 to 1. The default is 1.
finger : Mesh, path, (vertices, faces) or FingerSound, optional
    As for Layout.solve.
force : bool, optional
    As for Layout.solve.
nulls : array_like, shape (n, 3) or (3,), optional
    As for Layout.solve.
null_radius : float or array_like, shape (n,), optional
    As for Layout.solve.

Returns
-------
ndarray of complex128, shape (M,)
    Amplitude times exp(i phase).)";

inline constexpr const char* solve_touch_doc =
    R"(The drive for a slot of a touch. The layout stands in its default pose.

Parameters
----------
touch : Touch or path
    A touch, or a file that `palpa touch --json` wrote, or a program with Touch.json().
slot : int, optional
    In the touch's order, from 0.
nulls : array_like, shape (n, 3) or (3,), optional
    As for Layout.solve.
null_radius : float or array_like, shape (n,), optional
    As for Layout.solve.

Returns
-------
Drive)";

}  // namespace palpa::python
