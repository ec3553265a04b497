#include "predict_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "array/schedule.hpp"
#include "session/session.hpp"
#include "support/hand_films.hpp"
#include "support/shapes.hpp"
#include "touched_scene.hpp"

namespace palpa::test {
namespace {

std::vector<geometry::Solid> solids_of(const std::string& scene) {
  if (scene != "plate") return asset_solids(scene);
  return geometry::make_solids({"plate", {{"plate", box({-0.08, -0.02, -0.08}, {0.08, 0, 0.08})}}});
}

session::Session session_for(const ChainFilm& film, const std::vector<sensing::Camera>& cameras,
                             std::optional<double> latency_s, bool on_device) {
  session::SessionSetting setting{.solids = solids_of(film.scene), .cameras = cameras, .events = std::nullopt};
  if (latency_s) setting.predict = {session::Predict::automatic, latency_s};
  setting.layout.transducers.push_back({Vec3(0, -0.15, 0), Vec3(0, 1, 0)});
  return on_device ? session::Session(test_device(), std::move(setting)) : session::Session(std::move(setting));
}

/// The foci as they are seen over time.
struct Truth {
  struct Frame {
    double time_s = 0;
    std::vector<Vec3> foci;  ///< none: no finger
  };
  std::vector<Frame> frames;

  void add(double time_s, const array::Schedule& schedule) {
    frames.push_back({time_s, schedule.voice_count > 0 ? schedule.voices[0].foci : std::vector<Vec3>()});
  }
  /// Linear between two frames; nothing if one of them has no finger.
  std::optional<Vec3> at(double time_s, std::uint32_t number) const {
    const auto after =
        std::upper_bound(frames.begin(), frames.end(), time_s, [](double t, const Frame& f) { return t < f.time_s; });
    if (after == frames.begin() || after == frames.end()) return std::nullopt;
    const Frame &a = after[-1], &b = *after;
    if (number >= a.foci.size() || number >= b.foci.size()) return std::nullopt;
    return glm::mix(a.foci[number], b.foci[number], (time_s - a.time_s) / (b.time_s - a.time_s));
  }
};

double p95_of(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() * 95 / 100];
}

/// Renders a film frame by frame.
class Rendering {
 public:
  explicit Rendering(const ChainFilm& film) : Rendering(film, film.noise) {}
  Rendering(const ChainFilm& film, sensing::Noise noise) : film_(film), rig_(paper_cameras(), {}, noise, film.seed) {}
  const std::vector<sensing::Camera>& cameras() const { return rig_.cameras(); }
  std::uint64_t frames() const { return static_cast<std::uint64_t>(film_.length_s * film_.rate_hz); }
  double time_of(std::uint64_t k) const { return static_cast<double>(k) / film_.rate_hz; }
  std::span<const sensing::DepthFrame> frame(std::uint64_t k) {
    std::vector<sensing::Posed> posed{{film_.skin ? film_.skin : &finger_, film_.motion(time_of(k))}};
    if (film_.second) posed.push_back({&finger_, film_.second(time_of(k))});
    rig_.render(posed, k, set_);
    return set_.frames;
  }

 private:
  const ChainFilm& film_;
  sensing::SyntheticRig rig_;
  const geometry::Mesh& finger_ = finger_skin().mesh;
  sensing::FrameSet set_;
};

/// One of the two sessions, and what it did.
struct Run {
  session::Session session;
  bool predicts;
  ChainError error{};
  std::vector<array::Schedule> schedules{};  ///< one for each frame
  std::vector<double> errors{}, steps{};
};

}  // namespace

Transform tip_at(const Vec3& tip) {
  Transform T(1.0);
  T[3] = Vec4(tip, 1);
  return T;
}

ChainFilm sliding_film(double speed, bool along_z, double length_s) {
  return {"plate",
          [=](double t) {
            const double way = speed * (t - length_s / 2);
            return tip_at(along_z ? Vec3(0, -0.003, way) : Vec3(way, -0.003, 0));
          },
          length_s};
}

ChainFilm hand_film(double speed, bool along_z, double length_s) {
  static const HandScene hand = hand_scene("point", 3e-3, 45);
  ChainFilm film = sliding_film(speed, along_z, length_s);
  film.skin = hand.skin.at(0).mesh;
  film.motion = [=, T = hand.skin.at(0).T_world_mesh](double t) {
    const double way = speed * (t - length_s / 2);
    return tip_at(along_z ? Vec3(0, 0, way) : Vec3(way, 0, 0)) * T;
  };
  film.exact_truth = true;
  return film;
}

ChainFilm crossing_film(double speed) {
  constexpr double radius = 0.02, half = 0.015;
  return {"semi-sphere",
          [=](double t) {
            const double x = std::min(speed * t - half, radius);
            return tip_at({x, std::sqrt(radius * radius - x * x) - radius - 0.003, 0});
          },
          2 * half / speed};
}

