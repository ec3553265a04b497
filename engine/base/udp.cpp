#include "base/udp.hpp"

#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa {
namespace {

/// A socket that is connected or bound to an address, as `attach` does: ::connect or ::bind.
int open_socket(const UdpAddress& address, const std::string& what, const char* doing,
                int (*attach)(int, const sockaddr*, socklen_t)) {
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
  if (attached < 0) {
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
  return parse_udp_address(text.find(':') == std::string::npos ? "127.0.0.1:" + text : text, form);
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
    : socket_(open_socket(address, what, "listen on", ::bind)) {}

UdpReceiver::~UdpReceiver() {
  ::close(socket_);
}

bool UdpReceiver::wait(double most_s) const {
  pollfd look{.fd = socket_, .events = POLLIN, .revents = 0};
  return ::poll(&look, 1, static_cast<int>(std::ceil(std::clamp(most_s, 0.0, 1e6) * 1e3))) > 0;
}

std::optional<std::size_t> UdpReceiver::receive(std::span<char> into) const {
  const ssize_t size = ::recv(socket_, into.data(), into.size(), MSG_DONTWAIT);
  return size < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(size));
}

}  // namespace palpa
