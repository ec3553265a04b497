#include "driver/sonicsurface/wire.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

namespace palpa::driver::sonicsurface {

Encoder::Encoder(std::size_t boards, Firmware firmware, std::vector<float> degrees, double lag)
    : boards_(boards), firmware_(firmware), degrees_(std::move(degrees)), lag_(lag) {
  degrees_.resize(boards * transducers);
}

std::uint8_t Encoder::phase_of(std::size_t transducer, float phase) const {
  const int steps = firmware_ == Firmware::plain ? 32 : 16;
  const double lag = transducer < transducers ? 0 : lag_;
  const double turns = phase / (2 * std::numbers::pi) - degrees_[transducer] / 360.0 - lag;
  // The outputs of these slots come a step late.
  const int late = slot_of(transducer % transducers) % 8 == 3 ? 1 : 0;
  const int step = (static_cast<int>(std::floor(steps * (turns - std::floor(turns)) + 0.5)) + steps - late) % steps;
  return static_cast<std::uint8_t>(step * (32 / steps));
}

template <typename Phase>
void Encoder::write(std::span<std::uint8_t> frame, const Phase& phase) const {
  std::size_t at = 0;
  for (std::size_t board = 0; board < boards_; ++board) {
    if (boards_ > 1) frame[at++] = board == 0 ? primary : secondary;
    frame[at++] = begin;
    for (std::size_t t = 0; t < transducers; ++t)
      frame[at + slot_of(t)] = phase(board * transducers + t);
    at += transducers;
  }
  frame[at] = swap;
}

void Encoder::encode(std::span<const array::TransducerDrive> drive, std::span<std::uint8_t> frame) const {
  write(frame, [&](std::size_t t) { return drive[t].amplitude > 0 ? phase_of(t, drive[t].phase) : off; });
}

/// Adds all off for both buffers of the boards, which are selected one after the other.
void Encoder::add_off(std::vector<std::uint8_t>& bytes, std::initializer_list<std::uint8_t> selections) const {
  for (int times = 0; times < 2; ++times) {
    for (const std::uint8_t selection : selections) {
      if (firmware_ == Firmware::plain) bytes.push_back(selection);
      bytes.push_back(begin);
      bytes.insert(bytes.end(), transducers, off);
    }
    bytes.push_back(swap);
  }
}

std::vector<std::uint8_t> Encoder::own_off() const {
  std::vector<std::uint8_t> bytes;
  if (boards_ == 2)
    add_off(bytes, {secondary, primary});
  else
    add_off(bytes, {primary});
  return bytes;
}

std::vector<std::uint8_t> Encoder::all_off() const {
  std::vector<std::uint8_t> bytes = own_off();  // first, so that no later swap makes them sound
  if (firmware_ != Firmware::plain) return bytes;
  if (boards_ == 1) add_off(bytes, {secondary});
  // The tactile firmware takes a selection as a phase, which would wait in its hidden buffer. It is overwritten there.
  bytes.insert(bytes.end(), {primary, begin, off});
  return bytes;
}

}  // namespace palpa::driver::sonicsurface
