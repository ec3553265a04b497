// One connected UDP socket to send datagrams from, never waiting.
#pragma once

#include <string>
#include <string_view>

namespace palpa::session {

class UdpSender {
 public:
  /// `address` is HOST:PORT, or [HOST]:PORT for IPv6. `what` names the user in messages and `form` says what would be
  /// right. Throws bad_usage for another form, failure() for a host that does not resolve.
  UdpSender(const std::string& address, const std::string& what, const std::string& form);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  /// Sends one datagram. Nobody listening is no fault of the sender's: a receiver may come and go. Otherwise false: it
  /// could not be sent, and warn() says why.
  bool send(std::string_view datagram);
  /// A warning of the datagram that could not be sent, the first time only. Apart from send(), since whoever reads
  /// warnings may keep the caller waiting: silence goes first.
  void warn();

 private:
  std::string what_;
  int socket_;
  int fault_ = 0;  ///< errno of the last datagram that could not be sent
  bool warned_ = false;
};

}  // namespace palpa::session
