#include "hand_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "drawing/canvas.hpp"
#include "drawing/png.hpp"
#include "hand_truth.hpp"
#include "touch/types.hpp"

namespace palpa::test {
namespace {

using drawing::Canvas;
using drawing::Colour;
using drawing::rgb;

constexpr std::uint32_t panel = 340, shown_px = 170;  ///< half of a panel, in the camera's pixels
constexpr std::array<Colour, 12> colours{rgb(0xd55e00), rgb(0xe69f00), rgb(0xf0e442), rgb(0x009e73),
                                         rgb(0xcc79a7), rgb(0xff0000), rgb(0xb34700), rgb(0xb37b00),
                                         rgb(0xb3aa20), rgb(0x006b4e), rgb(0x994f78), rgb(0xa00000)};

void draw_view(Canvas& canvas, std::uint32_t column, std::uint32_t row, const RatedHand& hand, const HandTruth& truth,
               const TrueFrame& frame, const sensing::Camera& camera, const sensing::DepthFrame& image) {
  const Vec3 origin = transform_point(glm::inverse(camera.T_world_camera), Vec3(0));
  const Vec2 middle = sensing::project(camera, origin);
  const double delta = touch::Parameters().delta_m;
  for (std::uint32_t y = 0; y < panel; ++y) {
    for (std::uint32_t x = 0; x < panel; ++x) {
      const double u = std::round(middle.x) + x - shown_px, v = std::round(middle.y) + y - shown_px;
      if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
      const std::uint16_t raw = image.depth[static_cast<std::size_t>(v) * camera.width + static_cast<std::size_t>(u)];
      if (raw == 0) continue;
      const Vec3 place = sensing::deproject(camera, u, v, raw);
      const auto light =
          static_cast<float>(std::clamp(0.9 - 0.6 * (raw * camera.depth_unit_m - origin.z + 0.06) / 0.2, 0.1, 0.95));
      Colour colour{light, light, light};
      double deepest = -1;
      for (const geometry::Solid& solid : hand.solids)
        deepest = std::max(deepest, geometry::depth(solid, place));
      if (deepest > 0) colour = {light * 0.4F, light * 0.6F, light};
      if (deepest > 0 && deepest < delta) colour = colours[truth.part_at(frame, place) % colours.size()];
      canvas.set(column * panel + x, row * panel + y, colour);
    }
  }
}

}  // namespace

void draw_hand(const RatedHand& hand, const std::filesystem::path& file) {
  Canvas canvas(4 * panel, 2 * panel, rgb(0x202020));
  HandTruth truth(hand);
  sensing::SyntheticRig rig(hand.cameras, {}, sensing::Noise::d415, hand.seed);
  sensing::FrameSet set;
  const auto render = [&](double share) {
    const std::size_t k = static_cast<std::size_t>(share * static_cast<double>(hand.frames() - 1));
    std::vector<sensing::Posed> skin;
    for (const HandBody& body : hand.bodies)
      skin.push_back({&body.skin->mesh, body.pose(hand.time_of(k))});
    rig.render(skin, k, set);
    return truth.at(hand.time_of(k));
  };
  const TrueFrame middle = render(0.5);
  for (std::uint32_t c = 0; c < hand.cameras.size(); ++c)
    draw_view(canvas, c, 0, hand, truth, middle, hand.cameras[c], set.frames[c]);
  for (std::uint32_t n = 0; n < 4; ++n) {
    const TrueFrame then = render(std::array{0.0, 0.3, 0.7, 1.0}[n]);
    draw_view(canvas, n, 1, hand, truth, then, hand.cameras[0], set.frames[0]);
  }
  drawing::write_png(file, canvas.pixels());
}

}  // namespace palpa::test
