// Depth frames that the SDK delivers on its own threads. They can be taken at any time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "driver/cameras/device.hpp"
#include "driver/cameras/host.hpp"
#include "driver/cameras/offers.hpp"
#include "driver/realsense/sdk.hpp"

namespace palpa::driver::realsense {

/// If frames are not taken in time, the newest stay. Neither copied nor moved, because the SDK knows its address.
class Stream final : public cameras::Stream {
 public:
  /// Starts the sensor, which must be set up. Throws what Sensor::start() does.
  Stream(cameras::Host& host, std::unique_ptr<Sensor> sensor, const cameras::Offer& offer);
  ~Stream() override;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  int fd() const override { return fd_; }
  double period_s() const override { return 1 / offer_.rate_hz; }
  std::uint32_t buffers() const override { return most_buffers; }
  cameras::Take take(cameras::Taken& taken) override;
  const std::string& fault() const override { return fault_; }
  void copy(const cameras::Taken& taken, std::uint16_t* depth) const override;
  void release(const cameras::Taken& taken) override;

  /// A stamp that is older, or in the future, is ignored: the host's clock was set meanwhile.
  static constexpr double oldest_s = 0.25;

 private:
  struct Slot {
    Image image;
    double time_s = 0;
    bool used = false;
  };

  void arrived(const Image& image);
  void give_back(std::uint32_t slot);
  bool is_whole(const Image& image) const;

  cameras::Host& host_;
  std::unique_ptr<Sensor> sensor_;
  const cameras::Offer offer_;
  int fd_ = -1;  ///< readable while frames are ready
  double last_s_ = 0;
  std::string fault_;

  mutable std::mutex mutex_;  ///< protects what is below, which the SDK's thread also writes
  std::array<Slot, most_buffers> slots_{};
  std::array<std::uint32_t, most_buffers> ready_{};  ///< slots, oldest first
  std::uint32_t ready_count_ = 0;
};

}  // namespace palpa::driver::realsense
