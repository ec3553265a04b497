#include "viewer/view/stereo.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "base/error.hpp"

namespace palpa::viewer {
namespace {

constexpr double nearest_eye_m = 1e-3;

/// The point in the screen's frame.
Vec3 on_screen(const sensing::Screen& screen, const Vec3& world) {
  return transform_point(glm::inverse(screen.T_world_screen), world);
}

/// Where the line from the eye to a place on the screen passes the barrier, along the same axis, in metres.
double at_barrier(double place, double eye, double distance, const Barrier& barrier) {
  return place + (eye - place) * barrier.gap_m / distance;
}

/// The distance from the middle of the nearest slit, in pitches, 0 to 0.5.
double off_slit(double at, const Barrier& barrier) {
  const double turns = at / barrier.pitch_m - barrier.phase;
  return std::abs(turns - std::round(turns));
}

void copy_pixel(const drawing::Pixels& from, std::uint32_t x, std::uint32_t y, drawing::Pixels& to, std::uint32_t to_x,
                std::uint32_t to_y) {
  std::copy_n(from.at(x, y), 4, to.rgba.begin() + (static_cast<std::ptrdiff_t>(to_y) * to.width + to_x) * 4);
}

drawing::Pixels anaglyph(const drawing::Pixels& left, const drawing::Pixels& right) {
  drawing::Pixels out = right;
  // The left eye's brightness instead of its red, because blue things must not be dark for one eye and light for the
  // other.
  for (std::size_t i = 0; i < out.rgba.size(); i += 4)
    out.rgba[i] = static_cast<std::uint8_t>(
        std::lround(0.299 * left.rgba[i] + 0.587 * left.rgba[i + 1] + 0.114 * left.rgba[i + 2]));
  return out;
}

drawing::Pixels joined(const drawing::Pixels& left, const drawing::Pixels& right, bool beside) {
  drawing::Pixels out;
  out.width = beside ? left.width + right.width : left.width;
  out.height = beside ? left.height : left.height + right.height;
  out.rgba.resize(std::size_t{4} * out.width * out.height);
  for (std::uint32_t y = 0; y < left.height; ++y) {
    for (std::uint32_t x = 0; x < left.width; ++x) {
      copy_pixel(left, x, y, out, x, y);
      copy_pixel(right, x, y, out, beside ? x + left.width : x, beside ? y : y + left.height);
    }
  }
  return out;
}

}  // namespace

bool in_front(const sensing::Screen& screen) {
  return on_screen(screen, screen.eye_m).z > nearest_eye_m;
}

Frustum onto(const sensing::Screen& screen, const Vec3& eye) {
  const Vec3 e = on_screen(screen, eye);
  if (!(e.z > nearest_eye_m))
    throw bad_usage(
        fmt::format("the eye at {:g},{:g},{:g} is not in front of the screen: give an eye on the side that the "
                    "screen's z axis points to",
                    eye.x, eye.y, eye.z));
  Frustum frustum;
  frustum.T_world_eye = screen.T_world_screen;
  frustum.T_world_eye[3] = Vec4(eye, 1);
  const Vec2 half(screen.width_m / 2, screen.height_m / 2);
  frustum.low = (-half - Vec2(e)) / e.z;
  frustum.high = (half - Vec2(e)) / e.z;
  frustum.exact = true;
  return frustum;
}

Eyes eyes_before(const sensing::Screen& screen, double apart_m) {
  const Vec3 half = Vec3(screen.T_world_screen[0]) * (apart_m / 2);
  return {screen.eye_m - half, screen.eye_m + half};
}

Barrier default_barrier(const sensing::Screen& screen, const Eyes& eyes, Stereo stereo, std::uint32_t width,
                        std::uint32_t height) {
  const double distance = on_screen(screen, (eyes.left + eyes.right) / 2.0).z;
  if (stereo == Stereo::rows) return {2 * screen.height_m / height, 0, 0};
  // Seen from the eyes, two columns are as wide as a pitch. Seen through the slits, the eyes are half a pitch apart.
  const double column = screen.width_m / width, apart = glm::distance(eyes.left, eyes.right);
  Barrier barrier;
  barrier.gap_m = distance * column / (apart + column);
  barrier.pitch_m = 2 * column * (distance - barrier.gap_m) / distance;
  return barrier;
}

bool is_left(const sensing::Screen& screen, const Eyes& eyes, const Barrier& barrier, Stereo stereo, double place_m) {
  const Vec3 left = on_screen(screen, eyes.left), right = on_screen(screen, eyes.right);
  if (stereo == Stereo::columns) {
    return off_slit(at_barrier(place_m, left.x, left.z, barrier), barrier) <=
           off_slit(at_barrier(place_m, right.x, right.z, barrier), barrier);
  }
  const Vec3 middle = (left + right) / 2.0;
  const double turns = at_barrier(place_m, middle.y, middle.z, barrier) / barrier.pitch_m - barrier.phase;
  return turns - std::floor(turns) < 0.5;
}

EyeSize eye_size(Stereo stereo, std::uint32_t width, std::uint32_t height) {
  return {stereo == Stereo::side_by_side ? width / 2 : width, stereo == Stereo::top_bottom ? height / 2 : height};
}

drawing::Pixels grown_to(drawing::Pixels picture, std::uint32_t width, std::uint32_t height) {
  if (picture.width == width && picture.height == height) return picture;
  drawing::Pixels out{width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height)};
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x)
      copy_pixel(picture, std::min(x, picture.width - 1), std::min(y, picture.height - 1), out, x, y);
  }
  return out;
}

drawing::Pixels combine(const drawing::Pixels& left, const drawing::Pixels& right, const sensing::Screen& screen,
                        const Eyes& eyes, const Barrier& barrier, Stereo stereo) {
  if (stereo == Stereo::anaglyph) return anaglyph(left, right);
  if (stereo == Stereo::side_by_side || stereo == Stereo::top_bottom)
    return joined(left, right, stereo == Stereo::side_by_side);
  drawing::Pixels out = left;
  const bool columns = stereo == Stereo::columns;
  const std::uint32_t count = columns ? out.width : out.height;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double part = (i + 0.5) / count - 0.5;
    const double place = columns ? part * screen.width_m : -part * screen.height_m;
    if (is_left(screen, eyes, barrier, stereo, place)) continue;
    for (std::uint32_t j = 0; j < (columns ? out.height : out.width); ++j)
      copy_pixel(right, columns ? i : j, columns ? j : i, out, columns ? i : j, columns ? j : i);
  }
  return out;
}

}  // namespace palpa::viewer
