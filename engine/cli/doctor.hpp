// The report of `palpa doctor`. A probe looks for one kind of thing and reports what it found. The driver adds
// its own probes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sensing/camera.hpp"

namespace palpa::cli {

using Fact = std::variant<std::string, std::int64_t, bool, double>;

/// One device, layer or file that was looked at.
struct DoctorItem {
  std::string title;                                ///< "0 llvmpipe (LLVM 15.0.6, 256 bits)"
  bool ok = true;                                   ///< false: palpa cannot use it
  std::string advice;                               ///< what the user can do about it, or a remark; may be empty
  std::vector<std::pair<std::string, Fact>> facts;  ///< for --json, and shown after the title
};

struct DoctorSection {
  std::string key;      ///< in --json: "gpus", "boards", "cameras"
  std::string heading;  ///< for people: "Boards"
  std::vector<DoctorItem> items;
  std::string note;  ///< an additional remark, e.g. why nothing was found; may be empty
};

/// A depth camera for a rig. Its pose is unknown.
struct CameraThere {
  sensing::Camera camera;
  std::string note;  ///< one line: which camera it is, and which of its values are known
};

/// Depth cameras in the order in which a source names them.
struct CamerasThere {
  std::string source;  ///< as on the command line: "v4l2:/dev/video0,/dev/video4"
  std::vector<CameraThere> cameras;
  std::string problem;  ///< the devices that could not be opened; may be empty
};

/// Never throws because of missing hardware; the section's note reports it.
using DoctorProbe = std::function<DoctorSection()>;

}  // namespace palpa::cli
