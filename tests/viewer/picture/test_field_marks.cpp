// Sound in the picture: planes, colours on the skin, and their colour bars.
#include <gtest/gtest.h>

#include <complex>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "array/schedule.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/render/drawn.hpp"
#include "viewer/sound/field_slice.hpp"

namespace palpa::viewer {
namespace {

using ViewerField = test::DrawingTest;
using test::distance;
using test::pixel_at;
using Pressures = std::vector<std::complex<double>>;

constexpr std::uint32_t width = 640, height = 400;

Pixels draw(const Picture& picture, const ViewState& state) {
  return test::shoot(picture, {.state = state, .width = width, .height = height});
}

TEST(FieldMarks, SamplesAreThePlanesPixels) {
  SliceState slice;
  slice.T_world_slice = {{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {0.1, 0.2, 0.3, 1}};
  slice.size_m = {0.04, 0.02};
  const SliceGrid grid = slice_grid(slice, 8);
  EXPECT_EQ(grid.columns, 8u);
  EXPECT_EQ(grid.rows, 4u);
  const std::vector<Vec3> points = slice_points(slice, grid);
  ASSERT_EQ(points.size(), 32u);
  // From the top left, half a pixel from the edges: its x axis is the world's z axis.
  EXPECT_LT(glm::distance(points[0], Vec3(0.1, 0.2 + 0.0075, 0.3 - 0.0175)), 1e-12);
  EXPECT_LT(glm::distance(points[7], Vec3(0.1, 0.2 + 0.0075, 0.3 + 0.0175)), 1e-12);
  EXPECT_LT(glm::distance(points[31], Vec3(0.1, 0.2 - 0.0075, 0.3 + 0.0175)), 1e-12);
}

TEST(FieldMarks, BarsEndAtRoundNumbers) {
  for (const auto& [most, end] : {std::pair(1.2, 1.5), {700.0, 700.0}, {701.0, 800.0}, {9.5, 10.0}, {0.0, 1.0}})
    EXPECT_NEAR(round_up(most), end, 1e-9) << most;
}

TEST(FieldMarks, LoudPlanesShowTheShareOfTheLargestPressure) {
  Picture picture;
  const SliceGrid grid{2, 1};
  const Pressures quiet{{0, 300}, {400, 0}}, loud{{0, 2.134 * array::linear_pressure_pa}, {0, 0}};
  show_slice(picture, {}, grid, quiet);
  ASSERT_EQ(picture.bars.size(), 1u);
  EXPECT_EQ(picture.bars[0].most, 400);
  EXPECT_NE(picture.bars[0].title.find("Pa peak"), std::string::npos);
  EXPECT_EQ(picture.images.at(0).pixels[0], to_pixel(drawing::map_colour(0.75)));
  EXPECT_EQ(picture.images.at(0).pixels[1], to_pixel(drawing::map_colour(1)));
  show_slice(picture, {}, grid, loud);
  ASSERT_EQ(picture.bars.size(), 1u) << "in the place of the one before";
  ASSERT_EQ(picture.images.size(), 1u);
  EXPECT_EQ(picture.bars[0].most, 1);
  EXPECT_NE(picture.bars[0].title.find("of 21.3 kPa"), std::string::npos);
  EXPECT_NE(picture.bars[0].title.find("beyond linear acoustics"), std::string::npos);
  EXPECT_EQ(picture.images[0].pixels[0], to_pixel(drawing::map_colour(1)));
}

TEST_F(ViewerField, ASliceIsTheFieldWhereItIs) {
  const array::Layout own = array::load_layout("autd3");
  const array::Layout layout = array::transformed(own, own.default_T_world_layout);
  array::DriveOptions options;
  const std::vector<array::SlotFocus> foci{{.position = Vec3(0.01, 0, 0)}};
  array::Drive drive(layout.transducers.size());
  array::DriveScratch scratch;
  array::drive_for(layout, foci, options, drive, scratch);
  const acoustics::Air air = acoustics::without_absorption(acoustics::air_of({}));
  FieldSlice field(test::test_device(), layout, air, array::Directivity::t4010a1, 24);
  Picture picture;
  SliceState slice;
  field.show(picture, slice, drive);
  // Each pixel has its pressure's colour, to one step.
  const SliceGrid grid = slice_grid(slice, 24);
  const std::vector<Vec3> points = slice_points(slice, grid);
  const double most = picture.bars.at(0).most;
  std::size_t loudest = 0;
  double peak = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double p = std::abs(acoustics::pressure_at(layout, drive, points[i], air.medium));
    if (p > peak) {
      peak = p;
      loudest = i;
    }
    const std::uint32_t expected = to_pixel(drawing::map_colour(p / most)), is = picture.images.at(0).pixels[i];
    for (int channel = 0; channel < 24; channel += 8)
      ASSERT_NEAR(expected >> channel & 255, is >> channel & 255, 2) << i;
  }
  EXPECT_LT(glm::distance(points[loudest], foci[0].position), 8e-3) << "a focus is long along the way to it";
  EXPECT_LE(peak, most);
  // In the picture, it lies where the field is, hides what is behind it, and has a colour bar. If it is hidden, both
  // disappear.
  picture.skin_points.emplace_back(-0.02f, -0.01f, -0.01f);
  ViewState state = test::bare_view();
  const Pixels without = draw(picture, state);
  EXPECT_GT(distance(pixel_at(without, {-0.02, -0.01, -0.01}), test::paper()), 10);
  state.layers[Layer::slice].visible = true;
  const Pixels with = draw(picture, state);
  EXPECT_LE(distance(pixel_at(with, points[loudest]), drawing::map_colour(peak / most)), 12);
  EXPECT_GT(distance(pixel_at(with, {-0.02, -0.01, -0.01}), theme_of(false).skin_point), 40);
}

TEST_F(ViewerField, HeatIsThePressureAtTheVertices) {
  Picture picture;
  const geometry::Mesh box = test::box({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02});
  std::vector<double> pressure;
  for (const Vec3& at : box.positions)
    pressure.push_back(at.x > 0 ? 600 : -100);  // pulled elsewhere: the colour of zero
  show_heat(picture, "finger", box, pressure, "pressure, Pa");
  ASSERT_TRUE(picture.skin);
  EXPECT_EQ(picture.bars.at(0).layer, Layer::heat);
  EXPECT_EQ(picture.bars.at(0).title, "pressure, Pa");
  EXPECT_EQ(picture.bars.at(0).most, 600);
  ViewState state = test::bare_view();
  const Pixels skin = draw(picture, state);
  state.layers[Layer::heat].visible = true;
  const Pixels heat = draw(picture, state);
  // Without the layer, the skin has faintly its own colour. With the layer, it is dark on the left and bright on the
  // right, and nothing shines through.
  EXPECT_GT(pixel_at(skin, {-0.019, 0.003, 0.02})[1], 170);
  EXPECT_LT(pixel_at(heat, {-0.019, 0.003, 0.02})[1], 60);
  EXPECT_GT(pixel_at(heat, {0.019, 0.003, 0.02})[0], pixel_at(heat, {-0.019, 0.003, 0.02})[0] + 100);
  state.layers[Layer::heat].opacity = 0.3f;
  EXPECT_GT(pixel_at(draw(picture, state), {-0.019, 0.003, 0.02})[1], 120);
}

}  // namespace
}  // namespace palpa::viewer
