// One depth camera's stream through V4L2: opened, asked for "Z16 " of one size and rate, read without waiting.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "driver/cameras/device.hpp"
#include "driver/v4l2/kernel.hpp"

namespace palpa::driver::v4l2 {

/// What a camera is asked for.
struct Wanted {
  std::uint32_t width = 0, height = 0;  ///< pixels
  double rate_hz = 0;                   ///< 0: as it is set
};

using cameras::Take;
using cameras::Taken;

/// Neither copied nor moved, because its buffers are mapped.
class Stream final : public cameras::Stream {
 public:
  /// Throws Error with what is wrong with the device, the format that it has, and what would be right. `rig` is the
  /// file that asks for it. `configure` gets the open device before it streams; its exceptions are passed on.
  Stream(Kernel& kernel, const std::string& path, const Wanted& wanted, const std::string& rig,
         const std::function<void(int fd)>& configure = {});
  ~Stream() override;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  int fd() const override { return fd_; }
  double period_s() const override { return period_s_; }
  std::uint32_t buffers() const override { return buffer_count_; }
  Take take(Taken& taken) override;
  const std::string& fault() const override { return fault_; }
  void copy(const Taken& taken, std::uint16_t* depth) const override;
  void release(const Taken& taken) override;

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
