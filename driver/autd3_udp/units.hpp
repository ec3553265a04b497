// A chain of AUTD3 units of the UDP line as its client sees it: it finds and opens them, sends frames until each unit
// has answered, and knows whether all are there. Nothing waits: pump() goes on with whatever there is to do.
//
// A frame goes to all units (a round). Where frames are counted (protocols 2, 3), a unit carries out none after one
// that was lost, so palpa begins its count again (Reset) and repeats what it has not answered. Elsewhere a frame that
// was not answered is repeated alone. A pattern that a later one has replaced is never repeated: it would sound again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "driver/autd3_udp/cable.hpp"
#include "driver/autd3_udp/wire.hpp"
#include "driver/fixed_text.hpp"

namespace palpa::driver::autd3_udp {

/// What a round of frames is to the rounds before it.
enum class Round {
  setting,  ///< repeated until each unit has answered
  part,     ///< of a pattern: the same, until a pattern replaces it
  pattern,  ///< a whole pattern: replaces all patterns and parts before
};

class Units {
 public:
  static constexpr std::uint16_t failsafe_ms = 500;
  static constexpr std::size_t window = 4;  ///< rounds on their way

  /// `count` boards of the layout `layout`. Takes all its memory. `cable` must outlive it.
  Units(Cable& cable, std::size_t count, std::string layout, const Silencer& silencer);

  /// Begins to open the units, whatever state they are in.
  void open(double now_s);
  /// Reads what has come, and goes on.
  void pump(double now_s);
  /// Open, silent and with aligned clocks.
  bool ready() const { return step_ == Step::ready; }
  /// Nothing more happens until open(). fault() says why. Units that could be reached have been silenced; the others'
  /// failsafes need failsafe_ms, and an opening before that would keep them open.
  bool closed() const { return step_ == Step::closed; }
  /// Whether all units have answered that silence.
  bool closed_silent() const { return closed() && closed_silent_; }
  std::string_view fault() const { return fault_.view(); }
  /// Waits for units to agree on the time, which can take seconds.
  bool waits_for_clocks() const { return step_ == Step::lock; }
  pollfd watched() const { return cable_.watched(); }

  /// Only while they are ready.
  std::size_t count() const { return units_.size(); }
  const Protocol& protocol() const { return *protocol_; }
  /// Whether another round fits: fewer than `most` are on their way, and there is room.
  bool takes(std::size_t most = window) const { return rounds_on_way() < most; }
  /// All rounds have been answered by all units.
  bool idle() const { return rounds_on_way() == 0; }
  /// The frames of the next round, one for each unit: write them, then send.
  std::span<Datagram> frames();
  /// At `at_s` on the caller's clock, on all units at once; 0, or where frames carry no time: as soon as each has it.
  /// `counts`: drives_there() counts it once all units have carried it out.
  /// Returns the round's number.
  std::uint64_t send(Round round, double at_s, double now_s, bool counts = false);
  std::uint64_t newest() const { return round_number_; }  ///< of the rounds
  /// Whether all units have carried out that round, or it was replaced.
  bool done(std::uint64_t round) const;
  /// What to add to the caller's time for that of the units.
  double clock_ahead_s() const { return clock_ahead_s_; }
  std::uint64_t drives_there() const { return drives_there_; }

  std::uint64_t repeated() const { return repeated_; }  ///< frames sent again
  std::uint64_t strange() const { return strange_; }    ///< datagrams that were no answer to palpa
  /// Frames that came to a unit after their time, as all units answered the newest round of read_counters.
  std::uint32_t late() const;

