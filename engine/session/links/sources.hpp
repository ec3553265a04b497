// The sources of frames, by name: `synthetic[:MESH]`, `recording:DIR`, `joints:udp:PORT`, `joints:FILE`, and those that
// the driver adds (real cameras).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/synthetic.hpp"

namespace palpa::session {

/// The values a source gets when it is opened. The referenced values are not kept.
struct SourceSetting {
  const std::vector<sensing::Camera>& cameras;  ///< the rig's; a recording brings its own
  const geometry::Mesh& occluders;              ///< the array's boards in the world, which hide everything behind them
  std::string default_skin;                     ///< mesh file of a synthetic finger
  bool noise = true;                            ///< synthetic frames with the depth sensor's noise
  std::uint64_t seed = 0;
  bool paced = true;              ///< in real time; otherwise as fast as the caller asks, with no frame left out
  std::string rig = "the rig";    ///< its file, for messages
  Transform T_world_joints{1.0};  ///< where a tracker of hands stands
};

/// A kind of source: `name` or `name:ARGUMENT` on the command line.
struct SourceKind {
  std::string name;
  std::string help;
  std::function<std::unique_ptr<sensing::DepthSource>(const std::string& argument, const SourceSetting&)> open;
  bool ends = false;                                        ///< it ends by itself because it was recorded,
  std::function<bool(const std::string& argument)> live{};  ///< except with such an argument
};

/// `name`: a rendered fingertip, or another mesh, with this motion.
SourceKind synthetic_source(std::string name, std::string help, sensing::Motion motion);

/// `synthetic`, `recording` and `joints`.
std::vector<SourceKind> builtin_sources();

/// A skin mesh from a PLY or, all its meshes together, from a glTF file. Throws bad_input if the file has no mesh, and
/// for a mesh smaller than a micrometre.
geometry::Mesh load_skin(const std::string& file);

/// Whether "name" or "name:argument" ends by itself. Throws bad_usage as open_source does.
bool ends_by_itself(const std::string& spec, std::span<const SourceKind> kinds);

/// Opens "name" or "name:argument". Throws bad_usage with the known names for an unknown one, bad_input for broken
/// files.
std::unique_ptr<sensing::DepthSource> open_source(const std::string& spec, std::span<const SourceKind> kinds,
                                                  const SourceSetting& setting);

}  // namespace palpa::session
