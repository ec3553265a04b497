#include "driver/autd3_udp/cable.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "base/error.hpp"
#include "driver/autd3_udp/wire.hpp"

namespace palpa::driver::autd3_udp {
namespace {

constexpr const char* form =
    "link autd3-udp: '{}' is neither a network interface of this computer nor [ADDRESS%SCOPE]:PORT";

sockaddr_in6 to_system(const Endpoint& endpoint) {
  sockaddr_in6 out{};
  out.sin6_family = AF_INET6;
  out.sin6_port = htons(endpoint.port);
  out.sin6_scope_id = endpoint.scope;
  std::copy(endpoint.address.begin(), endpoint.address.end(), out.sin6_addr.s6_addr);
  return out;
}

Endpoint from_system(const sockaddr_in6& from) {
  Endpoint out;
  std::copy(std::begin(from.sin6_addr.s6_addr), std::end(from.sin6_addr.s6_addr), out.address.begin());
  out.scope = from.sin6_scope_id;
  out.port = ntohs(from.sin6_port);
  return out;
}

}  // namespace

std::string to_text(const Endpoint& endpoint) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  inet_ntop(AF_INET6, endpoint.address.data(), text.data(), text.size());
  std::array<char, IF_NAMESIZE> nic{};
  if (endpoint.scope != 0 && if_indextoname(endpoint.scope, nic.data()) != nullptr)
    return fmt::format("[{}%{}]:{}", text.data(), nic.data(), endpoint.port);
  return fmt::format("[{}]:{}", text.data(), endpoint.port);
}

bool Cable::may_come_from(const Endpoint& from) const {
  const Endpoint to = group();
  if (to.is_multicast()) return from.is_link_local() && from.scope == to.scope;
  return from.address == to.address;
}

Endpoint group_of(std::uint32_t nic) {
  Endpoint out{.scope = nic, .port = unit_port};
  out.address[0] = 0xff;
  out.address[1] = 0x02;
  out.address[15] = 0x01;
  return out;
}

Endpoint parse_group(const std::string& argument) {
  const auto refusal = [&] { return bad_usage(fmt::format(form, argument)); };
  if (argument.empty()) throw refusal();
  if (argument.front() != '[') {
    const std::uint32_t index = if_nametoindex(argument.c_str());
    if (index == 0) throw refusal();
    return group_of(index);
  }
  const std::size_t end = argument.find("]:");
  if (end == std::string::npos) throw refusal();
  std::string address = argument.substr(1, end - 1), scope;
  if (const std::size_t percent = address.find('%'); percent != std::string::npos) {
    scope = address.substr(percent + 1);
    address.resize(percent);
  }
  Endpoint out;
  if (inet_pton(AF_INET6, address.c_str(), out.address.data()) != 1) throw refusal();
  if (!scope.empty()) {
    out.scope = if_nametoindex(scope.c_str());
    if (out.scope == 0) throw refusal();
  }
  const std::string port = argument.substr(end + 2);
  const auto [last, fault] = std::from_chars(port.data(), port.data() + port.size(), out.port);
  if (fault != std::errc() || last != port.data() + port.size() || out.port == 0) throw refusal();
  if (out.scope == 0 && (out.is_multicast() || out.is_link_local()))
    throw bad_usage(
        fmt::format("link autd3-udp: {} needs its network interface: [{}%INTERFACE]:{}", argument, address, port));
  // The scope of a loopback is told to be none in what comes from it.
  if (!out.is_multicast() && !out.is_link_local()) out.scope = 0;
  return out;
}

UdpCable::UdpCable(const Endpoint& group)
    : group_(group), socket_(socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  const auto fault = [&](const char* what) {
    return failure(fmt::format("{}: {}: {}", to_text(group_), what, std::strerror(errno)));
  };
  if (!socket_) throw fault("no socket for IPv6");
  const auto set = [&](int option, const void* value, socklen_t size) {
    if (setsockopt(socket_.get(), IPPROTO_IPV6, option, value, size) != 0) throw fault("cannot be reached");
  };
  const int only = 1;
  set(IPV6_V6ONLY, &only, sizeof only);
  if (group_.is_multicast()) {
    const int hops = 1, own = 0;
    set(IPV6_MULTICAST_IF, &group_.scope, sizeof group_.scope);
    set(IPV6_MULTICAST_HOPS, &hops, sizeof hops);
    set(IPV6_MULTICAST_LOOP, &own, sizeof own);
  }
  const int room = 1 << 20;  // answers of many units while the guard gets no processor
  setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  setsockopt(socket_.get(), SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
  sockaddr_in6 any{};
  any.sin6_family = AF_INET6;
  if (bind(socket_.get(), reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0) throw fault("no port");
}

void UdpCable::send(const Endpoint& to, std::span<const std::uint8_t> datagram) {
  const sockaddr_in6 where = to_system(to);
  // An error of an earlier datagram, such as a port that nobody has, comes with the next call and means nothing then.
  for (int tries = 0; tries < 2; ++tries) {
    if (sendto(socket_.get(), datagram.data(), datagram.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&where),
               sizeof where) >= 0)
      return;
  }
}

std::optional<std::size_t> UdpCable::receive(std::span<std::uint8_t> into, Endpoint& from) {
  sockaddr_in6 where{};
  for (int tries = 0; tries < 4; ++tries) {
    socklen_t size = sizeof where;
    const ssize_t bytes =
        recvfrom(socket_.get(), into.data(), into.size(), 0, reinterpret_cast<sockaddr*>(&where), &size);
    if (bytes >= 0) {
      from = from_system(where);
      return static_cast<std::size_t>(bytes);
    }
    if (errno == EAGAIN) break;
  }
  return std::nullopt;
}

std::vector<Nic> nics() {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return {};
  std::vector<Nic> out;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if ((one->ifa_flags & IFF_LOOPBACK) != 0) continue;
    auto nic = std::ranges::find(out, one->ifa_name, &Nic::name);
    if (nic == out.end()) nic = out.insert(nic, Nic{one->ifa_name, if_nametoindex(one->ifa_name), false, false});
    nic->up = (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_RUNNING) != 0;
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET6) continue;
    sockaddr_in6 address{};
    std::memcpy(&address, one->ifa_addr, sizeof address);
    nic->ipv6 = nic->ipv6 || from_system(address).is_link_local();
  }
  freeifaddrs(all);
  std::ranges::sort(out, {}, &Nic::name);
  return out;
}

}  // namespace palpa::driver::autd3_udp
