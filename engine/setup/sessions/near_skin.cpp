#include "setup/sessions/near_skin.hpp"

#include <fmt/core.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <utility>

#include "sensing/joints/capsules.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::setup {
namespace {

/// The box around the given box after the pose has moved it.
Box moved_box(const Box& box, const Transform& pose) {
  Box out;
  for (const Vec3& corner : box.corners())
    out.add(transform_point(pose, corner));
  return out;
}

}  // namespace

NearSkin::NearSkin(const session::SessionSetting& setting)
    : setting_(&setting), rays_(sensing::make_rays(setting.cameras)), surroundings_(session::surroundings_of(setting)) {
  place({});
}

void NearSkin::place(std::vector<Transform> poses) {
  poses_ = std::move(poses);
  near_ = {};
  for (std::size_t i = 0; i < setting_->solids.size(); ++i) {
    const Box& rest = setting_->solids[i].bounds;
    const Box here = i < poses_.size() ? moved_box(rest, poses_[i]) : rest;
    if (glm::any(glm::greaterThan(glm::abs(here.centre()), Vec3(touch::out_of_reach_m)))) continue;
    near_.add(here.low - Vec3(near_skin_m));
    near_.add(here.high + Vec3(near_skin_m));
  }
  if (near_.empty()) near_.add(Vec3(0));
  sensing::plan_crops(setting_->cameras, rays_, near_, crops_);
  sensing::plan_drops(surroundings_, near_, volumes_);
}

void NearSkin::find(const sensing::FrameSet& set, sensing::SkinOfFrame& out) const {
  if (set.pushed) {
    out.points = set.points;
  } else if (set.tracked) {
    sensing::sample_skin(set.capsules, near_, out.points);
  } else {
    sensing::find_skin(rays_, set.frames, near_, crops_, volumes_, out);
  }
}

std::optional<NearestSkin> NearSkin::nearest(std::span<const sensing::SkinPoint> points) {
  constexpr std::size_t most = 4096;
  const std::vector<geometry::Solid>& solids = setting_->solids;
  for (std::size_t s = trees_.size(); s < solids.size(); ++s)
    trees_.emplace_back(solids[s].mesh);
  const std::size_t step = 1 + points.size() / most;
  std::optional<NearestSkin> nearest;
  Vec3 nearest_at(0);
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const Transform T_rest_world = s < poses_.size() ? glm::inverse(poses_[s]) : Transform(1.0);
    for (std::size_t i = 0; i < points.size(); i += step) {
      const Vec3 at = transform_point(T_rest_world, Vec3(points[i].position));
      const double least = nearest ? nearest->distance_m : std::numeric_limits<double>::infinity();
      const double distance = trees_[s].distance(at, least);
      if (distance >= least) continue;
      nearest = {distance, s, false};
      nearest_at = at;
    }
  }
  if (nearest) nearest->inside = geometry::depth(solids[nearest->solid], nearest_at) > 0;
  return nearest;
}

std::string why_untouched(const std::optional<NearestSkin>& nearest, std::span<const geometry::Solid> solids,
                          const char* is) {
  if (nearest) return fmt::format("the nearest skin {} {}", is, place_of(*nearest, solids));
  return fmt::format("no skin {} within {:.0f} mm of the objects", is, near_skin_m * 1e3);
}

session::UntouchedStats find_untouched(const session::SessionSetting& setting,
                                       std::span<const sensing::FrameSet> frames) {
  NearSkin near(setting);
  const std::vector<touch::SightCamera> cameras = touch::sight_cameras(setting.cameras, near.rays());
  sensing::SkinOfFrame skin;
  std::optional<NearestSkin> nearest;
  for (const sensing::FrameSet& set : frames) {
    near.find(set, skin);
    if (!set.frames.empty()) touch::part_flying({cameras, near.rays(), set.frames}, skin.points, skin.leavings);
    const std::optional<NearestSkin> found = near.nearest(skin.points);
    if (found && (!nearest || found->distance_m < nearest->distance_m)) nearest = found;
  }
  session::UntouchedStats untouched{.why = why_untouched(nearest, setting.solids, "was")};
  if (nearest) {
    untouched.solid = setting.solids[nearest->solid].name;
    untouched.distance_m = nearest->distance_m;
    untouched.inside = nearest->inside;
  }
  return untouched;
}

}  // namespace palpa::setup
