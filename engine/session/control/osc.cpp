#include "session/control/osc.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <string_view>
#include <vector>

#include "base/log.hpp"
#include "base/system/start_thread.hpp"
#include "base/text.hpp"
#include "geometry/haptics.hpp"
#include "session/control/osc_message.hpp"
#include "session/threads.hpp"

namespace palpa::session {
namespace {

using Numbers = std::span<const double>;

bool within(double number, double low, double high) {
  return number >= low && number <= high;  // NaN is not
}

/// A shift x y z, then maybe a unit quaternion x y z w, which turns about the world's origin before the shift.
std::optional<Transform> pose_of(Numbers n) {
  constexpr double farthest_m = 1000;
  if (n.size() != 3 && n.size() != 7) return std::nullopt;
  if (!std::ranges::all_of(n.first(3), [](double m) { return within(m, -farthest_m, farthest_m); }))
    return std::nullopt;
  Transform pose(1.0);
  if (n.size() == 7) {
    const glm::dquat turn(n[6], n[3], n[4], n[5]);
    if (!within(glm::length(turn), 0.99, 1.01)) return std::nullopt;
    pose = glm::mat4_cast(glm::normalize(turn));
  }
  pose[3] = Vec4(n[0], n[1], n[2], 1);
  return pose;
}

/// A message for the whole session. `set` returns false for arguments that it cannot have.
struct SessionAddress {
  std::string_view address, wants;
  bool (*set)(Numbers, LiveValues&);
};
constexpr SessionAddress session_addresses[] = {
    {"/palpa/gain", "a number from 0 to 1",
     [](Numbers n, LiveValues& values) {
       if (n.size() != 1 || !within(n[0], 0, 1)) return false;
       values.set_gain(n[0]);
       return true;
     }},
    {"/palpa/mute", "1 or 0",
     [](Numbers n, LiveValues& values) {
       if (n.size() != 1 || (n[0] != 0 && n[0] != 1)) return false;
       values.mute(n[0] == 1);
       return true;
     }},
};

std::optional<geometry::Click> click_of(Numbers n) {
  if (n.size() == 1 && n[0] == 0) return geometry::Click{.burst_s = 0};
  if (n.size() == 1 && n[0] == 1) return geometry::Click();
  return geometry::click_of(n);
}

/// Depths and forces by turns.
std::optional<Stiffness> stiffness_of(Numbers n) {
  if (n.empty() || n.size() % 2 != 0 || n.size() > 2 * geometry::most_stiffness_rows) return std::nullopt;
  Stiffness table;
  for (std::size_t i = 0; i < n.size(); i += 2) {
    const geometry::DepthForce row{n[i], n[i + 1]};
    if (!geometry::row_fault(table, row).empty()) return std::nullopt;
    table.push_back(row);
  }
  return table;
}

std::optional<array::Texture> texture_of(Numbers n) {
  const auto weights = geometry::texture_of(n);
  return weights ? std::optional(array::Texture{(*weights)[0], (*weights)[1], (*weights)[2]}) : std::nullopt;
}

/// The value alone, where there is one.
template <typename Value>
std::optional<SolidValues> alone(std::optional<Value> SolidValues::*which, const std::optional<Value>& value) {
  SolidValues values;
  values.*which = value;
  return value ? std::optional(values) : std::nullopt;
}
template <typename Value>
std::optional<SolidValues> alone(std::optional<Value> FeelChange::*which, const std::optional<Value>& value) {
  SolidValues values;
  values.feel.*which = value;
  return value ? std::optional(values) : std::nullopt;
}

/// A message for one solid, whose name follows the address. `read` returns nullopt for arguments that it cannot have.
struct SolidAddress {
  std::string_view address, wants;
  std::optional<SolidValues> (*read)(Numbers);
};
constexpr SolidAddress solid_addresses[] = {
    {"/palpa/pose/", "x y z in metres, at most 1000, or these and a unit quaternion x y z w",
     [](Numbers n) { return alone(&SolidValues::T_world_rest, pose_of(n)); }},
    {"/palpa/click/", "1 or 0, or the burst's length and frequency, 0.03 to 0.06 s and 150 to 200 Hz",
     [](Numbers n) { return alone(&FeelChange::click, click_of(n)); }},
    {"/palpa/stiffness/", "1 to 32 pairs, a depth in metres, which ascends, and the force there, 0 to 1",
     [](Numbers n) { return alone(&FeelChange::stiffness, stiffness_of(n)); }},
    {"/palpa/texture/", "the weights of steady, 30 Hz and 150 Hz, each from 0 to 1 and not all 0",
     [](Numbers n) { return alone(&FeelChange::texture, texture_of(n)); }},
};

std::string known_addresses() {
  std::string known;
  for (const SessionAddress& of : session_addresses)
    known += fmt::format("{}, ", of.address);
  for (const SolidAddress& of : solid_addresses)
    known += fmt::format("{}NAME, ", of.address);
  known.resize(known.size() - 2);
  return known;
}

/// Big-endian, as in OSC.
std::uint32_t number_at(std::span<const char> bytes) {
  std::uint32_t number = 0;
  for (int i = 0; i < 4; ++i)
    number = number << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  return number;
}

}  // namespace

NetAddress parse_osc_address(const std::string& text) {
  return parse_listening_address(text, "--osc takes PORT or ADDRESS:PORT, for example 9000 or 0.0.0.0:9000");
}

Osc::Osc(const std::string& address)
    : name_("--osc " + address), socket_((check_osc(), parse_osc_address(address)), name_) {}

Osc::~Osc() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
}

