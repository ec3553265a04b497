// A sensation on the finger that touches a solid, seen by depth cameras: where it plays, and when it falls silent.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "setup/sessions/play.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// Tells where the focus is in each slot in which something sounds.
class PlacesLink final : public session::Link {
 public:
  using Told = std::function<void(std::optional<Vec3> place_m)>;
  explicit PlacesLink(Told told) : told_(std::move(told)) {}
  void plan(const session::PlayedPlan& plan) override { schedule_ = plan.schedule; }
  void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    if (!session::sounds(drive)) return told_(std::nullopt);
    std::vector<array::SlotFocus> foci;
    array::foci_of_slot(schedule_, slot, foci);
    told_(foci.at(0).position);
  }

 private:
  Told told_;
  array::Schedule schedule_;
};

TEST(PlayOnFinger, PlaysAtItsCentroidAndIsSilentWithoutIt) {
  std::atomic<bool> touches{true}, stop{false};
  const session::SourceKind held =
      session::synthetic_source("synthetic", "a fingertip in the cube, or above it", [&](double) {
        Transform T_world_finger(1.0);
        T_world_finger[3] = Vec4(2e-3, touches ? -3e-3 : 60e-3, 1e-3, 1);
        return T_world_finger;
      });
  setup::PlayOptions options;
  options.names = {"it"};
  options.on = setup::On::finger;
  options.source = "synthetic";
  options.scene = source_file("assets/cube.glb").string();
  options.rig.layout = "openmpd";
  options.link = "places";
  options.hold_s = 1;  // frames of a busy machine are late
  options.common.backend = setup::Backend::cpu;
  options.common.quiet = options.noise_free = true;
  setup::check(options);
  setup::FrameOptions frames = options;
  frames.watched = true;
  const setup::Prepared seen = setup::prepare(frames, {&held, 1}, false);
  sensing::FrameSet frame;
  ASSERT_TRUE(seen.source->next(frame, 1));
  const touch::Touch& touch = seen.session->touch(frame.frames, frame.time_s);
  ASSERT_EQ(touch.finger_count, 1U);
  const Vec3 centroid(touch.fingers[0].section.centroid);
  EXPECT_LT(glm::distance(centroid, Vec3(2e-3, -1.5e-3, 1e-3)), 2e-3);

  // In the array's frame 10 mm to the right and 5 mm towards the finger: in the world to the right and upwards.
  sensation::FunctionSensation beside([](std::span<const double> times, auto& places, auto& gains) {
    places.assign(times.size(), Vec3(0.01, 0, 0.005));
    gains.assign(times.size(), 1);
  });
  int sounding = 0, silent = 0, turns = 0;
  std::vector<Vec3> places;
  const auto told = [&](const std::optional<Vec3>& place) {
    sounding = place ? sounding + 1 : 0;
    silent = place ? 0 : silent + 1;
    if (place) places.push_back(*place);
    constexpr int enough = 40;  // in a row
    if (touches && sounding >= enough) {
      touches = false;
      ++turns;
    } else if (!touches && silent >= enough) {
      touches = true;
    }
    if (turns == 3) stop = true;
  };
  const session::LinkKind kind{"places", "places: tells places", [&](const std::string&, const session::LinkSetting&) {
                                 return std::make_unique<PlacesLink>(told);
                               }};
  const auto links = setup::with_builtin(std::span(&kind, 1));
  const auto playing = setup::prepare_play(options, 0, "it", links);
  session::SensationControl control;
  const session::OutputStats stats = setup::play(options, beside, control, *playing, {}, {&held, 1}, links, stop);
  EXPECT_EQ(turns, 3);
  EXPECT_GT(stats.silent_drives, 0U);
  ASSERT_GE(places.size(), 120U);
  for (const Vec3& place : places)
    EXPECT_LT(glm::distance(place, centroid + Vec3(0.01, 0.005, 0)), 0.3e-3);
}

}  // namespace
}  // namespace palpa::test
