// A listener on a UDP port.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <vector>

namespace palpa::test {

/// A socket on the loopback, on a port that the system chooses.
class UdpReceiver {
 public:
  explicit UdpReceiver(std::chrono::milliseconds patience = std::chrono::minutes(1))
      : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    socklen_t size = sizeof(address);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    // A large receive buffer, as far as the system allows: on a busy machine, the receiver may be late.
    const int room = 8 << 20;
    if (setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof(room)) != 0)
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &room, sizeof(room));
    const timeval time{patience.count() / 1000, patience.count() % 1000 * 1000};
    EXPECT_EQ(setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &time, sizeof(time)), 0);
  }
  ~UdpReceiver() { ::close(socket_); }
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// "udp:HOST:PORT", the form of palpa's options.
  std::string address() const { return "udp:127.0.0.1:" + std::to_string(port_); }
  int port() const { return port_; }

  /// The next datagram; empty if none comes before its timeout.
  std::string next() const { return receive(0); }
  /// A datagram that has already arrived; empty if there is none.
  std::string waiting() const { return receive(MSG_DONTWAIT); }

 private:
  std::string receive(int flags) const {
    std::vector<char> text(65536);
    const ssize_t size = recv(socket_, text.data(), text.size(), flags);
    return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
  }

  int socket_ = -1;
  int port_ = 0;
};

}  // namespace palpa::test
