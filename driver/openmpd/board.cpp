#include "driver/openmpd/board.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "driver/fixed_text.hpp"
#include "driver/lag.hpp"
#include "driver/usb/system.hpp"
#include "session/links/hand_over.hpp"

namespace palpa::driver::openmpd {
namespace {

constexpr std::uint8_t default_divider = 4;
constexpr double opening_patience_s = 5;
/// At the end: longer than the waits for a stuck transfer, the purge after it and a request, one after the other.
constexpr double closing_patience_s = 0.75, flight_patience_s = 0.1;
constexpr double asking_s = 2e-3;

/// Formats without allocating. Text that is too long is cut.
template <typename... Args>
void note(BoardNotes& notes, void (BoardNotes::*level)(std::string_view) noexcept, fmt::format_string<Args...> text,
          Args&&... args) {
  (notes.*level)(FixedText<500>(text, std::forward<Args>(args)...).view());
}

void check_layout(const array::Layout& layout, std::size_t addresses) {
  std::size_t next = 0;
  for (const array::Board& board : layout.boards) {
    if (board.type != "openmpd" || board.first != next) break;
    next += board.count;
  }
  if (next != layout.transducers.size()) {
    throw bad_usage(
        fmt::format("the layout {} does not consist of OpenMPD boards only: give --layout openmpd, openmpd-pair or one "
                    "whose units are all of type openmpd",
                    layout.name));
  }
  if (layout.boards.size() != addresses) {
    throw bad_usage(
        fmt::format("the layout {} has {} OpenMPD boards, but {} serial numbers are given: give one for each board, in "
                    "the layout's order",
                    layout.name, layout.boards.size(), addresses));
  }
}

}  // namespace

Boards parse_boards(std::string argument) {
  Boards boards{.addresses = {}, .lag = take_lag(argument)};
  std::vector<Address>& addresses = boards.addresses;
  for (std::size_t at = 0; at <= argument.size();) {
    const std::size_t comma = std::min(argument.find(',', at), argument.size());
    const std::string one = argument.substr(at, comma - at);
    const std::size_t sign = one.rfind('@');
    Address address{one.substr(0, sign), sign == std::string::npos ? "" : one.substr(sign + 1)};
    if (address.serial.empty() || (sign != std::string::npos && address.place.empty())) {
      throw bad_usage(
          "link openmpd needs the boards' serial numbers, openmpd:SERIAL[,SERIAL...], or SERIAL@BUS-PORT if several "
          "boards have the same one");
    }
    for (const Address& other : addresses) {
      if (other.text() == address.text()) {
        throw bad_usage(fmt::format("link openmpd names the board {} twice", printable(address.text(), 80)));
      }
    }
    addresses.push_back(std::move(address));
    at = comma + 1;
  }
  refuse_lag_of_one(boards.lag, addresses.size());
  return boards;
}

std::vector<float> factors_of(const BoardSpec& spec) {
  if (spec.files.empty()) return {};
  const std::vector<BoardFile> files = read_board_files(spec.files);
  std::vector<float> factors;
  for (const Address& address : parse_boards(spec.argument).addresses) {
    const Calibration calibration = calibration_of(files, address.serial);
    factors.insert(factors.end(), calibration.factors.begin(), calibration.factors.end());
  }
  if (factors.size() != spec.layout.transducers.size()) return {};  // the board refuses that layout
  const bool alike = std::ranges::all_of(factors, [](float factor) { return factor == 1; });
  return alike ? std::vector<float>() : factors;
}

std::uint8_t divider_for(double slot_s) {
  const double most = std::floor(slot_s / 2 / period_s + 1e-9);
  if (most < 1) {
    throw bad_usage(
        fmt::format("OpenMPD boards take at most one frame every 0.025 ms, and a slot must last two frames: a dwell of "
                    "{} ms is shorter than 0.05 ms",
                    1e3 * slot_s));
  }
  return static_cast<std::uint8_t>(std::min<double>(most, default_divider));
}

OpenMpdBoard::OpenMpdBoard(const BoardSpec& spec, BoardNotes& notes, usb::Transport& transport, Clock& clock)
    : notes_(notes), clock_(clock) {
  const auto [addresses, lag] = parse_boards(spec.argument);
  check_layout(spec.layout, addresses.size());
  const std::uint8_t divider = divider_for(spec.slot_s);
  const double chip_need = frame_bytes / spec.slot_s;
  if (chip_need > chip_bytes_per_s) {
    throw bad_usage(
        fmt::format("a board needs {:.1f} MB/s at a dwell of {} ms, but an FT232H carries {:.0f}: use a longer --dwell",
                    1e-6 * chip_need, 1e3 * spec.slot_s, 1e-6 * chip_bytes_per_s));
  }
  std::vector<BoardFile> files;
  if (!spec.files.empty()) files = read_board_files(spec.files);
  next_.assign(addresses.size(), all_off_frame);
  silences_.assign(addresses.size(), 0);
  encoders_.reserve(addresses.size());
  wires_.reserve(addresses.size());
  for (const Address& address : addresses) {
    const auto named = [&](const BoardFile& file) { return file.serial == address.serial; };
    const bool has_file = std::any_of(files.begin(), files.end(), named);
    const double usual_lag = has_file ? 0 : array::find_board_type("openmpd")->follower_lag;
    encoders_.emplace_back(calibration_of(files, address.serial), encoders_.empty() ? 0 : lag.value_or(usual_lag));
    if (&address != &addresses.front() && !has_file && !lag) {
      note(notes_, &BoardNotes::info,
           "board {} has no file, so it is sent its phases {:g} periods earlier than the master {}, as its firmware's "
           "source asks for; to change it, add ,lag= to the link",
           address.serial, usual_lag, addresses.front().serial);
    }
    if (!files.empty() && !has_file) {
      note(notes_, &BoardNotes::warning, "no file in {} belongs to board {}, so it plays without calibration",
           spec.files, address.serial);
    }
    wires_.push_back(std::make_unique<Connection>(address, transport, clock, divider));
  }
  for (const auto& wire : wires_)
    wire->open();
  choose_steps(spec, divider * period_s);
  watched_.reserve(wires_.size());
  newest_.resize(spec.layout.transducers.size());
  sounding_.resize(newest_.size());
  const double begin_s = clock_.now_s();
  while (!in_step()) {
    clock_.sleep_s(1e-3);
    for (const auto& wire : wires_) {
      wire->tend();
      if (!wire->trouble().empty() && !wire->in_step()) {
        throw failure(fmt::format("board {} does not come up: {}", wire->address().text(), wire->trouble()));
      }
    }
    if (clock_.now_s() > begin_s + opening_patience_s) throw failure("the boards do not come up: they take no bytes");
  }
  sent_s_ = clock_.now_s();
}

OpenMpdBoard::Bandwidth OpenMpdBoard::check_bandwidth(double slot_s) const {
  double frames = chip_bytes_per_s * slot_s / frame_bytes;
  std::map<unsigned, unsigned> boards_of_bus;
  unsigned most_boards = 1;
  for (const auto& wire : wires_)
    most_boards = std::max(most_boards, ++boards_of_bus[wire->bus()]);
  for (const auto& [bus, boards] : boards_of_bus) {
    const double need = boards * frame_bytes / slot_s;
    if (need > bus_bytes_per_s) {
      throw bad_usage(
          fmt::format("{} boards on bus {} need {:.1f} MB/s at a dwell of {} ms, but a USB 2 bus carries {:.0f}: use a "
                      "dwell of at least {:.3f} ms, or more USB controllers",
                      boards, bus, 1e-6 * need, 1e3 * slot_s, 1e-6 * bus_bytes_per_s,
                      1e3 * boards * frame_bytes / bus_bytes_per_s));
    }
    frames = std::min(frames, bus_bytes_per_s / need);
  }
  return {static_cast<std::size_t>(std::max(frames, 1.0)), most_boards};
}

void OpenMpdBoard::choose_steps(const BoardSpec& spec, double frame_s) {
  const Bandwidth bandwidth = check_bandwidth(spec.slot_s);
  const auto frames_of = [&](double seconds) { return static_cast<std::size_t>(seconds / frame_s + 1e-9); };
  const array::BoardType* const type = array::find_board_type("openmpd");
  const array::ChangeSetting setting{
      .slot_s = spec.slot_s, .boards_of_bus = bandwidth.boards_of_bus, .steps = spec.steps, .nulls = spec.nulls};
  const std::string why = array::why_fewer_steps(type, setting);
  if (!why.empty()) note(notes_, &BoardNotes::warning, "{}", why);
  if (spec.nulls) return;
  if (!spec.steps) {
    constexpr std::size_t most_of_a_ramp = 8;
    const std::size_t wanted = frames_of(std::min(spec.ramp_s, spec.slot_s / 2));
    steps_ = std::clamp<std::size_t>(wanted, 1, std::min(bandwidth.frames, most_of_a_ramp));
    return;
  }
  steps_ = std::min<std::size_t>(array::changes_of(type, setting).phase_steps, Connection::most_frames);
  if (steps_ > 1) queue_ = std::min(frames_of(spec.slot_s), most_queued);
}

/// How many frames of the next drive all boards can be sent now.
std::size_t OpenMpdBoard::room() const {
  std::size_t room = steps_;
  for (const auto& wire : wires_) {
    if (!wire->takes()) return 0;
    if (queue_ > 0) room = std::min(room, queue_ - std::min(queue_, wire->most_queued()));
  }
  return room;
}

std::span<const pollfd> OpenMpdBoard::watched() {
  watched_.clear();
  if (queue_ == 0) return {};
  for (const auto& wire : wires_) {
    if (const pollfd one = wire->watched(); one.fd >= 0) watched_.push_back(one);
  }
  return watched_;
}

bool OpenMpdBoard::in_step() const {
  return std::all_of(wires_.begin(), wires_.end(), [](const auto& wire) { return wire->in_step(); });
}

void OpenMpdBoard::play(std::uint64_t, std::span<const array::TransducerDrive> drive) {
  for (std::size_t i = 0; i < wires_.size(); ++i)
    encoders_[i].encode(drive.subspan(i * transducers, transducers), next_[i]);
  if (steps_ > 1) std::copy(drive.begin(), drive.end(), newest_.begin());
  waits_ = true;
  const auto off = [](const Frame& frame) { return frame == all_off_frame; };
  if (std::all_of(next_.begin(), next_.end(), off)) begin_silence();
  tend_wires();
  send_next();
}

void OpenMpdBoard::all_off() {
  begin_silence();
  tend_wires();
  send_next();
}

void OpenMpdBoard::begin_silence() {
  waits_ = false;
  std::fill(sounding_.begin(), sounding_.end(), array::TransducerDrive{0.0f, 0.0f});
  // If a board is still waiting for its last all-off frame, nothing has been played since.
  if (send_silences()) std::fill(silences_.begin(), silences_.end(), std::uint8_t{1});
}

void OpenMpdBoard::tend() {
  tend_wires();
  if (!in_step()) {
    for (const auto& wire : wires_)
      wire->keep_awake();
  }
  if (!waits_ && silent_ && clock_.now_s() > sent_s_ + quiet_s) begin_silence();
  send_next();
}

/// Sends the all-off frame to the boards that take it. Returns false if some do not.
bool OpenMpdBoard::send_silences() {
  bool all = true;
  for (std::size_t i = 0; i < wires_.size(); ++i) {
    if (silences_[i] == 0) continue;
    if (!wires_[i]->takes()) {
      all = false;
      continue;
    }
    wires_[i]->send({&all_off_frame, 1});
    silences_[i] = 0;
    silent_ = true;
    sent_s_ = clock_.now_s();
  }
  return all;
}

/// Sends a drive to all boards or to none, so that they get the same number of frames.
void OpenMpdBoard::send_next() {
  if (!in_step()) {  // boards on their way back into step are silent, while drives go on coming
    waits_ = false;
    std::fill(silences_.begin(), silences_.end(), std::uint8_t{0});
    std::fill(sounding_.begin(), sounding_.end(), array::TransducerDrive{0.0f, 0.0f});
    return;
  }
  if (!send_silences() || !waits_) return;
  const std::size_t count = room();
  if (count == 0) return;
  for (std::size_t i = 0; i < wires_.size(); ++i)
    send_steps(i, count);
  if (steps_ > 1) std::swap(sounding_, newest_);
  waits_ = silent_ = false;
  sent_s_ = clock_.now_s();
}

/// Sends the last `count` steps of the drive.
void OpenMpdBoard::send_steps(std::size_t board, std::size_t count) {
  std::array<Frame, Connection::most_frames> frames;
  std::array<array::TransducerDrive, transducers> between, begin;
  std::array<float, transducers> ways;
  const auto to = std::span(newest_).subspan(board * transducers, transducers);
  for (std::size_t t = 0; count > 1 && t < transducers; ++t) {
    const array::TransducerDrive from = sounding_[board * transducers + t];
    const bool turns = from.amplitude != 0 && to[t].amplitude != 0;
    ways[t] = turns ? std::remainder(to[t].phase - from.phase, 2 * std::numbers::pi_v<float>) : 0.0f;
    begin[t] = {from.amplitude, from.amplitude == 0 ? to[t].phase : from.phase};
  }
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const float part = static_cast<float>(steps_ - count + 1 + i) / static_cast<float>(steps_);
    for (std::size_t t = 0; t < transducers; ++t)
      between[t] = {std::lerp(begin[t].amplitude, to[t].amplitude, part), begin[t].phase + ways[t] * part};
    encoders_[board].encode(between, frames[i]);
  }
  frames[count - 1] = next_[board];
  wires_[board]->send(std::span(frames).first(count), true);
}

