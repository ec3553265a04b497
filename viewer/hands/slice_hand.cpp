#include "viewer/hands/slice_hand.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace palpa::viewer {
namespace {

constexpr double reach_points = 9;

Vec2 pixels_of(const Sight& sight, const Vec3& world) {
  const Projected p = project(projection(sight.viewpoint, sight.width, sight.height), world);
  return {p.x, p.y};
}

bool visible(const Sight& sight, const Vec3& world) {
  return project(projection(sight.viewpoint, sight.width, sight.height), world).visible;
}

/// The slice moved by `amount`: metres along its normal, or radians.
SliceState moved(const SliceState& slice, SliceHandle handle, double amount) {
  SliceState out = slice;
  if (handle == SliceHandle::middle) {
    out.T_world_slice = glm::translate(slice.T_world_slice, Vec3(0, 0, amount));
  } else {
    const Vec3 axis = handle == SliceHandle::x_end ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    out.T_world_slice = glm::rotate(slice.T_world_slice, amount, axis);
  }
  return out;
}

}  // namespace

Vec3 place_of(SliceHandle handle, const SliceState& slice) {
  const Vec2 half = 0.5 * slice.size_m;
  const Vec3 own = handle == SliceHandle::middle  ? Vec3(0)
                   : handle == SliceHandle::x_end ? Vec3(half.x, 0, 0)
                                                  : Vec3(0, half.y, 0);
  return transform_point(slice.T_world_slice, own);
}

Vec3 normal_tip(const SliceState& slice) {
  return transform_point(slice.T_world_slice, Vec3(0, 0, 0.2 * std::min(slice.size_m.x, slice.size_m.y)));
}

bool SliceHand::handle(const WindowEvent& event, const Sight& sight, SliceState& slice) {
  const Vec2 pointer(event.x, event.y);
  if (event.kind == WindowEvent::Kind::press) {
    if (event.button != Button::left || event.shift || event.ctrl) return false;
    double best = reach_points * sight.ratio;
    for (const SliceHandle handle : slice_handles) {
      const Vec3 at = place_of(handle, slice);
      const double away = glm::distance(pixels_of(sight, at), pointer);
      if (!visible(sight, at) || away >= best) continue;  // of two, the one named first
      best = away;
      held_ = handle;
    }
    x_ = event.x;
    y_ = event.y;
    before_ = slice;
    return held_.has_value();
  }
  if (!held_) return false;
  if (event.kind == WindowEvent::Kind::key && event.down && event.key == Key::escape) {
    slice = before_;
    held_.reset();
    return true;
  }
  if (event.kind == WindowEvent::Kind::release) {
    held_.reset();
    return event.button == Button::left;
  }
  if (event.kind != WindowEvent::Kind::move) return false;
  // How the handle moves over the picture when the plane moves a little, and how far that is in the world.
  const double step = *held_ == SliceHandle::middle ? 1e-4 : 1e-3;
  const Vec2 way =
      (pixels_of(sight, place_of(*held_, moved(slice, *held_, step))) - pixels_of(sight, place_of(*held_, slice))) /
      step;
  // Seen from its end, a way has no direction. It is then taken as a part of its length, so that nothing jumps.
  const double arm =
      *held_ == SliceHandle::middle ? 1 : glm::distance(place_of(*held_, slice), Vec3(slice.T_world_slice[3]));
  const double least = 0.25 * arm / metres_per_pixel(sight.viewpoint, sight.height);
  const double length2 = std::max(glm::dot(way, way), least * least);
  slice = moved(slice, *held_, glm::dot(pointer - Vec2(x_, y_), way) / length2);
  x_ = event.x;
  y_ = event.y;
  return true;
}

}  // namespace palpa::viewer
