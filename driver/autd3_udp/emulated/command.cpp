#include "driver/autd3_udp/emulated/command.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "driver/autd3_udp/emulated/chain.hpp"
#include "driver/clock.hpp"
#include "driver/emulate/serve.hpp"
#include "driver/emulate/stop.hpp"

namespace palpa::driver::autd3_udp {
namespace {

constexpr std::uint16_t usual_port = 44336;
constexpr std::size_t most_units = 16;
constexpr double look_s = 20e-3;

/// What happens to one unit at a time.
struct Order {
  enum class What { mute, reboot, cut } what = What::mute;
  std::size_t unit = 0;
  double at_s = 0;
};

Error no_fault(const std::string& text) {
  return bad_usage(fmt::format(
      "--fault {}: give lose=SHARE, repeat=SHARE or delay=SHARE of the datagrams (1% or 0.01, at most half), or "
      "mute=UNIT@TIME, reboot=UNIT@TIME or cut=UNIT@TIME",
      printable(text, 60)));
}

/// Puts one fault into the setting, or returns the order.
std::optional<Order> read_fault(const std::string& text, ChainSetting& setting) {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos) throw no_fault(text);
  const std::string_view name = std::string_view(text).substr(0, sign);
  std::string_view value = std::string_view(text).substr(sign + 1);
  for (const auto& [word, share] : {std::pair("lose", &setting.lost), std::pair("repeat", &setting.repeated),
                                    std::pair("delay", &setting.delayed)}) {
    if (name != word) continue;
    const bool percent = !value.empty() && value.back() == '%';
    if (percent) value.remove_suffix(1);
    const std::optional<double> number = parse_number(value);
    if (!number) throw no_fault(text);
    *share = percent ? *number / 100 : *number;
    if (!(*share >= 0 && *share <= 0.5)) throw no_fault(text);
    return {};
  }
  for (const auto& [word, what] : {std::pair("mute", Order::What::mute), std::pair("reboot", Order::What::reboot),
                                   std::pair("cut", Order::What::cut)}) {
    if (name != word) continue;
    const std::size_t at = value.find('@');
    if (at == std::string_view::npos) throw no_fault(text);
    const auto unit = parse_whole<std::size_t>(value.substr(0, at));
    const auto time_s = parse_quantity(value.substr(at + 1), Quantity::time);
    if (!unit || *unit >= most_units || !time_s || *time_s < 0) throw no_fault(text);
    return Order{what, *unit, *time_s};
  }
  throw no_fault(text);
}

/// A UDP socket of ::1; port 0 takes any free port.
class Socket {
 public:
  explicit Socket(std::uint16_t port) : socket_(socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(port);
    address.sin6_addr = in6addr_loopback;
    socklen_t size = sizeof address;
    auto* where = reinterpret_cast<sockaddr*>(&address);
    if (!socket_ || bind(socket_.get(), where, size) != 0 || getsockname(socket_.get(), where, &size) != 0)
      throw failure(fmt::format("[::1]:{}: {}", port, std::strerror(errno)));
    port_ = ntohs(address.sin6_port);
  }
  int fd() const { return socket_.get(); }
  std::uint16_t port() const { return port_; }

 private:
  Descriptor socket_;
  std::uint16_t port_ = 0;
};

array::Layout layout_of(const std::string& name) {
  array::Layout layout = array::load_layout(name.empty() ? "autd3" : name);
  if (layout.boards.empty() || layout.boards.size() * EmulatedUnit::transducers != layout.transducers.size())
    throw bad_usage(fmt::format("the layout {} does not consist of AUTD3 units: give --layout one that does", name));
  if (layout.boards.size() > most_units) {
    throw bad_usage(
        fmt::format("the layout {} has {} units, and the emulator at most {}", name, layout.boards.size(), most_units));
  }
  return layout;
}

/// A pulse is centred, and as wide as the unit's table has it for the intensity.
array::Drive heard_drive(const EmulatedChain& chain, double now_s) {
  array::Drive drive;
  for (std::size_t u = 0; u < chain.size(); ++u) {
    for (const EmulatedUnit::Output& one : chain.unit(u).output(chain.moment(now_s))) {
      const double turns = one.phase / 256.0;
      const double phase = 2 * std::numbers::pi * (turns > 0.5 ? turns - 1 : turns);
      const double width = chain.unit(u).pulse_width(one.intensity);
      drive.push_back({static_cast<float>(std::sin(std::numbers::pi * width / 512)), static_cast<float>(phase)});
    }
  }
  return drive;
}

/// The sockets of a chain. A unit's changes with its id, as a unit's address does.
class Server {
 public:
  Server(EmulatedChain& chain, std::uint16_t port) : chain_(chain), group_(port) {
    for (std::size_t u = 0; u < chain_.size(); ++u)
      units_.push_back({Socket(0), chain_.id(u)});
  }
  std::uint16_t port() const { return group_.port(); }