void Osc::listen(const Session& session, RunObserver& observer) {
  values_.set_scene(session);
  observer_ = &observer;
  listen();
}

void Osc::listen() {
  thread_ = start_thread("--osc", [this] { work(); });
}

MessageStats Osc::end() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  if (stats_.refused > 1)
    log::warning(
        fmt::format("{}: {} of {} messages were refused", name_, stats_.refused, stats_.taken + stats_.refused));
  return stats_;
}

/// If messages come faster than they are taken, the system drops the newest ones.
void Osc::work() {
  constexpr int most_at_once = 64;
  constexpr double look_s = 0.05;
  take_no_signals();
  take_turns();
  std::vector<char> datagram(1 << 16);
  while (!ends_) {
    if (!socket_.wait(look_s)) continue;
    for (int i = 0; i < most_at_once && !ends_; ++i) {
      const std::optional<std::size_t> size = socket_.receive(datagram);
      if (!size) break;
      take(std::span(datagram).first(*size));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// A message, or a bundle of packets, whose time is ignored.
void Osc::take(std::span<char> packet, int depth) {
  constexpr std::string_view bundle("#bundle\0", 8);
  constexpr std::size_t head = 16;
  constexpr int deepest = 8;
  if (!std::string_view(packet.data(), packet.size()).starts_with(bundle)) return take_message(packet);
  if (packet.size() < head || depth == deepest) return refuse("a bundle is cut, or holds too many others");
  packet = packet.subspan(head);
  while (!packet.empty()) {
    const std::size_t size = packet.size() < 4 ? 0 : number_at(packet);
    if (size == 0 || size > packet.size() - 4) return refuse("a bundle is cut");
    take(packet.subspan(4, size), depth + 1);
    packet = packet.subspan(4 + size);
  }
}

void Osc::take_message(std::span<char> bytes) {
  const std::optional<OscMessage> message = read_osc_message(bytes);
  if (!message) return refuse("a datagram is no OSC message");
  const std::string_view address = message->address;
  const auto answer = [&](bool taken, std::string_view wants) {
    if (!taken) return refuse(fmt::format("{}: give {}", printable(address, 80), wants));
    ++stats_.taken;
  };
  for (const SessionAddress& of : session_addresses) {
    if (address == of.address) return answer(of.set(message->values(), values_), of.wants);
  }
  for (const SolidAddress& of : solid_addresses) {
    if (!address.starts_with(of.address)) continue;
    const std::optional<SolidValues> values = of.read(message->values());
    const std::string_view fault = values ? values_.change(address.substr(of.address.size()), *values) : "";
    if (!fault.empty()) return refuse(fmt::format("{}: {}", printable(address, 80), fault));
    return answer(values.has_value(), of.wants);
  }
  refuse(fmt::format("{}: is unknown; known: {}", printable(address, 80), known_addresses()));
}

void Osc::refuse(const std::string& why) {
  ++stats_.refused;
  if (!reasons_.writes(why)) return;
  log::warning(fmt::format("{}: a message is refused: {}; further ones like it are only counted", name_, why));
}

}  // namespace palpa::session
