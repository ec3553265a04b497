// Depth cameras through librealsense2, as far as this can be tested without one: an emulated SDK on an emulated clock.
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "driver/cameras/host.hpp"
#include "driver/cameras/made_up_frames.hpp"
#include "driver/realsense/sdk.hpp"
#include "driver/realsense/source.hpp"
#include "driver/realsense/stream.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::realsense {
namespace {

using cameras::test::described;
using palpa::test::error_of;
using palpa::test::stderr_of;

constexpr double period_s = 1.0 / 90;

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
  cameras::Lens lens{50, 50.5, 30.5, 24.5, {}};
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
      cameras::test::write_frame(bytes->data(), frame, width, height, stride);
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

std::unique_ptr<sensing::DepthSource> open(Bench& bench, const std::string& serials,
                                           std::vector<sensing::Camera> cameras = {described("one")}) {
  return open_cameras(std::make_unique<MadeUpHost>(bench), std::make_shared<MadeUpSdk>(bench), std::move(cameras),
                      serials, "rig.toml");
}

/// Gets the next set whose first image is a whole frame; returns its number.
std::uint64_t next_frame(sensing::DepthSource& source, sensing::FrameSet& set) {
  EXPECT_TRUE(source.next(set, 0.1));
  return set.frames.empty() ? 0 : cameras::test::frame_of(set.frames[0]);
}

/// Camera "A" alone, and its source.
struct OneCamera : Bench {
  MadeUpCamera& camera = plug("A");
  std::unique_ptr<sensing::DepthSource> source;
  sensing::FrameSet set;

  void begin() { source = open(*this, "A"); }
  std::uint64_t next() { return next_frame(*source, set); }
};

TEST(RealSense, FramesComeWholeInOrderWithTheTimeOfTheirCapture) {
  for (const std::uint32_t padding : {0u, 32u}) {
    OneCamera one;
    one.camera.padding = padding;
    one.begin();
    EXPECT_DOUBLE_EQ(one.source->cameras()[0].rate_hz, 90);
    const std::uint64_t first = one.next();
    for (std::uint64_t frame = first + 1; frame < first + 40; ++frame) {
      EXPECT_EQ(one.next(), frame);
      EXPECT_NEAR(one.set.time_s, static_cast<double>(frame) * period_s, 1e-6) << "not when it arrived, 4 ms later";
    }
    EXPECT_LE(one.camera.given, 3) << "the SDK has few frames";
    one.source.reset();
    EXPECT_EQ(one.camera.given, 0);
    EXPECT_FALSE(one.camera.taker);
  }
}

TEST(RealSense, StampsOfTheCamerasOwnClockOrOfAClockThatWasSetAreNotUsed) {
  for (const double ahead_s : {0.0, 3600.0, -3600.0}) {
    OneCamera one;
    if (ahead_s == 0) one.camera.options.erase(Option::global_time);
    one.camera.clock_ahead_s = ahead_s;
    one.begin();
    for (int i = 0; i < 20; ++i) {
      const double arrived_s = static_cast<double>(one.next()) * period_s + one.camera.delay_s;
      EXPECT_GE(one.set.time_s, arrived_s - 1e-9);
      EXPECT_LT(one.set.time_s, arrived_s + 2e-3);
    }
  }
}

TEST(RealSense, IsSetUpAsTheRigSays) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  camera.lens.distortion = {0.1, -0.2, 0.001, 0.002, 0.03};
  sensing::Camera wanted = described("one");
  wanted.device = {.own_lens = true, .exposure_s = 0.004, .preset = 3};
  const auto source = open(bench, "any", {wanted});
  const std::vector<std::pair<Option, double>> expected{{Option::hardware_preset, 3},
                                                        {Option::automatic_exposure, 0},
                                                        {Option::exposure_s, 0.004},
                                                        {Option::global_time, 1},
                                                        {Option::depth_unit_m, 0.0001}};
  EXPECT_EQ(camera.set, expected);
  const sensing::Camera& found = source->cameras()[0];
  EXPECT_EQ(found.fx, 50);
  EXPECT_EQ(found.fy, 50.5);
  EXPECT_EQ(found.cx, 30.5);
  EXPECT_EQ(found.cy, 24.5);
  EXPECT_EQ(found.distortion, camera.lens.distortion);
  EXPECT_EQ(camera.streamed.rate_hz, 90);
}

TEST(RealSense, ALensThatCannotBeIsWarnedOf) {
  Bench bench;
  bench.plug("A").lens.fy = 5;
  sensing::Camera wanted = described("one");
  wanted.device.own_lens = true;
  EXPECT_CONTAINS(palpa::test::stderr_of([&] { open(bench, "any", {wanted}); }),
                  "camera 'one': its own calibration: fx = 50 and fy = 5 differ by a factor of 10");
}

TEST(RealSense, WithoutARateTheHighestIsTakenAndNothingElseIsSet) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  sensing::Camera wanted = described("one");
  wanted.rate_hz = 0;
  wanted.depth_unit_m = 0.001;
  stderr_of([&] { open(bench, "A", {wanted}); });
  EXPECT_EQ(camera.streamed.rate_hz, 90);
  EXPECT_EQ(camera.set, (std::vector<std::pair<Option, double>>{{Option::global_time, 1}}));
}

