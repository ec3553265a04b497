// draw_two_fingers OUT.png: draws how two fingertips are followed that cross (left), and that meet and turn back
// (right). Their place along x is drawn downwards in time, with a colour for each id and large dots if both are one
// cluster. For docs/touch.md.
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "drawing/canvas.hpp"
#include "drawing/colour.hpp"
#include "drawing/ink.hpp"
#include "drawing/png.hpp"
#include "touch/fingers/two_fingers.hpp"

namespace palpa::drawing {
namespace {

constexpr std::uint32_t panel = 360, height = 420;
constexpr double top = 56, bottom = 396;
constexpr Colour paper = rgb(0xffffff), dark = rgb(0x404040), faint = rgb(0xc7c7c7);

void draw(Ink& ink, double left, const touch::test::Walk& walk, std::string_view title) {
  constexpr double rate_hz = 90, millimetre = 5.5;
  const auto frames = touch::test::film(walk, 3, rate_hz, 1);
  const auto place = [&](double x, double t) {
    return Vec2(left + panel / 2.0 + 1e3 * x * millimetre, top + (bottom - top) * t / walk.seconds);
  };
  ink.text(title, {left + 16, 24}, 9, dark);
  ink.text("20 mm", {left + panel / 2.0, 42}, 9, dark, Align::centre);
  ink.line({left + panel / 2.0 - 10 * millimetre, 48}, {left + panel / 2.0 + 10 * millimetre, 48}, 1, dark);
  for (int finger = 0; finger < 2; ++finger) {  // the true places of the tips
    for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
      const double t = frames[k].time_s, next = frames[k + 1].time_s;
      ink.line(place(walk.tips(t)[finger].x, t), place(walk.tips(next)[finger].x, next), 1, faint);
    }
  }
  constexpr std::array<Colour, 4> colours{rgb(0xd55e00), rgb(0x0072b2), rgb(0x009e73), rgb(0xcc79a7)};
  for (const auto& seen : touch::test::follow(walk, frames, 3))
    ink.disc(place(seen.centroid.x, seen.time_s), seen.both() ? 5 : 3, colours[seen.id % colours.size()]);
}

void run(const char* file) {
  std::vector<shader::ViewStroke> strokes;
  Ink ink(1, paper, strokes);
  draw(ink, 0, touch::test::crossing(0.1, 90, 0.006), "crossing at 0.1 m/s each");
  draw(ink, panel, touch::test::bouncing(0.1, 90, 0.1), "meeting and turning back");
  Canvas canvas(2 * panel, height, paper);
  canvas.draw(strokes);
  write_png(file, canvas.pixels());
}

}  // namespace
}  // namespace palpa::drawing

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw palpa::bad_usage("usage: draw_two_fingers OUT.png");
    palpa::drawing::run(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
