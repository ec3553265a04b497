#include "driver/autd3_udp/emulated/chain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpa::driver::autd3_udp {
namespace {

constexpr std::uint8_t frame = 0x00, unit_info = 0x01, reset_id = 0x02, discover = 0x03, assign = 0x04,
                       open_far_port = 0x05, set_time = 0x06, heartbeat = 0x07;
constexpr std::uint8_t fine = 0x00, wrong_protocol = 0x01, has_no_id = 0x02, bad_body = 0x03, not_the_first = 0x04;
constexpr std::size_t head_size = 4, most_bytes = 1448, most_waiting = 7;
constexpr double bit_s = 1e-8, id_stays_s = 20e-3, spin_s = 1e-6;
constexpr std::size_t overhead_bytes = 86;  // Ethernet, IPv6 and UDP

void put(std::vector<std::uint8_t>& out, std::uint64_t value, int bytes) {
  for (int byte = 0; byte < bytes; ++byte)
    out.push_back(static_cast<std::uint8_t>(value >> (8 * byte)));
}

/// How long a cable is taken by a datagram.
double length_s(std::size_t bytes) {
  return bit_s * 8 * static_cast<double>(bytes + overhead_bytes);
}

}  // namespace

EmulatedChain::EmulatedChain(const ChainSetting& setting)
    : setting_(setting), nodes_(setting.units, Node(setting.protocol)), random_(setting.seed) {
  time_then_ns_ = 1'000'000'000 + random_() % 1'000'000'000'000;  // some time since they were switched on
}

double EmulatedChain::chance() {
  return static_cast<double>(random_() >> 11) * 0x1p-53;
}

void EmulatedChain::add(Event event) {
  event.order = order_++;
  events_.push(std::move(event));
}

std::uint64_t EmulatedChain::unit_ns(double now_s) const {
  return time_then_ns_ +
         static_cast<std::uint64_t>(std::max(0.0, (now_s - time_set_s_) * (1 + 1e-6 * setting_.clock_ppm)) * 1e9);
}

/// When the units' clock shows that time of 32 bits, which is less than 2^31 us from now.
double EmulatedChain::when_s(double now_s, std::uint32_t at_us) const {
  const std::uint64_t ns = unit_ns(now_s);
  const auto ahead_us = static_cast<std::int32_t>(at_us - static_cast<std::uint32_t>(ns / 1000));
  const double ahead_s = 1e-6 * ahead_us - 1e-9 * static_cast<double>(ns % 1000);
  return now_s + ahead_s / (1 + 1e-6 * setting_.clock_ppm);
}

bool EmulatedChain::reached(std::size_t unit) const {
  for (std::size_t u = 0; u <= unit; ++u) {
    if (nodes_[u].cut || (u < unit && !nodes_[u].far_port)) return false;
  }
  return true;
}

std::vector<double> EmulatedChain::with_faults(double due_s) {
  if (setting_.lost + setting_.repeated + setting_.delayed <= 0) return {due_s};
  const double drawn = chance();
  if (drawn < setting_.lost) return {};
  if (drawn < setting_.lost + setting_.repeated) return {due_s, due_s + 1e-4};
  if (drawn < setting_.lost + setting_.repeated + setting_.delayed) return {due_s + setting_.delay_s};
  return {due_s};
}

void EmulatedChain::send_down(double now_s, std::size_t unit, std::span<const std::uint8_t> datagram, bool by_group) {
  // Everything passes the host's cable, so only that one makes it wait. Each unit on the way takes all of it first.
  const double each_s = length_s(datagram.size());
  down_free_s_ = std::max(now_s, down_free_s_) + each_s;
  for (const double at_s : with_faults(down_free_s_ + static_cast<double>(unit) * each_s)) {
    add({.what = Event::What::arrives,
         .at_s = at_s,
         .order = 0,
         .unit = unit,
         .by_group = by_group,
         .bytes = {datagram.begin(), datagram.end()}});
  }
}

void EmulatedChain::send_up(double now_s, std::size_t unit, std::vector<std::uint8_t> bytes) {
  if (nodes_[unit].muted || !reached(unit)) return;
  const std::uint8_t id = nodes_[unit].id;
  for (const double at_s : with_faults(now_s + static_cast<double>(unit) * length_s(bytes.size())))
    add({.what = Event::What::returns, .at_s = at_s, .order = 0, .unit = unit, .id = id, .bytes = bytes});
}

void EmulatedChain::take_from_group(double now_s, std::span<const std::uint8_t> datagram) {
  advance(now_s);
  for (std::size_t unit = 0; unit < nodes_.size() && reached(unit); ++unit)
    send_down(now_s, unit, datagram, true);
}

