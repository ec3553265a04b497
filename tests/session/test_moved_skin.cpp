// The skin of a finger that moves: how far it has moved, and whether it touches where it will be.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <vector>

#include "predict_chain.hpp"
#include "session/predict/second_search.hpp"
#include "session/predict/skin_step.hpp"
#include "support/shapes.hpp"
#include "touch/stage.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

/// A plate of 80 mm x 80 mm, 4 mm thick, whose top is at y = 0, and that faces downwards to the cameras as well.
geometry::Mesh plate() {
  return test::box({-0.04, -0.004, -0.04}, {0.04, 0, 0.04});
}

/// A finger in front of the paper's cameras, in two frames, and things that do not move.
struct TwoFrames {
  std::vector<sensing::Camera> cameras = test::paper_cameras();
  sensing::RayTables tables = sensing::make_rays(cameras);
  sensing::Surroundings surroundings;
  CameraView view{cameras, tables, &surroundings};
  std::vector<sensing::FrameSet> frames{2};

  TwoFrames(const Vec3& tip, const Vec3& way, const geometry::Mesh* still, const Transform& T_world_still) {
    sensing::SyntheticRig rig(cameras, {}, sensing::Noise::none, 1);
    for (int k = 0; k < 2; ++k) {
      std::vector<sensing::Posed> posed{{&test::finger_skin().mesh, test::tip_at(tip + (k == 1 ? way : Vec3(0)))}};
      if (still) posed.push_back({still, T_world_still});
      rig.render(posed, static_cast<std::uint64_t>(k), frames[static_cast<std::size_t>(k)]);
    }
  }
  TwoFrames(const TwoFrames&) = delete;
  TwoFrames& operator=(const TwoFrames&) = delete;

  KeptFrames kept(std::size_t k) const {
    KeptFrames kept(view);
    const std::vector<Box> boxes{Box{Vec3(-0.1), Vec3(0.1)}};
    kept.keep(view, frames[k].frames, boxes);
    return kept;
  }
  SkinStep step(const Box& box) const {
    SkinScratch scratch;
    return find_skin_step(view, kept(1), kept(0), box, Vec3(0), Vec3(0), scratch);
  }
};

constexpr double around_m = 14e-3;

Box around(const Vec3& place) {
  return {place - around_m, place + around_m};
}

TEST(SkinStep, IsThatOfTheSkinAlone) {
  const Vec3 way(2e-3, 1e-3, 0);
  // The plate is 3 mm beside the finger's side, in the box of the finger's tip.
  const geometry::Mesh board = plate();
  const Transform T_world_board = test::tip_at({-0.052, 0.004, 0});
  TwoFrames alone({0, 0, 0}, way, nullptr, Transform(1)), boarded({0, 0, 0}, way, &board, T_world_board);
  const Box box = around({0, 2e-3, 0});
  const SkinStep right = alone.step(box), mixed = boarded.step(box);
  ASSERT_GE(right.samples, least_skin_samples);
  EXPECT_LT(glm::distance(right.way, way), 0.4e-3);
  EXPECT_GT(glm::distance(mixed.way, right.way), 0.2e-3) << "the board is not in sight";
  // A board's face is its plane z = 0. This one faces upwards.
  sensing::Slab slab{.width_m = 0.08, .height_m = 0.08};
  slab.T_world_slab = Transform(Vec4(1, 0, 0, 0), Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(-0.052, 0.004, 0, 1));
  boarded.surroundings.slabs.push_back(slab);
  const SkinStep found = boarded.step(box);
  ASSERT_GE(found.samples, least_skin_samples);
  EXPECT_LT(found.samples, mixed.samples);
  EXPECT_LT(glm::distance(found.way, right.way), 0.1e-3);
  // Nothing is skin outside the room.
  boarded.surroundings.room = Box{Vec3(1), Vec3(2)};
  EXPECT_EQ(boarded.step(box).samples, 0U);
}

/// A finger 3 mm deep in the plate, and its touch.
struct InThePlate : TwoFrames {
  std::vector<geometry::Solid> solids = geometry::make_solids({"plate", {{"plate", plate()}}});
  touch::Touch seen;

  InThePlate() : TwoFrames({0, -3e-3, 0}, Vec3(0), nullptr, Transform(1)) {
    touch::Stage(solids, cameras).touch(frames[0].frames, seen);
  }
  /// The contacts that the finger has after it has moved up by `lift_m`; none if it no longer touches then.
  std::uint32_t contacts_after(double lift_m, std::uint32_t min_points, bool holds) {
    seen.fingers[0].holds = holds;
    touch::FingerOptions parameters;
    parameters.min_points = min_points;
    const touch::PreparedSolids prepared = touch::prepare_solids(solids, parameters);
    touch::Touch out;
    const bool touches = SecondSearch(view, prepared, parameters).move(seen, 0, {0, lift_m, 0}, kept(0), out);
    EXPECT_EQ(out.finger_count, touches ? 1U : 0U);
    return touches ? out.fingers[0].contact_count : 0;
  }
};

TEST(SecondSearch, AFingerThatHoldsEndsWithHalfOfTheContactsWithWhichItBegins) {
  InThePlate finger;
  ASSERT_EQ(finger.seen.finger_count, 1U);
  // The finger is near, so only every third pixel of every third row is examined, and a ninth of the contacts suffices.
  constexpr std::uint32_t min_points = 9 * 21;
  std::uint32_t few = 0;
  for (double lift_m = 0; lift_m < 4e-3; lift_m += 0.1e-3) {
    const std::uint32_t contacts = finger.contacts_after(lift_m, 1, false);
    SCOPED_TRACE(testing::Message() << lift_m * 1e3 << " mm, " << contacts << " contacts");
    EXPECT_EQ(finger.contacts_after(lift_m, min_points, false), contacts >= 21 ? contacts : 0);
    EXPECT_EQ(finger.contacts_after(lift_m, min_points, true), contacts >= 11 ? contacts : 0);
    few += contacts >= 11 && contacts < 21 ? 1 : 0;
  }
  EXPECT_GT(few, 0U);
  EXPECT_EQ(finger.contacts_after(4e-3, 1, true), 0U);
}

TEST(SecondSearch, AFingerThatHoldsEndsHalfAMillimetreOffTheSurface) {
  InThePlate finger;
  ASSERT_EQ(finger.seen.finger_count, 1U);
  const std::uint32_t seen = finger.seen.fingers[0].contact_count;
  finger.seen.fingers[0].inward = {0, -1, 0};
  double last_moved_m = 0;
  std::uint32_t whole = 0;
  for (double lift_m = 1.5e-3; lift_m < 4e-3; lift_m += 0.02e-3) {
    const bool has_half = finger.contacts_after(lift_m, 9 * 11, false) > 0;
    const std::uint32_t contacts = finger.contacts_after(lift_m, 9 * 21, true);
    if (contacts > 0) last_moved_m = lift_m;
    if (has_half || contacts == 0) continue;
    EXPECT_EQ(contacts, seen) << "it moves as a whole";
    ++whole;
  }
  EXPECT_GT(whole, 10U);
  EXPECT_NEAR(last_moved_m, 3.5e-3, 0.15e-3);
}

}  // namespace
}  // namespace palpa::session