  void serve(const std::atomic<bool>& stop, std::mutex& lock, const emulate::Emulator::Took& took,
             std::vector<Order> orders, double begin_s) {
    std::vector<pollfd> waits;
    while (!stop) {
      double until_s = look_s;
      {
        const std::lock_guard held(lock);
        const double now_s = clock_.now_s();
        std::erase_if(orders, [&](const Order& order) { return carry_out(order, now_s, begin_s); });
        chain_.advance(now_s);
        send_answers();
        until_s = std::clamp(chain_.next_s() - clock_.now_s(), 0.0, look_s);
      }
      waits.assign(1, {group_.fd(), POLLIN, 0});
      for (const Unit& unit : units_)
        waits.push_back({unit.socket.fd(), POLLIN, 0});
      const timespec wait{0, static_cast<long>(1e9 * until_s)};
      if (ppoll(waits.data(), waits.size(), &wait, nullptr) <= 0) {
        took({});
        continue;
      }
      for (std::size_t w = 0; w < waits.size(); ++w) {
        if (waits[w].revents != 0) receive(waits[w].fd, w, lock, took);
      }
    }
  }

 private:
  struct Unit {
    Socket socket;
    std::uint8_t id;
  };

  bool carry_out(const Order& order, double now_s, double begin_s) {
    if (now_s - begin_s < order.at_s) return false;
    if (order.unit >= chain_.size()) return true;
    if (order.what == Order::What::mute) chain_.mute(order.unit, true);
    if (order.what == Order::What::reboot) chain_.reboot(now_s, order.unit);
    if (order.what == Order::What::cut) chain_.cut(order.unit, true);
    return true;
  }

  /// `which`: 0 is the group's socket.
  void receive(int fd, std::size_t which, std::mutex& lock, const emulate::Emulator::Took& took) {
    std::array<std::uint8_t, 2048> bytes{};
    for (;;) {
      sockaddr_in6 from{};
      socklen_t size = sizeof from;
      const ssize_t length = recvfrom(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (length < 0) return;
      const std::span<const std::uint8_t> datagram(bytes.data(), static_cast<std::size_t>(length));
      host_ = from;
      took(datagram);
      const std::lock_guard held(lock);
      if (which == 0) {
        chain_.take_from_group(clock_.now_s(), datagram);
      } else {
        chain_.take(clock_.now_s(), which - 1, datagram);
      }
    }
  }

  /// Answers leave from the address that the unit had; then its socket follows its id.
  void send_answers() {
    for (const EmulatedChain::Answer& answer : chain_.answers()) {
      Unit& unit = units_[answer.unit];
      follow(unit, answer.id);
      sendto(unit.socket.fd(), answer.bytes.data(), answer.bytes.size(), 0, reinterpret_cast<const sockaddr*>(&host_),
             sizeof host_);
    }
    for (std::size_t u = 0; u < units_.size(); ++u)
      follow(units_[u], chain_.id(u));
  }

  static void follow(Unit& unit, std::uint8_t id) {
    if (unit.id != id) unit = {Socket(0), id};
  }

  EmulatedChain& chain_;
  Socket group_;
  std::vector<Unit> units_;
  sockaddr_in6 host_{};  ///< who spoke last
  Clock& clock_ = steady_clock();
};

}  // namespace

void check_fault(const std::string& text) {
  ChainSetting unused;
  read_fault(text, unused);
}

void emulate(const emulate::Options& options, const Outputs& outputs) {
  const array::Layout layout = layout_of(options.layout);
  const std::uint64_t protocol = options.protocol.value_or(5);
  if (protocol != 2 && protocol != 3 && protocol != 5) {
    throw bad_usage(
        fmt::format("no release speaks protocol {}: give --protocol 2 (0.10, 0.11), 3 (0.12) or 5 (0.13)", protocol));
  }
  ChainSetting setting{.protocol = static_cast<std::uint8_t>(protocol), .units = layout.boards.size()};
  setting.processing_s = options.processing_s.value_or(setting.processing_s);
  setting.seed = options.common.seed;
  std::vector<Order> orders;
  for (const std::string& fault : options.faults) {
    const auto order = read_fault(fault, setting);
    if (order && order->unit >= setting.units)
      throw bad_usage(fmt::format("--fault {}: there are {}, from 0", fault, counted(setting.units, "unit")));
    if (order) orders.push_back(*order);
  }
  const double begin_s = steady_clock().now_s();
  const emulate::Stop ends;  // until everything is printed
  EmulatedChain chain(setting);
  Server server(chain, static_cast<std::uint16_t>(options.port.value_or(usual_port)));
  const auto now_s = [] { return steady_clock().now_s(); };
  const auto violations = emulate::serve(
      options, {.address = fmt::format("[::1]:{}", server.port()),
                .wire = "udp",
                .layout = layout,
                .begin_s = begin_s,
                .now_s = now_s,
                .heard = [&] { return heard_drive(chain, now_s()); },
                .violations = [&] { return chain.violations(); },
                .serve = [&](const auto& stop, auto& lock,
                             const auto& took) { server.serve(stop, lock, took, std::move(orders), begin_s); }});
  const bool sounds = !chain.silent(now_s());
  emulate::conclude(options, outputs,
                    {fmt::format("{}, {}, {}", counted(chain.size(), "unit"), counted(chain.frames(), "frame"),
                                 sounds ? "sounding" : "silent"),
                     "frames", chain.frames(), sounds, violations, chain.violation_count()});
}

}  // namespace palpa::driver::autd3_udp