/// A drive has got as far as on the slowest board.
BoardCounts OpenMpdBoard::counts() const {
  const auto least = [&](std::uint64_t (Connection::*count)() const) {
    std::uint64_t fewest = (*wires_.front().*count)();
    for (const auto& wire : wires_)
      fewest = std::min(fewest, (*wire.*count)());
    return fewest;
  };
  return {.submitted = {.drives = least(&Connection::submitted)},
          .completed = {.drives = least(&Connection::completed)},
          .out_of_reach = troubled_};
}

void OpenMpdBoard::tend_wires(bool may_ask) {
  for (const auto& wire : wires_) {
    if (!wire->asks()) wire->tend();
  }
  // A device that does not answer holds up its caller. Healthy devices therefore come first, and the others take turns,
  // one each time.
  const double until_s = clock_.now_s() + (may_ask ? asking_s : 0);
  const auto ask = [&](Connection& wire) {
    while (wire.asks() && clock_.now_s() < until_s)
      wire.tend();
  };
  for (const auto& wire : wires_) {
    if (wire->trouble().empty()) ask(*wire);
  }
  for (std::size_t i = 0; i < wires_.size() && clock_.now_s() < until_s; ++i) {
    asker_ = (asker_ + 1) % wires_.size();
    ask(*wires_[asker_]);
  }
  if (in_step() == !troubled_) return;
  tell();
}