void EmulatedChain::take(double now_s, std::size_t unit, std::span<const std::uint8_t> datagram) {
  advance(now_s);
  if (reached(unit)) send_down(now_s, unit, datagram, false);
}

void EmulatedChain::advance(double now_s) {
  while (!events_.empty() && events_.top().at_s <= now_s) {
    const Event event = events_.top();
    events_.pop();
    switch (event.what) {
      case Event::What::arrives:
        arrive(event);
        break;
      case Event::What::finishes:
        finish(event);
        break;
      case Event::What::returns: {
        Event answers = event;
        answers.what = Event::What::answers;
        answers.at_s = up_free_s_ = std::max(event.at_s, up_free_s_) + length_s(event.bytes.size());
        add(std::move(answers));
        break;
      }
      case Event::What::answers:
        answers_.push_back({event.unit, event.id, event.at_s, event.bytes});
        break;
      case Event::What::drops_id:
        nodes_[event.unit].id = no_id;
        nodes_[event.unit].far_port = false;
        if (event.unit == 0) time_known_ = false;
        break;
    }
  }
}

std::vector<EmulatedChain::Answer> EmulatedChain::answers() {
  return std::exchange(answers_, {});
}

void EmulatedChain::reboot(double now_s, std::size_t unit) {
  advance(now_s);
  Node& node = nodes_[unit];
  const std::uint64_t begun = node.begun + 1;
  const Node fresh(setting_.protocol);
  node.firmware = fresh.firmware;
  node.id = no_id;
  node.far_port = false;
  node.queue.clear();
  node.begun = begun;
  if (unit == 0) time_known_ = false;
}

bool EmulatedChain::locked(double now_s, std::size_t unit) const {
  return time_known_ && now_s - time_set_s_ >= setting_.lock_s && nodes_[unit].id != no_id;
}

std::uint8_t EmulatedChain::flags(double now_s, std::size_t unit) const {
  const Node& node = nodes_[unit];
  unsigned bits = 0;
  if (node.id != no_id) bits |= 0x01;
  if (node.far_port) bits |= 0x02;
  if (node.far_port && unit + 1 < nodes_.size() && !nodes_[unit + 1].cut) bits |= 0x04;
  if (locked(now_s, unit)) bits |= 0x18;
  if (node.id == 0) bits |= 0x20;
  if (setting_.protocol == 5 && node.firmware.failsafe_shut(now_s)) bits |= 0x40;
  return static_cast<std::uint8_t>(bits);
}

std::vector<std::uint8_t> EmulatedChain::info(double now_s, std::size_t unit) const {
  std::vector<std::uint8_t> body;
  put(body, fine, 1);
  put(body, nodes_[unit].id, 1);
  put(body, flags(now_s, unit), 1);
  if (setting_.protocol != 5) {
    put(body, 0, 3);  // the port towards the host, a zero, the first number of the version
    put(body, setting_.protocol == 2 ? 11 : 12, 3);
    put(body, unit_ns(now_s), 8);
  }
  put(body, 0, 4);  // its clock is not off from the first unit's
  return body;
}

void EmulatedChain::answer(double now_s, std::size_t unit, std::span<const std::uint8_t> head,
                           std::vector<std::uint8_t> body) {
  std::vector<std::uint8_t> bytes{setting_.protocol, head[1], head[2], head[3]};
  bytes.insert(bytes.end(), body.begin(), body.end());
  send_up(now_s, unit, std::move(bytes));
}

void EmulatedChain::answer_frame(double now_s, std::size_t unit, std::span<const std::uint8_t> head,
                                 const EmulatedUnit::Result& result) {
  std::vector<std::uint8_t> body{result.ack, result.status, flags(now_s, unit), nodes_[unit].id};
  if (setting_.protocol == 5) body[0] = 0;
  put(body, unit_ns(now_s), 8);
  body.insert(body.end(), result.data.begin(), result.data.end());
  answer(now_s, unit, head, std::move(body));
}

