#include "driver/autd3/emulated/listener.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "driver/autd3/pattern.hpp"

namespace palpa::driver::autd3 {
namespace {

constexpr int look_ms = 20;

bool readable(int fd) {
  pollfd one{fd, POLLIN, 0};
  return poll(&one, 1, look_ms) > 0;
}

bool send_all(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t size = send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (size < 0 && errno != EINTR) return false;
    if (size > 0) bytes = bytes.subspan(static_cast<std::size_t>(size));
  }
  return true;
}

}  // namespace

double device_time_s() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<double>(now.tv_sec) - epoch_s + 1e-9 * static_cast<double>(now.tv_nsec);
}

Listener::Listener(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (!socket_) throw failure(fmt::format("127.0.0.1:{}: {}", port, std::strerror(errno)));
  const int yes = 1;
  setsockopt(socket_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  socklen_t size = sizeof address;
  auto* where = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket_.get(), where, size) != 0 || ::listen(socket_.get(), 1) != 0 ||
      getsockname(socket_.get(), where, &size) != 0)
    throw failure(fmt::format("127.0.0.1:{}: {}", port, std::strerror(errno)));
  port_ = ntohs(address.sin_port);
}

void Listener::serve(EmulatedServer& server, const std::atomic<bool>& stop, std::mutex& lock,
                     const std::function<void(std::span<const std::uint8_t>)>& heard) {
  std::array<std::uint8_t, 65536> bytes{};
  std::vector<std::uint8_t> answer;
  while (!stop) {
    if (!readable(socket_.get())) {
      if (heard) heard({});
      continue;
    }
    const Descriptor client(accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!client) continue;
    const int yes = 1;
    setsockopt(client.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    {
      const std::lock_guard held(lock);
      server.client_came();
    }
    for (bool goes_on = true; goes_on && !stop;) {
      if (!readable(client.get())) {
        if (heard) heard({});
        continue;
      }
      const ssize_t size = recv(client.get(), bytes.data(), bytes.size(), 0);
      if (size <= 0) break;
      const std::span<const std::uint8_t> came(bytes.data(), static_cast<std::size_t>(size));
      if (heard) heard(came);
      answer.clear();
      {
        const std::lock_guard held(lock);
        goes_on = server.take(device_time_s(), came, answer);
      }
      if (!send_all(client.get(), answer)) break;
    }
    const std::lock_guard held(lock);
    if (!stop) server.client_left(device_time_s());
  }
}

}  // namespace palpa::driver::autd3