/// Reports a change for the worse or the better.
void OpenMpdBoard::tell() {
  if (!troubled_) {
    troubled_ = silent_ = true;
    troubled_s_ = clock_.now_s();
    for (const auto& wire : wires_) {
      if (!wire->in_step()) {
        note(notes_, &BoardNotes::warning, "board {}: {}; it may still sound until it is in step again{}",
             wire->address().text(), wire->trouble(), wires_.size() > 1 ? ", and the others are silent" : "");
      }
    }
    // The others are silenced in the same way, so that all have had the same number of frames as the lost one when they
    // play again.
    for (const auto& wire : wires_)
      wire->resync();
  } else {
    troubled_ = false;
    sent_s_ = clock_.now_s();
    note(notes_, &BoardNotes::warning, "all boards are in step again after {:.1f} s and continue to play",
         sent_s_ - troubled_s_);
  }
}

bool OpenMpdBoard::healthy_wire_flies() const {
  return std::any_of(wires_.begin(), wires_.end(),
                     [](const auto& wire) { return wire->trouble().empty() && !wire->settled(); });
}

bool OpenMpdBoard::close() {
  const auto silenced = [&] {
    return !waits_ && send_silences() &&
           std::all_of(wires_.begin(), wires_.end(), [](const auto& wire) { return wire->silenced(); });
  };
  for (const auto& wire : wires_)
    wire->hurry();
  for (const double begin_s = clock_.now_s();;) {
    // The wait for the last request must also fit into the patience.
    tend_wires(clock_.now_s() - begin_s < closing_patience_s - usb::request_patience_s);
    send_next();
    if (silenced()) return true;
    const double waited_s = clock_.now_s() - begin_s;
    // A board in trouble is given up, but not the bytes that others are still taking.
    if (waited_s > closing_patience_s + (healthy_wire_flies() ? flight_patience_s : 0)) return false;
    clock_.sleep_s(5e-4);
  }
}

