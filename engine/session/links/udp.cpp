#include "session/links/udp.hpp"

#include <fmt/core.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::session {
namespace {

int connect_udp(const std::string& what, const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int fault = getaddrinfo(host.c_str(), port.c_str(), &hints, &found)) {
    throw failure(fmt::format("{}: {}:{} does not resolve: {}", what, host, port, gai_strerror(fault)));
  }
  int connected = -1, last_fault = 0;
  for (const addrinfo* address = found; address && connected < 0; address = address->ai_next) {
    const int candidate = ::socket(address->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (candidate >= 0 && ::connect(candidate, address->ai_addr, address->ai_addrlen) == 0) {
      connected = candidate;
    } else {
      last_fault = errno;
      if (candidate >= 0) ::close(candidate);
    }
  }
  freeaddrinfo(found);
  if (connected < 0)
    throw failure(fmt::format("{}: cannot send to {}:{}: {}", what, host, port, std::strerror(last_fault)));
  return connected;
}

int open_socket(const std::string& address, const std::string& what, const std::string& form) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) throw bad_usage(form);
  std::string host = address.substr(0, colon);
  const std::string port = address.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  const bool digits = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty() || !digits || std::stoi(port) < 1 || std::stoi(port) > 65535) throw bad_usage(form);
  return connect_udp(what, host, port);
}

}  // namespace

UdpSender::UdpSender(const std::string& address, const std::string& what, const std::string& form)
    : what_(what), socket_(open_socket(address, what, form)) {}

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

}  // namespace palpa::session
