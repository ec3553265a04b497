// Depth cameras through the installed librealsense2: a software device of the SDK is opened, set up, streamed from and
// lost like a camera.
#include <gtest/gtest.h>
#include <librealsense2/h/rs_internal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "driver/cameras/made_up_frames.hpp"
#include "driver/realsense/librealsense.hpp"
#include "driver/realsense/source.hpp"
#include "support/captured.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::realsense {
namespace {

using palpa::test::error_of;

constexpr int width = 848, height = 480, rate_hz = 90;

/// Frames whose pixels all hold the frame's number, at 90 Hz from a separate thread.
class SoftwareCamera {
 public:
  explicit SoftwareCamera(rs2_context* context) {
    device_ = rs2_create_software_device(&error_);
    rs2_software_device_register_info(device_, RS2_CAMERA_INFO_SERIAL_NUMBER, "SOFT1", &error_);
    rs2_software_device_register_info(device_, RS2_CAMERA_INFO_NAME, "Software", &error_);
    sensor_ = rs2_software_device_add_sensor(device_, "Stereo Module", &error_);
    rs2_software_sensor_add_option(sensor_, RS2_OPTION_DEPTH_UNITS, 1e-6f, 0.01f, 1e-6f, 0.001f, 1, &error_);
    rs2_software_sensor_add_option(sensor_, RS2_OPTION_EXPOSURE, 1, 165000, 1, 8500, 1, &error_);
    rs2_software_sensor_add_option(sensor_, RS2_OPTION_ENABLE_AUTO_EXPOSURE, 0, 1, 1, 1, 1, &error_);
    profile_ = rs2_software_sensor_add_video_stream(
        sensor_,
        {RS2_STREAM_DEPTH, 0, 1, width, height, rate_hz, 2, RS2_FORMAT_Z16,
         rs2_intrinsics{width, height, 420.5f, 238.5f, 641, 642, RS2_DISTORTION_BROWN_CONRADY, {0.01f, 0, 0, 0, 0}}},
        &error_);
    // The context itself at once forgets everything that nothing else holds.
    rs2_set_devices_changed_callback(
        context,
        [](rs2_device_list* removed, rs2_device_list* added, void* self) {
          rs2_delete_device_list(removed);
          static_cast<SoftwareCamera*>(self)->added_ = added;
        },
        this, &error_);
    rs2_context_add_software_device(context, device_, &error_);
    EXPECT_EQ(error_, nullptr) << (error_ ? rs2_get_error_message(error_) : "");
    sends_ = true;
    thread_ = std::thread([this] { send(); });
  }
  ~SoftwareCamera() {
    sends_ = false;
    thread_.join();
    rs2_delete_device_list(added_);
    rs2_delete_sensor(sensor_);
    rs2_delete_device(device_);
  }
  float option(rs2_option option) {
    return rs2_get_option(reinterpret_cast<const rs2_options*>(sensor_), option, &error_);
  }

 private:
  void send() {
    for (std::uint16_t frame = 1; sends_; ++frame) {
      auto* const pixels = new std::uint16_t[std::size_t{width} * height];
      std::fill_n(pixels, std::size_t{width} * height, frame);
      const auto now = std::chrono::system_clock::now().time_since_epoch();
      rs2_software_video_frame given{};
      given.pixels = pixels;
      given.deleter = [](void* memory) { delete[] static_cast<std::uint16_t*>(memory); };
      given.stride = width * 2;
      given.bpp = 2;
      given.timestamp = std::chrono::duration<double, std::milli>(now).count() - 3;
      given.domain = RS2_TIMESTAMP_DOMAIN_SYSTEM_TIME;
      given.frame_number = frame;
      given.profile = profile_;
      rs2_software_sensor_on_video_frame(sensor_, given, &error_);
      std::this_thread::sleep_for(std::chrono::milliseconds(11));
    }
  }

  rs2_error* error_ = nullptr;
  rs2_device* device_ = nullptr;
  rs2_device_list* added_ = nullptr;
  rs2_sensor* sensor_ = nullptr;
  rs2_stream_profile* profile_ = nullptr;
  std::atomic<bool> sends_ = false;
  std::thread thread_;
};

sensing::Camera soft() {
  sensing::Camera camera = cameras::test::described("soft", width, height, 640);
  camera.device = {.own_lens = true, .exposure_s = 0.004, .preset = {}};
  return camera;
}

TEST(RealSenseSdk, ADeviceWithinTheSdkIsSetUpAndStreams) {
  rs2_error* error = nullptr;
  rs2_context* const context = rs2_create_context(RS2_API_VERSION, &error);
  ASSERT_EQ(error, nullptr);
  SoftwareCamera camera(context);
  const std::shared_ptr<Sdk> sdk = make_sdk(context);
  const auto serials = sdk->serials();
  ASSERT_NE(std::find(serials.begin(), serials.end(), "SOFT1"), serials.end());
  {
    const auto source = open_cameras(std::make_unique<cameras::Host>(), sdk, {soft()}, "SOFT1", "rig.toml");
    EXPECT_NEAR(camera.option(RS2_OPTION_DEPTH_UNITS), 0.0001, 1e-9);
    EXPECT_EQ(camera.option(RS2_OPTION_ENABLE_AUTO_EXPOSURE), 0);
    EXPECT_EQ(camera.option(RS2_OPTION_EXPOSURE), 4000);
    EXPECT_EQ(source->cameras()[0].fx, 641);
    EXPECT_EQ(source->cameras()[0].cy, 238.5);
    EXPECT_NEAR(source->cameras()[0].distortion[0], 0.01, 1e-8);
    sensing::FrameSet set;
    std::uint16_t last = 0;
    int sets = 0;
    for (int i = 0; i < 1200 && sets < 30; ++i) {
      ASSERT_TRUE(source->next(set, 0.1));
      if (set.frames.empty()) continue;
      ++sets;
      const auto& depth = set.frames[0].depth;
      ASSERT_EQ(depth.size(), std::size_t{width} * height);
      EXPECT_GT(depth.front(), last);
      EXPECT_EQ(depth.front(), depth.back());
      last = depth.front();
      const double now_s = cameras::Host().now_s();
      EXPECT_GE(now_s - set.time_s, 0.003) << "when it was captured, not when it arrived";
      EXPECT_LT(now_s - set.time_s, 60) << "on the computer's clock";
    }
    EXPECT_EQ(sets, 30);
  }
  sensing::Camera other = soft();
  other.width = 640;
  EXPECT_CONTAINS(error_of([&] { open_cameras(std::make_unique<cameras::Host>(), sdk, {other}, "SOFT1", "rig.toml"); }),
                  "realsense:SOFT1: does not offer Z16 of 640x480; it has 848x480");
}

TEST(RealSenseSdk, AMissingSerialNumberIsNotFound) {
  const std::shared_ptr<Sdk> sdk = make_sdk();
  EXPECT_EQ(sdk->find("nobody"), nullptr);
}

}  // namespace
}  // namespace palpa::driver::realsense
