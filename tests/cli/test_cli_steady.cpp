// Foci do not jump: fingers at rest, dipping, sliding and fast on all four objects of the paper, seen by its rig and
// played by a session with the settings of a run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_mesh.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/synthetic.hpp"
#include "session/session.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "support/device.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

constexpr double film_hz = 90;

/// The motion of the finger of assets/finger.ply on an object whose top is at y = 0 on the y axis.
struct Film {
  sensing::Motion motion;
  int frames = 0;
  sensing::Noise noise = sensing::Noise::d415;
  std::uint64_t seed = 5;
};

Transform at(double x, double y, double z) {
  return glm::translate(Transform(1.0), Vec3(x, y, z));
}

/// The tip `press` below the surface of the semi-sphere, so far from its top along it; of any other object below y = 0.
Transform on(const std::string& object, double way, double press) {
  constexpr double radius = 0.02, beside = 0.4e-3;
  if (object != "semi-sphere") return at(way, -press, beside);
  return at(radius * std::sin(way / radius), radius * (std::cos(way / radius) - 1) - press, beside);
}

/// At rest near the object's middle, 2, 3 and 4 mm deep, `frames` each, with the finger away in between.
Film resting(int frames) {
  constexpr int away = 12;
  const auto motion = [frames](double t) {
    const int frame = static_cast<int>(std::lround(t * film_hz)), turn = frames + away;
    const int deeper = frame / turn;
    if (frame % turn >= frames) return at(0, 0.05, 0);
    return at(0.7e-3, -2e-3 - 1e-3 * deeper, 0.4e-3);
  };
  return {motion, 3 * frames + 2 * away};
}

/// Slides by 0.25 mm per frame, noise-free: over the cube's edge, down the semi-sphere's side, across the ridge of the
/// prism or the top of the pyramid.
Film sliding(const std::string& object) {
  const bool wide = object == "cube" || object == "semi-sphere";
  const double end = wide ? 0.027 : 0.009, begin = wide ? 0.012 : -end;
  const auto motion = [=](double t) { return on(object, begin + 0.25e-3 * film_hz * t, 3e-3); };
  return {motion, static_cast<int>((end - begin) / 0.25e-3) + 1, sensing::Noise::none};
}

/// From 0 at 100 mm/s for `duration`, the first and last 20 ms of it speeding up and slowing down.
double stroke(double t, double duration) {
  const auto ramp = [](double u) { return u < 0 ? 0.0 : u < 0.02 ? u * u / 0.04 : u - 0.01; };
  return 0.1 * (ramp(t) - ramp(t - duration));
}

/// On the cube, back and forth at 100 mm/s.
Film fast() {
  const auto motion = [](double t) { return on("cube", stroke(t - 0.05, 0.18) - stroke(t - 0.35, 0.18) - 8e-3, 3e-3); };
  return {motion, 54};
}

/// The object that a film is played on, and the settings that keep its foci from jumping.
struct Play {
  std::string object;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
};

/// The foci of one frame.
struct Foci {
  double time_s = 0;
  std::map<std::uint32_t, std::vector<Vec3>> of_finger;
};

session::Session session_for(const Play& play, const std::vector<sensing::Camera>& cameras) {
  const std::string scene = source_file("assets/" + play.object + ".glb");
  session::SessionSetting setting{.scene = scene,
                                  .solids = setup::load_solids(scene),
                                  .cameras = cameras,
                                  .schedule = setup::schedule_options({}),
                                  .events = std::nullopt,
                                  .axes = play.axes,
                                  .smoothing = play.smoothing,
                                  .hold_s = 0.5};
  setting.touch.foci = 10;
  // One transducer: foci do not depend on the array, and drives, which are not used here, take longer for more.
  setting.layout.transducers.push_back({Vec3(0, -0.15, 0), Vec3(0, 1, 0)});
  session::Session session(test_device(), std::move(setting));
  session.warm_up();
  return session;
}

/// The foci of each frame of a film, for each play. The film is rendered once for all plays.
std::vector<std::vector<Foci>> played(const Film& film, const std::vector<Play>& plays) {
  const setup::PosedRig rig = setup::load_posed_rig({});
  sensing::SyntheticRig cameras(rig.rig.cameras, array::board_mesh(rig.layout), film.noise, film.seed);
  const geometry::Ply ply = geometry::read_ply(source_file("assets/finger.ply"));
  const geometry::Mesh finger{ply.positions, ply.triangles};
  std::vector<session::Session> sessions;
  for (const Play& play : plays)
    sessions.push_back(session_for(play, cameras.cameras()));
  std::vector<std::vector<Foci>> all(plays.size());
  sensing::FrameSet set;
  for (int k = 0; k < film.frames; ++k) {
    const sensing::Posed posed{&finger, film.motion(k / film_hz)};
    set.sequence = static_cast<std::uint64_t>(k);
    set.time_s = k / film_hz;
    cameras.render(std::span(&posed, 1), set.sequence, set);
    for (sensing::DepthFrame& frame : set.frames)
      frame.time_s = set.time_s;
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      sessions[i].touch(set.frames, set.time_s);
      const array::Schedule& schedule = sessions[i].schedule();
      Foci& foci = all[i].emplace_back(Foci{schedule.time_s, {}});
      for (const array::Voice& voice : std::span(schedule.voices).first(schedule.voice_count))
        foci.of_finger[voice.id] = voice.foci;
    }
  }
  return all;
}

