// Pictures drawn on the tests' device, and what their pixels show.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "support/device.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/scenes.hpp"

namespace palpa::test {

/// How a picture is drawn.
struct Shot {
  viewer::ViewState state = bare_view();
  viewer::Viewpoint viewpoint = front_viewpoint();
  std::uint32_t width = 320, height = 240;
  viewer::Fineness fineness = viewer::Fineness::fine;
};

inline viewer::Pixels shoot(const viewer::Picture& picture, const Shot& shot = {}) {
  viewer::DrawnPicture drawn(test_device());
  drawn.update(picture, shot.state);
  viewer::Offscreen offscreen(test_device(), shot.width, shot.height, 1, shot.fineness);
  offscreen.draw(drawn, shot.viewpoint);
  return offscreen.pixels();
}

/// The pixel where a point of the world is drawn.
inline const std::uint8_t* pixel_at(const viewer::Pixels& pixels, const Vec3& world,
                                    const viewer::Viewpoint& viewpoint = front_viewpoint()) {
  const viewer::Projected p = viewer::project(projection(viewpoint, pixels.width, pixels.height), world);
  EXPECT_TRUE(p.visible && p.x >= 0 && p.y >= 0 && p.x < pixels.width && p.y < pixels.height);
  return pixels.at(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
}

/// Largest difference of a channel, in steps of 255.
inline int distance(const std::uint8_t* pixel, const drawing::Colour& colour) {
  int worst = 0;
  for (int i = 0; i < 3; ++i)
    worst = std::max(worst, std::abs(static_cast<int>(viewer::to_pixel(colour) >> (8 * i) & 255) - pixel[i]));
  return worst;
}

/// How many pixels have another colour.
inline std::size_t count_not(const viewer::Pixels& pixels, const drawing::Colour& colour) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < pixels.rgba.size(); i += 4)
    n += distance(&pixels.rgba[i], colour) > 1;
  return n;
}

inline drawing::Colour paper(bool dark = false) {
  return viewer::theme_of(dark).background;
}

}  // namespace palpa::test
