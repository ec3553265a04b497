// The skin near the solids of a live run, for those who look on: the viewer, and a run in which nothing touched.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/nearest.hpp"
#include "geometry/solid.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_twin.hpp"
#include "sensing/surroundings.hpp"
#include "session/plan/setting.hpp"
#include "session/watch/untouched.hpp"
#include "setup/sessions/nearest_skin.hpp"

namespace palpa::setup {

/// Depth images show far more than the hand. Only skin in the box around all solids, larger by this on each side, is
/// near them.
inline constexpr double near_skin_m = 0.12;

class NearSkin {
 public:
  /// The setting must outlive it, with its cameras and solids.
  explicit NearSkin(const session::SessionSetting& setting);

  /// The poses move the solids, by their index; those without one are at rest.
  void place(std::vector<Transform> poses);

  /// Replaces what `out` has by the skin of the frame. `wants_leavings` stays as it is.
  void find(const sensing::FrameSet& set, sensing::SkinOfFrame& out) const;
  const sensing::RayTables& rays() const { return rays_; }

  /// The point nearest to a solid's surface; nullopt without points. If there are more than 4096, only every n-th
  /// counts.
  std::optional<NearestSkin> nearest(std::span<const sensing::SkinPoint> points);

 private:
  const session::SessionSetting* setting_;
  sensing::RayTables rays_;
  sensing::Surroundings surroundings_;
  std::vector<Transform> poses_;
  Box near_;
  std::vector<sensing::Crop> crops_;
  std::vector<shader::SkinVolume> volumes_;
  std::vector<geometry::NearestTriangle> trees_;  ///< of the solids, made when they are needed
};

/// "31.0 mm away from the surface of cube", after "the nearest skin is " or "was "; or that no skin is near.
std::string why_untouched(const std::optional<NearestSkin>& nearest, std::span<const geometry::Solid> solids,
                          const char* is = "is");

/// Why nothing touched in a run of which these are some of the frames. Solids are where the setting has them.
session::UntouchedStats find_untouched(const session::SessionSetting& setting,
                                       std::span<const sensing::FrameSet> frames);

}  // namespace palpa::setup