ChainFilm lifting_film(double speed) {
  constexpr double rests_s = 0.12, deep = 0.005;
  const double from = speed < 0 ? -0.5 * deep : deep;  // above the plate, or in it
  return {"plate", [=](double t) { return tip_at({0, speed * std::max(t - rests_s, 0.0) - from, 0}); }, 0.3};
}

ChainErrors chain_errors(const ChainFilm& film, double late_s, bool on_device, double begin_s) {
  Rendering rendering(film);
  std::array<Run, 2> runs{Run{session_for(film, rendering.cameras(), std::nullopt, on_device), false},
                          Run{session_for(film, rendering.cameras(), late_s, on_device), true}};
  std::optional<Rendering> exact;
  std::optional<session::Session> sees_exactly;
  if (film.exact_truth) {
    exact.emplace(film, sensing::Noise::none);
    sees_exactly.emplace(session_for(film, rendering.cameras(), std::nullopt, on_device));
  }
  const double slot_s = runs[0].session.link_setting().slot_s;
  const auto first_of = [&](std::uint64_t k) {
    return static_cast<std::uint64_t>(std::ceil(rendering.time_of(k) / slot_s - 1e-6));
  };
  const std::uint64_t frames = rendering.frames();
  Truth truth;
  for (std::uint64_t k = 0; k < frames; ++k) {
    const double t = rendering.time_of(k);
    const auto images = rendering.frame(k);
    for (Run& run : runs) {
      const touch::Touch& touch = run.session.touch(images, t, first_of(k));
      const array::Schedule& schedule = run.session.schedule();
      run.error.begun += schedule.voice_count > touch.finger_count ? 1 : 0;
      run.schedules.push_back(schedule);
      if (!run.predicts && !film.exact_truth) truth.add(t, schedule);
    }
    if (!sees_exactly) continue;
    sees_exactly->touch(exact->frame(k), t, first_of(k));
    truth.add(t, sees_exactly->schedule());
  }

  std::vector<array::SlotFocus> foci;
  double since_s = -1;  // when the touch began
  for (std::uint64_t k = 0; k < frames; ++k) {
    const double t = truth.frames[k].time_s;
    since_s = truth.frames[k].foci.empty() ? -1 : since_s < 0 ? t : since_s;
    if (since_s < 0 || t < since_s + begin_s) continue;
    for (Run& run : runs) {
      const array::Schedule& schedule = run.schedules[k];
      if (schedule.voice_count == 0) continue;
      if (run.schedules[k - 1].voice_count > 0) {
        const std::vector<Vec3>&now = schedule.voices[0].foci, &before = run.schedules[k - 1].voices[0].foci;
        double most = 0;
        for (std::size_t n = 0; n < std::min(now.size(), before.size()); ++n)
          most = std::max(most, glm::distance(now[n], before[n]));
        run.steps.push_back(most);
      }
      for (std::uint64_t slot = first_of(k); slot < first_of(k + 1); ++slot) {
        const double sounds_s = t + late_s + static_cast<double>(slot - first_of(k)) * slot_s;
        if (sounds_s >= truth.frames.back().time_s) continue;
        if (!truth.at(sounds_s, 0)) {
          double left_s = sounds_s;
          while (left_s > 0 && !truth.at(left_s, 0))
            left_s -= slot_s;
          run.error.late_s = std::max(run.error.late_s, sounds_s - left_s);
          continue;
        }
        array::foci_of_slot(schedule, slot, foci);
        for (const array::SlotFocus& focus : foci) {
          if (const auto there = truth.at(sounds_s, focus.number))
            run.errors.push_back(glm::distance(focus.position, *there));
        }
      }
    }
  }
  for (Run& run : runs) {
    run.error.slots = run.errors.size();
    for (const double error : run.errors)
      run.error.mean_m += error / static_cast<double>(run.errors.size());
    run.error.p95_m = p95_of(run.errors);
    run.error.p95_step_m = p95_of(run.steps);
  }
  return {runs[0].error, runs[1].error};
}

std::vector<array::Schedule> schedules_of(const ChainFilm& film, double late_s,
                                          const std::function<double(std::uint64_t)>& time_of, bool knows_slots,
                                          std::vector<double>* distances_m) {
  Rendering rendering(film);
  session::Session session = session_for(film, rendering.cameras(), late_s, false);
  std::vector<array::Schedule> schedules;
  for (std::uint64_t k = 0; k < rendering.frames(); ++k) {
    const auto images = rendering.frame(k);
    knows_slots ? session.touch(images, time_of(k), 7 * k) : session.touch(images, time_of(k));
    schedules.push_back(session.schedule());
    if (distances_m) distances_m->push_back(session.report().prediction.value_or(session::Prediction()).distance_m);
  }
  return schedules;
}

}  // namespace palpa::test
