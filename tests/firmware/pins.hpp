// The shift registers behind a board, 32 times 74HC595, and what their 256 outputs do, as runs of equal periods.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace palpa::firmware {

/// Times in quarters of a femtosecond: the halves of all clocks are whole numbers.
using Time = std::int64_t;
inline constexpr Time nanosecond = 4'000'000, period = 25'000 * nanosecond;
inline double seconds(Time t) {
  return static_cast<double>(t) / (nanosecond * 1e9);
}

[[noreturn]] inline void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::exit(1);
}

/// Output n of each register, QA is 0: a bit for each register.
using Outputs = std::array<std::uint32_t, 8>;

/// A file: f64, by how many seconds the first step of a period is after the period's begin; then for each run of equal
/// periods u64 first period, u64 count, and the outputs at each step. A period is 25 us, counted from time 0.
class Recorder {
 public:
  Recorder(const char* name, unsigned steps) : file_(std::fopen(name, "wb")), steps_(steps), now_(steps), run_(steps) {
    if (!file_) fail("a file of pins cannot be written");
    put(&offset_, sizeof(offset_));
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() {
    write_run();
    offset_ = seconds(offset_time_);
    std::rewind(file_);
    put(&offset_, sizeof(offset_));
    std::fclose(file_);
  }

  /// The outputs from this time on. A step without a change of its own keeps the outputs of the step before.
  void change(Time at, const Outputs& outputs) {
    const Time step = period / steps_;
    const std::int64_t k = at / step;
    offset_time_ = at % step;
    while (next_ < k)
      step_on(last_);
    last_ = outputs;
    if (next_ == k) step_on(outputs);
  }

 private:
  void step_on(const Outputs& outputs) {
    now_[static_cast<std::size_t>(next_ % steps_)] = outputs;
    if (++next_ % steps_ != 0) return;
    if (count_ != 0 && now_ == run_) {
      ++count_;
      return;
    }
    write_run();
    run_ = now_;
    first_ = static_cast<std::uint64_t>(next_ / steps_ - 1);
    count_ = 1;
  }
  void write_run() {
    if (count_ == 0) return;
    put(&first_, sizeof(first_));
    put(&count_, sizeof(count_));
    put(run_.data(), run_.size() * sizeof(Outputs));
  }
  void put(const void* data, std::size_t size) {
    if (std::fwrite(data, 1, size, file_) != size) fail("a file of pins cannot be written");
  }

  std::FILE* file_;
  std::int64_t steps_, next_ = 0;
  std::vector<Outputs> now_, run_;  ///< a period each
  Outputs last_{};
  std::uint64_t first_ = 0, count_ = 0;
  Time offset_time_ = 0;
  double offset_ = 0;
};

/// 32 registers of 8 bits with a common shift clock and a common latch clock.
class Registers {
 public:
  void see(Time at, bool shift, bool latch, std::uint32_t data, Recorder& recorder) {
    if (shift && !shift_) {
      for (std::size_t n = 7; n > 0; --n)
        bits_[n] = bits_[n - 1];
      bits_[0] = data;
    }
    if (latch && !latch_) recorder.change(at, bits_);
    shift_ = shift;
    latch_ = latch;
  }

 private:
  Outputs bits_{};
  bool shift_ = true, latch_ = true;
};

/// A byte on its way to the board, and when the chip or the line has it.
struct Byte {
  double at_s;
  std::uint8_t value;
};
inline std::vector<Byte> read_bytes(const char* name) {
  std::FILE* file = std::fopen(name, "rb");
  if (!file) fail("the file of bytes cannot be read");
  std::vector<Byte> bytes;
  unsigned char record[9];
  while (std::fread(record, 1, sizeof(record), file) == sizeof(record)) {
    Byte& byte = bytes.emplace_back();
    std::memcpy(&byte.at_s, record, sizeof(byte.at_s));
    byte.value = record[8];
  }
  std::fclose(file);
  return bytes;
}

}  // namespace palpa::firmware
