// sonicsurface SECONDS BYTES PINS [PINS OF A SECONDARY]: SonicSurface's firmware on the bytes of a serial line.
//
// MODEL is the board that has the line: V_primary or V_tactile. With PAIR, a V_secondary is connected to it by the two
// wires of the makers' page. Its clock is not in step with the first board's.
#include <algorithm>
#include <cstdlib>
#include <memory>

#include "pins.hpp"

#define STRING(name) #name
#define HEADER(name) STRING(name.h)
#include HEADER(MODEL)
#ifdef PAIR
#include "V_secondary.h"
#endif

namespace palpa::firmware {
namespace {

/// 8N1: a start bit, the lowest bit first, a stop bit. A byte begins when it is there and the one before has ended.
class Line {
 public:
  Line(const std::vector<Byte>& bytes, double baud) : bytes_(bytes), bit_s_(1 / baud) {}
  bool level(double now_s) {
    while (next_ < bytes_.size() && now_s >= end_s_ && now_s >= bytes_[next_].at_s) {
      begin_s_ = std::max(end_s_, bytes_[next_].at_s);
      end_s_ = begin_s_ + 10 * bit_s_;
      value_ = 0x200u | (static_cast<unsigned>(bytes_[next_++].value) << 1);
    }
    if (now_s >= end_s_) return true;
    return ((value_ >> static_cast<unsigned>((now_s - begin_s_) / bit_s_)) & 1) != 0;
  }

 private:
  const std::vector<Byte>& bytes_;
  double bit_s_, begin_s_ = 0, end_s_ = 0;
  unsigned value_ = 0x3ff;
  std::size_t next_ = 0;
};

template <typename Model>
struct Board {
  Board(const char* pins, Time half, Time begin) : recorder(pins, PERIOD_CLOCKS / 8), half(half), next(begin) {}
  /// The next edge of the clock.
  void edge() {
    model->clk = !model->clk;
    model->eval();
    registers.see(next, model->shift_clock_1, model->latch_clock_1, model->data, recorder);
    next += half;
  }
  std::unique_ptr<Model> model = std::make_unique<Model>();
  Registers registers;
  Recorder recorder;
  Time half, next;
};

int run(int count, char** arguments) {
  const std::vector<Byte> bytes = read_bytes(arguments[2]);
  const auto end = static_cast<Time>(std::atof(arguments[1]) * 1e9) * nanosecond;
  Line line(bytes, BAUD);
  constexpr Time half = period / PERIOD_CLOCKS / 2;
  Board<MODEL> first(arguments[3], half, half);
#ifdef PAIR
  if (count != 5) fail("a file for the pins of the secondary is missing");
  Board<V_secondary> second(arguments[4], half, half + half * 37 / 50);
#else
  if (count != 4) fail("usage: sonicsurface SECONDS BYTES PINS");
#endif
  while (first.next < end) {
#ifdef PAIR
    if (second.next < first.next) {
      second.model->misc_b = first.model->misc_e;
      second.model->misc_a = first.model->misc_d;
      second.edge();
      continue;
    }
#endif
    first.model->misc_b = line.level(seconds(first.next));
    first.edge();
  }
  return 0;
}

}  // namespace
}  // namespace palpa::firmware

int main(int count, char** arguments) {
  if (count < 4) palpa::firmware::fail("usage: sonicsurface SECONDS BYTES PINS [PINS]");
  return palpa::firmware::run(count, arguments);
}
