#include "driver/openmpd/emulated/command.hpp"

#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "driver/clock.hpp"
#include "driver/emulate/live_sound_picture.hpp"
#include "driver/emulate/stop.hpp"
#include "driver/emulate/trace.hpp"
#include "driver/openmpd/board.hpp"
#include "driver/openmpd/board_file.hpp"
#include "driver/openmpd/emulated/board.hpp"
#include "driver/usb/local_server.hpp"

namespace palpa::driver::openmpd {
namespace {

/// A board, its socket, its trace.
struct Emulated {
  Emulated(const Address& address, usb::ftdi::Channel channel, const Calibration& its_calibration, double its_lag,
           const OpenFile* trace, bool alone)
      : board(address.serial, channel), calibration(its_calibration), lag(its_lag) {
    if (trace != nullptr) tap.emplace(*trace, alone ? "" : address.serial);
    server = std::make_unique<usb::LocalServer>(board, tap ? &*tap : nullptr);
  }
  const std::string& serial() const { return board.identity().serial; }

  EmulatedBoard board;
  Calibration calibration;
  double lag;  ///< periods
  std::optional<emulate::UsbTrace> tap;
  std::unique_ptr<usb::LocalServer> server;
  std::size_t told = 0;  ///< how many of its violations have been printed
};

/// The picture that is shown twice a second, on its own thread, because the boards have no time for that.
class BoardsPicture {
 public:
  BoardsPicture(const array::Layout& layout, std::span<const std::unique_ptr<Emulated>> boards)
      : boards_(boards), drive_(layout.transducers.size(), {0, 0}), view_(layout, [this] {
          const std::lock_guard lock(mutex_);
          return drive_;
        }) {}
  /// As LiveSoundPicture::end().
  void end() { view_.end(); }
  /// Takes what the boards sound now.
  void take() {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < boards_.size(); ++i) {
      const array::Drive heard =
          heard_drive(boards_[i]->board.fpga().pulses(), boards_[i]->calibration, boards_[i]->lag);
      std::copy(heard.begin(), heard.end(), drive_.begin() + static_cast<std::ptrdiff_t>(i * transducers));
    }
  }

