#include "driver/autd3_udp/units.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace palpa::driver::autd3_udp {
namespace {

// The opening:
constexpr double request_s = 0.2;     ///< one request is waited for
constexpr double others_s = 0.01;     ///< further answers to a request that only one unit may answer
constexpr double protocols_s = 0.05;  ///< further answers to the question for the protocol
constexpr double reset_s = 0.3;       ///< until units have dropped their numbers and shut their far ports
constexpr double search_s = 3;        ///< for each unit
constexpr double lock_poll_s = 0.05, lock_s = 30;
constexpr double prepare_s = 5;
constexpr int tries_each = 3;
constexpr double greeting_s = 0.05;
constexpr int greeting_tries = 10;

// Frames:
constexpr double answer_s = 0.01;  ///< ... is repeated
constexpr double silent_s = 0.25;  ///< ... means that the unit is lost; half of what its failsafe takes
constexpr std::uint32_t least_repeats = 5;
constexpr double heartbeat_s = 0.05;
constexpr double stop_s = 0.15;
constexpr double gap_s = 0.3;  ///< after which a failsafe may have shut while palpa got no processor
constexpr double least_ahead_s = 20e-6;
constexpr double drift = 1e-4;  ///< more than any clock's

constexpr std::uint8_t all_ready = pulse_runs | clock_locked;
constexpr std::uint8_t reset_answer = 0xff;  ///< the sequence in the answer to Reset

}  // namespace

Units::Units(Cable& cable, std::size_t count, std::string layout, const Silencer& silencer)
    : cable_(cable), wanted_(count), layout_(std::move(layout)), silencer_(silencer) {
  units_.reserve(most_units);
  for (Sent& round : rounds_)
    round.frames.resize(count);
}

// ---- opening -------------------------------------------------------------------------------------------------------

void Units::open(double now_s) {
  protocol_ = nullptr;
  units_.clear();
  for (Sent& round : rounds_)
    round.waits = 0;
  bytes_seen_ = {};
  clock_known_ = unlocked_ = false;
  fault_.clear();
  begun_s_ = pumped_s_ = now_s;
  enter(Step::ask, now_s);
}

void Units::enter(Step step, double now_s) {
  step_ = step;
  entered_s_ = now_s;
  step_id_ = id_;
  tries_ = 0;
  ask(now_s);
}

void Units::request(Kind kind, const Endpoint& to, double now_s) {
  put_request(scratch_, protocol_ == nullptr ? ask_byte : protocol_->byte, kind, next_id());
  cable_.send(to, scratch_.view());
  asked_s_ = now_s;
}

/// Sends the request of the step, also once more.
void Units::ask(double now_s) {
  ++tries_;
  const auto next = static_cast<std::uint8_t>(units_.size());
  switch (step_) {
    case Step::ask:
    case Step::info:
    case Step::find_assigned:
    case Step::lock:
      for (Unit& unit : units_)
        unit.answered = false;
      return request(Kind::info, cable_.group(), now_s);
    case Step::reset_ids:
      return request(Kind::reset_id, cable_.group(), now_s);
    case Step::discover:
      return request(Kind::discover, cable_.group(), now_s);
    case Step::assign:
      put_assign(scratch_, *protocol_, next_id(), next);
      cable_.send(found_, scratch_.view());
      asked_s_ = now_s;
      return;
    case Step::greet:
      return send_greeting(now_s);
    case Step::open_far_port:
      return request(Kind::open_far_port, units_.back().where, now_s);
    case Step::set_time:
      put_set_time(scratch_, *protocol_, next_id(), 0);
      cable_.send(units_.front().where, scratch_.view());
      asked_s_ = now_s;
      return;
    default:
      return;
  }
}

