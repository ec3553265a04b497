// Prints how fingers flicker: hands that do not move, with each rule of hysteresis on and off. It is not a test; run it
// by hand. Arguments: frames per film (default 30), films of fingers that move (default 18), anything: only with all
// rules and with none. Or: still FRAMES, only hands at rest. Or: motion FILMS, only fingers that move. Or: leave FILMS,
// only fingers that leave. Or: scan FRAMES, for many hands. Or: trace POSE TURN TILT PRESS_MM CAMERAS, for one of them.
// The tables of docs/notes/finger-rates.md come from "still 30", "motion 9" and "leave 9".
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "sensing/recording.hpp"
#include "support/hand_films.hpp"
#include "support/shared_data.hpp"
#include "touch/fingers/known.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::fingers_scene;
using palpa::test::hand_scene;
using palpa::test::HandFilm;

struct Still {
  std::string name;
  std::vector<geometry::Solid> solids;
  std::vector<sensing::Camera> cameras;
  std::vector<sensing::FrameSet> frames;
  std::uint32_t truth = 0;
};

/// The first frames of a film have little before them.
constexpr double settled_s = 0.1;

struct Flicker {
  std::map<std::uint32_t, int> counts;
  int frames = 0, right = 0;    ///< after the first 0.1 s
  int changes = 0, events = 0;  ///< in all frames
  int late_changes = 0;         ///< after the first 0.1 s
  std::vector<double> steps;    ///< after the first 0.1 s

  void add(const Flicker& other) {
    frames += other.frames;
    right += other.right;
    changes += other.changes;
    events += other.events;
    late_changes += other.late_changes;
    steps.insert(steps.end(), other.steps.begin(), other.steps.end());
  }
  double right_percent() const { return frames == 0 ? 0 : 100.0 * right / frames; }
};

double quantile(std::vector<double>& values, double share) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

Flicker flicker_of(const Still& still, const StageSetting& setting) {
  Stage stage(still.solids, still.cameras, setting);
  Touch touch;
  Flicker result;
  std::map<std::uint32_t, std::vector<Focus>> before;
  std::uint32_t count_before = 0;
  for (std::size_t k = 0; k < still.frames.size(); ++k) {
    stage.touch(still.frames[k].frames, touch, still.frames[k].time_s);
    std::map<std::uint32_t, std::vector<Focus>> now;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f)
      now[touch.fingers[f].id] = touch.fingers[f].foci;
    ++result.counts[touch.finger_count];
    const bool settled = still.frames[k].time_s - still.frames[0].time_s >= settled_s;
    result.frames += settled ? 1 : 0;
    result.right += settled && touch.finger_count == still.truth ? 1 : 0;
    if (k > 0) {
      result.changes += touch.finger_count != count_before ? 1 : 0;
      result.late_changes += settled && touch.finger_count != count_before ? 1 : 0;
      for (const auto& [id, foci] : now)
        result.events += before.contains(id) ? 0 : 1;
      for (const auto& [id, foci] : before) {
        const auto at = now.find(id);
        if (at == now.end()) {
          ++result.events;
          continue;
        }
        for (std::size_t n = 0; settled && n < foci.size() && n < at->second.size(); ++n)
          result.steps.push_back(glm::distance(foci[n].position, at->second[n].position));
      }
    }
    before = std::move(now);
    count_before = touch.finger_count;
  }
  return result;
}

std::vector<Still> recorded() {
  std::vector<Still> all;
  const std::filesystem::path folder = palpa::test::shared_data("flicker");
  if (folder.empty()) return all;
  struct Row {
    const char* name;
    std::filesystem::path scene;
    std::uint32_t truth;
  };
  for (const Row& row : {Row{"one-finger-through-semi-sphere", palpa::test::source_file("assets/semi-sphere.glb"), 1},
                         Row{"spread-hand-leaning", folder / "plate-35mm.glb", 5},
                         Row{"two-fingers-touching", folder / "plate.glb", 2}}) {
    Still& still = all.emplace_back();
    const sensing::Recording recording = sensing::load_recording(folder / row.name);
    still = {row.name, geometry::make_solids(geometry::load_gltf(row.scene)), recording.cameras, {}, row.truth};
    for (std::size_t k = 0; k < recording.entries.size(); ++k)
      read_entry(recording, k, still.frames.emplace_back());
  }
  return all;
}

