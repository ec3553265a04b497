// Times of the parts of a frame that run on the host.
#pragma once

#include <chrono>
#include <vector>

#include "gpu/pass_time.hpp"

namespace palpa::touch {

/// Times each part from the end of the one before.
class PassWatch {
 public:
  explicit PassWatch(std::vector<gpu::PassTime>& times) : times_(times) {}

  /// `name`: a string literal, kept by pointer.
  void mark(const char* name) {
    const auto now = Clock::now();
    times_.push_back({name, std::chrono::duration<double, std::milli>(now - begin_).count()});
    begin_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<gpu::PassTime>& times_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace palpa::touch
