// A tracker of hands as the source of a session.
#pragma once

#include <string>

#include "session/plan/setting.hpp"
#include "setup/sessions/frames.hpp"

namespace palpa::setup {

/// The shell of solids for a tracker without --delta: its joints are off by several millimetres.
inline constexpr double tracker_delta_m = 3e-3;

bool is_tracker(const std::string& source);

/// Throws bad_usage if an option is given that needs depth images, which a tracker does not have.
void refuse_image_options(const FrameOptions& options);

/// Throws bad_usage for a tracker as the source of depth images that palpa calibrate takes.
void refuse_tracker(const std::string& source);

/// Makes the setting, which has no cameras, that of a tracker.
void take_tracker(const FrameOptions& options, session::SessionSetting& setting);

}  // namespace palpa::setup