/// The digits with at least five contacts in a picture without noise.
std::uint32_t digits_in(const palpa::test::HandScene& scene, int cameras) {
  const HandFilm film = make_film(scene, {.cameras = cameras, .frames = 1, .noise = palpa::test::FilmNoise::none});
  Stage stage({box({-0.3, -scene.plate_m, -0.3}, {0.3, 0, 0.3}, "plate")}, film.cameras);
  Touch touch;
  stage.touch(film.frames[0].frames, touch);
  std::vector<int> has(scene.digits);
  for (const Contact& contact : touch.contacts)
    ++has[film.nearest(Vec3(contact.position), 0).digit];
  return static_cast<std::uint32_t>(std::ranges::count_if(has, [](int n) { return n >= 5; }));
}

Still rendered(const std::string& name, const palpa::test::HandScene& scene, int cameras, palpa::test::FilmNoise noise,
               std::size_t frames) {
  HandFilm film = make_film(scene, {.cameras = cameras, .frames = frames, .noise = noise});
  return {name + ", " + std::to_string(cameras) + (noise == palpa::test::FilmNoise::half ? " half" : " full"),
          {box({-0.3, -scene.plate_m, -0.3}, {0.3, 0, 0.3}, "plate")},
          film.cameras,
          std::move(film.frames),
          digits_in(scene, cameras)};
}

Flicker print(const Still& still, const char* how, const StageSetting& setting) {
  Flicker flicker = flicker_of(still, setting);
  std::string counts;
  for (const auto& [count, times] : flicker.counts)
    counts += (counts.empty() ? "" : ", ") + std::to_string(count) + " x " + std::to_string(times);
  const auto at = [&](double share) { return 1e3 * quantile(flicker.steps, share); };
  std::printf("  %-44s %-10s truth %u: %3.0f %%, %2d changes, %2d events, foci %5.2f %5.2f %5.2f mm  (%s)\n",
              still.name.c_str(), how, still.truth, flicker.right_percent(), flicker.changes, flicker.events, at(0.5),
              at(0.99), at(1), counts.c_str());
  std::fflush(stdout);
  return flicker;
}

constexpr std::uint32_t every_rule =
    known_few | known_islands | known_apart | known_together | known_edges | known_falling;
constexpr std::pair<const char*, std::uint32_t> variants[] = {
    {"off", 0},
    {"on", every_rule},
    {"not few", every_rule & ~known_few},
    {"no islands", every_rule & ~known_islands},
    {"not apart", every_rule & ~known_apart},
    {"not one", every_rule & ~known_together},
    {"no edges", every_rule & ~known_edges},
    {"lingers", every_rule & ~known_falling},
};

/// Two upright fingers that move, and which of them each id of a frame has: the one whose axis is nearer.
struct Walked {
  int swaps = 0, lost = 0, frames = 0, right = 0;
  std::vector<double> told_apart_s;  ///< after they are 5 mm apart
};

constexpr double thick = 18e-3;

