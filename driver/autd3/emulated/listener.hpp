// The emulated server on a real TCP port.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>

#include "base/system/descriptor.hpp"
#include "driver/autd3/emulated/server.hpp"

namespace palpa::driver::autd3 {

/// Seconds since 2000-01-01 by this machine's time of day, which the emulated devices share.
double device_time_s();

class Listener {
 public:
  /// Listens on 127.0.0.1. Port 0 takes any free port. Throws failure() if the port is taken.
  explicit Listener(std::uint16_t port);
  std::uint16_t port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  /// Serves one client after the other until `stop`, which it checks 50 times a second. `heard` gets the bytes before
  /// the server takes them, and no bytes at each check without any. `lock` is held while the server is used, so that
  /// other threads can look at it.
  void serve(EmulatedServer& server, const std::atomic<bool>& stop, std::mutex& lock,
             const std::function<void(std::span<const std::uint8_t>)>& heard = {});

 private:
  Descriptor socket_;
  std::uint16_t port_ = 0;
};

}  // namespace palpa::driver::autd3
