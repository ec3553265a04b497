// A program that sends datagrams to a port of the loopback.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <string>

namespace palpa::test {

/// A port that was free a moment ago, below those that the kernel gives to programs that name none.
inline std::uint16_t free_udp_port() {
  constexpr int first = 10000, ports = 20000;
  static std::atomic<int> tried{0};
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  do
    address.sin_port = htons(static_cast<std::uint16_t>(first + (37 * getpid() + tried++) % ports));
  while (bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 && tried < ports);
  ::close(socket);
  return ntohs(address.sin_port);
}

class UdpSender {
 public:
  explicit UdpSender(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to_.sin_port = htons(port);
  }
  ~UdpSender() { ::close(socket_); }
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  /// On the loopback, it has arrived when this returns, unless the receiver's buffer is full.
  void send(const std::string& datagram) const {
    ::sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof(to_));
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

}  // namespace palpa::test
