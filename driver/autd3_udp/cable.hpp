// The way to AUTD3 units of the UDP line: datagrams over IPv6, to a unit or to all that hear a network interface. A
// test puts units of its own in its place.
#pragma once

#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/system/descriptor.hpp"

namespace palpa::driver::autd3_udp {

/// An IPv6 address with its interface, and a port.
struct Endpoint {
  std::array<std::uint8_t, 16> address{};
  std::uint32_t scope = 0;  ///< the interface's index
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
  bool is_link_local() const { return address[0] == 0xfe && (address[1] & 0xc0) == 0x80; }
  bool is_multicast() const { return address[0] == 0xff; }
};
std::string to_text(const Endpoint& endpoint);

class Cable {
 public:
  virtual ~Cable() = default;
  /// All units that hear it.
  virtual Endpoint group() const = 0;
  /// Sends without waiting. A datagram that does not fit is lost, as any may be.
  virtual void send(const Endpoint& to, std::span<const std::uint8_t> datagram) = 0;
  /// Takes the next datagram, and says how long it is; nothing: there is none. The rest of a longer one is lost.
  virtual std::optional<std::size_t> receive(std::span<std::uint8_t> into, Endpoint& from) = 0;
  /// What to wait for; -1: nothing.
  virtual pollfd watched() const = 0;

  /// Whether a unit could have sent from there: for a group of units on a cable, from a link-local address of the same
  /// interface; else from the same address. Nothing is sent to anything else.
  bool may_come_from(const Endpoint& from) const;
};

/// The group that the argument of the link names: NIC, or [ADDRESS%SCOPE]:PORT. Throws bad_usage.
Endpoint parse_group(const std::string& argument);

/// A socket for that group. Throws failure() if this machine has none.
class UdpCable final : public Cable {
 public:
  explicit UdpCable(const Endpoint& group);
  Endpoint group() const override { return group_; }
  void send(const Endpoint& to, std::span<const std::uint8_t> datagram) override;
  std::optional<std::size_t> receive(std::span<std::uint8_t> into, Endpoint& from) override;
  pollfd watched() const override { return {socket_.get(), POLLIN, 0}; }

 private:
  Endpoint group_;
  Descriptor socket_;
};

/// A network interface to which units could be connected.
struct Nic {
  std::string name;
  std::uint32_t index = 0;
  bool up = false;    ///< switched on, with a cable that has another end
  bool ipv6 = false;  ///< has a link-local address
};
/// All but loopbacks, in the order of their names.
std::vector<Nic> nics();
/// The group of the units on that interface.
Endpoint group_of(std::uint32_t nic);

}  // namespace palpa::driver::autd3_udp