 private:
  enum class Step {
    closed,
    ask,
    ask_others,
    reset_ids,
    discover,
    discover_others,
    assign,
    find_assigned,
    greet,
    open_far_port,
    info,
    set_time,
    lock,
    prepare,
    ready,
    stop,
  };
  /// A frame or a heartbeat that a unit has not answered.
  struct Open {
    std::uint16_t id = 0;
    std::uint8_t sequence = 0;
    bool heartbeat = false;
    std::size_t round = 0;  ///< its place among the rounds
    double due_s = 0;
  };
  struct Unit {
    Endpoint where;
    bool answered = false;  ///< the newest request for info
    std::uint8_t flags = 0;
    std::uint8_t next_sequence = 0;
    std::array<Open, 8> open;
    std::size_t open_count = 0;
    double sent_s = 0;          ///< the newest datagram
    double unanswered_s = 0;    ///< the oldest one since it answered; 0: none
    std::uint32_t repeats = 0;  ///< since it answered
    std::uint32_t late = 0;
  };
  struct Sent {
    Round round = Round::setting;
    std::uint64_t number = 0;
    double at_s = 0;
    bool counts = false;
    std::size_t waits = 0;  ///< for so many units
    std::vector<Datagram> frames;
  };

  // Opening.
  void enter(Step step, double now_s);
  void request(Kind kind, const Endpoint& to, double now_s);
  void ask(double now_s);
  void go_on(double now_s);
  void take(const Answer& answer, const Endpoint& from, double now_s);
  void take_info(const Answer& answer, const Endpoint& from, double now_s);
  void take_greeting(const Answer& answer, double now_s);
  void send_greeting(double now_s);
  void end_search(double now_s);
  void check_protocols(double now_s);
  void send_preparation(double now_s);
  // Frames.
  void take_frame(const Answer& answer, Unit& unit, double now_s);
  void transmit(Unit& unit, std::size_t round, double now_s);
  void reset(Unit& unit, double now_s);
  void resend(Unit& unit, double now_s);
  static Open take_out(Unit& unit, std::size_t which);
  void end(const Open& open, bool done);
  void look_at_units(double now_s);
  void beat(Unit& unit, double now_s);
  bool is_replaced(const Sent& round) const { return round.round != Round::setting && round.number < replaced_; }
  std::size_t rounds_on_way() const;
  // Faults.
  template <typename... Args>
  void fail(double now_s, fmt::format_string<Args...> text, Args&&... args) {
    fault_.format(text, std::forward<Args>(args)...);
    end_in_silence(now_s);
  }
  void end_in_silence(double now_s);

  std::uint16_t next_id() { return ++id_; }
  bool is_of_step(const Answer& answer) const {
    return static_cast<std::uint16_t>(answer.id - step_id_ - 1) < static_cast<std::uint16_t>(id_ - step_id_);
  }
  std::size_t number_of(const Unit& unit) const { return static_cast<std::size_t>(&unit - units_.data()); }
  Unit* find(const Endpoint& where);
  void follow_clock(std::uint64_t unit_ns, double now_s);

  Cable& cable_;
  std::size_t wanted_;
  std::string layout_;
  Silencer silencer_;
  const Protocol* protocol_ = nullptr;
  std::vector<Unit> units_;  ///< those that have their number
  Step step_ = Step::closed;
  double begun_s_ = 0;         ///< the search for the next unit
  double entered_s_ = 0;       ///< the step
  double asked_s_ = 0;         ///< its newest request
  int tries_ = 0;              ///< requests of the step
  std::uint16_t step_id_ = 0;  ///< the newest message id before the step
  std::array<bool, 256> bytes_seen_{};
  Endpoint found_;         ///< a unit without a number
  bool far_link_ = false;  ///< something is connected behind the last unit
  std::size_t stage_ = 0;  ///< of a greeting or the preparation
  std::array<Sent, 8> rounds_;
  std::size_t writing_ = 0;                        ///< the next of them
  std::uint64_t round_number_ = 0, replaced_ = 0;  ///< the newest round, and the newest whole pattern
  std::uint64_t drives_there_ = 0, repeated_ = 0, strange_ = 0;
  bool closed_silent_ = false;
  bool unlocked_ = false;  ///< some unit has lost the common time
  double pumped_s_ = 0;
  double clock_ahead_s_ = 0, clock_seen_s_ = 0;  ///< of unit 0
  bool clock_known_ = false;
  std::uint16_t id_ = 0;
  Datagram scratch_;
  std::array<std::uint8_t, 2048> incoming_{};
  FixedText<300> fault_;
};

}  // namespace palpa::driver::autd3_udp