/// `apart(t)` is the distance of the fingers' axes, from the first to the second.
void walk(const std::function<Vec3(double time_s)>& apart, double seconds, int cameras, std::uint64_t seed,
          const StageSetting& setting, Walked& sum) {
  const palpa::test::HandScene scene = fingers_scene(2, thick, 3e-3, 0);
  const auto motion = [&](std::size_t skin, double t) {
    return (skin == 0 ? -0.5 : 0.5) * apart(t) - Vec3((skin == 0 ? -0.5 : 0.5) * thick, 0, 0);
  };
  const HandFilm film = make_film(scene, {.cameras = cameras,
                                          .frames = static_cast<std::size_t>(seconds * 90),
                                          .noise = palpa::test::FilmNoise::full,
                                          .seed = seed,
                                          .motion = motion});
  Stage stage({box({-0.3, -scene.plate_m, -0.3}, {0.3, 0, 0.3}, "plate")}, film.cameras, setting);
  Touch touch;
  std::map<std::uint32_t, std::size_t> owner;
  double gap_since = -1;
  bool told = true;
  for (const sensing::FrameSet& set : film.frames) {
    stage.touch(set.frames, touch, set.time_s);
    const Vec3 way = apart(set.time_s);
    const Vec3 places[2] = {-0.5 * way, 0.5 * way};
    const double gap = glm::length(way) - thick;
    ++sum.frames;
    sum.right += touch.finger_count == 2 ? 1 : 0;
    if (gap < 5e-3) {
      gap_since = -1;
      told = false;
    } else if (gap_since < 0) {
      gap_since = set.time_s;
    }
    if (gap_since >= 0 && !told && touch.finger_count == 2) {
      told = true;
      sum.told_apart_s.push_back(set.time_s - gap_since);
    }
    if (touch.finger_count != 2 || gap < 3e-3) continue;
    std::map<std::uint32_t, std::size_t> now;
    for (std::uint32_t f = 0; f < 2; ++f) {
      const glm::vec3& c = touch.fingers[f].section.centroid;
      const Vec3 at(c.x, 0, c.z);
      now[touch.fingers[f].id] = glm::distance(at, places[0]) <= glm::distance(at, places[1]) ? 0 : 1;
    }
    const bool first = owner.empty();
    for (const auto& [id, which] : now) {
      if (owner.contains(id)) {
        sum.swaps += owner[id] != which ? 1 : 0;
      } else if (!first) {
        ++sum.lost;
      }
      owner[id] = which;
    }
  }
}

void walks(int count) {
  for (const auto& [how, rules] : variants) {
    StageSetting setting{.follow = true, .hysteresis = rules != 0 ? Hysteresis::on : Hysteresis::off};
    setting.hysteresis_rules = rules;
    for (const char* kind : {"crossing", "meeting and parting"}) {
      Walked sum;
      for (int k = 0; k < count; ++k) {
        const double speed = std::array{0.05, 0.1, 0.2}[k % 3], aside = std::array{8e-3, 14e-3, 19e-3}[k / 3 % 3];
        const bool crossing = kind[0] == 'c';
        const double far = 35e-3, way = crossing ? 2 * far : 2 * (far - thick);
        const auto apart = [&](double t) {
          const double gone = 2 * speed * t;  // both move
          if (crossing) return Vec3(far - gone, 0, aside);
          return Vec3(std::max(thick, std::abs(far - thick - gone) + thick), 0, 0);
        };
        walk(apart, way / (2 * speed), 1 + 2 * (k % 2), static_cast<std::uint64_t>(k + 1), setting, sum);
      }
      std::ranges::sort(sum.told_apart_s);
      std::printf(
          "  %-20s %-10s %d films: %d swaps, %d new ids, two fingers in %.0f %% of the frames, told apart %.0f ms at "
          "most\n",
          kind, how, count, sum.swaps, sum.lost, 100.0 * sum.right / sum.frames,
          sum.told_apart_s.empty() ? -1 : 1e3 * sum.told_apart_s.back());
      std::fflush(stdout);
    }
  }
}

