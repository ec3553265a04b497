// Emulated AUTD3 units on a network cable: the first one at the host, each further one behind the far port of the one
// before it. Datagrams go over a wire of 100 Mbit/s that all units share, wait in their unit's queue of seven, take the
// unit's time, and are answered over the same wire. No sockets: the caller passes datagrams with their times.
//
// Units share a clock of their own, which is off from the host's by a random time and by `clock_ppm`.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <queue>
#include <random>
#include <span>
#include <vector>

#include "driver/autd3_udp/emulated/unit.hpp"

namespace palpa::driver::autd3_udp {

struct ChainSetting {
  std::uint8_t protocol = 5;
  std::size_t units = 1;        ///< 1 to 16
  double processing_s = 50e-6;  ///< the unit's time for a frame, which its makers do not publish: a guess
  double lock_s = 50e-3;        ///< from the setting of the time until the units' clocks are locked
  double clock_ppm = 50;
  // Faults on the wire, each as a share of the datagrams of both directions.
  double lost = 0, repeated = 0, delayed = 0;
  double delay_s = 5e-3;  ///< of the delayed
  std::uint64_t seed = 1;
};

class EmulatedChain {
 public:
  static constexpr std::uint8_t no_id = 0xff;

  explicit EmulatedChain(const ChainSetting& setting);

  /// A datagram that the host sends to the group's address, or to a unit's.
  void take_from_group(double now_s, std::span<const std::uint8_t> datagram);
  void take(double now_s, std::size_t unit, std::span<const std::uint8_t> datagram);
  /// Does all that happens until now.
  void advance(double now_s);
  /// When something happens next; infinity: never.
  double next_s() const { return events_.empty() ? std::numeric_limits<double>::infinity() : events_.top().at_s; }

  /// A datagram that has reached the host. `id`: the unit's when it sent it, on which its address depends.
  struct Answer {
    std::size_t unit = 0;
    std::uint8_t id = no_id;
    double at_s = 0;
    std::vector<std::uint8_t> bytes;
  };
  /// Those that came since the last call, in order.
  std::vector<Answer> answers();

  /// The unit's present address: its id, or no_id.
  std::uint8_t id(std::size_t unit) const { return nodes_[unit].id; }
  /// A unit that is muted takes frames, and answers nothing.
  void mute(std::size_t unit, bool muted) { nodes_[unit].muted = muted; }
  /// The unit restarts: without sound, id and far port.
  void reboot(double now_s, std::size_t unit);
  /// Nothing passes the cable in front of this unit any more, or all passes again.
  void cut(std::size_t unit, bool away) { nodes_[unit].cut = away; }

  std::size_t size() const { return nodes_.size(); }
  const EmulatedUnit& unit(std::size_t index) const { return nodes_[index].firmware; }
  Moment moment(double now_s) const { return {now_s, unit_ns(now_s)}; }
  bool silent(double now_s) const;
  std::uint64_t frames() const { return frames_; }
  /// The units' violations together, oldest first.
  std::vector<emulate::Violation> violations() const;
  std::size_t violation_count() const;

 private:
  struct Frame {
    std::vector<std::uint8_t> datagram;
    bool late = false;
  };
  struct Node {
    explicit Node(std::uint8_t protocol) : firmware(protocol) {}
    EmulatedUnit firmware;
    std::uint8_t id = no_id;
    bool far_port = false, muted = false, cut = false;
    std::deque<Frame> queue;  ///< the first is being carried out
    std::uint64_t begun =
        0;  ///< counts what it has begun, so that the end of something dropped is not taken for another
  };
  struct Event {
    enum class What { arrives, finishes, returns, answers, drops_id } what;
    double at_s;
    std::uint64_t order;  ///< of events at the same time
    std::size_t unit;
    std::uint64_t begun = 0;
    std::uint8_t id = no_id;
    bool by_group = false;
    std::vector<std::uint8_t> bytes{};
    bool operator<(const Event& other) const {
      return at_s != other.at_s ? at_s > other.at_s : order > other.order;  // the earliest is on top
    }
  };

  std::uint64_t unit_ns(double now_s) const;
  double when_s(double now_s, std::uint32_t at_us) const;
  bool reached(std::size_t unit) const;
  void send_down(double now_s, std::size_t unit, std::span<const std::uint8_t> datagram, bool by_group);
  void send_up(double now_s, std::size_t unit, std::vector<std::uint8_t> bytes);
  /// When a datagram arrives that was due then: none if it is lost, two times if it is repeated.
  std::vector<double> with_faults(double due_s);
  void add(Event event);
  void arrive(const Event& event);
  void begin(double now_s, std::size_t unit);
  void finish(const Event& event);
  void answer(double now_s, std::size_t unit, std::span<const std::uint8_t> head, std::vector<std::uint8_t> body);
  void answer_frame(double now_s, std::size_t unit, std::span<const std::uint8_t> head,
                    const EmulatedUnit::Result& result);
  std::uint8_t flags(double now_s, std::size_t unit) const;
  bool locked(double now_s, std::size_t unit) const;
  std::vector<std::uint8_t> info(double now_s, std::size_t unit) const;
  double chance();

  ChainSetting setting_;
  std::vector<Node> nodes_;
  std::priority_queue<Event> events_;
  std::uint64_t order_ = 0, frames_ = 0;
  std::vector<Answer> answers_;
  std::mt19937_64 random_;
  double down_free_s_ = 0, up_free_s_ = 0;  ///< when the host's cable is free
  double time_set_s_ = 0;                   ///< when the host set the time
  std::uint64_t time_then_ns_ = 0;
  bool time_known_ = false;
};

}  // namespace palpa::driver::autd3_udp
