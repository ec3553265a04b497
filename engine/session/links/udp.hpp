// One connected UDP socket that sends datagrams without waiting.
#pragma once

#include <string>
#include <string_view>

namespace palpa::session {

class UdpSender {
 public:
  /// `address` is HOST:PORT, or [HOST]:PORT for IPv6. In messages, `what` names the user of the socket and `form` is
  /// the expected form. Throws bad_usage for another form, failure() for a host that does not resolve.
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

}  // namespace palpa::session
