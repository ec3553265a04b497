#include "session/watch/hand_watch.hpp"

#include <algorithm>
#include <cstddef>

#include "session/watch/touches.hpp"

namespace palpa::session {
namespace {

/// In a wider image, only every n-th pixel of every n-th row is looked at.
constexpr std::uint32_t most_columns = 320;
/// Fewer are noise. A fingertip has more, even in small images.
constexpr std::size_t fewest_points = 8;

std::uint32_t stride_of(const sensing::Camera& camera) {
  return std::max(1U, camera.width / most_columns);
}

}  // namespace

HandWatch::HandWatch(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
                     const std::vector<sensing::Slab>& slabs)
    : cameras_(cameras), tables_(tables), surroundings_{.slabs = slabs, .room = {}} {
  crops_.reserve(cameras.size());
  volumes_.reserve(sensing::most_drops(surroundings_));
  std::size_t most = 0;
  for (const sensing::Camera& camera : cameras) {
    const auto pixels = [&](std::size_t length) { return length / stride_of(camera) + 1; };
    most += pixels(camera.width) * pixels(camera.height);
  }
  skin_.points.reserve(most);
}

std::uint32_t HandWatch::hands_in(std::span<const sensing::DepthFrame> images, const touch::Touch& touch,
                                  double time_s) {
  if (touch.finger_count > 0) {
    last_s_ = time_s;
    box_ = {};
    for (const touch::Finger& finger : std::span(touch.fingers).first(touch.finger_count)) {
      box_.add(Vec3(finger.section.centroid) - near_m);
      box_.add(Vec3(finger.section.centroid) + near_m);
    }
    return 1;
  }
  if (time_s < last_s_ || time_s > last_s_ + lost_press_s) return 1;
  sensing::plan_crops(cameras_, tables_, box_, crops_);
  for (sensing::Crop& crop : crops_)
    crop.stride = stride_of(cameras_[crop.camera]);
  sensing::plan_drops(surroundings_, box_, volumes_);
  sensing::find_skin(tables_, images, box_, crops_, volumes_, skin_);
  return skin_.points.size() < fewest_points ? 0 : 1;
}

}  // namespace palpa::session