/// What the passing of time brings.
void Units::go_on(double now_s) {
  const double in_step_s = now_s - entered_s_;
  const bool unanswered = now_s - asked_s_ >= request_s;
  switch (step_) {
    case Step::closed:
      return;
    case Step::ask:
      if (!unanswered) return;
      if (in_step_s >= search_s)
        return fail(now_s,
                    "no AUTD3 unit answers at {}: check its power and its cable, and that the firewall lets UDP "
                    "from port {} in",
                    to_text(cable_.group()), unit_port);
      return ask(now_s);
    case Step::ask_others:
      if (in_step_s >= protocols_s) check_protocols(now_s);
      return;
    case Step::reset_ids:
      if (in_step_s < reset_s) return;
      begun_s_ = now_s;
      return enter(Step::discover, now_s);
    case Step::discover:
      if (!unanswered) return;
      if (now_s - begun_s_ >= search_s || units_.size() == wanted_) return end_search(now_s);
      // It may have a number of an earlier opening.
      if (tries_ % 2 == 1) {
        ++tries_;
        return request(Kind::info, cable_.group(), now_s);
      }
      return ask(now_s);
    case Step::discover_others:
      if (in_step_s >= others_s) enter(Step::assign, now_s);
      return;
    case Step::assign:
      if (!unanswered) return;
      if (tries_ >= tries_each) return enter(Step::find_assigned, now_s);
      return ask(now_s);
    case Step::greet:
      if (now_s - asked_s_ < greeting_s) return;
      if (tries_ >= greeting_tries) return fail(now_s, "unit {} does not answer", units_.size() - 1);
      return ask(now_s);
    case Step::find_assigned:
    case Step::open_far_port:
    case Step::info:
    case Step::set_time:
      if (!unanswered) return;
      if (tries_ < tries_each) return ask(now_s);
      if (step_ == Step::find_assigned) return fail(now_s, "unit {} does not take its number", units_.size());
      for (const Unit& unit : units_) {
        if (step_ != Step::info || !unit.answered) {
          const std::size_t number = step_ == Step::open_far_port ? units_.size() - 1 : number_of(unit);
          return fail(now_s, "unit {} does not answer", number);
        }
      }
      return;
    case Step::lock:
      if (in_step_s >= lock_s)
        return fail(now_s, "the units do not agree on the time after {} s: check their cables", lock_s);
      if (now_s - asked_s_ >= lock_poll_s) {
        // Meanwhile they must not think that palpa is gone.
        ask(now_s);
        for (Unit& unit : units_)
          beat(unit, now_s);
      }
      return;
    case Step::prepare:
      look_at_units(now_s);
      if (step_ != Step::prepare) return;
      if (in_step_s >= prepare_s) return fail(now_s, "the units are not ready after {} s", prepare_s);
      if (idle()) send_preparation(now_s);
      return;
    case Step::ready:
      return look_at_units(now_s);
    case Step::stop:
      if (idle() || in_step_s >= stop_s) {
        closed_silent_ = idle();
        step_ = Step::closed;
        return;
      }
      for (Unit& unit : units_)
        resend(unit, now_s);
      return;
  }
}

void Units::check_protocols(double now_s) {
  std::string_view with;
  FixedText<120> seen;
  std::size_t count = 0;
  std::uint8_t byte = 0;
  for (std::size_t b = 0; b < bytes_seen_.size(); ++b) {
    if (!bytes_seen_[b]) continue;
    ++count;
    byte = static_cast<std::uint8_t>(b);
    seen = FixedText<120>("{}{}{}", seen.view(), with, b);
    with = " and ";
  }
  if (count > 1)
    return fail(now_s, "the units speak different protocols, {}: give all of them one firmware", seen.view());
  protocol_ = find_protocol(byte);
  if (protocol_ == nullptr)
    return fail(now_s, "the units speak protocol {}, and palpa knows {}", byte, known_protocols());
  enter(Step::reset_ids, now_s);
}

/// No further unit answers.
void Units::end_search(double now_s) {
  if (units_.size() == wanted_) return enter(Step::info, now_s);
  fail(now_s, "{} unit{} answer{}, and the layout {} has {}", units_.size(), units_.size() == 1 ? "" : "s",
       units_.size() == 1 ? "s" : "", layout_, wanted_);
}

Units::Unit* Units::find(const Endpoint& where) {
  const auto found = std::ranges::find(units_, where, &Unit::where);
  return found == units_.end() ? nullptr : &*found;
}