/// How long after its skin a finger leaves, by the skin's speed. The skin leaves at any time between two frames.
void withdrawals(int count) {
  for (const auto& [how, rules] : variants) {
    if (rules != 0 && (rules & known_falling) != 0 && rules != every_rule) continue;
    StageSetting setting{.follow = true, .hysteresis = rules != 0 ? Hysteresis::on : Hysteresis::off};
    setting.hysteresis_rules = rules;
    for (const double speed : {0.02, 0.1, 0.3}) {
      std::vector<double> late, beside;
      for (int k = 0; k < count; ++k) {
        const double press = std::array{1e-3, 2e-3, 4e-3}[k % 3];
        const palpa::test::HandScene scene =
            fingers_scene(1 + k % 2, thick, press, std::array{0.0, 30.0, 60.0}[k / 2 % 3]);
        const double begins_s = 0.1 + std::fmod(k * 0.618034, 1.0) / 90, leaves_s = begins_s + press / speed;
        const auto motion = [&](std::size_t, double t) { return Vec3(0, speed * std::max(0.0, t - begins_s), 0); };
        const HandFilm film = make_film(scene, {.cameras = 1 + k % 3,
                                                .frames = static_cast<std::size_t>((leaves_s + 0.1) * 90),
                                                .noise = palpa::test::FilmNoise::full,
                                                .seed = static_cast<std::uint64_t>(k + 1),
                                                .motion = motion});
        Stage stage({box({-0.3, -scene.plate_m, -0.3}, {0.3, 0, 0.3}, "plate")}, film.cameras, setting);
        Touch touch;
        double last = -1;
        for (std::size_t f = 0; f < film.frames.size(); ++f) {
          stage.touch(film.frames[f].frames, touch, film.frames[f].time_s);
          if (touch.finger_count > 0) last = film.frames[f].time_s;
          for (std::uint32_t i = 0; f % 4 == 0 && i < touch.finger_count; ++i) {
            for (const Focus& focus : touch.fingers[i].foci)
              beside.push_back(film.nearest(Vec3(focus.position), f).apart_m);
          }
        }
        late.push_back(last - leaves_s);
      }
      std::printf(
          "  withdrawal at %3.0f mm/s, %-8s %d films: the last frame with a finger is %.1f ms late at most, %.1f ms in "
          "99 %%, %.1f ms in the median; foci beside the skin: %.2f mm (99 %%)\n",
          speed * 1e3, how, count, quantile(late, 1) * 1e3, quantile(late, 0.99) * 1e3, quantile(late, 0.5) * 1e3,
          1e3 * quantile(beside, 0.99));
      std::fflush(stdout);
    }
  }
}

void stills(std::size_t frames, bool brief) {
  using palpa::test::FilmNoise;
  std::array<Flicker, std::size(variants)> sums;
  int films = 0;
  const auto see = [&](const Still& still) {
    ++films;
    for (std::size_t v = 0; v < std::size(variants); ++v) {
      const auto& [how, rules] = variants[v];
      if (brief && rules != 0 && rules != every_rule) continue;
      StageSetting setting{.follow = true, .hysteresis = rules != 0 ? Hysteresis::on : Hysteresis::off};
      setting.hysteresis_rules = rules;
      sums[v].add(print(still, how, setting));
    }
  };
  for (const Still& still : recorded())
    see(still);
  const std::vector<std::pair<const char*, palpa::test::HandScene>> scenes{
      {"one finger, 3 mm", fingers_scene(1, 18e-3, 3e-3, 0)},
      {"one finger, 0 mm", fingers_scene(1, 18e-3, 0, 0)},
      {"one finger, 0.2 mm", fingers_scene(1, 18e-3, 0.2e-3, 0)},
      {"two fingers of 16 mm, 0.3 mm", fingers_scene(2, 16e-3, 0.3e-3, 60)},
      {"two fingers of 14 mm, 2 mm", fingers_scene(2, 14e-3, 2e-3, 0)},
      {"two fingers of 18 mm, 3 mm", fingers_scene(2, 18e-3, 3e-3, 30)},
      {"three fingers of 16 mm, 10 mm", fingers_scene(3, 16e-3, 10e-3, 30)},
      {"a flat finger, 1 mm plate", fingers_scene(1, 18e-3, 2e-3, 90, 1e-3)},
      {"spread hand, 60 degrees", hand_scene("spread", 20e-3, 60)},
      {"relaxed hand, 60 degrees", hand_scene("relaxed", 20e-3, 60)},
      {"relaxed hand, 20 degrees", hand_scene("relaxed", 10e-3, 20)},
      {"fist, 1 mm plate", hand_scene("fist", 3e-3, 30, 1e-3)},
      {"fist", hand_scene("fist", 5e-3, 30)},
  };
  for (const auto& [name, scene] : scenes) {
    for (const int cameras : {1, 2, 3}) {
      for (const FilmNoise noise : {FilmNoise::half, FilmNoise::full})
        see(rendered(name, scene, cameras, noise, frames));
    }
  }
  for (std::size_t v = 0; v < std::size(variants); ++v) {
    Flicker& sum = sums[v];
    if (sum.frames == 0) continue;
    std::printf("%-10s %d films: right %.1f %%, %d changes (%d after 0.1 s), %d events, foci %.2f mm (99 %%)\n",
                variants[v].first, films, sum.right_percent(), sum.changes, sum.late_changes, sum.events,
                1e3 * quantile(sum.steps, 0.99));
  }
}

