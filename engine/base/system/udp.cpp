#include "base/system/udp.hpp"

#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa {
namespace {

/// A socket that is connected or bound to an address, as `attach` does: ::connect or ::bind.
/// `absent`: the errors for which there is none, -1.
int open_socket(const UdpAddress& address, const std::string& what, const char* doing,
                int (*attach)(int, const sockaddr*, socklen_t), std::initializer_list<int> absent = {}) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int fault = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found)) {
    throw failure(fmt::format("{}: {}:{} does not resolve: {}", what, address.host, address.port, gai_strerror(fault)));
  }
  int attached = -1, last_fault = 0;
  for (const addrinfo* at = found; at && attached < 0; at = at->ai_next) {
    const int candidate = ::socket(at->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (candidate >= 0 && attach(candidate, at->ai_addr, at->ai_addrlen) == 0) {
      attached = candidate;
    } else {
      last_fault = errno;
      if (candidate >= 0) ::close(candidate);
    }
  }
  freeaddrinfo(found);
  if (attached < 0 && std::ranges::find(absent, last_fault) == absent.end()) {
    throw failure(
        fmt::format("{}: cannot {} {}:{}: {}", what, doing, address.host, address.port, std::strerror(last_fault)));
  }
  return attached;
}

}  // namespace

UdpAddress parse_udp_address(const std::string& text, const std::string& form) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) throw bad_usage(form);
  std::string host = text.substr(0, colon);
  const std::string port = text.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  const bool digits = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty() || !digits || std::stoi(port) < 1 || std::stoi(port) > 65535) throw bad_usage(form);
  return {std::move(host), port};
}

UdpAddress parse_listening_address(const std::string& text, const std::string& form) {
  if (text.find(':') != std::string::npos) return parse_udp_address(text, form);
  UdpAddress address = parse_udp_address("127.0.0.1:" + text, form);
  address.loopback = true;
  return address;
}

UdpSender::UdpSender(const std::string& address, const std::string& what, const std::string& form)
    : what_(what), socket_(open_socket(parse_udp_address(address, form), what, "send to", ::connect)) {}

UdpSender::~UdpSender() {
  ::close(socket_);
}

bool UdpSender::send(std::string_view datagram) {
  const auto try_send = [&] {
    return ::send(socket_, datagram.data(), datagram.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0;
  };
  // The kernel reports a missing receiver at the next send, which then sends nothing. So that send is repeated.
  if (try_send() || (errno == ECONNREFUSED && try_send()) || errno == ECONNREFUSED) return true;
  fault_ = errno;
  return false;
}

void UdpSender::warn() {
  if (std::exchange(warned_, true)) return;
  log::warning(fmt::format("{}: a datagram could not be sent: {}", what_, std::strerror(fault_)));
}

UdpReceiver::UdpReceiver(const UdpAddress& address, const std::string& what)
    : socket_(open_socket(address, what, "listen on", ::bind)) {
  if (!address.loopback) return;
  try {
    socket6_ = open_socket({"::1", address.port}, what, "listen on", ::bind, {EAFNOSUPPORT, EADDRNOTAVAIL});
  } catch (...) {
    ::close(socket_);
    throw;
  }
}

UdpReceiver::~UdpReceiver() {
  ::close(socket_);
  if (socket6_ >= 0) ::close(socket6_);
}

bool UdpReceiver::wait(double most_s) const {
  // The kernel leaves out a negative one.
  std::array<pollfd, 2> look{{{socket_, POLLIN, 0}, {socket6_, POLLIN, 0}}};
  return ::poll(look.data(), look.size(), static_cast<int>(std::ceil(std::clamp(most_s, 0.0, 1e6) * 1e3))) > 0;
}

std::optional<std::size_t> UdpReceiver::receive(std::span<char> into) const {
  for (const int socket : {socket_, socket6_}) {
    const ssize_t size = socket < 0 ? -1 : ::recv(socket, into.data(), into.size(), MSG_DONTWAIT);
    if (size >= 0) return static_cast<std::size_t>(size);
  }
  return std::nullopt;
}

}  // namespace palpa
