#include "driver/rosbag/source.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "driver/rosbag/bag.hpp"
#include "driver/rosbag/cursor.hpp"
#include "driver/rosbag/database.hpp"
#include "driver/rosbag/messages.hpp"

namespace palpa::driver::rosbag {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_sensors = 64;
/// A clock that moves on by more than this between two images was set. Nobody waits that long in silence.
constexpr double longest_gap_s = 3600;
constexpr double default_interval_s = 1.0 / 30;  ///< of a camera whose rate the bag does not say

std::unique_ptr<MessageReader> open_reader(const std::string& file) {
  if (is_database(InputFile(file).head(16))) return open_database(file);
  return std::make_unique<Bag>(file);
}

/// What the bag says about a sensor that has depth.
struct Sensor {
  sensing::Camera camera;
  bool has_lens = false, has_unit = false;
};

struct Frame {
  std::vector<std::uint16_t> depth;
  double time_s = 0;
  std::uint64_t sequence = 0;
};

class BagSource final : public sensing::DepthSource {
 public:
  BagSource(const std::string& file, const sensing::Camera* posed, bool paced)
      : bag_(open_reader(file)), paced_(paced) {
    there_ = read(next_);
    if (!there_ && bag_->cut_short()) {
      throw bad_input(file, fmt::format("ends {}, before its first depth image: the recording was cut short; record it "
                                        "again, or copy the whole file",
                                        bag_->cut_short()));
    }
    if (!there_) refuse_without_depth();
    place(posed);
    first_s_ = next_.time_s;
    more_ = read(after_);
  }

  const std::vector<sensing::Camera>& cameras() const override { return cameras_; }

  bool next(sensing::FrameSet& out, double timeout_s) override {
    if (!there_) return false;
    if (paced_ && !wait(timeout_s)) {
      out.frames.clear();
      return true;
    }
    out.frames.resize(1);
    out.frames[0].depth.swap(next_.depth);
    out.frames[0].time_s = out.time_s = next_.time_s;
    out.sequence = next_.sequence;
    advance();
    return true;
  }

 private:
  [[noreturn]] void refuse_without_depth() const {
    constexpr std::size_t most_named = 3, most_bytes = 80;
    const std::vector<std::string> topics = bag_->topics();
    std::string there;
    for (std::size_t i = 0; i < std::min(topics.size(), most_named); ++i)
      there += fmt::format("{}{}", i == 0 ? "" : ", ", printable(topics[i], most_bytes));
    if (topics.size() > most_named) there += fmt::format(" and {} more", topics.size() - most_named);
    throw bad_input(bag_->file(), fmt::format("has no depth of a RealSense: there is no image on a topic such as "
                                              "/device_0/sensor_0/Depth_0/image/data or "
                                              ".../image/data/compressedDepth; {}",
                                              there.empty() ? "it has no topic" : "its topics are " + there));
  }

