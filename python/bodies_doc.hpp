// The docstrings of simulate and figure6.
#pragma once

namespace palpa::python {

inline constexpr const char* simulate_doc =
    R"(Press a rigid finger into a scene and focus the array on its skin, as in a live run.

The result is the radiation pressure of linear sound, scattered by the finger (boundary elements), on the finger.

Parameters
----------
scene : Scene
finger : FingerBody, Mesh, path or (vertices, faces)
    A closed mesh, tip at the origin, body along +y, metres. A FingerBody keeps the equations, so that further arrays
    and methods take less time.
penetration : float or str, optional
    How far the finger's lowest point is below the solids' top, metres.
skin : {"vertices", "cameras"}, optional
    Which skin touches: the mesh's vertices, or what the rig's cameras would see of it.
noise_free : bool, optional
    With skin="cameras": cameras without the sensor's noise.
bare_elongation : bool, optional
    Also compute `Simulation.bare_elongation`.
force : bool, optional
    Also take a finger whose faces are too coarse for the wavelength.

Returns
-------
Simulation

Raises
------
BadInput
    The finger touches nothing, is no closed mesh, or meets the array.
BadUsage
    Options do not go together.
NoDevice
    There is no usable GPU, but one was asked for.)";

inline constexpr const char* figure6_doc =
    R"(The paper's Fig. 6: the finger in each of the paper's objects, with every method.

Parameters
----------
finger : FingerBody, Mesh, path or (vertices, faces)
    As for simulate().
penetration : float or str, optional
    How far the finger's lowest point is below the solids' top, metres.
skin : {"vertices", "cameras"}, optional
    Which skin touches.
noise_free : bool, optional
    With skin="cameras": cameras without the sensor's noise.
force : bool, optional
    Also take a finger whose faces are too coarse for the wavelength.

Returns
-------
Figure6)";

}  // namespace palpa::python