namespace {

/// A board together with its transport.
class OpenBoard final : public Board {
 public:
  OpenBoard(const BoardSpec& spec, BoardNotes& notes) : board_(spec, notes, *transport_, steady_clock()) {}
  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override { board_.play(slot, drive); }
  void all_off() override { board_.all_off(); }
  void tend() override { board_.tend(); }
  bool close() override { return board_.close(); }
  BoardCounts counts() const override { return board_.counts(); }
  std::span<const pollfd> watched() override { return board_.watched(); }

 private:
  std::unique_ptr<usb::Transport> transport_ = usb::system_transport();
  OpenMpdBoard board_;
};

}  // namespace

BoardKind board_kind() {
  return {"openmpd",
          "openmpd:SERIAL[,SERIAL...][,lag=PERIODS]  OpenMPD boards on USB, by the layout's order; SERIAL@BUS-PORT "
          "where several share a "
          "serial number",
          [](const BoardSpec& spec, BoardNotes& notes) { return std::make_unique<OpenBoard>(spec, notes); },
          false,
          true,
          [](const std::string& argument) -> std::string {
            const std::size_t boards = parse_boards(argument).addresses.size();
            return boards == 1 ? "openmpd" : boards == 2 ? "openmpd-pair" : "";
          },
          {},
          true,
          factors_of};
}

}  // namespace palpa::driver::openmpd