void Units::take(const Answer& answer, const Endpoint& from, double now_s) {
  const auto strange = [&] { ++strange_; };
  if (step_ == Step::closed) return;
  if (protocol_ == nullptr) {
    if (answer.kind != Kind::info || answer.status != status_wrong_protocol || !is_of_step(answer)) return strange();
    bytes_seen_[answer.protocol] = true;
    if (step_ == Step::ask) {
      const std::uint16_t since = step_id_;
      enter(Step::ask_others, now_s);
      step_id_ = since;
    }
    return;
  }
  if (answer.protocol != protocol_->byte) {
    if (step_ == Step::ready || step_ == Step::stop || !is_of_step(answer)) return strange();
    return fail(now_s, "the units speak different protocols, {} and {}: give all of them one firmware", protocol_->byte,
                answer.protocol);
  }
  Unit* const unit = find(from);
  if (answer.kind == Kind::frame || answer.kind == Kind::heartbeat) {
    if (unit == nullptr) return strange();
    if (step_ == Step::greet) return take_greeting(answer, now_s);
    return take_frame(answer, *unit, now_s);
  }
  if (!is_of_step(answer)) return strange();
  if (answer.kind == Kind::info) return take_info(answer, from, now_s);
  if (answer.kind == Kind::discover && unit == nullptr && answer.status == status_ok) {
    if (step_ == Step::discover) {
      found_ = from;
      const std::uint16_t since = step_id_;
      enter(Step::discover_others, now_s);
      step_id_ = since;
    } else if (step_ == Step::discover_others && from != found_) {
      fail(now_s, "two units answer where one should, at {} and {}: connect all units in one chain", to_text(found_),
           to_text(from));
    }
    return;
  }
  if (answer.kind == Kind::assign && step_ == Step::assign && unit == nullptr) {
    if (answer.status != status_ok)
      return fail(now_s, "unit {} refuses its number with status {:02x}", units_.size(), answer.status);
    units_.push_back({.where = from});
    stage_ = 0;
    return enter(Step::greet, now_s);
  }
  if (answer.kind == Kind::open_far_port && step_ == Step::open_far_port && unit == &units_.back()) {
    if (answer.status != status_ok)
      return fail(now_s, "unit {} does not open its far port, status {:02x}", units_.size() - 1, answer.status);
    begun_s_ = now_s;
    if (answer.data[0] == 0 || units_.size() == most_units) return end_search(now_s);
    return enter(Step::discover, now_s);
  }
  if (answer.kind == Kind::set_time && step_ == Step::set_time && unit == &units_.front()) {
    if (answer.status != status_ok) return fail(now_s, "unit 0 does not take the time, status {:02x}", answer.status);
    return enter(Step::lock, now_s);
  }
  if (answer.kind != Kind::reset_id) strange();
}

void Units::take_info(const Answer& answer, const Endpoint& from, double now_s) {
  Unit* const unit = find(from);
  if (answer.status != status_ok) return;
  const bool numbered = (answer.flags & has_id) != 0;
  if (unit == nullptr) {
    if (!numbered) return;
    if (step_ == Step::find_assigned && answer.unit == units_.size()) {
      units_.push_back({.where = from});
      stage_ = 0;
      return enter(Step::greet, now_s);
    }
    // It answers discover only without its old number.
    if (step_ == Step::discover) {
      put_request(scratch_, protocol_->byte, Kind::reset_id, next_id());
      cable_.send(from, scratch_.view());
    } else {
      ++strange_;
    }
    return;
  }
  if (!numbered || answer.unit != number_of(*unit)) return;
  unit->answered = true;
  unit->flags = answer.flags;
  if (step_ != Step::info && step_ != Step::lock) return;
  const std::uint8_t needed = step_ == Step::lock ? all_ready : std::uint8_t{0};
  if (!std::ranges::all_of(units_, [&](const Unit& u) { return u.answered && (u.flags & needed) == needed; })) return;
  if (step_ == Step::info) return enter(Step::set_time, now_s);
  for (Unit& u : units_)
    u.open_count = 0;  // heartbeats on their way
  stage_ = 0;
  enter(Step::prepare, now_s);
}

/// A unit is silenced as soon as it has its number: it may sound since another program died.
void Units::send_greeting(double now_s) {
  constexpr Command counted[] = {Command::reset, Command::read_versions, Command::clear};
  constexpr Command uncounted[] = {Command::read_versions, Command::clear, Command::settings};
  const std::span<const Command> all = protocol_->counts_frames ? std::span(counted) : std::span(uncounted);
  Unit& unit = units_.back();
  if (stage_ == all.size()) return enter(Step::open_far_port, now_s);
  if (all[stage_] == Command::settings) {
    put_settings(scratch_, *protocol_, failsafe_ms);
  } else {
    put_command(scratch_, *protocol_, all[stage_]);
  }
  stamp(scratch_, *protocol_, {.id = next_id(), .sequence = unit.next_sequence});
  cable_.send(unit.where, scratch_.view());
  asked_s_ = now_s;
}

