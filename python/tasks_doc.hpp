// The docstrings of parts, calibration and recordings.
#pragma once

namespace palpa::python {

inline constexpr const char* decompose_doc = R"(Cut the solids of a model into convex parts, as in the paper (V-HACD).

Parameters
----------
scene : Scene or path
    A glTF file. Parts are cut from the file's meshes. The file of a Scene is read again, with the Scene's `gltf_scene`.

Returns
-------
Parts

Raises
------
BadInput
    There is no mesh that can be touched, or one that cannot be cut.)";

inline constexpr const char* parts_solids_doc =
    R"(list of dict, one for each solid: solid, parts (list of Mesh), volume_ratio, error_mean, error_p95, error_max
(m, from the parts' surface to the mesh), mesh_error_mean, mesh_error_p95, mesh_error_max (m, from the mesh to the
parts' surface), filled_cavities, internal_share and seconds.)";

inline constexpr const char* calibrate_doc =
    R"(Find the poses of a rig's cameras, from frames of the target (docs/calibration.md).

Returns
-------
Calibration

Raises
------
BadInput
    A camera does not see the target, or the rig is broken.)";

inline constexpr const char* target_doc = R"(Write the target, as palpa calibrate --target does (docs/calibration.md).

Parameters
----------
file : path
    .stl writes it for a printer, in millimetres. .glb writes it in its place in the world, for a viewer.

Raises
------
BadUsage
    The file has another ending, or a place was given for a printer's file.)";

inline constexpr const char* nudged_doc =
    R"(Write a rig with its array moved, as palpa calibrate --nudge does (docs/calibration.md).

Parameters
----------
file : path
    The TOML file to write.
offset : array_like, shape (3,)
    The offset, given to Session.set_aim, at which foci were felt where they were seen. Metres, world; at most 5 cm
    along each axis. The array of the new rig is moved by this offset in the opposite direction.

Raises
------
BadUsage
    The offset is larger.)";

inline constexpr const char* background_doc = R"(Learn what cameras see without a hand (docs/calibration.md).

Parameters
----------
out : path, optional
    The rig that is written, with the names of the images that are written beside it. Without it, nothing is written.

Returns
-------
Background

Raises
------
BadInput
    The rig and the source have different cameras, or a file is broken.
Error
    The source has fewer than 10 frames.)";

inline constexpr const char* recording_doc = R"(Depth frames that `palpa run --record` wrote.

Parameters
----------
folder : path

Raises
------
BadInput
    The folder has no recording, or a broken one.)";

inline constexpr const char* images_doc = R"(The depth images of a frame.

Parameters
----------
frame : int

Returns
-------
list of Any
    An array of uint16 for each camera, shape (height, width), in the camera's depth unit; 0 means no data.)";

inline constexpr const char* export_doc = R"(Play a source on its own clock, and take what all its frames give.

Parameters
----------
scene : Scene or path
    The file of a Scene is read again, as it was read for the Scene.
source : Recording, str or path
    A Recording, or what --source takes: "recording:DIR", "bag:FILE", "synthetic".

Returns
-------
Export

Raises
------
BadUsage
    The source does not end by itself and `frames` is missing, or options do not go together.
BadInput
    A file is missing or broken.)";

inline constexpr const char* export_played_doc = R"(Compute the drives of foci that were played before, and write them.

Parameters
----------
played : path
    A JSON file of foci that `export` or a touch of a study wrote.
drives : path
    File for the drive of every slot (docs/run.md).

Returns
-------
str
    What `palpa export --played --json` writes.

Raises
------
BadUsage
    Options do not go together.
BadInput
    A file is missing or broken.)";

}  // namespace palpa::python