TEST(RealSense, RefusesWithOneLineThatSaysWhatWouldBeRight) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  sensing::Camera wanted = described("one");
  const auto refuses = [&](const char* part, const std::string& serials = "A", Exit code = Exit::bad_input) {
    EXPECT_ERROR(open(bench, serials, {wanted}), code, part);
    wanted = described("one");
  };
  wanted.width = 640;
  refuses(
      "realsense:A: does not offer Z16 of 640x48; it has 64x48, 128x72: set width and height of rig.toml to one of "
      "these");
  wanted.rate_hz = 60;
  refuses("realsense:A: does not offer Z16 64x48 at 60 Hz; it has 90, 30 Hz: set rate_hz of rig.toml to one of these");
  refuses("realsense:B: is not plugged in; librealsense2 finds A", "B");
  refuses("source realsense names 2 cameras, but rig.toml describes 1", "A,B", Exit::usage);
  refuses("source realsense needs cameras: realsense:SERIAL or realsense:any", "", Exit::usage);
  camera.keeps_unit = true;
  refuses("realsense:A: keeps its depth unit of 1 mm (librealsense2: read-only); set depth_unit_m = 0.001 in rig.toml");
  camera.keeps_unit = false;
  camera.options.erase(Option::hardware_preset);
  wanted.device.preset = 3;
  refuses("realsense:A: has no hardware preset, which hardware_preset of rig.toml would set");
  const auto other = open(bench, "A");
  refuses("realsense:A: the camera does not start to stream: librealsense2: failed to set");
  bench.plug("B");
  refuses("source realsense: 2 cameras are plugged in; name the rig's cameras, in the rig's order: realsense:A,B",
          "any", Exit::usage);
  bench.unplug("A");
  bench.unplug("B");
  refuses("realsense:any: librealsense2 finds no camera", "any");
}

TEST(RealSense, UnpluggedItIsFoundAgainByItsSerialNumberUnlessItsLensHasChanged) {
  Bench bench;
  MadeUpCamera& camera = bench.plug("A");
  bench.plug("B");
  sensing::Camera wanted = described("a");
  wanted.device.own_lens = true;
  const auto source = open(bench, "B,A", {described("b"), wanted});
  sensing::FrameSet set;
  ASSERT_GT(next_frame(*source, set), 0u);
  const double begin_s = bench.now_s;
  bench.later = {{begin_s + 1, [&] { bench.unplug("A"); }},
                 {begin_s + 2, [&] { camera.plugged = true, camera.lens.fx += 1; }},
                 {begin_s + 6, [&] { camera.lens.fx -= 1; }}};
  std::uint64_t alone = 0;
  const std::string said = stderr_of([&] {
    while (bench.now_s < begin_s + 8) {
      ASSERT_GT(next_frame(*source, set), 0u);
      alone += set.frames[1].depth[0] == 0;
    }
  });
  EXPECT_GT(alone, 430u);
  EXPECT_LT(alone, 480u);
  EXPECT_GT(set.frames[1].depth[0], 0) << "it is back";
  EXPECT_EQ(camera.starts, 2u);
  EXPECT_CONTAINS(said, "camera 'a' (realsense:A): unplugged; palpa continues without it");
  EXPECT_CONTAINS(said,
                  "camera 'a' cannot be opened again: realsense:A: its lens has changed: the camera was recalibrated");
  EXPECT_CONTAINS(said, "camera 'a' (realsense:A): is back");
  EXPECT_LE(camera.given, 3);
}

