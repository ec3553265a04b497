// The field in a plane, computed in the background of the drawing.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "acoustics/field/pressure.hpp"
#include "support/begins.hpp"
#include "viewer/live/played.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/sound/slice_preview.hpp"

namespace palpa::viewer {
namespace {

using test::Played;

TEST(SlicePreview, IsCoarseFirstAndFineAtRest) {
  Played played;
  SlicePreview preview({});
  Picture picture;
  SliceState slice;
  slice.T_world_slice = glm::translate(Transform(1.0), Vec3(0, 0, 0.1));
  slice.size_m = {0.03, 0.03};
  double now_s = 0;
  std::uint32_t first = 0;
  preview.look(played.now, slice, picture, now_s);
  EXPECT_TRUE(picture.images.empty()) << "nobody waits for it";
  ASSERT_TRUE(test::begins([&] {
    preview.look(played.now, slice, picture, now_s += 0.05);
    if (first == 0 && !picture.images.empty()) first = picture.images[0].width;
    return !preview.busy();
  }));
  ASSERT_EQ(picture.images.size(), 1u) << preview.fault();
  EXPECT_GE(first, SlicePreview::coarsest);
  EXPECT_LE(first, SlicePreview::finest / 2);
  EXPECT_EQ(picture.images[0].width, SlicePreview::finest);
  // Its colours are the field's.
  const SliceGrid grid = slice_grid(slice, SlicePreview::finest);
  const std::vector<Vec3> points = slice_points(slice, grid);
  const bool loud = picture.bars.at(0).title.find("beyond") != std::string::npos;
  for (std::size_t i = 0; i < points.size() && !loud; i += 97) {
    const double p = std::abs(acoustics::pressure_at(*played.now.layout, played.now.slot, points[i]));
    const std::uint32_t expected = to_pixel(drawing::map_colour(p / picture.bars[0].most)),
                        is = picture.images[0].pixels[i];
    for (int channel = 0; channel < 24; channel += 8)
      ASSERT_NEAR(expected >> channel & 255, is >> channel & 255, 2) << i;
  }
  EXPECT_FALSE(loud) << "choose a quieter case";

  slice.T_world_slice = glm::translate(slice.T_world_slice, Vec3(0, 0, 5e-3));
  preview.look(played.now, slice, picture, now_s);
  EXPECT_TRUE(preview.busy());
  EXPECT_NEAR(picture.images[0].corners[0].z, 0.1, 1e-6) << "still where it is right";
  ASSERT_TRUE(test::begins([&] {
    preview.look(played.now, slice, picture, now_s += 0.01);
    return picture.images[0].corners[0].z > 0.104f;
  }));
  EXPECT_LT(picture.images[0].width, SlicePreview::finest) << "a moving plane is coarse";

  played.now.slot = {};
  preview.look(played.now, slice, picture, now_s);
  EXPECT_TRUE(picture.images.empty() && picture.bars.empty()) << "silence";
}

}  // namespace
}  // namespace palpa::viewer
