#include "driver/sources.hpp"

#include "driver/realsense/source.hpp"
#include "driver/rosbag/source.hpp"
#include "driver/v4l2/source.hpp"

namespace palpa::driver {

std::vector<session::SourceKind> camera_sources() {
  return {v4l2::source_kind(), realsense::source_kind(), rosbag::source_kind()};
}

}  // namespace palpa::driver
