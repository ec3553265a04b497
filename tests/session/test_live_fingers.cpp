// Foci on the fingers that a loop follows: where a finger stands, the sound on it some frames later, and a whole run.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/finger_transfer.hpp"
#include "array/drive.hpp"
#include "fakes.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "sensing/skin_twin.hpp"
#include "sensing/synthetic.hpp"
#include "session/loop/live_fingers.hpp"
#include "session/plan/finger_drives.hpp"
#include "session/session.hpp"
#include "support/thrown.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

using Complex = std::complex<double>;

/// A blunt finger: 40 mm long, its tip at the origin.
geometry::Mesh blunt_finger() {
  geometry::Mesh mesh = geometry::icosphere(8e-3, 8);
  for (Vec3& p : mesh.positions)
    p = {p.x, 2.5 * p.y + 20e-3, 0.9 * p.z};
  return mesh;
}

geometry::Mesh whole_finger() {
  return geometry::weld(test::finger_skin().mesh);
}

const std::vector<sensing::Camera>& cameras() {
  static const std::vector<sensing::Camera> paper = test::paper_cameras();
  return paper;
}

sensing::FrameSet seen(const geometry::Mesh& finger, const Transform& T_world_finger, sensing::Noise noise) {
  static sensing::SyntheticRig exact(cameras(), {}, sensing::Noise::none, 1);
  static sensing::SyntheticRig noisy(cameras(), {}, sensing::Noise::d415, 1);
  const sensing::Posed skin{&finger, T_world_finger};
  sensing::FrameSet set;
  (noise == sensing::Noise::none ? exact : noisy).render(std::span(&skin, 1), 0, set);
  return set;
}

std::vector<Vec3> skin_near(const sensing::FrameSet& set, const Vec3& at) {
  std::vector<Vec3> points;
  const Box box{at - Vec3(FingerFit::reach_m), at + Vec3(FingerFit::reach_m)};
  for (const sensing::SkinPoint& point : sensing::find_skin(cameras(), set.frames, box))
    points.emplace_back(point.position);
  return points;
}

Transform tilted(double about_x, double about_z, const Vec3& tip) {
  return glm::rotate(glm::rotate(glm::translate(Transform(1.0), tip), about_x, Vec3(1, 0, 0)), about_z, Vec3(0, 0, 1));
}

double angle_between(const Transform& a, const Transform& b) {
  return std::acos(std::clamp(glm::dot(Vec3(a[1]), Vec3(b[1])), -1.0, 1.0));
}

TEST(FingerFit, FindsAFingerInNoisyImages) {
  const geometry::Mesh finger = whole_finger();
  const FingerFit fit(finger);
  for (const Transform& stands : {tilted(0, 0, {0, -2e-3, 0}), tilted(0.3, -0.25, {3e-3, -1e-3, -4e-3}),
                                  tilted(-0.5, 0.1, {-5e-3, 2e-3, 2e-3})}) {
    const Vec3 tip(stands[3]);
    std::vector<Vec3> skin = skin_near(seen(finger, stands, sensing::Noise::d415), tip);
    ASSERT_GE(skin.size(), 200U);
    // Some skin of another finger beside it.
    for (int i = 0; i < 60; ++i)
      skin.push_back(tip + Vec3(19e-3 + 1e-3 * std::sin(i), 0.2e-3 * i, 3e-3 * std::cos(2.3 * i)));
    const std::optional<FittedPose> pose = fit.find(skin, tip + 1e-3 * Vec3(stands[1]), std::nullopt);
    ASSERT_TRUE(pose.has_value());
    EXPECT_LE(glm::distance(Vec3(pose->T_world_finger[3]), tip), 0.8e-3);
    EXPECT_LE(angle_between(pose->T_world_finger, stands), 0.05);
    EXPECT_LE(pose->rms_m, 0.8e-3);
    // A little later, from there.
    const Transform later = glm::translate(Transform(1.0), Vec3(1e-3, -2e-3, 1e-3)) * stands;
    const Vec3 then(later[3]);
    const auto next = fit.find(skin_near(seen(finger, later, sensing::Noise::d415), then), then, pose->T_world_finger);
    ASSERT_TRUE(next.has_value());
    EXPECT_LE(glm::distance(Vec3(next->T_world_finger[3]), then), 0.8e-3);
    EXPECT_LE(angle_between(next->T_world_finger, later), 0.05);
  }
}

TEST(FingerFit, FindsNoFingerInOtherThings) {
  const geometry::Mesh finger = whole_finger();
  const FingerFit fit(finger);
  std::vector<Vec3> table;
  for (int i = -20; i <= 20; ++i) {
    for (int j = -20; j <= 20; ++j)
      table.emplace_back(1e-3 * i, 0, 1e-3 * j);
  }
  EXPECT_FALSE(fit.find(table, Vec3(0), std::nullopt).has_value());
  EXPECT_FALSE(fit.find(std::span(table).first(20), table[0], std::nullopt).has_value());
}

