#include "base/system/udp.hpp"

#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa {
namespace {

constexpr std::size_t most_sockets = 8;

/// A socket for each of the name's addresses, connected or bound to it, as `attach` does: ::connect or ::bind. Those
/// that this machine cannot reach or does not have are left out. If none is left, that is a fault, unless `optional`.
std::vector<Descriptor> open_sockets(const NetAddress& address, const std::string& what, const char* doing,
                                     int (*attach)(int, const sockaddr*, socklen_t), bool optional = false) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* list = nullptr;
  if (const int fault = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list))
    throw failure(fmt::format("{}: {}:{} does not resolve: {}", what, address.host, address.port, gai_strerror(fault)));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(list, freeaddrinfo);
  std::vector<Descriptor> sockets;
  int last_fault = 0;
  for (const addrinfo* at = list; at != nullptr && sockets.size() < most_sockets; at = at->ai_next) {
    const auto same = [at](const addrinfo* other) {
      return other->ai_addrlen == at->ai_addrlen && std::memcmp(other->ai_addr, at->ai_addr, at->ai_addrlen) == 0;
    };
    const addrinfo* first = list;
    while (!same(first))
      first = first->ai_next;
    if (first != at) continue;  // a name may have an address twice
    Descriptor candidate(::socket(at->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (candidate && attach(candidate.get(), at->ai_addr, at->ai_addrlen) == 0) {
      sockets.push_back(std::move(candidate));
    } else {
      last_fault = errno;
      if (last_fault == EADDRINUSE) break;  // another program would get a part of what comes
    }
  }
  if (last_fault == EADDRINUSE || (sockets.empty() && !optional)) {
    throw failure(
        fmt::format("{}: cannot {} {}:{}: {}", what, doing, address.host, address.port, std::strerror(last_fault)));
  }
  return sockets;
}

}  // namespace

NetAddress parse_address(const std::string& text, const std::string& form) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) throw bad_usage(form);
  std::string host = text.substr(0, colon), port = text.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  const bool digits = !port.empty() && port.find_first_not_of("0123456789") == std::string::npos;
  if (host.empty() || !digits) throw bad_usage(form);
  int number = 0;
  const auto [end, fault] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (fault != std::errc() || number < 1 || number > 65535)
    throw bad_usage(fmt::format("{}; a port is from 1 to 65535, not {}", form, port.substr(0, 20)));
  return {std::move(host), std::move(port)};
}

NetAddress parse_listening_address(const std::string& text, const std::string& form) {
  if (text.find(':') != std::string::npos) return parse_address(text, form);
  NetAddress address = parse_address("127.0.0.1:" + text, form);
  address.loopback = true;
  return address;
}

UdpSender::UdpSender(const std::string& address, const std::string& what, const std::string& form)
    : what_(what),
      address_(address),
      sockets_(open_sockets(parse_address(address, form), what, "send to", ::connect)) {}

UdpSender::Sent UdpSender::send(std::string_view datagram) {
  for (std::size_t tried = 0; tried < sockets_.size(); ++tried) {
    const int socket = sockets_[place_].get();
    const auto try_send = [&] {
      return ::send(socket, datagram.data(), datagram.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0;
    };
    const auto refusal = [&] {
      int fault = 0;
      socklen_t size = sizeof fault;
      getsockopt(socket, SOL_SOCKET, SO_ERROR, &fault, &size);
      return fault == ECONNREFUSED;
    };
    bool refuses = refusal();  // an earlier datagram
    bool sent = try_send();
    if (!sent && errno == ECONNREFUSED) {  // the same, just now; the kernel has sent nothing
      refuses = true;
      sent = try_send();
    }
    if (!sent) {
      fault_ = errno;
      return Sent::no;
    }
    refuses = refusal() || refuses;
    if (!refuses) return Sent::yes;
    place_ = (place_ + 1) % sockets_.size();
  }
  refused_ = true;
  return Sent::refused;
}

void UdpSender::warn() {
  if (fault_ != 0 && !std::exchange(told_fault_, true))
    log::warning(fmt::format("{}: a datagram could not be sent: {}", what_, std::strerror(fault_)));
  if (refused_ && !std::exchange(told_refusal_, true))
    log::warning(fmt::format("{}: nobody listens at {}: see whether the receiver runs there", what_, address_));
}

UdpReceiver::UdpReceiver(const NetAddress& address, const std::string& what)
    : sockets_(open_sockets(address, what, "listen on", ::bind)) {
  if (!address.loopback) return;
  for (Descriptor& socket : open_sockets({"::1", address.port}, what, "listen on", ::bind, true))
    sockets_.push_back(std::move(socket));
}

bool UdpReceiver::wait(double most_s) const {
  std::array<pollfd, 2 * most_sockets> look{};
  for (std::size_t i = 0; i < sockets_.size(); ++i)
    look[i] = {sockets_[i].get(), POLLIN, 0};
  return ::poll(look.data(), sockets_.size(), static_cast<int>(std::ceil(std::clamp(most_s, 0.0, 1e6) * 1e3))) > 0;
}

std::optional<std::size_t> UdpReceiver::receive(std::span<char> into) const {
  for (const Descriptor& socket : sockets_) {
    const ssize_t size = ::recv(socket.get(), into.data(), into.size(), MSG_DONTWAIT);
    if (size >= 0) return static_cast<std::size_t>(size);
  }
  return std::nullopt;
}

}  // namespace palpa