Vec3 mean_of(const std::vector<Vec3>& foci) {
  Vec3 sum(0);
  for (const Vec3& focus : foci)
    sum += focus / static_cast<double>(foci.size());
  return sum;
}

const std::vector<Vec3>* foci_of(const Foci& frame, std::uint32_t finger) {
  const auto found = frame.of_finger.find(finger);
  return found == frame.of_finger.end() ? nullptr : &found->second;
}

/// From frame to frame, the movement of the focus that moves most, without the movement of the foci's mean: metres,
/// ascending. A touch's first `leave_out` frames do not count.
std::vector<double> movements_of(const std::vector<Foci>& frames, int leave_out = 0) {
  std::vector<double> movements;
  std::map<std::uint32_t, int> age;  // in frames, of those that touch
  for (std::size_t k = 1; k < frames.size(); ++k) {
    std::map<std::uint32_t, int> next;
    for (const auto& [id, now] : frames[k].of_finger) {
      const std::vector<Vec3>* const before = foci_of(frames[k - 1], id);
      next[id] = before ? age[id] + 1 : 0;
      if (!before || before->size() != now.size() || next[id] < leave_out) continue;
      const Vec3 mean = mean_of(now) - mean_of(*before);
      double most = 0;
      for (std::size_t n = 0; n < now.size(); ++n)
        most = std::max(most, glm::length(now[n] - (*before)[n] - mean));
      movements.push_back(most);
    }
    age = next;
  }
  std::sort(movements.begin(), movements.end());
  return movements;
}

/// Which 95 % of them do not exceed.
double usual_of(const std::vector<double>& movements) {
  return movements.empty()
             ? 0
             : movements[static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(movements.size() - 1)))];
}

/// More than `count` movements; 95 % of them are at most `usual`, all at most `most`: metres.
void expect_steady(const std::vector<double>& movements, std::size_t count, double usual, double most) {
  ASSERT_GT(movements.size(), count);
  EXPECT_LE(usual_of(movements), usual);
  EXPECT_LE(movements.back(), most);
}

/// The delay of the mean of the foci of `late` behind that of `early`, in seconds: least squares over all fingers.
double lag_of(const std::vector<Foci>& early, const std::vector<Foci>& late) {
  double behind = 0, square = 0;
  for (std::size_t k = 1; k + 1 < early.size(); ++k) {
    for (const auto& [id, now] : early[k].of_finger) {
      const std::vector<Vec3>*const before = foci_of(early[k - 1], id), *const after = foci_of(early[k + 1], id),
                                    *const same = foci_of(late[k], id);
      if (!before || !after || !same) continue;
      const Vec3 velocity = (mean_of(*after) - mean_of(*before)) / (early[k + 1].time_s - early[k - 1].time_s);
      behind += glm::dot(velocity, mean_of(now) - mean_of(*same));
      square += glm::dot(velocity, velocity);
    }
  }
  return behind / square;
}

/// The film on each object: it is the same on all.
std::vector<std::vector<Foci>> on_each(const std::vector<std::string>& objects, const Film& film) {
  std::vector<Play> plays;
  for (const std::string& object : objects)
    plays.push_back({object});
  return played(film, plays);
}

const std::vector<std::string> all_objects = the_first<std::string>(1, {"cube", "semi-sphere", "pyramid", "prism"});

// With sanitizers, only the dipping finger is played: the others take the same path.
constexpr const char* same_path = "skipped: the dipping finger takes the same path";

TEST(SteadyFoci, OfAFingerAtRest) {
  if (instrumented()) GTEST_SKIP() << same_path;
  for (const std::vector<Foci>& frames : on_each(all_objects, resting(20)))
    expect_steady(movements_of(frames), 45, 0.6e-3, 1.2e-3);
  // Without steady axes and smoothing, they jump: these tests measure something.
  const Play jumping{"prism", touch::Axes::covariance, touch::Smoothing::none};
  EXPECT_GT(usual_of(movements_of(played(resting(8), {jumping})[0])), 2e-3);
}

TEST(SteadyFoci, OfTheDippingFinger) {
  const Film film{.motion = sensing::dipping_motion, .frames = 95, .seed = 0};
  for (const std::vector<Foci>& frames : on_each(all_objects, film))
    expect_steady(movements_of(frames, 3), 40, 0.8e-3, 1.6e-3);
}

TEST(SteadyFoci, OfAFingerThatSlidesOverEdges) {
  if (instrumented()) GTEST_SKIP() << same_path;
  const std::vector<std::vector<std::string>> paths{{"cube"}, {"semi-sphere"}, {"pyramid", "prism"}};
  for (const std::vector<std::string>& objects : paths) {
    for (const std::vector<Foci>& frames : on_each(objects, sliding(objects.front())))
      expect_steady(movements_of(frames), 20, 3 * 0.25e-3, 3 * 0.25e-3);
  }
}

TEST(SteadyFoci, OfAFastFingerAreNotLate) {
  if (instrumented()) GTEST_SKIP() << same_path;
  const auto both = played(fast(), {{"cube"}, {.object = "cube", .smoothing = touch::Smoothing::none}});
  EXPECT_GT(movements_of(both[1]).size(), 30u);
  EXPECT_LE(lag_of(both[1], both[0]), 5e-3);
}

}  // namespace
}  // namespace palpa::test