/// A blunt finger above a board, with six foci inside its tip.
struct Above {
  SessionSetting setting;
  touch::Touch touch;
  array::Schedule schedule;
  std::shared_ptr<const acoustics::RigidBody> body;

  Above() {
    setting.cameras = cameras();
    const Transform up = glm::translate(Transform(1.0), Vec3(0, -0.15, 0)) *
                         glm::rotate(Transform(1.0), -std::numbers::pi / 2, Vec3(1, 0, 0));
    setting.layout = array::transformed(array::load_layout("openmpd"), up);
    setting.finger = {"the finger", blunt_finger(), acoustics::without_absorption(acoustics::air_of({}))};
    body = std::make_shared<const acoustics::RigidBody>(setting.finger->body, setting.finger->air.wave_number());
  }
  /// The frame's finger stands at `T`. Before it, the frame has another finger, which is expected to have left when its
  /// foci would sound, and thus has no voice.
  void stand(const Transform& T, double time_s, std::uint32_t id = 7) {
    touch.fingers.resize(2);
    touch.finger_count = 2;
    touch.fingers[0].id = id + 100;
    touch.fingers[0].section.centroid = glm::vec3(0.1F, 0, 0);
    touch.fingers[1].id = id;
    touch.fingers[1].section.centroid = glm::vec3(transform_point(T, {0, 2e-3, 0}));
    schedule.clear();
    schedule.time_s = time_s;
    array::Voice& voice = schedule.add_voice();
    voice.id = id;
    voice.foci.clear();
    for (int i = 0; i < 6; ++i)
      voice.foci.push_back(transform_point(T, {2.5e-3 * std::cos(i), 3e-3, 2.5e-3 * std::sin(i)}));
  }
  /// Shows frames of a finger that stands there until `done`, which hears whether the frame's finger is known.
  bool watch(LiveFingers& live, const Transform& T, const std::function<bool(bool known)>& done) {
    const sensing::FrameSet images = seen(setting.finger->body, T, sensing::Noise::none);
    double time_s = 0;
    // The frames' time passes more slowly than the clock's, because answers are slow with sanitizers, and expire.
    for (std::uint64_t sequence = 0; sequence < 20000; ++sequence, time_s += 4e-4) {
      stand(T, time_s);
      const bool known = live.take(schedule);
      live.saw(images.frames, sequence);
      live.planned({.sequence = sequence, .time_s = time_s, .touch = &touch}, schedule);
      if (done(known)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  array::Drive drive(const Vec3& focus, const array::Transfer* transfer) const {
    array::DriveOptions drive = setting.drive;
    drive.transfer = transfer;
    const array::SlotFocus one{focus};
    return array::drive_for(setting.layout, {&one, 1}, drive);
  }
  /// The pressure on the skin of each focus of a finger at `T`, with the drive by `transfer` (null: for free air) over
  /// that with the best drive.
  std::vector<double> parts(const Transform& T, const array::Transfer* transfer) const {
    const array::Layout layout = array::transformed(setting.layout, glm::inverse(T));
    acoustics::FingerTransfer exact(*body, layout, setting.finger->air, setting.drive.directivity);
    std::vector<double> parts;
    for (const Vec3& focus : schedule.voices[0].foci) {
      const Vec3 place = transform_point(glm::inverse(T), focus);
      exact.aim({&place, 1});
      array::Columns columns;
      const array::FocusSource source{place, 0, 1};
      exact.fill({&source, 1}, array::Weighting::uniform, columns);
      const array::Drive played = drive(focus, transfer);
      Complex sum = 0;
      double best = 0;
      for (std::size_t t = 0; t < played.size(); ++t) {
        sum += std::polar<double>(played[t].amplitude, played[t].phase) * columns.transfer(t);
        best += played[t].amplitude * std::abs(columns.transfer(t));
      }
      parts.push_back(std::abs(sum) / best);
    }
    return parts;
  }
};

void expect_same(std::span<const array::TransducerDrive> is, const array::Drive& right, double amplitude,
                 double phase) {
  ASSERT_EQ(is.size(), right.size());
  for (std::size_t t = 0; t < right.size(); ++t) {
    ASSERT_NEAR(is[t].amplitude, right[t].amplitude, amplitude);
    ASSERT_NEAR(std::remainder(is[t].phase - right[t].phase, 2 * std::numbers::pi), 0, phase);
  }
}

TEST(LiveFingers, FociSoundOnTheSkinOfAFingerThatMovesOn) {
  Above above;
  LiveFingers live(above.setting);
  live.begin();
  const Transform begins = tilted(0.1, 0.05, {1e-3, -1e-3, 0});
  ASSERT_TRUE(above.watch(live, begins, [](bool known) { return known; }));
  const double time_s = above.schedule.time_s;
  // Three frames later, the finger has moved and turned a little.
  const Transform later = tilted(0.12, 0.03, {2e-3, -1.8e-3, 0.5e-3});
  above.stand(later, time_s + 0.03);
  ASSERT_TRUE(live.take(above.schedule));
  const std::vector<double> with = above.parts(later, &live), without = above.parts(later, nullptr);
  double least_gain = 1e9;
  for (std::size_t j = 0; j < with.size(); ++j) {
    EXPECT_GE(with[j], 0.96) << j;
    least_gain = std::min(least_gain, with[j] / without[j]);
  }
  EXPECT_GE(least_gain, 1.01);
  // A planner's drives of single foci are these, at the cost of free air.
  Scheduler scheduler("scene", {}, {}, {});
  FingerDrives drives(above.setting, scheduler, live);
  Plan plan;
  plan.schedule = above.schedule;
  array::Voice& voice = plan.schedule.voices[0];
  voice.order = {0, 1, 2, 3, 4, 5};
  SlotWork work;
  ASSERT_TRUE(drives.make(plan, work));
  ASSERT_EQ(plan.cycle.length, 6U);
  for (std::size_t j = 0; j < voice.foci.size(); ++j)
    expect_same(plan.drive(j, above.setting.layout.transducers.size()), above.drive(voice.foci[j], &live), 5e-3, 1e-4);
  // Slots that the plan does not list sound as in free air.
  const std::uint64_t frames = live.stats().frames;
  const array::Voice copy = voice;
  plan.schedule.add_voice() = copy;
  plan.schedule.voices[1].dwell_s = 1.637e-3;
  EXPECT_FALSE(drives.make(plan, work));
  EXPECT_EQ(live.stats().frames, frames);

  const FingerSoundStats stats = live.stats();
  EXPECT_GE(stats.answers, 1U);
  EXPECT_EQ(stats.not_found, 0U);
  above.stand(begins, time_s);
  std::vector<double> gains;
  for (const double part : above.parts(begins, nullptr))
    gains.push_back(1 / part);
  std::ranges::sort(gains);
  EXPECT_NEAR(stats.gain.quantile(0), gains.front(), 0.04 * gains.front());
  EXPECT_NEAR(stats.gain.quantile(1), gains.back(), 0.04 * gains.back());

  // A focus that moved along the skin, another finger, an old answer: free air.
  above.stand(begins, time_s);
  above.schedule.voices[0].foci[2] += Vec3(0, 4e-3, 0);
  ASSERT_TRUE(live.take(above.schedule));
  const Vec3 moved = above.schedule.voices[0].foci[2];
  expect_same(above.drive(moved, &live), above.drive(moved, nullptr), 1e-6, 1e-5);
  above.stand(begins, time_s, 8);
  EXPECT_FALSE(live.take(above.schedule));
  above.stand(begins, time_s + 2 * LiveFingers::most_age_s);
  EXPECT_FALSE(live.take(above.schedule));
}

TEST(LiveFingers, FindNoFingerInWhatIsNoSkin) {
  Above above;
  above.setting.surroundings.room = Box{{1, 1, 1}, {2, 2, 2}};  // the finger is outside
  LiveFingers live(above.setting);
  live.begin();
  EXPECT_TRUE(above.watch(live, tilted(0.1, 0.05, {1e-3, -1e-3, 0}), [&](bool known) {
    EXPECT_FALSE(known);
    return live.stats().not_found > 0;
  }));
  EXPECT_EQ(live.stats().answers, 0U);
}

SessionSetting running() {
  SessionSetting setting = Above().setting;
  setting.solids = test::asset_solids("cube");
  return setting;
}

/// A session goes on computing between its runs, so that a slow machine needs only more of them.
TEST(LiveFingers, OfARunAreFoundInItsImages) {
  Session session(running());
  FingerSoundStats found;
  for (int runs = 0; runs < 100 && found.answers == 0; ++runs) {
    const auto source = sensing::make_synthetic_source(cameras(), blunt_finger(), {}, {.frames = 60});
    test::SpyLink link;
    std::atomic<bool> stop = false;
    found = session.run(*source, link, stop).finger_sounds.value();
  }
  EXPECT_GT(found.answers, 0U);
}

TEST(LiveFingers, AreRefusedWhereTheyCannotWork) {
  SessionSetting single = running();
  single.frame_by_frame = true;
  EXPECT_ERROR(Session(std::move(single)), Exit::usage, "only while it runs");
  Session session(running());
  const auto source = sensing::make_synthetic_source(cameras(), blunt_finger(), {}, {.paced = false, .frames = 1});
  test::SpyLink link;
  std::atomic<bool> stop = false;
  EXPECT_ERROR(session.run(*source, link, stop, {.every_frame = true}), Exit::usage, "a run of every frame");
}

}  // namespace
}  // namespace palpa::session