/// Everything differs between the cameras: each gets what its own table says, in every order, and again when it is
/// back.
TEST(RealSense, EachOfUnlikeCamerasIsSetUpAsItsOwnTableSays) {
  std::vector<sensing::Camera> rig{described("a"), described("b", 128, 72), described("c")};
  rig[0].device = {.own_lens = true, .exposure_s = 0.004, .preset = 3};
  rig[1].device = {.exposure_s = 0, .preset = 5};
  rig[1].depth_unit_m = 0.0005;
  rig[1].rate_hz = 30;
  rig[2].rate_hz = 30;
  rig[2].depth_unit_m = 0.0002;
  const std::vector<std::string> serials{"A", "B", "C"};
  for (std::vector<std::size_t> order{0, 1, 2};;) {
    Bench bench;
    std::vector<sensing::Camera> wanted;
    std::string names;
    for (const std::size_t i : order) {
      bench.plug(serials[i]).lens.fx += static_cast<double>(i);
      wanted.push_back(rig[i]);
      names += (names.empty() ? "" : ",") + serials[i];
    }
    std::unique_ptr<sensing::DepthSource> source;
    stderr_of([&] { source = open(bench, names, wanted); });
    std::map<std::string, std::vector<std::pair<Option, double>>> told;
    for (std::size_t i = 0; i < 3; ++i) {
      const MadeUpCamera& camera = *bench.cameras.at(serials[order[i]]);
      const sensing::Camera &found = source->cameras()[i], &own = rig[order[i]];
      told[serials[order[i]]] = camera.set;
      EXPECT_EQ(std::pair(camera.streamed.width, camera.streamed.height), std::pair(own.width, own.height));
      EXPECT_EQ(camera.streamed.rate_hz, own.rate_hz);
      EXPECT_EQ(found.name, own.name);
      EXPECT_EQ(found.depth_unit_m, own.depth_unit_m);
      const cameras::Lens lens =
          own.device.own_lens ? camera.lens : cameras::Lens{own.fx, own.fy, own.cx, own.cy, own.distortion};
      EXPECT_EQ((cameras::Lens{found.fx, found.fy, found.cx, found.cy, found.distortion}), lens);
      EXPECT_DOUBLE_EQ(found.rate_hz, own.rate_hz);
      const auto set = [&](Option option) {
        const auto at = std::ranges::find(camera.set, option, &std::pair<Option, double>::first);
        return at == camera.set.end() ? -1 : at->second;
      };
      EXPECT_EQ(set(Option::hardware_preset), own.device.preset ? *own.device.preset : -1);
      EXPECT_EQ(set(Option::exposure_s), own.device.exposure_s.value_or(0) > 0 ? *own.device.exposure_s : -1);
      EXPECT_EQ(set(Option::automatic_exposure), own.device.exposure_s ? (*own.device.exposure_s > 0 ? 0 : 1) : -1);
      EXPECT_NEAR(set(Option::depth_unit_m), own.depth_unit_m, 1e-9);
    }
    // Each loses its power, and comes back as it left the factory.
    sensing::FrameSet frames;
    stderr_of([&] {
      for (const std::string& serial : serials) {
        const auto before = bench.cameras.at(serial);
        bench.unplug(serial);
        for (int i = 0; i < 15; ++i)
          source->next(frames, 0.1);
        bench.plug(serial).lens = before->lens;
        for (const double end_s = bench.now_s + 5; bench.now_s < end_s && bench.cameras.at(serial)->starts == 0;)
          source->next(frames, 0.1);
        EXPECT_EQ(bench.cameras.at(serial)->set, told.at(serial)) << serial;
        EXPECT_EQ(bench.cameras.at(serial)->streamed.rate_hz, before->streamed.rate_hz);
        EXPECT_EQ(bench.cameras.at(serial)->streamed.width, before->streamed.width);
      }
    });
    if (!std::ranges::next_permutation(order).found) break;
  }
}

TEST(RealSense, AnUnknownDepthUnitIsToldOnceEvenIfTheCameraComesBack) {
  OneCamera one;
  one.camera.options.erase(Option::depth_unit_m);
  EXPECT_CONTAINS(stderr_of([&] { one.begin(); }), "does not report its depth unit; palpa assumes 0.1 mm");
  ASSERT_GT(one.next(), 0u);
  one.unplug("A");
  const std::string said = stderr_of([&] {
    for (int i = 0; i < 15; ++i)
      one.source->next(one.set, 0.1);
    one.camera.plugged = true;
    for (int i = 0; i < 30; ++i)
      one.source->next(one.set, 0.1);
  });
  EXPECT_EQ(one.camera.starts, 2u);
  EXPECT_CONTAINS(said, "is back");
  EXPECT_EQ(said.find("assumes"), std::string::npos) << said;
}

TEST(RealSense, ShortFramesAreLeftOutAndTheirMemoryIsGivenBack) {
  OneCamera one;
  one.begin();
  const std::uint64_t first = one.next();
  for (std::uint64_t frame = first + 1; frame < first + 80; frame += 2)
    one.camera.cut.insert(frame);
  stderr_of([&] {
    for (std::uint64_t frame = first + 2; frame < first + 80; frame += 2)
      EXPECT_EQ(one.next(), frame);
  });
  EXPECT_LE(one.camera.given, 3);
}

TEST(RealSense, OfFramesThatNobodyTookTheNewestStay) {
  OneCamera one;
  one.begin();
  ASSERT_GT(one.next(), 0u);
  for (int i = 0; i < 1000; ++i)
    one.step();
  EXPECT_LE(one.camera.given, 8) << "the SDK has no more than sixteen to give";
  const std::uint64_t newest = one.camera.next - 1;
  EXPECT_EQ(one.next(), newest);
}

TEST(RealSense, WithoutTheSdkTheLineSaysWhatToDo) {
#ifdef PALPA_WITH_REALSENSE
  GTEST_SKIP() << "skipped: this palpa is built with librealsense2";
#else
  const std::vector<sensing::Camera> cameras{described("one")};
  const geometry::Mesh none;
  EXPECT_CONTAINS(
      error_of([&] { source_kind().open("any", {.cameras = cameras, .occluders = none, .default_skin = {}}); },
               Exit::usage),
      "built without librealsense2; use v4l2:/dev/videoN, which needs no SDK, or install librealsense2");
#endif
}

}  // namespace
}  // namespace palpa::driver::realsense