  /// Waits until the next frame is due. A late caller gets the newest frame, but the very last one is never dropped.
  bool wait(double timeout_s) {
    if (!start_) start_ = Clock::now();
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - *start_).count();
    while (more_ && after_.time_s - first_s_ <= elapsed_s)
      advance();
    const double wait_s = next_.time_s - first_s_ - elapsed_s;
    std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(wait_s, 0.0, std::max(timeout_s, 0.0))));
    return wait_s <= timeout_s;
  }

  void advance() {
    std::swap(next_, after_);
    there_ = more_;
    more_ = more_ && read(after_);
  }

  /// Reads the bag's next depth image, and notes everything about its sensor on the way.
  bool read(Frame& frame) {
    for (Message message; bag_->next(message);) {
      try {
        if (take(message, frame)) return true;
      } catch (const Malformed& malformed) {
        bag_->fault(fmt::format("topic {}: {}", *message.topic, malformed.what()));
      }
    }
    if (bag_->cut_short() && read_ > 0)
      log::warning(fmt::format("{}: ends {}, after {}; the recording was cut short", bag_->file(), bag_->cut_short(),
                               counted(read_, "depth frame")));
    return false;
  }

  bool take(const Message& message, Frame& frame) {
    const Says says = says_of(*message.topic);
    if (says == Says::nothing) return false;
    Sensor& sensor = sensor_at(*message.topic);
    switch (says) {
      case Says::unit:
        note_unit(message, sensor);
        return false;
      case Says::lens:
        if (chosen_.empty()) read_lens(message, sensor.camera);
        sensor.has_lens = true;
        return false;
      case Says::rate:
        sensor.camera.rate_hz = read_rate(message);
        return false;
      default:
        return take_image(message, sensor, frame);
    }
  }

  void note_unit(const Message& message, Sensor& sensor) {
    const double unit_m = read_unit_m(message);
    if (!chosen_.empty() && sensor_of(chosen_) == sensor_of(*message.topic) && cameras_[0].depth_unit_m != unit_m)
      throw Malformed(
          fmt::format("the depth unit changes to {:g} m after an image with {:g} m", unit_m, cameras_[0].depth_unit_m));
    sensor.camera.depth_unit_m = unit_m;
    sensor.has_unit = true;
  }

  bool take_image(const Message& message, const Sensor& sensor, Frame& frame) {
    if (chosen_.empty()) choose(*message.topic, sensor);
    if (chosen_ != *message.topic) {
      if (!std::exchange(others_said_, true))
        log::warning(fmt::format("{}: has several depth cameras; {} is played", bag_->file(), chosen_));
      return false;
    }
    read_image(message, cameras_[0], frame.depth);
    frame.time_s = last_s_ = read_ > 0 ? time_after(last_s_, message.time_s) : message.time_s;
    frame.sequence = read_++;
    return true;
  }

  /// The time of the image that has this stamp. After a step of the clock, times go on where they were, until the clock
  /// is right again.
  double time_after(double last_s, double stamp_s) {
    const double rate_hz = cameras_[0].rate_hz, interval_s = rate_hz > 0 ? 1 / rate_hz : default_interval_s;
    const auto follows = [&](double time_s, double least_s) {
      return time_s > last_s + least_s && time_s <= last_s + longest_gap_s;
    };
    if (shift_s_ != 0 && follows(stamp_s, interval_s / 2)) shift_s_ = 0;
    const double step_s = stamp_s + shift_s_ - last_s;
    if (!follows(stamp_s + shift_s_, 0)) {
      if (!std::exchange(steps_said_, true)) {
        const std::string step =
            step_s == 0 ? "stands still"
                        : fmt::format("steps {} by {:.3g} s", step_s < 0 ? "back" : "forward", std::abs(step_s));
        log::warning(
            fmt::format("{}: its clock {} after {}; palpa plays every frame, and continues their times at "
                        "{:.3g} Hz from there",
                        bag_->file(), step, counted(read_, "depth frame"), 1 / interval_s));
      }
      shift_s_ = last_s + interval_s - stamp_s;
    }
    return stamp_s + shift_s_;
  }

  void choose(const std::string& topic, const Sensor& sensor) {
    if (!sensor.has_lens) throw Malformed("an image comes before the camera_info that describes it");
    if (!sensor.has_unit)
      log::warning(fmt::format("{}: does not say its depth unit; palpa assumes 1 mm, the default of RealSense cameras",
                               bag_->file()));
    if (const std::string odd = sensing::implausible_unit(sensor.camera.depth_unit_m); !odd.empty())
      log::warning(fmt::format("{}: {}", bag_->file(), odd));
    if (const std::string odd = sensing::implausible_lens(sensor.camera); !odd.empty())
      log::warning(fmt::format("{}: its camera: {}", bag_->file(), odd));
    chosen_ = topic;
    cameras_ = {sensor.camera};
    cameras_[0].name = sensor_of(topic);
  }

  void place(const sensing::Camera* posed) {
    sensing::Camera& camera = cameras_[0];
    if (!posed) {
      log::warning(
          fmt::format("{0}: the pose of its camera is not known, so palpa places it at the world's origin; give --rig "
                      "with one [[camera]] and its T_world_camera (palpa doctor --write-rig rig.toml --source bag:{0} "
                      "writes one, and palpa calibrate --rig rig.toml --source bag:TARGET.bag --out calibrated.toml "
                      "finds the pose, from a bag of the same camera in the same place that shows the printed target)",
                      bag_->file()));
      return;
    }
    camera.name = posed->name;
    camera.T_world_camera = posed->T_world_camera;
    camera.min_range_m = posed->min_range_m;
    if (posed->width == camera.width && posed->height == camera.height) {
      camera.roi = posed->roi;
      camera.mask = posed->mask;
      camera.background = posed->background;
    } else if (posed->roi || posed->mask || posed->background) {
      throw bad_input(bag_->file(), fmt::format("has images of {}x{}, but the rig's roi, mask and background are for "
                                                "{}x{}: leave them out of the rig, or make new ones",
                                                camera.width, camera.height, posed->width, posed->height));
    }
    if (camera.background && std::abs(posed->depth_unit_m / camera.depth_unit_m - 1) > 1e-6) {
      throw bad_input(bag_->file(),
                      fmt::format("has depths in steps of {:g} m, but the rig's background has steps of {:g} "
                                  "m: set depth_unit_m in the rig and learn the background again",
                                  camera.depth_unit_m, posed->depth_unit_m));
    }
  }

  Sensor& sensor_at(std::string_view topic) {
    std::string name = sensor_of(topic);
    if (sensors_.size() >= most_sensors && !sensors_.contains(name))
      throw Malformed(fmt::format("there are more than {} sensors", most_sensors));
    return sensors_[std::move(name)];
  }

  std::unique_ptr<MessageReader> bag_;
  bool paced_;
  std::map<std::string, Sensor> sensors_;
  std::string chosen_;  ///< the topic that is played
  std::vector<sensing::Camera> cameras_;
  Frame next_, after_;
  bool there_ = false, more_ = false;  ///< whether next_ and after_ are frames
  std::uint64_t read_ = 0;
  double last_s_ = 0, first_s_ = 0;
  double shift_s_ = 0;  ///< from stamps to times
  std::optional<Clock::time_point> start_;
  bool others_said_ = false, steps_said_ = false;
};

}  // namespace

std::unique_ptr<sensing::DepthSource> open_bag(const std::string& file, const sensing::Camera* posed, bool paced) {
  return std::make_unique<BagSource>(file, posed, paced);
}

session::SourceKind source_kind() {
  return {"bag", "bag:FILE: the depth of a RealSense camera as RealSense Viewer records it",
          [](const std::string& file, const session::SourceSetting& setting) {
            if (file.empty()) throw bad_usage("source bag needs a file: bag:FILE");
            return open_bag(file, setting.cameras.size() == 1 ? setting.cameras.data() : nullptr, setting.paced);
          },
          true};
}

}  // namespace palpa::driver::rosbag
