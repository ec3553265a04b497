#include "cli/support/steady_films.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "array/layouts/board_mesh.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/recording.hpp"
#include "session/session.hpp"
#include "setup/load.hpp"
#include "setup/touch_schedule.hpp"
#include "support/device.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::test {
namespace {

constexpr double radius = 0.02;  // of the semi-sphere

Transform at(double x, double y, double z) {
  return glm::translate(Transform(1.0), Vec3(x, y, z));
}

/// The tip `press` below the surface of the semi-sphere, so far from its top along it; of any other object below y = 0.
Transform on(const std::string& object, double way, double press, double beside) {
  if (object != "semi-sphere") return at(way, -press, beside);
  return at(radius * std::sin(way / radius), radius * (std::cos(way / radius) - 1) - press, beside);
}

/// From 0 at 100 mm/s for `duration`, the first and last 20 ms of it speeding up and slowing down.
double stroke(double t, double duration) {
  const auto ramp = [](double u) { return u < 0 ? 0.0 : u < 0.02 ? u * u / 0.04 : u - 0.01; };
  return 0.1 * (ramp(t) - ramp(t - duration));
}

Vec3 mean_of(const std::vector<Vec3>& foci) {
  Vec3 sum(0);
  for (const Vec3& focus : foci)
    sum += focus / static_cast<double>(foci.size());
  return sum;
}

FociLine line_of(const nlohmann::json& json) {
  FociLine line{json["time_s"], {}};
  for (const auto& finger : json["fingers"]) {
    FociLine::Finger& f = line.fingers.emplace_back();
    f.id = finger["id"];
    for (const auto& focus : finger["foci_m"])
      f.foci.emplace_back(focus[0].get<float>(), focus[1].get<float>(), focus[2].get<float>());
  }
  return line;
}

/// The line that a link of foci sends for a schedule.
FociLine line_of(const array::Schedule& schedule) {
  FociLine line{schedule.time_s, {}};
  for (const array::Voice& voice : std::span(schedule.voices).first(schedule.voice_count)) {
    FociLine::Finger& f = line.fingers.emplace_back();
    f.id = voice.id;
    for (const Vec3& focus : voice.foci)
      f.foci.emplace_back(glm::vec3(focus));
  }
  return line;
}

/// A film in front of the paper's rig, frame by frame.
class Rendering {
 public:
  explicit Rendering(Film film) : film_(std::move(film)), cameras_(cameras_of(film_)) {
    geometry::Ply ply = geometry::read_ply(source_file("assets/finger.ply"));
    finger_ = {std::move(ply.positions), std::move(ply.triangles)};
  }

  const std::vector<sensing::Camera>& cameras() const { return cameras_.cameras(); }
  int frames() const { return film_.frames; }

  /// Valid until the next call.
  const sensing::FrameSet& frame(int k) {
    const sensing::Posed posed{&finger_, film_.motion(k / film_hz)};
    set_.sequence = static_cast<std::uint64_t>(k);
    set_.time_s = k / film_hz;
    cameras_.render(std::span(&posed, 1), set_.sequence, set_);
    for (sensing::DepthFrame& frame : set_.frames)
      frame.time_s = set_.time_s;
    return set_;
  }

 private:
  static sensing::SyntheticRig cameras_of(const Film& film) {
    const setup::PosedRig rig = setup::load_posed_rig({});
    return {rig.rig.cameras, array::board_mesh(rig.layout), film.noise, film.seed};
  }

  Film film_;
  sensing::SyntheticRig cameras_;
  geometry::Mesh finger_;
  sensing::FrameSet set_;
};

constexpr double hold_s = 0.5;  ///< on a busy machine, frames may be old before they are reported

session::Session session_for(const Play& play, const std::vector<sensing::Camera>& cameras) {
  const std::string scene = source_file("assets/" + play.object + ".glb").string();
  session::SessionSetting setting{.scene = scene,
                                  .solids = setup::load_solids(scene),
                                  .cameras = cameras,
                                  .schedule = setup::schedule_options({}),
                                  .events = std::nullopt,
                                  .axes = play.axes,
                                  .smoothing = play.smoothing,
                                  .hold_s = hold_s};
  setting.touch.foci = play.foci;
  // One transducer: foci do not depend on the array, and drives, which are not used here, take longer for more.
  setting.layout.transducers.push_back({Vec3(0, -0.15, 0), Vec3(0, 1, 0)});
  session::Session session(test_device(), std::move(setting));
  session.warm_up();
  return session;
}

/// Whether the second line is of the frame after the first's.
bool follow_each_other(const FociLine& a, const FociLine& b) {
  return b.time_s > a.time_s && b.time_s - a.time_s < 1.5 / film_hz;
}

const FociLine::Finger* finger_of(const FociLine& line, std::uint32_t id) {
  for (const FociLine::Finger& finger : line.fingers) {
    if (finger.id == id) return &finger;
  }
  return nullptr;
}

}  // namespace

Film resting(const std::string& object, int frames) {
  constexpr int away = 12;
  const auto motion = [frames](double t) {
    const int frame = static_cast<int>(std::lround(t * film_hz)), turn = frames + away;
    const int deeper = frame / turn;
    if (frame % turn >= frames) return at(0, 0.05, 0);
    return at(0.7e-3, -2e-3 - 1e-3 * deeper, 0.4e-3);
  };
  return {object, "at rest", motion, 3 * frames + 2 * away, "rest"};
}

Film dipping(const std::string& object, int frames) {
  return {object, "dipping", sensing::dipping_motion, frames, "dip"};
}

