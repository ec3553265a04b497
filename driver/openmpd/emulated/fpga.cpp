#include "driver/openmpd/emulated/fpga.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace palpa::driver::openmpd {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::size_t phases = 256;
constexpr std::size_t last_light = 24, lights_apply = 25, first_divider = 26, divider_apply = 34;

std::int64_t nanoseconds(double seconds) {
  return static_cast<std::int64_t>(std::llround(1e9 * seconds));
}

}  // namespace

Fpga::Fpga(emulate::Violations& violations) : violations_(violations) {}

void Fpga::violate(std::int64_t now_ns, const char* what) {
  violations_.add(1e-9 * static_cast<double>(now_ns), what);
}

namespace {

bool any_sounds(const Pulses& pulses) {
  return std::any_of(pulses.begin(), pulses.end(), [](const Pulse& pulse) { return pulse.width % 128 != 0; });
}

}  // namespace

bool Fpga::sounds() const {
  return any_sounds(front_);
}

bool Fpga::sounds_behind() const {
  bool waits = false;
  for (std::size_t i = 0; i < used_; ++i)
    waits = waits || (buffer_[(first_ + i) % buffer_bytes] & 0x7f) != 0;
  return waits || any_sounds(back_);
}

void Fpga::begin_resync(double now_s) {
  advance(now_s);
  resyncing_ = true;
  resync_from_ns_ = now_ns_;
  sounding_frames_ = 0;
  left_ = used_;
  frames_in_step_ = 0;
}

std::size_t Fpga::take(double now_s, std::span<const std::uint8_t> bytes) {
  advance(now_s);
  std::size_t taken = 0;
  while (taken < bytes.size() && used_ < stop_bytes) {
    buffer_[(first_ + used_) % buffer_bytes] = bytes[taken++];
    ++used_;
    most_used_ = std::max(most_used_, used_);
    if (used_ >= block_bytes && reader_ == Reader::idle) read_block(now_ns_);
  }
  return taken;
}

void Fpga::advance(double now_s) {
  step_to(std::max(now_ns_, nanoseconds(now_s)));
}

/// Goes from event to event: the end of the start, a block that is due, a clear of the buffer.
void Fpga::step_to(std::int64_t now_ns) {
  constexpr auto never = std::numeric_limits<std::int64_t>::max();
  for (;;) {
    const std::int64_t start = reader_ == Reader::starting ? second_ns : never;
    const std::int64_t edge = reader_ == Reader::counting ? next_edge_ns_ : never;
    const std::int64_t clear = used_ < block_bytes ? below_since_ns_ + second_ns : never;
    const std::int64_t next = std::min({start, edge, clear});
    if (next > now_ns) break;
    now_ns_ = next;
    if (next == start) {
      reader_ = Reader::idle;
      parse(0x80, next);
      for (std::size_t i = 1; i < block_bytes; ++i)
        parse(0, next);
      swapping_ = false;
      if (used_ >= block_bytes) read_block(next);
    } else if (next == edge) {
      reader_ = Reader::idle;
      if (used_ >= block_bytes) read_block(next);
    } else {
      if (used_ > 0) {
        ++clears_;
        if (!resyncing_) violate(next, "a part of a frame lay in the buffer for a second and was dropped");
      }
      used_ = left_ = 0;
      below_since_ns_ = next;
    }
  }
  now_ns_ = std::max(now_ns_, now_ns);
}

void Fpga::read_block(std::int64_t now_ns) {
  for (std::size_t i = 0; i < block_bytes; ++i) {
    const std::uint8_t byte = buffer_[first_];
    first_ = (first_ + 1) % buffer_bytes;
    parse(byte, now_ns);
  }
  if (swapping_ && now_ns >= resync_from_ns_ + second_ns) resyncing_ = false;
  swapping_ = false;  // a swap at the block's end is over before the next block comes
  used_ -= block_bytes;
  left_ -= std::min(left_, block_bytes);
  if (used_ < block_bytes) below_since_ns_ = now_ns;
  reader_ = Reader::counting;
  next_edge_ns_ = (now_ns / period_ns + divider()) * period_ns;
}

void Fpga::parse(std::uint8_t byte, std::int64_t now_ns) {
  const bool bit = (byte & 0x80) != 0;
  if (swapping_) {
    swapping_ = false;
    if (!resyncing_) violate(now_ns, "a byte came in the clock of a swap and was lost: frames are out of step");
    return;
  }
  if (at_ == 0 && !bit) {
    if (!resyncing_ && byte != 0) violate(now_ns, "a byte that belongs to no frame: frames are out of step");
    return;
  }
  if (at_ < phases) {
    back_[at_].phase = byte & 0x7f;
    if (at_ > 0 && at_ <= last_light && bit) violate(now_ns, "a frame sets a light");
    if (at_ == lights_apply && bit) violate(now_ns, "a frame switches lights");
    if (at_ >= first_divider && at_ < divider_apply) {
      const unsigned mask = 1u << (at_ - first_divider);
      divider_bits_ = static_cast<std::uint8_t>(bit ? divider_bits_ | mask : divider_bits_ & ~mask);
    }
    if (at_ == divider_apply) {
      if (bit) {
        divider_ = divider_bits_;
        ++dividers_set_;
      } else if (divider_bits_ != 0 && !resyncing_) {
        violate(now_ns, "a frame has bits of the divider but does not set it");
      }
    }
    if (at_ > divider_apply && bit) violate(now_ns, "a phase of more than 127");
  } else {
    const unsigned width = byte & 0x7f;
    if (bit) violate(now_ns, "an amplitude with bit 7");
    if (width > 64) violate(now_ns, "a pulse longer than half a period");
    back_[at_ - phases].width = static_cast<std::uint8_t>(width);
  }
  if (++at_ == block_bytes) finish_frame(now_ns);
}

void Fpga::finish_frame(std::int64_t now_ns) {
  at_ = 0;
  swapping_ = true;
  front_ = back_;
  ++frames_;
  if (!resyncing_) ++frames_in_step_;
  if (resyncing_ && left_ == 0 && sounds() && ++sounding_frames_ == 2)
    violate(now_ns, "sound before the board was resynchronised");
  const std::int64_t edge_ns = (now_ns / period_ns + 1) * period_ns;
  shown_s_ = 1e-9 * static_cast<double>(edge_ns);
  if (shown_) shown_(shown_s_, front_);
}

}  // namespace palpa::driver::openmpd
