#include "driver/realsense/librealsense.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <type_traits>
#include <utility>

#include "base/error.hpp"

namespace palpa::driver::realsense {
namespace {

/// Calls a function of the SDK, whose last argument receives its error.
template <typename Function, typename... Arguments>
auto ask(Function function, Arguments... arguments) {
  rs2_error* error = nullptr;
  const auto check = [&] {
    if (!error) return;
    const std::string text = rs2_get_error_message(error);
    rs2_free_error(error);
    throw failure("librealsense2: " + text);
  };
  if constexpr (std::is_void_v<std::invoke_result_t<Function, Arguments..., rs2_error**>>) {
    function(arguments..., &error);
    check();
  } else {
    const auto result = function(arguments..., &error);
    check();
    return result;
  }
}

/// The same for calls during cleanup, where errors are ignored.
template <typename Function, typename... Arguments>
void tell(Function function, Arguments... arguments) noexcept {
  rs2_error* error = nullptr;
  function(arguments..., &error);
  if (error) rs2_free_error(error);
}

template <auto function>
struct Free {
  template <typename T>
  void operator()(T* owned) const {
    function(owned);
  }
};
using ContextOwner = std::unique_ptr<rs2_context, Free<rs2_delete_context>>;
using DeviceListOwner = std::unique_ptr<rs2_device_list, Free<rs2_delete_device_list>>;
using DeviceOwner = std::unique_ptr<rs2_device, Free<rs2_delete_device>>;
using SensorListOwner = std::unique_ptr<rs2_sensor_list, Free<rs2_delete_sensor_list>>;
using SensorOwner = std::unique_ptr<rs2_sensor, Free<rs2_delete_sensor>>;
using ProfilesOwner = std::unique_ptr<rs2_stream_profile_list, Free<rs2_delete_stream_profiles_list>>;

struct Name {
  rs2_option option;
  double unit;  ///< palpa's unit per unit of the SDK
};
Name name_of(Option option) {
  switch (option) {
    case Option::depth_unit_m:
      return {RS2_OPTION_DEPTH_UNITS, 1};
    case Option::exposure_s:
      return {RS2_OPTION_EXPOSURE, 1e-6};
    case Option::automatic_exposure:
      return {RS2_OPTION_ENABLE_AUTO_EXPOSURE, 1};
    case Option::hardware_preset:
      return {RS2_OPTION_HARDWARE_PRESET, 1};
    case Option::global_time:
      break;
  }
  return {RS2_OPTION_GLOBAL_TIME_ENABLED, 1};
}

/// The SDK's stamps are milliseconds of the system's clock, or of the camera's own clock.
double age_of(rs2_frame* frame) {
  if (ask(rs2_get_frame_timestamp_domain, frame) == RS2_TIMESTAMP_DOMAIN_HARDWARE_CLOCK) return 0;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count() - ask(rs2_get_frame_timestamp, frame) * 1e-3;
}

class DepthSensor final : public Sensor {
 public:
  DepthSensor(DeviceOwner device, SensorOwner sensor)
      : device_(std::move(device)),
        sensor_(std::move(sensor)),
        profiles_(ask(rs2_get_stream_profiles, sensor_.get())) {}
  ~DepthSensor() override { end(); }
  DepthSensor(const DepthSensor&) = delete;
  DepthSensor& operator=(const DepthSensor&) = delete;

  std::vector<cameras::Offer> offers() override {
    std::vector<cameras::Offer> offers;
    each_profile([&](const rs2_stream_profile*, const cameras::Offer& offer) { offers.push_back(offer); });
    return offers;
  }

  cameras::Lens lens(const cameras::Offer& offer) override {
    rs2_intrinsics found{};
    ask(rs2_get_video_stream_intrinsics, profile_of(offer), &found);
    cameras::Lens lens{found.fx, found.fy, found.ppx, found.ppy};
    const bool none = std::all_of(std::begin(found.coeffs), std::end(found.coeffs), [](float c) { return c == 0; });
    if (none) return lens;
    if (found.model != RS2_DISTORTION_BROWN_CONRADY) {
      throw failure(
          fmt::format("its lens has the distortion {}, which palpa does not support; set calibration = \"file\"",
                      rs2_distortion_to_string(found.model)));
    }
    std::copy(std::begin(found.coeffs), std::end(found.coeffs), lens.distortion.begin());
    return lens;
  }

  bool has(Option option) override { return ask(rs2_supports_option, options(), name_of(option).option) != 0; }
  double get(Option option) override {
    const Name name = name_of(option);
    return static_cast<double>(ask(rs2_get_option, options(), name.option)) * name.unit;
  }
  void set(Option option, double value) override {
    const Name name = name_of(option);
    ask(rs2_set_option, options(), name.option, static_cast<float>(value / name.unit));
  }

  void start(const cameras::Offer& offer, std::function<void(const Image&)> taker) override {
    taker_ = std::move(taker);
    ask(rs2_open, sensor_.get(), profile_of(offer));
    open_ = true;
    ask(rs2_start, sensor_.get(), &DepthSensor::arrived, static_cast<void*>(this));
    runs_ = true;
  }
  void stop() noexcept override { end(); }
  void release(const Image& image) override { rs2_release_frame(static_cast<rs2_frame*>(image.frame)); }
  bool connected() override { return ask(rs2_device_is_connected, device_.get()) != 0; }