Film sliding(const std::string& object, bool along, bool half) {
  // Where it touches: the cube up to 20 mm from its middle and beyond, the ridge's sides for some millimetres only.
  const bool wide = along || object == "cube" || object == "semi-sphere";
  const double end = wide ? 0.027 : 0.009;
  const double begin = half && wide ? 0.012 : -end;
  const auto motion = [=](double t) {
    const double way = begin + 0.25e-3 * film_hz * t;
    return along ? at(0.7e-3, -2e-3, way) : on(object, way, 3e-3, 0.4e-3);
  };
  const std::string path = along ? "along" : object == "semi-sphere" ? "down" : wide ? "over" : "across";
  return {object, along ? "sliding along" : "sliding",
          motion, static_cast<int>((end - begin) / 0.25e-3) + 1,
          path,   sensing::Noise::none};
}

Film fast(const std::string& object, int times) {
  const auto motion = [object](double t) {
    const double u = std::fmod(t, 0.6);
    const double way = stroke(u - 0.05, 0.18) - stroke(u - 0.35, 0.18) - 8e-3;
    return object == "prism" ? at(0.7e-3, -3e-3, way) : on(object, way, 3e-3, 0.4e-3);
  };
  return {object, "100 mm/s", motion, 54 * times, "fast " + object};
}

void record(const Film& film, const std::filesystem::path& folder) {
  Rendering rendering(film);
  sensing::RecordingWriter writer(folder, rendering.cameras());
  for (int k = 0; k < rendering.frames(); ++k)
    writer.write(rendering.frame(k));
}

std::vector<std::vector<FociLine>> played(const Film& film, const std::vector<Play>& plays) {
  Rendering rendering(film);
  std::vector<session::Session> sessions;
  for (const Play& play : plays)
    sessions.push_back(session_for(play, rendering.cameras()));
  std::vector<std::vector<FociLine>> lines(plays.size());
  for (int k = 0; k < rendering.frames(); ++k) {
    const sensing::FrameSet& set = rendering.frame(k);
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      sessions[i].touch(set.frames, set.time_s);
      lines[i].push_back(line_of(sessions[i].schedule()));
    }
  }
  return lines;
}

std::vector<FociLine> sent_by_palpa(const std::string& source, const std::string& object,
                                    const std::vector<std::string>& options) {
  const UdpReceiver receiver(std::chrono::milliseconds(50));
  std::vector<FociLine> lines;
  std::atomic<bool> ended{false};
  std::thread listener([&] {
    while (true) {
      const bool last = ended;
      const std::string text = receiver.next();
      if (!text.empty()) {
        lines.push_back(line_of(nlohmann::json::parse(text)));
      } else if (last) {
        return;
      }
    }
  });
  std::vector<std::string> arguments{"run",
                                     "--scene",
                                     source_file("assets/" + object + ".glb").string(),
                                     "--source",
                                     source,
                                     "--every-frame",
                                     "--link",
                                     "foci:" + receiver.address(),
                                     "--quiet",
                                     "--hold",
                                     std::to_string(hold_s)};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Result result = palpa(arguments);
  ended = true;
  listener.join();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  constexpr std::size_t silence = 3;  // lines at the end
  EXPECT_GT(lines.size(), silence);
  lines.resize(std::max(lines.size(), silence) - silence);
  return lines;
}

double Movement::at(std::vector<double> values, double quantile) {
  std::sort(values.begin(), values.end());
  return values.empty()
             ? 0
             : values[static_cast<std::size_t>(std::ceil(quantile * static_cast<double>(values.size() - 1)))];
}

Movement movement_of(const std::vector<FociLine>& lines, int leave_out) {
  Movement movement;
  std::map<std::uint32_t, int> age;  // in frames, of those that touch
  for (std::size_t k = 1; k < lines.size(); ++k) {
    std::map<std::uint32_t, int> next;
    for (const FociLine::Finger& now : lines[k].fingers) {
      const FociLine::Finger* before = finger_of(lines[k - 1], now.id);
      const bool goes_on =
          before && before->foci.size() == now.foci.size() && follow_each_other(lines[k - 1], lines[k]);
      const int frames = next[now.id] = before ? age[now.id] + 1 : 0;
      if (!goes_on || frames < leave_out) continue;
      const Vec3 mean = mean_of(now.foci) - mean_of(before->foci);
      double relative = 0, absolute = 0;
      for (std::size_t n = 0; n < now.foci.size(); ++n) {
        const Vec3 way = now.foci[n] - before->foci[n];
        relative = std::max(relative, glm::length(way - mean));
        absolute = std::max(absolute, glm::length(way));
      }
      movement.relative.push_back(relative);
      movement.absolute.push_back(absolute);
    }
    age = next;
  }
  return movement;
}

double lag_of(const std::vector<FociLine>& early, const std::vector<FociLine>& late) {
  double behind = 0, square = 0;
  for (std::size_t k = 1; k + 1 < early.size(); ++k) {
    const auto then =
        std::find_if(late.begin(), late.end(), [&](const FociLine& line) { return line.time_s == early[k].time_s; });
    if (then == late.end()) continue;
    if (!follow_each_other(early[k - 1], early[k]) || !follow_each_other(early[k], early[k + 1])) continue;
    for (const FociLine::Finger& now : early[k].fingers) {
      const FociLine::Finger* before = finger_of(early[k - 1], now.id);
      const FociLine::Finger* after = finger_of(early[k + 1], now.id);
      const FociLine::Finger* same = finger_of(*then, now.id);
      if (!before || !after || !same) continue;
      const Vec3 velocity =
          (mean_of(after->foci) - mean_of(before->foci)) / (early[k + 1].time_s - early[k - 1].time_s);
      behind += glm::dot(velocity, mean_of(now.foci) - mean_of(same->foci));
      square += glm::dot(velocity, velocity);
    }
  }
  return behind / square;
}

}  // namespace palpa::test