void Units::take_greeting(const Answer& answer, double now_s) {
  if (answer.kind != Kind::frame || !is_of_step(answer)) return;
  Unit& unit = units_.back();
  const std::size_t number = units_.size() - 1;
  const bool resets = protocol_->counts_frames && stage_ == 0;
  if (protocol_->counts_frames && answer.sequence != (resets ? reset_answer : unit.next_sequence)) {
    stage_ = 0;  // a repeated frame came after the next one
    return enter(Step::greet, now_s);
  }
  if (answer.status != status_ok)
    return fail(now_s, "unit {} does not begin: {} (status {:02x})", number, frame_status(answer.status),
                answer.status);
  if (!answer.data.empty()) {
    const auto versions = parse_versions(answer);
    const auto fits = [&](const Version& v) {
      return v.major == 0 && v.minor >= protocol_->minor_from && v.minor <= protocol_->minor_to;
    };
    if (!versions || !fits(versions->cpu) || !fits(versions->fpga)) {
      const Versions seen = versions.value_or(Versions{});
      return fail(now_s, "unit {} has firmware {}.{}.{} (its FPGA {}.{}.{}); with protocol {} palpa needs {}", number,
                  seen.cpu.major, seen.cpu.minor, seen.cpu.patch, seen.fpga.major, seen.fpga.minor, seen.fpga.patch,
                  protocol_->byte, protocol_->firmware);
    }
  }
  unit.next_sequence = resets ? std::uint8_t{0} : static_cast<std::uint8_t>(unit.next_sequence + 1);
  ++stage_;
  enter(Step::greet, now_s);
}

/// The units have the same time now: they begin once more, with what palpa needs.
void Units::send_preparation(double now_s) {
  constexpr Command all[] = {Command::clear, Command::settings, Command::synchronize, Command::silencer};
  if (stage_ < std::size(all) && all[stage_] == Command::settings && !protocol_->has_settings) ++stage_;
  if (stage_ == std::size(all)) {
    step_ = Step::ready;
    return;
  }
  for (Datagram& frame : frames()) {
    switch (all[stage_]) {
      case Command::settings:
        put_settings(frame, *protocol_, failsafe_ms);
        break;
      case Command::silencer:
        put_silencer(frame, *protocol_, silencer_);
        break;
      default:
        put_command(frame, *protocol_, all[stage_]);
        break;
    }
  }
  ++stage_;
  send(Round::setting, 0, now_s);
}

// ---- frames --------------------------------------------------------------------------------------------------------

std::size_t Units::rounds_on_way() const {
  return static_cast<std::size_t>(std::ranges::count_if(rounds_, [](const Sent& round) { return round.waits > 0; }));
}

std::span<Datagram> Units::frames() {
  const auto free = std::ranges::find(rounds_, std::size_t{0}, &Sent::waits);
  assert(free != rounds_.end());
  writing_ = static_cast<std::size_t>(free - rounds_.begin());
  return free->frames;
}

std::uint64_t Units::send(Round round, double at_s, double now_s, bool counts) {
  Sent& sent = rounds_[writing_];
  sent.round = round;
  sent.number = ++round_number_;
  sent.at_s = protocol_->carries_time ? at_s : 0;
  sent.counts = counts;
  sent.waits = units_.size();
  if (round == Round::pattern) replaced_ = sent.number;
  ++id_;
  for (std::size_t u = units_.size(); u-- > 0;)  // the farthest first
    transmit(units_[u], writing_, now_s);
  return sent.number;
}

bool Units::done(std::uint64_t round) const {
  return std::ranges::none_of(rounds_, [&](const Sent& sent) { return sent.waits > 0 && sent.number == round; });
}

/// With the newest message id, which all units' frames of a round share.
void Units::transmit(Unit& unit, std::size_t round, double now_s) {
  const Sent& sent = rounds_[round];
  Datagram& frame = rounds_[round].frames[number_of(unit)];
  Stamp with{.id = id_, .sequence = unit.next_sequence};
  const bool later = sent.at_s > now_s + least_ahead_s && clock_known_;
  if (later) with.exec_at = exec_at(1e9 * (sent.at_s + clock_ahead_s_));
  stamp(frame, *protocol_, with);
  cable_.send(unit.where, frame.view());
  if (protocol_->counts_frames) ++unit.next_sequence;
  unit.sent_s = now_s;
  if (unit.unanswered_s == 0) unit.unanswered_s = now_s;
  if (unit.open_count == unit.open.size()) end(take_out(unit, 0), false);  // cannot happen: there are not more rounds
  unit.open[unit.open_count++] = {.id = with.id,
                                  .sequence = with.sequence,
                                  .heartbeat = false,
                                  .round = round,
                                  .due_s = (later ? sent.at_s : now_s) + answer_s};
}

