// Recordings of things that stand still.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sensing/recording.hpp"
#include "sensing/synthetic.hpp"

namespace palpa::test {

/// Records what a rig sees at these times, seconds, as what these cameras saw; returns the recording as a source. With
/// noise, each frame has its own.
inline std::string record_still(const std::filesystem::path& folder, const std::vector<sensing::Camera>& cameras,
                                sensing::SyntheticRig& rig, std::span<const sensing::Posed> skin,
                                const std::vector<double>& times_s, sensing::Noise noise = sensing::Noise::none) {
  sensing::RecordingWriter writer(folder, cameras);
  sensing::FrameSet set;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (i == 0 || noise != sensing::Noise::none) rig.render(skin, i, set);
    set.sequence = i;
    set.time_s = times_s[i];
    for (sensing::DepthFrame& frame : set.frames)
      frame.time_s = set.time_s;
    writer.write(set);
  }
  return "recording:" + folder.string();
}

}  // namespace palpa::test