void EmulatedChain::arrive(const Event& event) {
  Node& node = nodes_[event.unit];
  const std::span<const std::uint8_t> datagram = event.bytes;
  const double now_s = event.at_s;
  if (datagram.size() < head_size) return node.firmware.violate(now_s, "a datagram of less than 4 bytes");
  const std::uint8_t kind = datagram[1];
  const std::span<const std::uint8_t> body = datagram.subspan(head_size);
  const auto say = [&](std::vector<std::uint8_t> bytes) { answer(now_s, event.unit, datagram, std::move(bytes)); };
  if (datagram[0] != setting_.protocol) return say({wrong_protocol});
  const bool for_group = kind == unit_info || kind == reset_id || kind == discover;
  if (event.by_group && !for_group) return node.firmware.violate(now_s, fmt::format("kind {:02x} to the group", kind));
  switch (kind) {
    case frame:
      if (node.id == no_id) return;
      if (body.size() < node.firmware.head_size() || body.size() > most_bytes)
        return node.firmware.violate(now_s, fmt::format("a frame of {} bytes", body.size()));
      node.firmware.host_spoke(now_s);
      if (node.queue.size() >= most_waiting) return node.firmware.queue_was_full(now_s);
      ++frames_;
      node.queue.push_back({{datagram.begin(), datagram.end()}});
      if (node.queue.size() == 1) begin(now_s, event.unit);
      return;
    case heartbeat:
      if (node.id == no_id) return;
      node.firmware.host_spoke(now_s);
      return answer_frame(now_s, event.unit, datagram, node.firmware.last_result());
    case unit_info:
      return say(info(now_s, event.unit));
    case reset_id:
      say({fine});
      return add({.what = Event::What::drops_id, .at_s = now_s + id_stays_s, .order = 0, .unit = event.unit});
    case discover:
      if (node.id == no_id) say({fine});
      return;
    case assign:
      if (node.id != no_id) return;
      if (body.size() < 2 || body[0] == no_id || body[1] > 1) return say({bad_body});
      node.id = body[0];
      return say({fine});
    case open_far_port:
      if (node.id == no_id) return say({has_no_id});
      node.far_port = true;
      return say({fine, std::uint8_t{event.unit + 1 < nodes_.size() && !nodes_[event.unit + 1].cut}});
    case set_time: {
      if (node.id == no_id) return say({has_no_id});
      if (node.id != 0) return say({not_the_first});
      if (body.size() < 8) return say({bad_body});
      std::uint64_t ns = 0;
      for (std::size_t byte = 0; byte < 8; ++byte)
        ns |= std::uint64_t{body[byte]} << (8 * byte);
      if (ns / 1'000'000'000 > 0xffffffff) return say({bad_body});
      time_set_s_ = now_s;
      time_then_ns_ = ns;
      time_known_ = true;
      return say({fine});
    }
    default:
      return node.firmware.violate(now_s, fmt::format("an unknown kind {:02x}", kind));
  }
}

/// Begins with the first frame of the queue, if there is one.
void EmulatedChain::begin(double now_s, std::size_t unit) {
  Node& node = nodes_[unit];
  if (node.queue.empty()) return;
  Frame& first = node.queue.front();
  const std::span<const std::uint8_t> body = std::span(first.datagram).subspan(head_size);
  double done_s = now_s + setting_.processing_s;
  if (const std::uint32_t at_us = node.firmware.execute_at_us(body); at_us != 0) {
    const double named_s = when_s(now_s, at_us);
    first.late = done_s >= named_s + spin_s;
    done_s = std::max(done_s, named_s);
  }
  add({.what = Event::What::finishes, .at_s = done_s, .order = 0, .unit = unit, .begun = ++node.begun});
}

void EmulatedChain::finish(const Event& event) {
  Node& node = nodes_[event.unit];
  if (node.begun != event.begun || node.queue.empty()) return;  // it has restarted
  const Frame first = std::move(node.queue.front());
  node.queue.pop_front();
  const std::span<const std::uint8_t> datagram = first.datagram;
  const EmulatedUnit::Result result =
      node.firmware.carry_out(moment(event.at_s), datagram.subspan(head_size), first.late);
  answer_frame(event.at_s, event.unit, datagram, result);
  if (datagram[head_size + 1] == 0x07) reboot(event.at_s, event.unit);
  begin(event.at_s, event.unit);
}

bool EmulatedChain::silent(double now_s) const {
  return std::ranges::all_of(nodes_, [&](const Node& node) { return node.firmware.silent(moment(now_s)); });
}

std::vector<emulate::Violation> EmulatedChain::violations() const {
  std::vector<emulate::Violation> all;
  for (std::size_t unit = 0; unit < nodes_.size(); ++unit) {
    for (emulate::Violation one : nodes_[unit].firmware.violations().kept()) {
      if (nodes_.size() > 1) one.what = fmt::format("unit {}: {}", unit, one.what);
      all.push_back(std::move(one));
    }
  }
  std::ranges::stable_sort(all, {}, &emulate::Violation::time_s);
  return all;
}

std::size_t EmulatedChain::violation_count() const {
  std::size_t count = 0;
  for (const Node& node : nodes_)
    count += node.firmware.violations().count();
  return count;
}

}  // namespace palpa::driver::autd3_udp
