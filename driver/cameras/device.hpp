// A depth camera, whoever brings its frames: the kernel (driver/v4l2) or librealsense2 (driver/realsense). What is
// common to them, their matching, what becomes of one that goes, is written once on top of this.
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
  broken,  ///< a frame that is no whole one, or no newer than the one before; its buffer is the camera's again
  nothing,
  gone,  ///< the device does not answer any more: unplugged, or the stream has failed
};

/// Between its making and its end the camera streams. Its end may take seconds where the device does not answer.
class Stream {
 public:
  virtual ~Stream() = default;

  /// What poll() is to wait for.
  virtual int fd() const = 0;
  /// From frame to frame, as it was asked for.
  virtual double period_s() const = 0;
  /// How many the camera has; one whose frames all wait with whoever took them has none to fill.
  virtual std::uint32_t buffers() const = 0;

  /// The oldest frame that the camera has ready. Never waits.
  virtual Take take(Taken& taken) = 0;
  /// Why take() said gone: "unplugged", or what the kernel said.
  virtual const std::string& fault() const = 0;
  /// Rows of the frame, `width * height` values, into `depth`.
  virtual void copy(const Taken& taken, std::uint16_t* depth) const = 0;
  /// Gives its buffer back.
  virtual void release(const Taken& taken) = 0;

  /// A camera has that many at most, and three at least.
  static constexpr std::uint32_t most_buffers = 8;
};

/// The way to one camera, which may go and come back.
class Device {
 public:
  virtual ~Device() = default;
  /// For messages: "/dev/video2". As it was when it was last open.
  virtual const std::string& address() const = 0;
  /// Opened, set up as the rig says, and streaming. Throws Error: what is wrong, and what would be right. May take
  /// seconds where the device does not answer.
  virtual std::unique_ptr<Stream> open() = 0;
  /// The same of one that was gone, wherever it is now, on whatever thread; what it says of itself has to be what it
  /// said before. Null while it is not there.
  virtual std::unique_ptr<Stream> open_again() = 0;
  /// Of its own calibration, where the setting asks for that. After open().
  virtual const std::optional<Lens>& lens() const = 0;
};

}  // namespace palpa::driver::cameras
