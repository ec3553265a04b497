// A source of emulated cameras at 90 Hz, and the properties of its sets that tests check.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/made_up_cameras.hpp"
#include "driver/cameras/made_up_frames.hpp"
#include "driver/v4l2/source.hpp"

namespace palpa::driver::v4l2::test {

using cameras::test::described;
using cameras::test::frame_of;
inline constexpr double period_s = 1.0 / 90;

inline std::unique_ptr<sensing::DepthSource> open(Machine& machine, const std::vector<std::string>& nodes,
                                                  std::vector<sensing::Camera> cameras = {}) {
  while (cameras.size() < nodes.size())
    cameras.push_back(described("camera " + std::to_string(cameras.size() + 1)));
  return open_cameras(machine.kernel(), cameras, nodes, "rig.toml");
}

/// Cameras "A", "B", ... at /dev/video0, /dev/video2, ..., and their source.
struct Rig {
  explicit Rig(std::size_t count = 1) {
    for (std::size_t i = 0; i < count; ++i) {
      nodes.push_back("/dev/video" + std::to_string(2 * i));
      cameras.push_back(machine.plug(nodes.back(), std::string(1, static_cast<char>('A' + i))));
    }
  }
  /// Opens them, and waits for a first set.
  void begin() {
    source = test::open(machine, nodes);
    ASSERT_TRUE(next());
  }
  /// The next set, if it comes within the loop's wait of 100 ms.
  bool next() {
    EXPECT_TRUE(source->next(set, 0.1));
    return !set.frames.empty();
  }
  /// Takes sets for that time, and calls `look` after each. Returns the longest time without one.
  double longest_gap_s(double seconds, const std::function<void()>& look = {}) {
    double longest_s = 0, last_s = machine.now_s;
    for (const double end_s = machine.now_s + seconds; machine.now_s < end_s;) {
      if (!next()) continue;
      longest_s = std::max(longest_s, machine.now_s - last_s);
      last_s = machine.now_s;
      if (look) look();
    }
    return std::max(longest_s, machine.now_s - last_s);
  }

  Machine machine;
  std::vector<std::string> nodes;
  std::vector<std::shared_ptr<MadeUpCamera>> cameras;
  std::unique_ptr<sensing::DepthSource> source;
  sensing::FrameSet set;
};

}  // namespace palpa::driver::v4l2::test
