#include "driver/bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/system/now.hpp"
#include "driver/openmpd/board.hpp"
#include "driver/usb/ftdi.hpp"
#include "driver/usb/in_process.hpp"

namespace palpa::driver {
namespace {

constexpr std::size_t boards = 16;
constexpr std::uint32_t each = openmpd::transducers;
constexpr double slot_s = 250e-6;  // 4 kHz

/// A clock that advances only during sleeps, because boards take a second to come up.
class StandingClock final : public Clock {
 public:
  double now_s() const override { return now_s_; }
  void sleep_s(double seconds) override { now_s_ += seconds; }

 private:
  double now_s_ = 0;
};

/// An FT232H with nothing behind it. Keeps the last frame.
class Sink final : public usb::Peripheral {
 public:
  explicit Sink(std::string serial)
      : identity_{usb::ftdi::vendor, usb::ftdi::product_232h, usb::ftdi::release_232h, std::move(serial)} {}
  const Identity& identity() const override { return identity_; }
  usb::Outcome control(double, const usb::Setup&, std::span<std::uint8_t> in, std::size_t& filled) override {
    if (!in.empty()) in[0] = static_cast<std::uint8_t>(usb::ftdi::Channel::fifo);
    filled = in.size();
    return usb::Outcome::done;
  }
  std::size_t bulk_out(double, std::uint8_t, std::span<const std::uint8_t> bytes) override {
    if (bytes.size() == last_.size()) std::copy(bytes.begin(), bytes.end(), last_.begin());
    return bytes.size();
  }
  void advance(double) override {}
  void closed(double) override {}
  void unplugged(double) override {}
  const openmpd::Frame& last() const { return last_; }

 private:
  Identity identity_;
  openmpd::Frame last_{};
};

class NoNotes final : public BoardNotes {
 public:
  void warning(std::string_view) noexcept override {}
  void info(std::string_view) noexcept override {}
  void waits(std::string_view) noexcept override {}
};

/// Another drive each time, with amplitudes and phases of all sizes.
void change(array::Drive& drive, std::size_t seed) {
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive[i] = {static_cast<float>((i + seed) % 97) / 96,
                static_cast<float>(static_cast<double>((i * 7 + seed) % 628) / 100 - std::numbers::pi)};
  }
}

}  // namespace

void measure_links(std::uint32_t runs, std::vector<bench::Row>& rows) {
  constexpr std::size_t warm_up = 100;
  const std::size_t samples = std::max<std::size_t>(runs, 1000);
  array::Layout layout;
  std::string argument;
  std::vector<std::unique_ptr<Sink>> sinks;
  StandingClock clock;
  usb::InProcessBus bus(clock);
  for (std::uint32_t i = 0; i < boards; ++i) {
    sinks.push_back(std::make_unique<Sink>(fmt::format("B{}", i)));
    bus.plug(*sinks.back());
    layout.boards.push_back({"openmpd", each * i, each, 0.168, 0.168});
    argument += (i == 0 ? "B" : ",B") + std::to_string(i);
  }
  layout.transducers.resize(boards * openmpd::transducers);
  const std::string files;
  NoNotes notes;
  argument += ",lag=0";  // all boards are sent the same
  openmpd::OpenMpdBoard board({argument, files, layout, slot_s}, notes, bus, clock);

  const openmpd::Encoder encoder;
  std::array<openmpd::Frame, boards> frames{};
  array::Drive drive(layout.transducers.size());
  std::vector<double> encode_ms, send_ms;
  for (std::size_t i = 0; i < warm_up + samples; ++i) {
    change(drive, i);
    const double begin_ms = now_ms();
    for (std::size_t b = 0; b < boards; ++b)
      encoder.encode(std::span(drive).subspan(b * openmpd::transducers, openmpd::transducers), frames[b]);
    const double encoded_ms = now_ms();
    board.play(i, drive);
    const double sent_ms = now_ms();
    clock.sleep_s(slot_s);
    for (std::size_t b = 0; b < boards; ++b) {
      if (sinks[b]->last() != frames[b]) throw failure("bench: what was sent is not what was encoded");
    }
    if (i < warm_up) continue;
    encode_ms.push_back(encoded_ms - begin_ms);
    send_ms.push_back(sent_ms - encoded_ms);
  }
  const std::string name = "16 OpenMPD boards at 4 kHz";
  bench::Row encode = bench::make_row("links", name, "encode", std::move(encode_ms));
  encode.value = 100 * encode.median_ms / (1e3 * slot_s);
  encode.unit = "% of a core";
  rows.push_back(std::move(encode));
  rows.push_back(bench::make_row("links", name, "drive to wire", std::move(send_ms)));
}

}  // namespace palpa::driver
