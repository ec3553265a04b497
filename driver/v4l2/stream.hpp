// One depth camera's stream through V4L2: opened, asked for "Z16 " of one size and rate, read without waiting.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2 {

/// What a camera is asked for.
struct Wanted {
  std::uint32_t width = 0, height = 0;  ///< pixels
  double rate_hz = 0;                   ///< 0: as it is set
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

/// Between its making and its end the camera streams. Neither copied nor moved: its buffers are mapped.
class Stream {
 public:
  /// Throws Error: what is wrong with the device, the format that it has, what would be right. `rig` is the file that
  /// asks for it. `configure` gets the open device before it streams; what it throws is thrown.
  Stream(Kernel& kernel, const std::string& path, const Wanted& wanted, const std::string& rig,
         const std::function<void(int fd)>& configure = {});
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  int fd() const { return fd_; }
  double period_s() const { return period_s_; }
  /// How many the camera has; one whose frames all wait with whoever took them has none to fill.
  std::uint32_t buffers() const { return buffer_count_; }

  /// The oldest frame that the camera has ready. Never waits.
  Take take(Taken& taken);
  /// Why take() said gone: "unplugged", or what the kernel said.
  const std::string& fault() const { return fault_; }
  /// Rows of the frame, `width * height` values, into `depth`.
  void copy(const Taken& taken, std::uint16_t* depth) const;
  /// Gives its buffer back.
  void release(const Taken& taken);

  /// A camera has that many at most, and three at least.
  static constexpr std::uint32_t most_buffers = 8;

 private:
  struct Mapped {
    const std::byte* memory = nullptr;
    std::size_t length = 0;
  };

  void check_node();
  void set_format(const Wanted& wanted, const std::string& rig);
  void set_rate(double rate_hz, const std::string& rig);
  void map_buffers();
  void start();
  void ask(unsigned long request, void* argument, const char* what);
  void stop() noexcept;
  bool enqueue(std::uint32_t buffer);
  Take lost(int error);

  Kernel& kernel_;
  std::string path_;
  int fd_ = -1;
  std::uint32_t width_ = 0, height_ = 0, stride_ = 0;  ///< stride in bytes
  double period_s_ = 0;
  std::array<Mapped, most_buffers> buffers_{};
  std::uint32_t buffer_count_ = 0;
  double last_s_ = 0;  ///< capture time of the frame before
  std::string fault_;
};

}  // namespace palpa::driver::v4l2