 private:
  rs2_options* options() const { return reinterpret_cast<rs2_options*>(sensor_.get()); }  // as the SDK's own C++ does

  template <typename Visitor>
  void each_profile(Visitor visit) {
    const int count = ask(rs2_get_stream_profiles_count, profiles_.get());
    for (int i = 0; i < count; ++i) {
      const rs2_stream_profile* profile = ask(rs2_get_stream_profile, profiles_.get(), i);
      rs2_stream stream{};
      rs2_format format{};
      int index = 0, id = 0, rate_hz = 0, width = 0, height = 0;
      ask(rs2_get_stream_profile_data, profile, &stream, &format, &index, &id, &rate_hz);
      if (stream != RS2_STREAM_DEPTH || format != RS2_FORMAT_Z16) continue;
      ask(rs2_get_video_stream_resolution, profile, &width, &height);
      visit(profile, {.width = static_cast<std::uint32_t>(width),
                      .height = static_cast<std::uint32_t>(height),
                      .rate_hz = static_cast<double>(rate_hz)});
    }
  }

  const rs2_stream_profile* profile_of(const cameras::Offer& wanted) {
    const rs2_stream_profile* found = nullptr;
    each_profile([&](const rs2_stream_profile* profile, const cameras::Offer& offer) {
      if (offer.width == wanted.width && offer.height == wanted.height && offer.rate_hz == wanted.rate_hz)
        found = profile;
    });
    if (!found) throw failure(fmt::format("no Z16 of {}x{}", wanted.width, wanted.height));
    return found;
  }

  /// Called on one of the SDK's threads. The SDK has a C interface, so nothing may be thrown into it.
  static void arrived(rs2_frame* frame, void* self) noexcept {
    auto* const sensor = static_cast<DepthSensor*>(self);
    try {
      Image image{.frame = frame};
      image.depth = static_cast<const std::byte*>(ask(rs2_get_frame_data, frame));
      image.width = static_cast<std::uint32_t>(ask(rs2_get_frame_width, frame));
      image.height = static_cast<std::uint32_t>(ask(rs2_get_frame_height, frame));
      image.stride = static_cast<std::uint32_t>(ask(rs2_get_frame_stride_in_bytes, frame));
      // For memory that is not the SDK's own, as with software devices, the SDK returns 0.
      const int bytes = ask(rs2_get_frame_data_size, frame);
      image.bytes = bytes > 0 ? static_cast<std::size_t>(bytes) : std::size_t{image.stride} * image.height;
      image.age_s = age_of(frame);
      sensor->taker_(image);
    } catch (const std::exception&) {
      rs2_release_frame(frame);
    }
  }

  void end() noexcept {
    if (std::exchange(runs_, false)) tell(rs2_stop, sensor_.get());
    if (std::exchange(open_, false)) tell(rs2_close, sensor_.get());
  }

  DeviceOwner device_;
  SensorOwner sensor_;
  ProfilesOwner profiles_;
  std::function<void(const Image&)> taker_;
  bool open_ = false, runs_ = false;
};

class Library final : public Sdk {
 public:
  explicit Library(rs2_context* context) : context_(context) {}

  std::vector<std::string> serials() override {
    std::vector<std::string> serials;
    each_camera([&](const std::string& serial, DeviceOwner, SensorOwner) {
      serials.push_back(serial);
      return false;
    });
    std::sort(serials.begin(), serials.end());
    return serials;
  }

  std::unique_ptr<Sensor> find(const std::string& wanted) override {
    std::unique_ptr<Sensor> found;
    each_camera([&](const std::string& serial, DeviceOwner device, SensorOwner sensor) {
      if (serial == wanted) found = std::make_unique<DepthSensor>(std::move(device), std::move(sensor));
      return found != nullptr;
    });
    return found;
  }

 private:
  /// Calls `visit(serial, device, depth sensor)` for each camera until `visit` says that it has enough.
  template <typename Visitor>
  void each_camera(Visitor visit) {
    const DeviceListOwner devices(ask(rs2_query_devices, context_.get()));
    const int count = ask(rs2_get_device_count, devices.get());
    for (int d = 0; d < count; ++d) {
      DeviceOwner device(ask(rs2_create_device, devices.get(), d));
      if (!ask(rs2_supports_device_info, device.get(), RS2_CAMERA_INFO_SERIAL_NUMBER)) continue;
      const std::string serial = ask(rs2_get_device_info, device.get(), RS2_CAMERA_INFO_SERIAL_NUMBER);
      const SensorListOwner sensors(ask(rs2_query_sensors, device.get()));
      const int sensor_count = ask(rs2_get_sensors_count, sensors.get());
      for (int s = 0; s < sensor_count; ++s) {
        SensorOwner sensor(ask(rs2_create_sensor, sensors.get(), s));
        if (!ask(rs2_is_sensor_extendable_to, sensor.get(), RS2_EXTENSION_DEPTH_SENSOR)) continue;
        if (visit(serial, std::move(device), std::move(sensor))) return;
        break;
      }
    }
  }

  ContextOwner context_;
};

}  // namespace

std::unique_ptr<Sdk> make_sdk(rs2_context* context) {
  return std::make_unique<Library>(context);
}

std::unique_ptr<Sdk> make_sdk() {
  return make_sdk(ask(rs2_create_context, RS2_API_VERSION));
}

}  // namespace palpa::driver::realsense
