// openmpd SECONDS BYTES PINS [BYTES PINS]: OpenMPD's firmware on the bytes of an FT232H, one board or a master and a
// slave, which are connected by their cable. The slave's clocks are not in step with the master's.
#include <algorithm>
#include <cstdlib>
#include <memory>

#include "V_openmpd_board.h"
#include "pins.hpp"

namespace palpa::firmware {
namespace {

/// The chip as an asynchronous FIFO: a byte is on its pins 14 ns after RD# falls, until RD# rises; then RXF# is high
/// for 60 ns.
class Chip {
 public:
  explicit Chip(std::vector<Byte> bytes) : bytes_(std::move(bytes)) {}
  void see(Time now, bool rd_n) {
    if (!rd_n && reads_) {
      valid_ = now + 14 * nanosecond;
    } else if (rd_n && !reads_) {
      if (next_ < bytes_.size() && !empty(now)) ++next_;
      again_ = now + 60 * nanosecond;
    }
    reads_ = rd_n;
  }
  bool empty(Time now) const { return next_ == bytes_.size() || seconds(now) < bytes_[next_].at_s; }
  bool rxf_n(Time now) const { return now < again_ || empty(now); }
  std::uint8_t pins(Time now) const { return reads_ || now < valid_ || empty(now) ? 0xff : bytes_[next_].value; }

 private:
  std::vector<Byte> bytes_;
  std::size_t next_ = 0;
  Time valid_ = 0, again_ = 0;
  bool reads_ = true;  ///< the level of RD#
};

struct Board {
  Board(const char* bytes, const char* pins, bool master, Time begin)
      : chip(read_bytes(bytes)),
        recorder(pins, 128),
        next_clock(begin + clock_half),
        next_pll(begin + pll_half + not_together) {
    model->master = master;
    model->rxf_n = 1;
  }
  Time next() const { return std::min(next_clock, next_pll); }
  void edge() {
    if (next_clock < next_pll) {
      model->clock = !model->clock;
      if (model->clock) {
        model->rxf_n = chip.rxf_n(next_clock);
        model->bytes = chip.pins(next_clock);
      }
      model->eval();
      chip.see(next_clock, model->rd_n);
      next_clock += clock_half;
    } else {
      model->pll_clock = !model->pll_clock;
      model->eval();
      registers.see(next_pll, model->shift_clock, model->latch_clock, model->data, recorder);
      next_pll += pll_half;
    }
  }

  /// 50 MHz, and 1024 clocks in a period. Their edges never fall together.
  static constexpr Time clock_half = 10 * nanosecond, pll_half = period / 2048, not_together = 39'000;
  std::unique_ptr<V_openmpd_board> model = std::make_unique<V_openmpd_board>();
  Chip chip;
  Registers registers;
  Recorder recorder;
  Time next_clock, next_pll;
};

int run(int count, char** arguments) {
  const auto end = static_cast<Time>(std::atof(arguments[1]) * 1e9) * nanosecond;
  Board master(arguments[2], arguments[3], true, 0);
  std::unique_ptr<Board> slave;
  if (count == 6) slave = std::make_unique<Board>(arguments[4], arguments[5], false, 7 * nanosecond + 1);
  while (master.next() < end) {
    if (slave && slave->next() < master.next()) {
      slave->model->sync_in = master.model->sync_out;
      slave->edge();
    } else {
      master.edge();
    }
  }
  return 0;
}

}  // namespace
}  // namespace palpa::firmware

int main(int count, char** arguments) {
  if (count != 4 && count != 6) palpa::firmware::fail("usage: openmpd SECONDS BYTES PINS [BYTES PINS]");
  return palpa::firmware::run(count, arguments);
}
