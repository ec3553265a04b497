// All shapes of a study as one scene.
#include <gtest/gtest.h>

#include <vector>

#include "geometry/gltf/write.hpp"
#include "geometry/solid.hpp"
#include "setup/sessions/load.hpp"
#include "sitting_bench.hpp"
#include "support/shapes.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "viewer/study/shapes.hpp"

namespace palpa::viewer {
namespace {

class Shapes : public testing::Test {
 protected:
  const std::filesystem::path folder_ = test::scratch_folder("study-shapes");
  const study::StudyPlan plan_ = study::read_plan(test::write_study_plan(folder_, ""));
  const StudyShapes shapes_ = load_shapes(plan_);
};

TEST_F(Shapes, OneAtATimeIsWithinReach) {
  geometry::write_glb(folder_ / "all.glb", shapes_.meshes);
  const std::vector<geometry::Solid> solids = setup::load_solids((folder_ / "all.glb").string());
  ASSERT_EQ(solids.size(), 2u);
  const std::vector<std::string> names{solids[0].name, solids[1].name};
  touch::PreparedSolids prepared = touch::prepare_solids(solids);
  for (std::size_t shape = 0; shape < 2; ++shape) {
    EXPECT_EQ(shape_of(names[shape]), shape);
    const std::vector<Transform> poses = only(shape, names);
    for (std::uint32_t s = 0; s < 2; ++s)
      touch::set_pose(prepared, s, poses[s]);
    // As if the other shape were not there.
    const std::vector<geometry::Solid> alone = setup::load_solids(plan_.shapes[shape].model);
    const Box box = touch::touchable_box(prepared), expected = touch::touchable_box(touch::prepare_solids(alone));
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(box.low[i], expected.low[i], 1e-6);
      EXPECT_NEAR(box.high[i], expected.high[i], 1e-6);
    }
    EXPECT_NEAR(shapes_.shapes[shape].box.high.y, 0, 1e-6) << "the objects' top";
  }
}

/// The level at the ears is predicted from both.
TEST(StudyShapes, AreTakenAsThePlanIsTried) {
  const std::filesystem::path folder = test::scratch_folder("study-unlike-shapes");
  std::string text = "[[method]]\nname = \"single-focus\"\nlayout = \"openmpd\"\n[study]\nparticipants = 2\n";
  const auto add = [&](const std::string& name, const geometry::Haptics& haptics, const Vec3& low, const Vec3& high) {
    const geometry::SceneMesh mesh{name, test::box(low, high), haptics, {}, {}};
    geometry::write_glb(folder / (name + ".glb"), {&mesh, 1});
    text += "[[shape]]\nname = \"" + name + "\"\nmodel = \"" + (folder / (name + ".glb")).string() + "\"\n";
  };
  geometry::Haptics quiet, spring, asking;
  quiet.intensity = 0.4;
  spring.stiffness = {{0, 0}, {0.01, 0.3}};
  asking.pressure_pa = 900;
  add("plain", {}, {-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
  add("quiet", quiet, {0, -0.02, 0}, {0.02, 0.01, 0.03});
  add("spring", spring, {-0.03, -0.03, -0.01}, {-0.01, 0, 0.01});
  add("asking", asking, {-0.01, -0.02, -0.04}, {0.01, 0.02, -0.02});
  test::write_text(folder / "plan.toml", text);
  study::StudyPlan taken = study::read_plan(folder / "plan.toml"), tried = taken;
  const std::vector<Box> boxes = take_shapes(taken, load_shapes(taken)), expected = setup::try_files(tried);
  ASSERT_EQ(boxes.size(), 4u);
  ASSERT_EQ(expected.size(), 4u);
  for (std::size_t shape = 0; shape < 4; ++shape) {
    SCOPED_TRACE(taken.shapes[shape].name);
    EXPECT_EQ(boxes[shape].low, expected[shape].low);
    EXPECT_EQ(boxes[shape].high, expected[shape].high);
    EXPECT_EQ(taken.shapes[shape].intensity, tried.shapes[shape].intensity);
    EXPECT_EQ(taken.shapes[shape].is_spring, tried.shapes[shape].is_spring);
    EXPECT_EQ(taken.shapes[shape].pressure_pa, tried.shapes[shape].pressure_pa);
    for (std::size_t other = 0; other < shape; ++other)
      EXPECT_NE(expected[shape].low, expected[other].low) << "unlike";
  }
  EXPECT_EQ(tried.shapes[1].intensity, 0.4);
  EXPECT_TRUE(tried.shapes[2].is_spring);
  EXPECT_EQ(tried.shapes[3].pressure_pa, 900);
}

TEST_F(Shapes, TheLowestPointIsOverTheObject) {
  const Box& cube = shapes_.shapes[0].box;
  std::vector<sensing::SkinPoint> points;
  const auto add_skin = [&](const glm::vec3& lowest) {
    for (int i = 0; i < 36; ++i)
      points.push_back(
          {lowest +
               glm::vec3(static_cast<float>(i % 6), 0.2F * static_cast<float>(i), static_cast<float>(i / 6)) * 1e-3F,
           0});
  };
  add_skin({0.03F, -0.01F, 0});
  EXPECT_FALSE(lowest_point(points, cube)) << "beside the cube, whose half width is 20 mm";
  add_skin({0, -0.043F, 0});
  const auto deep = lowest_point(points, cube);
  ASSERT_TRUE(deep) << "a finger that sticks out below is seen within the cube";
  EXPECT_LT(deep->y, -0.039);
  points.clear();
  add_skin({0.005F, -0.004F, 0.005F});
  points.push_back({{0, -0.03F, 0}, 1});  // a flying pixel
  const auto lowest = lowest_point(points, cube);
  ASSERT_TRUE(lowest);
  EXPECT_NEAR(lowest->y, -0.004, 1e-7);
}

}  // namespace
}  // namespace palpa::viewer