/// Begins a unit's count of frames again.
void Units::reset(Unit& unit, double now_s) {
  put_command(scratch_, *protocol_, Command::reset);
  stamp(scratch_, *protocol_, {.id = next_id()});
  cable_.send(unit.where, scratch_.view());
  unit.next_sequence = 0;
  unit.sent_s = now_s;
}

/// Sends again what a unit has not answered, if that is due; where frames are counted, all of it.
void Units::resend(Unit& unit, double now_s) {
  const auto due = [&](const Open& open) { return now_s >= open.due_s; };
  const std::span<const Open> open(unit.open.data(), unit.open_count);
  if (std::ranges::none_of(open, due)) return;
  std::array<std::size_t, std::tuple_size_v<decltype(unit.open)>> again{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < unit.open_count;) {
    if (!protocol_->counts_frames && !due(unit.open[i])) {
      ++i;
      continue;
    }
    const Open one = take_out(unit, i);
    if (one.heartbeat || is_replaced(rounds_[one.round])) {
      end(one, false);
    } else {
      again[count++] = one.round;
    }
  }
  ++unit.repeats;
  if (protocol_->counts_frames) reset(unit, now_s);
  if (count == 0) return beat(unit, now_s);  // whether it is there at all
  for (std::size_t i = 0; i < count; ++i) {
    ++repeated_;
    ++id_;
    transmit(unit, again[i], now_s);
  }
}

Units::Open Units::take_out(Unit& unit, std::size_t which) {
  const auto begin = unit.open.begin();
  const Open out = unit.open[which];
  std::move(begin + static_cast<std::ptrdiff_t>(which) + 1, begin + static_cast<std::ptrdiff_t>(unit.open_count),
            begin + static_cast<std::ptrdiff_t>(which));
  --unit.open_count;
  return out;
}

/// A unit has carried it out, or it is given up.
void Units::end(const Open& open, bool done) {
  if (open.heartbeat) return;
  Sent& round = rounds_[open.round];
  round.counts = round.counts && done;
  if (--round.waits == 0 && round.counts) ++drives_there_;
}

void Units::beat(Unit& unit, double now_s) {
  if (unit.open_count == unit.open.size()) return;
  const std::uint16_t id = next_id();
  put_request(scratch_, protocol_->byte, Kind::heartbeat, id);
  cable_.send(unit.where, scratch_.view());
  unit.sent_s = now_s;
  if (unit.unanswered_s == 0) unit.unanswered_s = now_s;
  unit.open[unit.open_count++] = {.id = id, .sequence = 0, .heartbeat = true, .round = 0, .due_s = now_s + answer_s};
}

void Units::take_frame(const Answer& answer, Unit& unit, double now_s) {
  const std::size_t number = number_of(unit);
  const bool playing = step_ == Step::ready;
  if ((answer.flags & has_id) == 0 || answer.unit != number) {
    if (step_ == Step::stop) return;
    return fail(now_s, "unit {} has restarted", number);
  }
  unit.unanswered_s = 0;
  unit.repeats = 0;
  unit.flags = answer.flags;
  if (number == 0) follow_clock(answer.time_ns, now_s);
  if (playing) {
    if (protocol_->failsafe_flag && (answer.flags & failsafe_shut) != 0)
      return fail(now_s, "unit {} has fallen silent: its failsafe has shut", number);
    if ((answer.flags & pulse_runs) == 0) return fail(now_s, "unit {} has lost its pulse", number);
    unlocked_ = unlocked_ || (answer.flags & clock_locked) == 0;
  }
  const auto* const end_of = unit.open.begin() + unit.open_count;
  const auto* const found = std::find_if(unit.open.begin(), unit.open.begin() + unit.open_count, [&](const Open& o) {
    return o.id == answer.id && o.heartbeat == (answer.kind == Kind::heartbeat);
  });
  if (found == end_of) return;  // it came late, or twice
  const auto which = static_cast<std::size_t>(found - unit.open.begin());
  const Open one = *found;
  if (one.heartbeat) return end(take_out(unit, which), true);
  if (protocol_->counts_frames && answer.sequence != one.sequence) {
    // A frame before it was lost, so it was not carried out.
    for (std::size_t i = 0; i < unit.open_count; ++i)
      unit.open[i].due_s = now_s;
    return resend(unit, now_s);
  }
  const Command command = rounds_[one.round].frames[number].command();
  if (answer.status == status_sync_missed && command == Command::synchronize) {
    unit.open[which].due_s = now_s + answer_s;
    return;
  }
  if (answer.status != status_ok && step_ != Step::stop)
    return fail(now_s, "unit {} refuses command {:02x}: {} (status {:02x})", number, static_cast<int>(command),
                frame_status(answer.status), answer.status);
  if (command == Command::read_counters) unit.late = parse_late(answer, *protocol_).value_or(0);
  if (command == Command::read_state && !answer.data.empty() && (answer.data[0] & state_failsafe) != 0 && playing &&
      !protocol_->failsafe_flag)
    return fail(now_s, "unit {} has fallen silent: its failsafe has shut", number);
  if (protocol_->counts_frames) {  // so it has carried out those before it, whose answers were lost
    for (std::size_t i = 0; i < unit.open_count && unit.open[i].id != one.id;) {
      if (unit.open[i].heartbeat) {
        ++i;
      } else {
        end(take_out(unit, i), true);
      }
    }
  }
  for (std::size_t i = 0; i < unit.open_count; ++i) {
    if (unit.open[i].id == one.id) return end(take_out(unit, i), true);
  }
}

