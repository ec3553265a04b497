// From the options of frames to the setting of a session.
#pragma once

#include <vector>

#include "array/layouts/layout.hpp"
#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "session/plan/setting.hpp"
#include "setup/sessions/frames.hpp"

namespace palpa::setup {

/// `layout` is posed in the world. Without cameras, the session takes skin as points. Throws bad_usage as
/// drive_options does.
session::SessionSetting session_setting(const FrameOptions& options, std::vector<geometry::Solid> solids,
                                        std::vector<sensing::Camera> cameras, array::Layout layout,
                                        FingerMesh mesh = FingerMesh::unknown);

}  // namespace palpa::setup
