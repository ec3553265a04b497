// A USB port of this machine's own kernel for an emulated device. The module vhci_hcd hands over each of the kernel's
// transfers through a socket, as USB/IP messages, and takes the answers from there. Everything above the host
// controller is the same as with a real device. Needs root.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "driver/clock.hpp"
#include "usb/gadget.hpp"

namespace palpa::test {

/// Whether it becomes true within that time: for what must not. Wait with begins() for what must.
bool eventually(double seconds, const std::function<bool()>& condition);

class VhciPort {
 public:
  /// `gadget` must outlive it.
  explicit VhciPort(Gadget& gadget) : gadget_(gadget) {}
  ~VhciPort() { unplug(); }
  VhciPort(const VhciPort&) = delete;
  VhciPort& operator=(const VhciPort&) = delete;

  /// Plugs in at the next free port; returns when the kernel knows the device. Throws std::runtime_error if it does not
  /// within the time of begins().
  void plug();
  /// Unplugs the device; returns when the kernel has noticed.
  void unplug();
  bool plugged() const { return plugged_; }

  /// BUS-PORT, the kernel's name for the place where it is plugged in.
  const std::string& place() const { return place_; }
  /// Its file in /dev/bus/usb.
  std::string device_file() const;

  /// While this is held, no other thread calls the gadget.
  [[nodiscard]] std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }
  double now_s() const { return clock_.now_s(); }

 private:
  struct Message;

  void serve();
  void hear();
  void submit(const Message& message);
  void unlink(const Message& message);
  void carry();
  void answer(UsbTransfer& transfer, bool ok);
  void drop();

  Gadget& gadget_;
  driver::SteadyClock clock_;
  std::mutex mutex_;
  std::thread thread_;
  std::atomic<bool> plugged_{false}, ends_{false};
  int fd_ = -1;
  unsigned port_ = 0;
  std::string place_;
  std::map<std::uint8_t, std::deque<UsbTransfer>> waiting_;  ///< by endpoint, oldest first
};

}  // namespace palpa::test
