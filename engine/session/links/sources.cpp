#include "session/links/sources.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/plausible.hpp"
#include "sensing/joints/tracked_source.hpp"
#include "sensing/recording.hpp"
#include "session/links/spec.hpp"

namespace palpa::session {
namespace {

/// As of solids and of bodies that scatter sound. Smaller skin was meant in another unit.
constexpr double smallest_skin_m = 1e-6;

std::unique_ptr<sensing::DepthSource> open_synthetic(const std::string& file, const SourceSetting& setting,
                                                     const sensing::Motion& motion) {
  if (setting.cameras.empty())
    throw bad_input(setting.rig, "has no [[camera]]; a synthetic source renders what the rig's cameras see");
  sensing::SyntheticOptions options;
  options.noise = setting.noise ? sensing::Noise::d415 : sensing::Noise::none;
  options.seed = setting.seed;
  options.paced = setting.paced;
  options.motion = motion;
  options.skin_name = file.empty() ? setting.default_skin : file;
  return sensing::make_synthetic_source(setting.cameras, load_skin(options.skin_name), setting.occluders, options);
}

std::unique_ptr<sensing::DepthSource> open_recording(const std::string& folder, const SourceSetting& setting) {
  if (folder.empty()) throw bad_usage("source recording needs a folder: recording:DIR");
  return sensing::make_replay(sensing::load_recording(folder), {.paced = setting.paced});
}

}  // namespace

geometry::Mesh load_skin(const std::string& file) {
  geometry::Mesh mesh = geometry::load_triangles(file);
  if (mesh.triangles.empty()) throw bad_input(file, "has no triangles; a synthetic source needs the skin as a mesh");
  const Box box = geometry::bounds(mesh);
  const Vec3 extent = box.high - box.low;
  if (const double size = std::max({extent.x, extent.y, extent.z}); !(size >= smallest_skin_m)) {
    throw bad_input(
        file,
        fmt::format("is only {:.4g} m across; skin measures at least a micrometre, and coordinates are metres", size));
  }
  if (const std::string odd = geometry::implausible_size(box); !odd.empty())
    log::warning(fmt::format("{}: its skin {}", file, odd));
  return mesh;
}

SourceKind synthetic_source(std::string name, std::string help, sensing::Motion motion) {
  return {std::move(name), std::move(help),
          [motion = std::move(motion)](const std::string& file, const SourceSetting& setting) {
            return open_synthetic(file, setting, motion);
          }};
}

std::vector<SourceKind> builtin_sources() {
  return {synthetic_source("synthetic", "synthetic[:MESH]: a rendered fingertip, or another mesh, that dips in and out",
                           sensing::dipping_motion),
          {"recording", "recording:DIR: what palpa run --record wrote, or a folder with a recording.toml",
           open_recording, true},
          {"joints",
           "joints:udp:PORT or joints:FILE: hands from a tracker, as lines of JSON that a program sends to this "
           "computer, or of a file",
           [](const std::string& argument, const SourceSetting& setting) {
             return sensing::make_tracked_source(sensing::open_tracker(argument, setting.paced),
                                                 setting.T_world_joints);
           },
           true, sensing::is_live_tracker}};
}

bool ends_by_itself(const std::string& spec, std::span<const SourceKind> kinds) {
  const auto [name, argument] = parse_spec(spec);
  const SourceKind& kind = find_kind(kinds, name, "source");
  return kind.ends && !(kind.live && kind.live(argument));
}

std::unique_ptr<sensing::DepthSource> open_source(const std::string& spec, std::span<const SourceKind> kinds,
                                                  const SourceSetting& setting) {
  const auto [name, argument] = parse_spec(spec);
  return find_kind(kinds, name, "source").open(argument, setting);
}

}  // namespace palpa::session
