#include "driver/openmpd/connection.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "driver/usb/ftdi.hpp"

namespace palpa::driver::openmpd {
namespace {

namespace ftdi = usb::ftdi;
using usb::Outcome;

bool wanted(std::uint16_t vendor, std::uint16_t product) {
  return vendor == ftdi::vendor && product == ftdi::product_232h;
}

bool is(const usb::Entry& entry, const Address& address) {
  return wanted(entry.vendor, entry.product) && entry.serial == address.serial &&
         (address.place.empty() || entry.place == address.place);
}

std::string name_of(const usb::Entry& entry) {
  return printable(entry.serial.empty() ? "(no serial number)@" + entry.place : entry.serial, 80);
}

/// Throws if there is not exactly one.
usb::Entry find(const usb::Listing& listing, const Address& address) {
  std::vector<usb::Entry> found;
  std::string others, places;
  for (const usb::Entry& entry : listing.entries) {
    if (is(entry, address)) {
      places += (found.empty() ? "" : ",") + entry.serial + "@" + entry.place;
      found.push_back(entry);
    } else if (wanted(entry.vendor, entry.product)) {
      others += (others.empty() ? "" : ", ") + name_of(entry);
    }
  }
  if (found.empty()) {
    std::string there = others.empty() ? "no FT232H is plugged in" : "these are plugged in: " + shortened(others, 200);
    if (!listing.problem.empty()) there += "; " + printable(listing.problem);
    throw failure(fmt::format("no OpenMPD board has the serial number {}: {}", printable(address.text(), 80), there));
  }
  if (found.size() > 1) {
    throw bad_usage(fmt::format("{} boards have the serial number {}: choose one by its USB port: {}", found.size(),
                                printable(address.serial, 80), shortened(places, 200)));
  }
  return found.front();
}

}  // namespace

Connection::Connection(Address address, usb::Transport& transport, const Clock& clock, std::uint8_t divider)
    : address_(std::move(address)), transport_(transport), clock_(clock), divider_(divider) {}

void Connection::open() {
  find_device();
  take_device();
  while (state_ == State::asking)
    ask();
  if (state_ == State::lost) throw failure(fmt::format("board {}: {}", address_.text(), trouble()));
}

void Connection::find_device() {
  usb::Entry entry = find(transport_.list(wanted), address_);
  if (!entry.refusal.empty()) {
    throw failure(
        fmt::format("board {} cannot be opened: {}; palpa doctor says what to do", address_.text(), entry.refusal));
  }
  entry_ = std::move(entry);
}

void Connection::take_device() {
  device_ = transport_.open(entry_, ftdi::endpoint_out);
  state_ = State::asking;
  asked_ = 0;
  halted_ = divider_set_ = false;
}

/// One of the two steps towards a device that is lost.
void Connection::look_for_device() {
  try {
    if (state_ == State::lost) {
      due_s_ = clock_.now_s() + retry_s;
      find_device();
      state_ = State::found;
    } else {
      take_device();
    }
  } catch (const std::exception& error) {  // also without memory: try again later
    lose(error.what());
  }
}

/// For a device that was just opened: asks what it is, then makes it ready. After trouble: only the purges. Then sends
/// the frames that silence the board in any state.
void Connection::ask() {
  if (halted_) {
    halted_ = false;
    device_->clear_halt();
    return;
  }
  if (asked_ == 0) return check_channel();
  const Outcome outcome = device_->request(ftdi::ready_requests[asked_ - 1]);
  if (outcome != Outcome::done) {
    const bool readied = asked_ > ftdi::first_purge;
    if (!readied) return lose(FixedText<80>("cannot be set up: {}", usb::text_of(outcome)).view());
    if (outcome == Outcome::gone || outcome == Outcome::failed) return lose(usb::text_of(outcome));
    return start_over(usb::text_of(outcome));
  }
  if (++asked_ <= ftdi::ready_requests.size()) return;
  std::array<std::uint8_t, 3 * frame_bytes> burst{};
  std::copy(all_off_frame.begin(), all_off_frame.end(), burst.begin() + frame_bytes);
  std::copy(all_off_frame.begin(), all_off_frame.end(), burst.begin() + 2 * frame_bytes);
  state_ = State::flushing;
  begin(burst);
}

void Connection::check_channel() {
  ftdi::Channel channel{};
  const Outcome outcome = ftdi::read_channel(*device_, channel);
  if (outcome != Outcome::done)
    return lose(FixedText<80>("cannot be set up: its EEPROM: {}", usb::text_of(outcome)).view());
  if (entry_.release != ftdi::release_232h || channel != ftdi::Channel::fifo) {
    return lose(
        FixedText<400>("the device at {} is not an OpenMPD board, or is not set up as one: its EEPROM says {}, but a "
                       "board's says 245 FIFO (set it with FTDI's FT_PROG, or give the serial number of the board)",
                       entry_.place, ftdi::text_of(channel))
            .view());
  }
  asked_ = 1;
}

bool Connection::asks() const {
  if (state_ == State::lost) return clock_.now_s() >= due_s_;
  return state_ == State::found || state_ == State::asking;
}

void Connection::hurry() {
  if (state_ == State::lost || state_ == State::draining) due_s_ = clock_.now_s();
}

void Connection::tend() {
  const double now_s = clock_.now_s();
  forgive_absence(now_s);
  if (device_ == nullptr) {
    if (asks()) look_for_device();
    return;
  }
  reap();
  if (device_ == nullptr) return;
  if (flying_ > 0 && state_ != State::draining && now_s - oldest_s() > transfer_patience_s)
    fall_out(Outcome::timed_out);
  switch (state_) {
    case State::asking:
      ask();
      break;
    case State::draining:
      if (flying_ == 0 && now_s >= due_s_) {
        state_ = State::asking;
        asked_ = 1 + ftdi::first_purge;
      } else if (flying_ > 0 && now_s - oldest_s() > 10 * transfer_patience_s) {
        lose("its transfers cannot be cancelled");
      }
      break;
    case State::flushing:
      if (flying_ > 0) break;
      due_s_ = now_s + pause_s;
      state_ = State::pausing;
      break;
    case State::pausing: {
      if (now_s < due_s_) break;
      std::array<std::uint8_t, 2 * frame_bytes> burst{};
      const Frame last = divider_set_ ? all_off_frame : with_divider(all_off_frame, divider_);
      std::copy(last.begin(), last.end(), burst.begin() + frame_bytes);
      state_ = State::ending;
      begin(burst);
      break;
    }
    case State::ending:
      if (flying_ > 0) break;
      divider_set_ = true;
      state_ = State::in_step;
      trouble_.clear();
      break;
    case State::lost:
    case State::found:
    case State::in_step:
      break;
  }
}

void Connection::begin(std::span<const std::uint8_t> bytes, bool sounds) {
  const auto free =
      std::find_if(pending_.begin(), pending_.end(), [](const Pending& pending) { return !pending.flies; });
  std::copy(bytes.begin(), bytes.end(), free->bytes.begin());
  free->length = bytes.size();
  free->sent = 0;
  free->sounds = sounds;
  free->order = ++begun_;
  begun_s_ = clock_.now_s();
  submit(static_cast<unsigned>(free - pending_.begin()));
}

bool Connection::submit(unsigned number) {
  Pending& pending = pending_[number];
  const Outcome outcome = device_->submit(
      number, std::span<const std::uint8_t>(pending.bytes).subspan(pending.sent, pending.length - pending.sent));
  if (outcome != Outcome::done) {
    fall_out(outcome);
    return false;
  }
  if (pending.sent == 0) {
    pending.since_s = clock_.now_s();
    submitted_ += pending.sounds ? 1 : 0;
  }
  pending.flies = true;
  ++flying_;
  return true;
}

void Connection::reap() {
  while (const auto sent = device_->reap()) {
    Pending& pending = pending_[sent->number];
    pending.flies = false;
    --flying_;
    pending.sent += sent->bytes;
    if (pending.sounds && pending.sent == pending.length) ++completed_;
    if (pending.sent == pending.length) note_arrival(pending.length);
    if (state_ == State::draining) continue;
    if (sent->outcome != Outcome::done) {
      fall_out(sent->outcome);
      if (device_ == nullptr) return;
    } else if (pending.sent < pending.length) {
      // The rest of the transfer follows at its byte, unless a later transfer is already on its way or done: they end
      // in any order.
      if (pending.order != begun_) {
        fall_out(Outcome::failed);
      } else if (!submit(sent->number) && device_ == nullptr) {
        return;
      }
    }
  }
}

void Connection::note_arrival(std::size_t bytes) {
  const double frame_s = divider_ * period_s;
  const auto frames = static_cast<double>(bytes) / frame_bytes;
  // A real chip passes on one byte after the other, so all but those that it holds came earlier.
  constexpr double chip_frames = 2;
  const double earlier_s = std::min(frame_s, frame_bytes / chip_bytes_per_s) * std::max(frames - 1 - chip_frames, 0.0);
  drained_s_ = std::max(drained_s_, clock_.now_s() - (device_->is_real() ? earlier_s : 0)) + frames * frame_s;
}

std::size_t Connection::most_queued() const {
  std::size_t bytes = 0;
  for (const Pending& pending : pending_)
    bytes += pending.flies ? pending.length : 0;
  const double left = std::max(drained_s_ - clock_.now_s(), 0.0) / (divider_ * period_s);
  constexpr double rounding = 1e-6;
  return bytes / frame_bytes + static_cast<std::size_t>(std::ceil(left - rounding));
}

void Connection::fall_out(Outcome outcome) {
  halted_ = halted_ || outcome == Outcome::stalled;
  if (outcome == Outcome::gone) return lose(text_of(outcome));
  start_over(outcome == Outcome::timed_out ? "it takes no bytes" : text_of(outcome));
}

void Connection::start_over(std::string_view trouble) {
  // If it falls out of step again during a resynchronisation, wait. Otherwise resynchronisations would follow each
  // other without a pause.
  due_s_ = clock_.now_s() + (state_ == State::in_step ? 0 : retry_s);
  state_ = State::draining;
  if (trouble_.empty()) trouble_.assign(trouble);  // the first trouble is the reason
  if (flying_ > 0) device_->cancel();
}

void Connection::resync() {
  if (state_ == State::in_step) start_over({});
}

void Connection::lose(std::string_view trouble) {
  device_.reset();
  for (Pending& pending : pending_)
    pending.flies = false;
  flying_ = 0;
  state_ = State::lost;
  due_s_ = clock_.now_s() + retry_s;
  trouble_.assign(trouble);
}

bool Connection::takes() const {
  return state_ == State::in_step && flying_ < usb::most_in_flight;
}

void Connection::send(std::span<const Frame> frames, bool sounds) {
  frames_ += frames.size();
  begin({frames.front().data(), frames.size() * frame_bytes}, sounds);
}

void Connection::keep_awake() {
  if (takes() && clock_.now_s() - begun_s_ > idle_s) begin(std::array<std::uint8_t, frame_bytes>{});
}

bool Connection::silenced() const {
  return flying_ == 0 && state_ >= State::flushing;
}

/// Time without calls, because the computer was busy or asleep, does not count against the device.
void Connection::forgive_absence(double now_s) {
  constexpr double usual_s = 0.02;
  const double absent_s = now_s - std::exchange(tended_s_, now_s);
  if (absent_s < usual_s) return;
  for (Pending& pending : pending_)
    pending.since_s += std::min(absent_s, now_s - pending.since_s);
}

double Connection::oldest_s() const {
  double oldest = std::numeric_limits<double>::infinity();
  for (const Pending& pending : pending_) {
    if (pending.flies) oldest = std::min(oldest, pending.since_s);
  }
  return oldest;
}

}  // namespace palpa::driver::openmpd
