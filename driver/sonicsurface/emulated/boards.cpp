#include "driver/sonicsurface/emulated/boards.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpa::driver::sonicsurface {
namespace {

// Written down independently of the encoder's numbers.
constexpr std::uint8_t phases_follow = 0xfe, exchange = 0xfd, stop_shifting = 150, start_shifting = 151,
                       first_board = 192, second_board = 193, no_sound = 0x20;

/// The transducer that a slot on the wire drives: columns in fours, rows in pairs, and a fixed order within these.
std::size_t transducer_at(std::size_t slot) {
  // (column, row) of the eight places of four columns and two rows.
  constexpr std::array<std::array<std::size_t, 2>, 8> inside{
      {{0, 0}, {2, 0}, {3, 0}, {1, 1}, {0, 1}, {3, 1}, {2, 1}, {1, 0}}};
  const auto& place = inside[slot & 7];
  const std::size_t column = 4 * (slot >> 6) + place[0], row = 2 * ((slot >> 3) & 7) + place[1];
  return 16 * row + column;
}

bool quiet(std::span<const std::uint8_t> buffer) {
  return std::all_of(buffer.begin(), buffer.end(), [](std::uint8_t phase) { return phase == no_sound; });
}

}  // namespace

EmulatedBoards::EmulatedBoards(std::size_t boards, bool tactile) : tactile_(tactile), boards_(boards) {}

void EmulatedBoards::set_baud(double now_s, double baud) {
  constexpr double own = 227556, tolerance = 0.03;
  if (std::abs(baud - own) > tolerance * own)
    violations_.add(now_s, fmt::format("the line runs at {} baud, the board at {}", baud, own));
}

void EmulatedBoards::take(double now_s, std::span<const std::uint8_t> bytes) {
  now_s_ = now_s;
  for (const std::uint8_t byte : bytes)
    take_byte(byte);
}

void EmulatedBoards::take_byte(std::uint8_t byte) {
  ++bytes_;
  if (byte == phases_follow) {
    for (Board& board : boards_) {
      if (!board.selected) continue;
      board.counter = board.written = 0;
    }
  } else if (byte == exchange) {
    ++swaps_;
    for (Board& board : boards_) {
      if (board.written != 0 && board.written != slots)
        violations_.add(now_s_, fmt::format("a swap after {} phases", board.written));
      board.front ^= 1;
      board.counter = board.written = 0;
    }
  } else if (!tactile_ && (byte == first_board || byte == second_board)) {
    for (std::size_t i = 0; i < boards_.size(); ++i)
      boards_[i].selected = (i == 0) == (byte == first_board);
  } else if (!tactile_ && (byte == stop_shifting || byte == start_shifting)) {
    violations_.add(now_s_, fmt::format("command {}, which must not be sent", byte));
  } else if (tactile_ && (byte >> 5) == 5) {
    violations_.add(now_s_, fmt::format("0x{:02x} sets the speed of the modulation", byte));
  } else {
    for (Board& board : boards_) {
      if (board.selected) take_phase(board, byte);
    }
  }
}

void EmulatedBoards::take_phase(Board& board, std::uint8_t byte) {
  if (byte > no_sound) violations_.add(now_s_, fmt::format("phase {} is out of range", byte));
  if (tactile_ && byte < no_sound && byte % 2 != 0)
    violations_.add(now_s_, fmt::format("phase {}, whose last bit is dropped", byte));
  if (board.counter >= slots) {
    violations_.add(now_s_, "more phases than slots");
    board.counter = 0;
  }
  board.buffers[board.front ^ 1][board.counter++] = byte == no_sound ? no_sound : byte & 0x1f;
  ++board.written;
}

int EmulatedBoards::sounding(std::size_t board, std::size_t transducer) const {
  const Board& one = boards_[board];
  for (std::size_t slot = 0; slot < slots; ++slot) {
    if (transducer_at(slot) != transducer) continue;
    const std::uint8_t phase = one.buffers[one.front][slot];
    return phase == no_sound ? silent : phase;
  }
  return silent;
}

double EmulatedBoards::late_periods(std::size_t board, std::size_t transducer) const {
  std::size_t slot = 0;
  while (transducer_at(slot) != transducer)
    ++slot;
  const double step = tactile_ ? 1.0 / 16 : 1.0 / 32;
  return (slot % 8 == 3 ? step : 0) + (board > 0 ? 12.92 / 25 : 0);
}

bool EmulatedBoards::all_silent() const {
  return std::all_of(boards_.begin(), boards_.end(), [](const Board& b) { return quiet(b.buffers[b.front]); });
}

bool EmulatedBoards::all_silent_behind() const {
  return std::all_of(boards_.begin(), boards_.end(), [](const Board& b) { return quiet(b.buffers[b.front ^ 1]); });
}

}  // namespace palpa::driver::sonicsurface
