// A depth camera whose frames come from the kernel (driver/v4l2) or from librealsense2 (driver/realsense). The common
// parts, such as matching frames and handling a lost camera, are written once on top of this.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace palpa::driver::cameras {

/// Pinhole of the depth image, as the camera keeps it.
struct Lens {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 5> distortion{};     ///< k1 k2 p1 p2 k3, as OpenCV
  bool operator==(const Lens&) const = default;
};

/// A frame that the camera has delivered and that still lies in its buffer.
struct Taken {
  std::uint32_t buffer = 0;
  double time_s = 0;  ///< CLOCK_MONOTONIC; never later than when it was taken
};

/// What take() found.
enum class Take {
  frame,
  broken,  ///< an incomplete frame, or not newer than the one before; the camera has its buffer again
  nothing,
  gone,  ///< the device does not answer any more: unplugged, or the stream has failed
};

/// The camera streams while this object exists. Its destructor may take seconds if the device does not answer.
class Stream {
 public:
  virtual ~Stream() = default;

  /// The descriptor that poll() waits for.
  virtual int fd() const = 0;
  /// The time from frame to frame, as requested.
  virtual double period_s() const = 0;
  /// How many buffers the camera has. It has none to fill while all of its frames are taken and not yet released.
  virtual std::uint32_t buffers() const = 0;

  /// The oldest frame that the camera has ready. Never waits.
  virtual Take take(Taken& taken) = 0;
  /// Why take() returned gone: "unplugged", or the kernel's message.
  virtual const std::string& fault() const = 0;
  /// Copies the rows of the frame, `width * height` values, into `depth`.
  virtual void copy(const Taken& taken, std::uint16_t* depth) const = 0;
  /// Gives the frame's buffer back.
  virtual void release(const Taken& taken) = 0;

  /// A camera has at most this many buffers, and at least three.
  static constexpr std::uint32_t most_buffers = 8;
};

/// The way to one camera, which may go and come back.
class Device {
 public:
  virtual ~Device() = default;
  /// For messages: "/dev/video2". As it was when it was last open.
  virtual const std::string& address() const = 0;
  /// Opens the camera, sets it up as the rig says, and starts it. Throws Error with what is wrong and what would be
  /// right. May take seconds if the device does not answer.
  virtual std::unique_ptr<Stream> open() = 0;
  /// The same for a camera that was gone, wherever it is now, on any thread. It must report the same about itself as
  /// before. Null while it is not there.
  virtual std::unique_ptr<Stream> open_again() = 0;
  /// The lens of the camera's own calibration, if the setting asks for it. Call after open().
  virtual const std::optional<Lens>& lens() const = 0;
};

}  // namespace palpa::driver::cameras
