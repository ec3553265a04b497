// An emulated librealsense2, on a clock that advances only while something waits.
#pragma once

#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "driver/cameras/host.hpp"
#include "driver/realsense/sdk.hpp"

namespace palpa::driver::realsense::test {

/// The camera that is plugged in under one serial number. Frame n is captured at phase_s + n / rate and arrives delay_s
/// later.
struct MadeUpCamera {
  std::vector<cameras::Offer> offers{{0, 64, 48, 90}, {0, 64, 48, 30}, {0, 128, 72, 30}};
  std::map<Option, double> options{{Option::depth_unit_m, 0.001},
                                   {Option::exposure_s, 0.0085},
                                   {Option::automatic_exposure, 1},
                                   {Option::hardware_preset, 0},
                                   {Option::global_time, 0}};
  bool keeps_unit = false;
  cameras::Lens lens{50, 50.5, 31.5, 23.5, {}};
  double phase_s = 0, delay_s = 0.004;
  std::uint32_t padding = 0;    ///< bytes after each row
  double clock_ahead_s = 0;     ///< the host's clock was set: stamps are wrong by this much
  std::set<std::uint64_t> cut;  ///< these frames are too short
  bool plugged = true;

  // State.
  std::function<void(const Image&)> taker;
  cameras::Offer streamed;
  std::vector<std::pair<Option, double>> set;
  std::uint64_t next = 0, starts = 0;
  int given = 0;  ///< frames that palpa holds
};

/// The value of every pixel of frame n of a camera.
inline std::uint16_t pixel_of(std::uint64_t frame, std::uint32_t pixel) {
  return static_cast<std::uint16_t>(1 + frame % 60000 + pixel % 5);
}

struct Bench {
  double now_s = 100;
  std::map<std::string, std::shared_ptr<MadeUpCamera>> cameras;
  std::vector<std::pair<double, std::function<void()>>> later;  ///< events and their times, in order

  MadeUpCamera& plug(const std::string& serial) {
    cameras[serial] = std::make_shared<MadeUpCamera>();
    return *cameras[serial];
  }
  void unplug(const std::string& serial) { cameras.at(serial)->plugged = false; }

  /// Advances by a millisecond; frames that are due then arrive.
  void step() {
    now_s += 1e-3;
    while (!later.empty() && later.front().first <= now_s) {
      const auto what = std::move(later.front().second);
      later.erase(later.begin());
      what();
    }
    for (const auto& [serial, camera] : cameras)
      deliver(*camera);
  }

 private:
  void deliver(MadeUpCamera& camera) {
    for (;;) {
      if (!camera.taker) return;
      if (camera.next == 0)
        camera.next = static_cast<std::uint64_t>((now_s - camera.phase_s) * camera.streamed.rate_hz) + 1;
      const double captured_s = camera.phase_s + static_cast<double>(camera.next) / camera.streamed.rate_hz;
      if (captured_s + camera.delay_s > now_s) return;
      const std::uint64_t frame = camera.next++;
      if (!camera.plugged) continue;
      const std::uint32_t width = camera.streamed.width, height = camera.streamed.height;
      const std::size_t stride = std::size_t{width} * 2 + camera.padding;
      auto* const bytes = new std::vector<std::byte>(stride * height);
      for (std::uint32_t v = 0; v < height; ++v) {
        for (std::uint32_t u = 0; u < width; ++u) {
          const std::uint16_t depth = pixel_of(frame, v * width + u);
          std::copy_n(reinterpret_cast<const std::byte*>(&depth), 2, bytes->data() + v * stride + u * std::size_t{2});
        }
      }
      ++camera.given;
      const bool global = camera.options[Option::global_time] == 1;
      camera.taker({bytes, bytes->data(), camera.cut.contains(frame) ? stride : bytes->size(), width, height,
                    static_cast<std::uint32_t>(stride), global ? now_s - captured_s + camera.clock_ahead_s : 0});
    }
  }
};

class MadeUpSensor final : public Sensor {
 public:
  explicit MadeUpSensor(std::shared_ptr<MadeUpCamera> camera) : camera_(std::move(camera)) {}
  ~MadeUpSensor() override { end(); }

  std::vector<cameras::Offer> offers() override { return camera_->offers; }
  cameras::Lens lens(const cameras::Offer&) override { return camera_->lens; }
  bool has(Option option) override { return camera_->options.contains(option); }
  double get(Option option) override { return camera_->options.at(option); }
  void set(Option option, double value) override {
    if (option == Option::depth_unit_m && camera_->keeps_unit) throw failure("librealsense2: read-only");
    camera_->options[option] = static_cast<float>(value);
    camera_->set.emplace_back(option, value);
  }
  void start(const cameras::Offer& offer, std::function<void(const Image&)> taker) override {
    if (camera_->taker) throw failure("librealsense2: failed to set power state");
    camera_->streamed = offer;
    camera_->taker = std::move(taker);
    ++camera_->starts;
    runs_ = true;
  }
  void stop() noexcept override { end(); }
  void release(const Image& image) override {
    delete static_cast<std::vector<std::byte>*>(image.frame);
    --camera_->given;
  }
  bool connected() override { return camera_->plugged; }

 private:
  void end() noexcept {
    if (std::exchange(runs_, false)) camera_->taker = nullptr;
  }

  std::shared_ptr<MadeUpCamera> camera_;
  bool runs_ = false;
};

class MadeUpSdk final : public Sdk {
 public:
  explicit MadeUpSdk(Bench& bench) : bench_(bench) {}
  std::vector<std::string> serials() override {
    std::vector<std::string> serials;
    for (const auto& [serial, camera] : bench_.cameras) {
      if (camera->plugged) serials.push_back(serial);
    }
    return serials;
  }
  std::unique_ptr<Sensor> find(const std::string& serial) override {
    const auto found = bench_.cameras.find(serial);
    if (found == bench_.cameras.end() || !found->second->plugged) return nullptr;
    return std::make_unique<MadeUpSensor>(found->second);
  }

 private:
  Bench& bench_;
};

/// Waits for real descriptors in emulated time.
class MadeUpHost final : public cameras::Host {
 public:
  explicit MadeUpHost(Bench& bench) : bench_(bench) {}
  int poll(std::span<pollfd> descriptors, double timeout_s) override {
    for (const double end_s = bench_.now_s + timeout_s;;) {
      const int ready = ::poll(descriptors.data(), descriptors.size(), 0);
      if (ready != 0 || bench_.now_s >= end_s) return ready;
      bench_.step();
    }
  }
  std::future<void> beside(std::function<void()> work) override {
    work();
    std::promise<void> done;
    done.set_value();
    return done.get_future();
  }
  double now_s() override { return bench_.now_s; }

 private:
  Bench& bench_;
};

}  // namespace palpa::driver::realsense::test
