// draw_two_fingers OUT.png: how two fingertips are followed that cross (left) and that meet and turn back (right):
// their place along x downwards in time, one colour for each id, large dots where both are one cluster. For
// docs/touch.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>

#include "base/error.hpp"
#include "touch/two_fingers.hpp"
#include "viewer/font.hpp"
#include "viewer/png.hpp"

namespace palpa::viewer {
namespace {

using Colour = std::array<double, 3>;
constexpr std::uint32_t panel = 360, height = 420;
constexpr double top = 56, bottom = 396;

/// Blends a disc; its rim is one pixel soft.
void disc(Pixels& picture, const Vec2& at, double radius, const Colour& colour) {
  const auto low = [](double v) { return static_cast<int>(std::max(0.0, std::floor(v))); };
  for (int y = low(at.y - radius - 1); y < std::min<int>(static_cast<int>(height), low(at.y + radius + 2)); ++y) {
    for (int x = low(at.x - radius - 1); x < std::min<int>(2 * panel, low(at.x + radius + 2)); ++x) {
      const double cover = std::clamp(radius + 0.5 - std::hypot(x - at.x, y - at.y), 0.0, 1.0);
      std::uint8_t* pixel =
          &picture.rgba[(static_cast<std::size_t>(y) * picture.width + static_cast<std::size_t>(x)) * 4];
      for (int k = 0; k < 3; ++k)
        pixel[k] = static_cast<std::uint8_t>(std::lround(pixel[k] * (1 - cover) + 255 * colour[k] * cover));
    }
  }
}

void line(Pixels& picture, const Vec2& from, const Vec2& to, double width, const Colour& colour) {
  const double length = glm::distance(from, to);
  for (double s = 0; s <= length; s += 0.5)
    disc(picture, from + (to - from) * (length > 0 ? s / length : 0), width / 2, colour);
}

void text(Pixels& picture, std::string_view words, const Vec2& at) {
  std::vector<PenStroke> strokes;
  write_text(words, at, 9, strokes);
  for (const PenStroke& stroke : strokes)
    line(picture, stroke.from, stroke.to, 1.2, {0.25, 0.25, 0.25});
}

void draw(Pixels& picture, double left, const touch::test::Walk& walk, std::string_view title) {
  constexpr double rate_hz = 90, millimetre = 5.5;
  const auto frames = touch::test::film(walk, 3, rate_hz, 1);
  const auto place = [&](double x, double t) {
    return Vec2(left + panel / 2.0 + 1e3 * x * millimetre, top + (bottom - top) * t / walk.seconds);
  };
  text(picture, title, {left + 16, 24});
  text(picture, "20 mm", {left + panel / 2.0 - 16, 42});
  line(picture, {left + panel / 2.0 - 10 * millimetre, 48}, {left + panel / 2.0 + 10 * millimetre, 48}, 1,
       {0.25, 0.25, 0.25});
  for (int finger = 0; finger < 2; ++finger) {  // where the tips really are
    for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
      const double t = frames[k].time_s, next = frames[k + 1].time_s;
      line(picture, place(walk.tips(t)[finger].x, t), place(walk.tips(next)[finger].x, next), 1, {0.78, 0.78, 0.78});
    }
  }
  constexpr std::array<Colour, 4> colours{Colour{0.84, 0.37, 0.0}, Colour{0.0, 0.45, 0.70}, Colour{0.0, 0.62, 0.45},
                                          Colour{0.80, 0.47, 0.65}};
  for (const auto& seen : touch::test::follow(walk, frames, 3, touch::test::Backend::cpu))
    disc(picture, place(seen.centroid.x, seen.time_s), seen.both() ? 5 : 3, colours[seen.id % colours.size()]);
}

void run(const char* file) {
  Pixels picture{2 * panel, height, std::vector<std::uint8_t>(std::size_t{2} * panel * height * 4, 255)};
  draw(picture, 0, touch::test::crossing(0.1, 90, 0.006), "crossing at 0.1 m/s each");
  draw(picture, panel, touch::test::bouncing(0.1, 90, 0.1), "meeting and turning back");
  write_png(file, picture);
}

}  // namespace
}  // namespace palpa::viewer

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw palpa::bad_usage("usage: draw_two_fingers OUT.png");
    palpa::viewer::run(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