 private:
  std::span<const std::unique_ptr<Emulated>> boards_;
  std::mutex mutex_;
  array::Drive drive_;
  emulate::LiveSoundPicture view_;
};

array::Layout layout_of(const emulate::Options& options, std::size_t boards) {
  const std::string name = !options.layout.empty() ? options.layout : boards == 2 ? "openmpd-pair" : "openmpd";
  array::Layout layout = array::load_layout(name);
  if (layout.boards.size() != boards || layout.transducers.size() != boards * transducers) {
    throw bad_usage(
        fmt::format("the layout {} does not consist of {}: give --layout one that does, or leave --view out", name,
                    counted(boards, "OpenMPD board")));
  }
  return layout;
}

void serve(std::span<const std::unique_ptr<Emulated>> boards, BoardsPicture* viewer, bool quiet) {
  const SteadyClock clock;
  const double begin_s = clock.now_s();
  double taken_s = 0;
  std::vector<pollfd> watched;
  while (!emulate::Stop::asked()) {
    bool waits = false;
    watched.clear();
    for (const auto& one : boards) {
      one->server->watch(watched);
      waits = waits || one->server->waits();
    }
    const timespec wait{0, waits ? 200'000 : 20'000'000};
    ppoll(watched.data(), watched.size(), &wait, nullptr);
    const double now_s = clock.now_s() - begin_s;
    for (const auto& one : boards) {
      one->server->go_on(now_s);
      const auto& kept = one->board.violations().kept();
      for (; one->told < kept.size() && !quiet; ++one->told) {
        write_file("-",
                   fmt::format("{} at {:.4f} s: {}\n", one->serial(), kept[one->told].time_s, kept[one->told].what));
      }
    }
    if (viewer != nullptr && now_s > taken_s + 0.1) {
      viewer->take();
      taken_s = now_s;
    }
  }
  // A board that was released at the last moment may sound on only for this long.
  for (const auto& one : boards)
    one->board.advance(clock.now_s() - begin_s + 0.1);
}

std::string to_json(std::span<const std::unique_ptr<Emulated>> boards) {
  JsonWriter json;
  json.begin_object().key("boards").begin_array(JsonWriter::Style::block);
  for (const auto& one : boards) {
    const Fpga& fpga = one->board.fpga();
    json.begin_object(JsonWriter::Style::line)
        .member("serial", one->serial())
        .member("frames", fpga.frames())
        .member("frames_in_step", fpga.frames_in_step())
        .member("divider", std::uint32_t{fpga.divider()})
        .member("most_buffered_bytes", std::uint64_t{fpga.most_buffered()})
        .member("sounds", fpga.sounds())
        .member("violation_count", std::uint64_t{one->board.violations().count()});
    json.key("violations").begin_array();
    for (const auto& violation : one->board.violations().kept())
      json.begin_object(JsonWriter::Style::line)
          .member("t_s", violation.time_s)
          .member("what", violation.what)
          .end_object();
    json.end_array().end_object();
  }
  json.end_array().end_object();
  return json.take();
}

/// Throws if anything was wrong.
void judge(std::span<const std::unique_ptr<Emulated>> boards) {
  for (const auto& one : boards) {
    const auto& violations = one->board.violations();
    if (violations.count() == 0) continue;
    throw failure(fmt::format("{}: {}, the first at {:.4f} s: {}", one->serial(),
                              counted(violations.count(), "violation"), violations.kept()[0].time_s,
                              violations.kept()[0].what));
  }
  for (const auto& one : boards) {
    const std::uint64_t first = boards[0]->board.fpga().frames_in_step(), its = one->board.fpga().frames_in_step();
    if (its != first) {
      throw failure(
          fmt::format("{} received {} frames and {} received {} since they were brought into step: the boards of one "
                      "array must receive the same number",
                      boards[0]->serial(), first, one->serial(), its));
    }
  }
}

}  // namespace

void emulate(const emulate::Options& options, const Outputs& outputs) {
  const std::vector<Address> addresses = parse_boards(options.serials.empty() ? "EMU1" : options.serials).addresses;
  std::vector<BoardFile> files;
  if (!options.files.empty()) files = read_board_files(options.files);
  std::optional<array::Layout> layout;
  if (options.view) layout = layout_of(options, addresses.size());
  std::optional<OpenFile> trace;
  if (!options.trace.empty()) trace = emulate::open_trace(options.trace);

  const emulate::Stop stop;
  std::vector<std::unique_ptr<Emulated>> boards;
  boards.reserve(addresses.size());
  for (const Address& address : addresses) {
    const auto channel = options.uart ? usb::ftdi::Channel::uart : usb::ftdi::Channel::fifo;
    // The counter of a slave begins 19.04 us after the master's. A board's file contains it.
    constexpr double slave_lag = 19.04 / 25;
    const bool has_file = std::ranges::find(files, address.serial, &BoardFile::serial) != files.end();
    boards.push_back(std::make_unique<Emulated>(address, channel, calibration_of(files, address.serial),
                                                boards.empty() || has_file ? 0 : slave_lag, trace ? &*trace : nullptr,
                                                addresses.size() == 1));
  }
  for (const auto& one : boards)
    write_file("-", one->server->address().string() + "\n");

  std::optional<BoardsPicture> viewer;
  if (layout) viewer.emplace(*layout, boards);
  serve(boards, viewer ? &*viewer : nullptr, options.common.quiet);
  if (viewer) viewer->end();
  viewer.reset();

  if (!options.common.json.empty()) write_file(options.common.json, to_json(boards));
  if (setup::shows_summary(options.common, outputs)) {
    for (const auto& one : boards) {
      const Fpga& fpga = one->board.fpga();
      write_file("-",
                 fmt::format("{}: {}, {}, at most {} bytes waited\n", one->serial(), counted(fpga.frames(), "frame"),
                             fpga.sounds() ? "sounds" : "silent", fpga.most_buffered()));
    }
  }
  judge(boards);
}

}  // namespace palpa::driver::openmpd
