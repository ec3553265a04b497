// UDP sockets: one that sends datagrams without waiting, and one that receives them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace palpa {

struct UdpAddress {
  std::string host, port;
  bool loopback = false;  ///< this computer's: also ::1, where it has IPv6
};
/// HOST:PORT, or [HOST]:PORT for IPv6. Throws bad_usage for another form: `form` is the message.
UdpAddress parse_udp_address(const std::string& text, const std::string& form);
/// The same, or PORT of this computer's loopback: 127.0.0.1 and ::1.
UdpAddress parse_listening_address(const std::string& text, const std::string& form);

class UdpSender {
 public:
  /// In messages, `what` names the user of the socket. Throws as parse_udp_address does, and failure() for a host that
  /// does not resolve.
  UdpSender(const std::string& address, const std::string& what, const std::string& form);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  /// Sends one datagram. It is not an error if nobody listens, because a receiver may come and go. Returns false if the
  /// datagram could not be sent; warn() gives the reason.
  bool send(std::string_view datagram);
  /// Warns of the datagram that could not be sent, the first time only. Separate from send(), because the reader of
  /// warnings may keep the caller waiting, and silence must go first.
  void warn();

 private:
  std::string what_;
  int socket_;
  int fault_ = 0;  ///< errno of the last datagram that could not be sent
  bool warned_ = false;
};

class UdpReceiver {
 public:
  /// Listens on this address. Throws failure() if it does not resolve, is not this machine's, or is taken. A loopback
  /// without IPv6 is 127.0.0.1 alone.
  UdpReceiver(const UdpAddress& address, const std::string& what);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Waits for a datagram. False: none has come.
  bool wait(double most_s) const;
  /// Takes the next datagram, without waiting; nullopt if there is none. `into` must have room for it: the rest of a
  /// longer one is lost.
  std::optional<std::size_t> receive(std::span<char> into) const;

 private:
  int socket_;
  int socket6_ = -1;  ///< of ::1
};

}  // namespace palpa
