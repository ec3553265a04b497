// A peripheral at a socket, for the drivers of other processes (local.hpp): many of them may ask what it is, but only
// one can have it open.
#pragma once

#include <poll.h>

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "driver/usb/local.hpp"
#include "driver/usb/peripheral.hpp"

namespace palpa::driver::usb {

/// Gets everything that crossed the wire, when it ended. For traces.
class Wiretap {
 public:
  virtual ~Wiretap() = default;
  virtual void control(double now_s, const Setup& setup, std::span<const std::uint8_t> in) = 0;
  virtual void bulk(double now_s, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) = 0;
};

class LocalServer {
 public:
  /// Listens at the next free address. The peripheral and the tap, which may be null, must outlive this object. Throws
  /// failure().
  LocalServer(Peripheral& peripheral, Wiretap* tap);
  ~LocalServer();
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  const std::filesystem::path& address() const { return address_; }
  /// Appends the descriptors to wait on.
  void watch(std::vector<pollfd>& watched) const;
  /// Whether bytes wait for the peripheral to have room.
  bool waits() const;
  /// Serves all clients without waiting. The clock is read for each packet, so that nothing comes before it was sent.
  void go_on(const std::function<double()>& now);

 private:
  struct Transfer {
    std::uint32_t number = 0;
    std::size_t taken = 0;
    std::vector<std::uint8_t> bytes;
  };
  struct Client {
    int fd = -1;
    bool owner = false;
    std::uint8_t endpoint = 0;
    std::deque<Transfer> transfers;
  };

  void listen_at_free_address();
  bool hear(Client& client, const std::function<double()>& now);
  void leave(Client& client, double now_s);
  void take(Client& client, LocalMessage message, std::span<const std::uint8_t> bytes, double now_s);
  void describe(const Client& client, const LocalMessage& message);
  void claim(Client& client, LocalMessage message);
  void request(const Client& client, LocalMessage message, double now_s);
  void carry(Client& client, double now_s);
  void end_transfers(Client& client, Outcome outcome, double now_s);
  void end_transfer(Client& client, Outcome outcome, double now_s);
  static void answer(const Client& client, const LocalMessage& message, std::span<const std::uint8_t> bytes = {});

  Peripheral& peripheral_;
  Wiretap* tap_;
  std::filesystem::path address_;
  int listener_ = -1;
  std::vector<Client> clients_;
  std::vector<std::uint8_t> packet_;
};

}  // namespace palpa::driver::usb
