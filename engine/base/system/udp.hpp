// Addresses of programs, and UDP sockets: one that sends datagrams without waiting, and one that receives them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/system/descriptor.hpp"

namespace palpa {

struct NetAddress {
  std::string host, port;
  bool loopback = false;  ///< this computer's: also ::1, where it has IPv6
};
/// HOST:PORT, or [HOST]:PORT for IPv6, with a port from 1 to 65535. Throws bad_usage for another form: `form` is the
/// message.
NetAddress parse_address(const std::string& text, const std::string& form);
/// The same, or PORT of this computer's loopback: 127.0.0.1 and ::1.
NetAddress parse_listening_address(const std::string& text, const std::string& form);

class UdpSender {
 public:
  /// In messages, `what` names the user of the socket. Throws as parse_address does, and failure() for a host that does
  /// not resolve.
  UdpSender(const std::string& address, const std::string& what, const std::string& form);

  enum class Sent {
    yes,      ///< as far as the kernel knows
    refused,  ///< nobody listens, at none of the addresses of the name; not an error, a receiver may come and go
    no        ///< it could not be sent
  };
  /// Sends one datagram, without waiting, to the first address of the name that does not refuse it. On the loopback,
  /// the kernel knows at once that nobody listens; elsewhere with the next datagram, if at all.
  Sent send(std::string_view datagram);
  /// Warns of datagrams that could not be sent and of those that were refused, the first time only. Separate from
  /// send(), because the reader of warnings may keep the caller waiting, and silence must go first.
  void warn();

 private:
  std::string what_, address_;
  std::vector<Descriptor> sockets_;  ///< one for each address of the name
  std::size_t place_ = 0;            ///< the one that takes datagrams
  int fault_ = 0;                    ///< errno of the last datagram that could not be sent
  bool refused_ = false;             ///< one was
  bool told_fault_ = false, told_refusal_ = false;
};

class UdpReceiver {
 public:
  /// Listens on this address; of a name, on all its addresses that this machine has. Throws failure() if it does not
  /// resolve, is not this machine's, or is taken.
  UdpReceiver(const NetAddress& address, const std::string& what);

  /// Waits for a datagram. False: none has come.
  bool wait(double most_s) const;
  /// Takes the next datagram, without waiting; nullopt if there is none. `into` must have room for it: the rest of a
  /// longer one is lost.
  std::optional<std::size_t> receive(std::span<char> into) const;

 private:
  std::vector<Descriptor> sockets_;
};

}  // namespace palpa