/// Many hands for a few frames each: prints those that flicker without hysteresis.
void scan(std::size_t frames) {
  std::vector<Flicker> sums(2);
  int films = 0, flicker = 0;
  for (const char* pose : {"relaxed", "spread", "fist"}) {
    for (const double turn : {0.0, 120.0, 240.0}) {
      for (const double tilt : {15.0, 40.0, 60.0, 80.0}) {
        for (const double press : {2e-3, 6e-3, 15e-3}) {
          const palpa::test::HandScene scene = hand_scene(pose, press, tilt, press < 3e-3 ? 1e-3 : 35e-3, turn);
          const std::string name = std::string(pose) + " " + std::to_string(int(turn)) + " " +
                                   std::to_string(int(tilt)) + " " + std::to_string(int(press * 1e3)) + " mm";
          const Still still = rendered(name, scene, 1 + 2 * (films % 2), palpa::test::FilmNoise::half, frames);
          ++films;
          StageSetting setting{.follow = true};
          const Flicker off = flicker_of(still, setting);
          setting.hysteresis = Hysteresis::on;
          const Flicker on = flicker_of(still, setting);
          sums[0].add(off);
          sums[1].add(on);
          if (off.changes == 0 && on.changes == 0) continue;
          ++flicker;
          setting.hysteresis = Hysteresis::off;
          print(still, "off", setting);
          setting.hysteresis = Hysteresis::on;
          print(still, "on", setting);
        }
      }
    }
  }
  for (const int k : {0, 1}) {
    std::printf(
        "%s: %d hands, %d flicker; %d changes, %d events, the true count in %.1f %% of the frames, foci %.2f mm (99 "
        "%%)\n",
        k == 0 ? "off" : "on", films, flicker, sums[k].changes, sums[k].events, sums[k].right_percent(),
        1e3 * quantile(sums[k].steps, 0.99));
  }
}

/// The fingers of each frame of one hand of scan().
void trace(const std::string& pose, double turn, double tilt, double press, int cameras) {
  const palpa::test::HandScene scene = hand_scene(pose, press, tilt, press < 3e-3 ? 1e-3 : 35e-3, turn);
  const Still still = rendered(pose, scene, cameras, palpa::test::FilmNoise::half, 16);
  Stage stage(still.solids, still.cameras, {.follow = true, .hysteresis = Hysteresis::on});
  Touch touch;
  for (const sensing::FrameSet& set : still.frames) {
    stage.touch(set.frames, touch, set.time_s);
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      const Finger& finger = touch.fingers[f];
      const glm::vec3 at = finger.section.centroid * 1e3F;
      std::printf("  %u: %u at %.0f %.0f %.0f", finger.id, finger.contact_count, at.x, at.y, at.z);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace palpa::touch::test

int main(int argc, char** argv) {
  namespace tool = palpa::touch::test;
  const std::string what = argc > 1 ? argv[1] : "";
  const int number = argc > 2 ? std::atoi(argv[2]) : 0;
  if (argc > 6 && what == "trace") {
    tool::trace(argv[2], std::atof(argv[3]), std::atof(argv[4]), std::atof(argv[5]) * 1e-3, std::atoi(argv[6]));
  } else if (what == "still") {
    tool::stills(number > 0 ? static_cast<std::size_t>(number) : 30, argc > 3);
  } else if (what == "leave") {
    tool::withdrawals(number > 0 ? number : 18);
  } else if (what == "motion") {
    tool::withdrawals(number > 0 ? number : 18);
    tool::walks(number > 0 ? number : 18);
  } else if (what == "scan") {
    tool::scan(number > 0 ? static_cast<std::size_t>(number) : 12);
  } else {
    tool::stills(argc > 1 ? std::stoul(what) : 30, argc > 3);
    tool::walks(argc > 2 ? number : 18);
    tool::withdrawals(argc > 2 ? number : 18);
  }
}