void Units::look_at_units(double now_s) {
  for (Unit& unit : units_) {
    if (unit.unanswered_s != 0 && unit.repeats >= least_repeats && now_s - unit.unanswered_s > silent_s)
      return fail(now_s, "unit {} does not answer any more", number_of(unit));
    resend(unit, now_s);
    if (unit.open_count == 0 && now_s - unit.sent_s >= heartbeat_s) beat(unit, now_s);
  }
  if (step_ != Step::ready || !takes()) return;
  if (unlocked_ && std::ranges::all_of(units_, [](const Unit& u) { return (u.flags & all_ready) == all_ready; })) {
    unlocked_ = false;
    for (Datagram& frame : frames())
      put_command(frame, *protocol_, Command::synchronize);
    send(Round::setting, 0, now_s);
  }
}

void Units::follow_clock(std::uint64_t unit_ns, double now_s) {
  // The way of an answer makes a clock seem late, never early.
  const double ahead_s = 1e-9 * static_cast<double>(unit_ns) - now_s;
  const double before_s = clock_ahead_s_ - drift * (now_s - clock_seen_s_);
  clock_ahead_s_ = clock_known_ ? std::max(before_s, ahead_s) : ahead_s;
  clock_seen_s_ = now_s;
  clock_known_ = true;
}

std::uint32_t Units::late() const {
  std::uint32_t all = 0;
  for (const Unit& unit : units_)
    all += unit.late;
  return all;
}

// ---- both ----------------------------------------------------------------------------------------------------------

void Units::pump(double now_s) {
  constexpr int most_reads = 256;  // then the caller has its turn
  Endpoint from;
  for (int reads = 0; reads < most_reads; ++reads) {
    const std::optional<std::size_t> size = cable_.receive(incoming_, from);
    if (!size) break;
    const auto answer = parse_answer(std::span(incoming_).first(std::min(*size, incoming_.size())));
    if (!answer || !cable_.may_come_from(from)) {
      ++strange_;
      continue;
    }
    take(*answer, from, now_s);
  }
  const bool paused = now_s - std::exchange(pumped_s_, now_s) > gap_s;
  if (paused && ready() && !protocol_->failsafe_flag && takes()) {
    for (Datagram& frame : frames())
      put_command(frame, *protocol_, Command::read_state);
    send(Round::setting, 0, now_s);
  }
  go_on(now_s);
}

/// After a fault. Units that can be reached are silenced, whatever they play and whatever waits in their queues.
void Units::end_in_silence(double now_s) {
  const bool opening = step_ != Step::ready && step_ != Step::prepare;
  step_ = Step::closed;
  closed_silent_ = false;
  if (opening) return;
  for (Unit& unit : units_)
    unit.open_count = 0;
  for (Sent& round : rounds_)
    round.waits = 0;
  step_ = Step::stop;
  entered_s_ = now_s;
  if (protocol_->counts_frames) {
    for (Unit& unit : units_)
      reset(unit, now_s);
  }
  for (Datagram& frame : frames())
    put_command(frame, *protocol_, Command::clear);
  send(Round::pattern, 0, now_s);
}

}  // namespace palpa::driver::autd3_udp
