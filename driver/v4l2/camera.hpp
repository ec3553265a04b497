// One camera of a source: its stream, the frames of it that wait to be matched, and what is said when it goes and when
// it is back.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "driver/v4l2/d400.hpp"
#include "driver/v4l2/kernel.hpp"
#include "driver/v4l2/stream.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::v4l2 {

class LiveCamera {
 public:
  struct Description {
    std::string name;  ///< the rig's
    std::string path;  ///< as on the command line
    Wanted wanted;
    std::string rig;  ///< its file, for messages
    double depth_unit_m = 0.001;
    sensing::DeviceSetting setting{};
  };
  /// Opens it, sets it up where it is a RealSense, and starts it. Throws as Stream does, and where it has another depth
  /// unit than the rig says.
  LiveCamera(Kernel& kernel, Description description);

  /// Takes what the camera has ready and keeps the newest frames of it. A camera that is gone is opened again when it
  /// is time, which may take a while. Whether a frame came.
  bool tend();
  /// Whether a set has to have a frame of it: not while it is gone or silent.
  bool awaited() const;

  /// Capture times of the frames that wait, oldest first.
  std::span<const double> times_s() const { return {times_s_.data(), held_}; }
  void copy(std::uint32_t frame, std::uint16_t* depth) const { stream_->copy(taken_[frame], depth); }
  /// Gives back the buffers of the frames up to and including this one.
  void release_through(std::uint32_t frame);

  /// What poll() is to wait for; below 0 while it is gone.
  int fd() const { return stream_ ? stream_->fd() : -1; }
  double period_s() const { return period_s_; }
  /// Of its own calibration, where the setting asks for that.
  const std::optional<d400::Lens>& lens() const { return lens_; }

 private:
  static constexpr std::uint32_t most_held = 3;

  void open();
  void configure(int fd);
  void set_depth_unit(int fd);
  void reopen();
  void keep(const Taken& taken);
  void drop();
  void count_broken();
  void say_lost(const std::string& how);
  void say_back();

  Kernel& kernel_;
  Description description_;
  Identity identity_;
  std::string path_;  ///< under which it is now
  std::unique_ptr<Stream> stream_;
  double period_s_ = 0;
  std::optional<d400::Lens> lens_;
  bool trusted_said_ = false;
  bool unit_read_ = false;  ///< once: a camera that answers is not trusted again
  std::array<Taken, most_held> taken_{};
  std::array<double, most_held> times_s_{};
  std::uint32_t held_ = 0;
  double opened_s_ = 0;       ///< when it was opened
  double frame_s_ = 0;        ///< when its last frame was taken; 0: none since it was opened
  double await_until_s_ = 0;  ///< its first frame is waited for until then
  double retry_s_ = 0;        ///< when it is looked for again
  double lost_s_ = 0;         ///< since when it is gone
  bool lost_ = false;         ///< and that has been said
  bool refusal_said_ = false;
  std::uint32_t broken_ = 0;
};

}  // namespace palpa::driver::v4l2
