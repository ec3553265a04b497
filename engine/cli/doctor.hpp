// What `palpa doctor` reports. A probe looks at one kind of thing and says what it found; rooms above the engine bring
// their own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sensing/camera.hpp"

namespace palpa::cli {

using Fact = std::variant<std::string, std::int64_t, bool>;

/// One device, layer or file that was looked at.
struct DoctorItem {
  std::string title;                                ///< "0 llvmpipe (LLVM 15.0.6, 256 bits)"
  bool ok = true;                                   ///< false: palpa cannot use it
  std::string advice;                               ///< what to do about it, or a remark; may be empty
  std::vector<std::pair<std::string, Fact>> facts;  ///< for --json, and shown after the title
};

struct DoctorSection {
  std::string key;      ///< in --json: "gpus", "boards", "cameras"
  std::string heading;  ///< for people: "Boards"
  std::vector<DoctorItem> items;
  std::string note;  ///< what is to be said besides, e.g. why nothing was found; may be empty
};

/// A depth camera, as a rig can have it. Its pose is not known.
struct CameraThere {
  sensing::Camera camera;
  std::string note;  ///< one line: which it is, and how much of it is known
};

/// Depth cameras in the order in which a source names them.
struct CamerasThere {
  std::string source;  ///< as on the command line: "v4l2:/dev/video0,/dev/video4"
  std::vector<CameraThere> cameras;
  std::string problem;  ///< what could not be opened; may be empty
};

/// Never throws for what the machine lacks: that is what the section's note is for.
using DoctorProbe = std::function<DoctorSection()>;

}  // namespace palpa::cli
