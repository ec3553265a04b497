#include "setup/sessions/tracker.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/error.hpp"
#include "session/links/spec.hpp"

namespace palpa::setup {

bool is_tracker(const std::string& source) {
  return session::parse_spec(source).name == "joints";
}

void refuse_image_options(const FrameOptions& o) {
  refuse_finger_width(o.touch, "depth cameras");
  for (const auto& [name, given] : {std::pair<std::string, bool>("--hysteresis", o.hysteresis.has_value()),
                                    {"--keep-boards", o.keep_boards},
                                    {asks_for_finger(o.drive), !asks_for_finger(o.drive).empty()}}) {
    if (given) throw bad_usage(fmt::format("{} goes with depth cameras: --source joints has no depth images", name));
  }
}

void refuse_tracker(const std::string& source) {
  if (is_tracker(source))
    throw bad_usage("--source joints has no depth images; palpa calibrate --nudge finds where a tracker stands");
}

void take_tracker(const FrameOptions& o, session::SessionSetting& setting) {
  setting.tracked = true;
  if (!o.touch.delta_given) setting.touch.delta_m = tracker_delta_m;
}

}  // namespace palpa::setup
