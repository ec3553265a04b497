// One camera of a source: its stream, its frames that wait to be matched, and the reports when it is lost and when it
// is back.
#pragma once

#include <array>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "driver/cameras/device.hpp"
#include "driver/cameras/host.hpp"

namespace palpa::driver::cameras {

class LiveCamera {
 public:
  /// Opens it, sets it up and starts it. Throws as Device::open() does. `name` is the camera's name in the rig.
  LiveCamera(Host& host, std::string name, std::unique_ptr<Device> device);
  /// Waits for a camera that is being opened.
  ~LiveCamera();
  LiveCamera(const LiveCamera&) = delete;
  LiveCamera& operator=(const LiveCamera&) = delete;

  /// Takes the frames that the camera has ready, and keeps the newest. A camera that is gone is closed, looked for and
  /// opened again in the background. Returns whether a frame came.
  bool tend();
  /// Whether a set must have a frame of this camera: not while the camera is gone or silent.
  bool awaited() const;
  /// Whether a frame of it has come since it was opened.
  bool gives_frames() const { return frame_s_ > 0; }

  /// Capture times of the frames that wait, oldest first.
  std::span<const double> times_s() const { return {times_s_.data(), held_}; }
  void copy(std::uint32_t frame, std::uint16_t* depth) const { stream_->copy(taken_[frame], depth); }
  /// Gives back the buffers of the frames up to and including this one.
  void release_through(std::uint32_t frame);

  /// The descriptor that poll() waits for; below 0 while the camera is gone.
  int fd() const { return stream_ ? stream_->fd() : -1; }
  /// The time from frame to frame: the requested one, or the smallest of the last few intervals if that is longer. In
  /// the dark, automatic exposure takes longer than a frame.
  double period_s() const;
  /// The lens of the camera's own calibration, if the setting asks for it. Call before the first tend().
  const std::optional<Lens>& lens() const { return device_->lens(); }

 private:
  static constexpr std::uint32_t most_held = 3, distances = 3;

  void look_for_it();
  void find_and_open();
  void adopt();
  void keep(const Taken& taken);
  void drop();
  void count_broken();
  void say_lost(const std::string& how);
  void say_back();

  Host& host_;
  const std::string name_;
  std::unique_ptr<Device> device_;  ///< used only by the background work while that looks for the camera
  std::unique_ptr<Stream> stream_;
  std::array<Taken, most_held> taken_{};
  std::array<double, most_held> times_s_{};
  std::uint32_t held_ = 0;
  double last_s_ = 0;                            ///< capture time of the newest frame; 0: none since it was opened
  std::array<double, distances> distances_s_{};  ///< of the last frames, overwritten in turn
  std::uint32_t next_distance_ = 0;
  double opened_s_ = 0;       ///< when it was opened
  double frame_s_ = 0;        ///< when its last frame was taken; 0: none since it was opened
  double await_until_s_ = 0;  ///< its first frame is waited for until then
  double retry_s_ = 0;        ///< when it is looked for again
  double lost_s_ = 0;         ///< when it was lost
  bool lost_ = false;         ///< it is gone, and that has been reported
  bool refusal_said_ = false;
  std::uint32_t broken_ = 0;

  // For the background work, which alone uses them while it runs.
  std::unique_ptr<Stream> old_, new_;
  std::string refusal_;
  std::future<void> beside_;  ///< not valid: there is no background work
};

}  // namespace palpa::driver::cameras
