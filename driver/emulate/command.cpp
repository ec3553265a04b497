#include "driver/emulate/command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/system/real_time.hpp"
#include "base/text.hpp"
#include "driver/autd3/emulated/command.hpp"
#include "driver/autd3_udp/emulated/command.hpp"
#include "driver/openmpd/emulated/command.hpp"
#include "driver/sonicsurface/emulated/command.hpp"
#include "line/values.hpp"

namespace palpa::driver::emulate {
namespace {

void add_options(CLI::App& app, Options& o) {
  const line::Group board(app, "Which board");
  std::string names;
  for (const Kind& kind : kinds())
    names += (names.empty() ? "" : ", ") + kind.name + ": " + kind.help;
  board.text("board", o.board, "BOARD", names);
  board.text("--serial", o.serials, "SERIAL,...", "serial numbers of USB boards, one board for each [EMU1]");
  board.flag("--uart", o.uart, "USB boards as they are delivered: their FT232H is a serial port, which palpa refuses");
  board.integer("--port", o.port, 0, 65535,
                fmt::format("port of an AUTD3 server [{}] or of a group of AUTD3 units [44336]; 0 takes a free one",
                            default_port));
  board.integer("--protocol", o.protocol, 2, 5,
                "protocol of AUTD3 units on a network cable: 2 (releases 0.10, 0.11), 3 (0.12) or 5 (0.13) [5]");
  board.quantity("--processing", o.processing_s, Quantity::time, {0, 0.1},
                 "time that an AUTD3 unit on a network cable takes for a frame; real units' is not published [50us]");
  board.texts("--fault", o.faults, "FAULT",
              "a fault of the network cable or of a unit: lose=1%, repeat=1%, delay=1% (by 5 ms), mute=UNIT@TIME, "
              "reboot=UNIT@TIME, cut=UNIT@TIME [none]",
              autd3_udp::check_fault);
  board.flag("--tactile", o.tactile, "emulates a SonicSurface with the tactile firmware");
  board.text("--layout", o.layout, "NAME|FILE", "how the boards stand [one alone, two as a pair]");
  board.text("--board-files", o.files, "DIR",
             "folder with the boards' own files, board_NAME.pat, which say how their transducers differ [none]");
  const line::Group shown(app, "What it tells");
  shown.text("--trace", o.trace, "FILE", "writes all that comes over the wire, as lines of JSON [no trace]");
  shown.flag("--view", o.view, "shows the focus that the bytes on the wire make, twice a second");
}

/// Throws bad_usage for an option that this board would ignore.
void check(const Options& o, const Kind& kind) {
  for (const auto& [name, given] :
       {std::pair("--serial", !o.serials.empty()), std::pair("--uart", o.uart), std::pair("--port", o.port.has_value()),
        std::pair("--protocol", o.protocol.has_value()), std::pair("--processing", o.processing_s.has_value()),
        std::pair("--fault", !o.faults.empty()), std::pair("--tactile", o.tactile),
        std::pair("--board-files", !o.files.empty())}) {
    if (!given || std::ranges::find(kind.options, name) != kind.options.end()) continue;
    std::string others;
    for (const Kind& other : kinds()) {
      if (std::ranges::find(other.options, name) != other.options.end())
        others += (others.empty() ? "" : " and ") + other.name;
    }
    throw bad_usage(fmt::format("{} goes with {}, not with {}", name, others, kind.name));
  }
  if (!o.files.empty() && !o.view) throw bad_usage("--board-files goes with --view, which shows what the boards play");
  if (!o.layout.empty() && kind.name == "openmpd" && !o.view)
    throw bad_usage("--layout goes with --view: --serial sets the number of OpenMPD boards");
}

void run(const Options& o) {
  for (const Kind& kind : kinds()) {
    if (kind.name != o.board) continue;
    check(o, kind);
    const RealTime turns(emulated_priority);
    const Outputs outputs({{"--trace", o.trace}, {"--json", o.common.json}});
    return kind.run(o, outputs);
  }
  std::string names;
  for (const Kind& kind : kinds())
    names += (names.empty() ? "" : ", ") + kind.name;
  throw bad_usage(o.board.empty() ? fmt::format("the board is missing: give palpa emulate BOARD, with one of {}", names)
                                  : fmt::format("unknown board {}: give one of {}", o.board, names));
}

}  // namespace

std::vector<Kind> kinds() {
  return {
      {"autd3", "AUTD3 units behind a server", autd3::emulate, {"--port"}},
      {"autd3-udp",
       "AUTD3 units on a network cable",
       autd3_udp::emulate,
       {"--port", "--protocol", "--processing", "--fault"}},
      {"openmpd", "OpenMPD boards on USB", openmpd::emulate, {"--serial", "--uart", "--board-files"}},
      {"sonicsurface", "SonicSurface boards on a serial port", sonicsurface::emulate, {"--tactile", "--board-files"}}};
}

void tell_violations(const Options& options, std::span<const Violation> all, std::size_t& told) {
  for (; told < all.size(); ++told) {
    if (options.common.quiet) continue;
    write_file("-", fmt::format("at {:.4f} s: {}\n", all[told].time_s, all[told].what));
  }
}

void conclude(const Options& options, const Outputs& outputs, const Outcome& outcome) {
  if (!options.common.json.empty()) {
    JsonWriter json;
    json.begin_object().member(outcome.counted, outcome.count).member("sounds", outcome.sounds);
    json.member("violation_count", std::uint64_t{outcome.violation_count}).key("violations");
    json.begin_array(JsonWriter::Style::block);
    for (const Violation& violation : outcome.violations) {
      json.begin_object(JsonWriter::Style::line).member("t_s", violation.time_s);
      json.member("what", violation.what).end_object();
    }
    json.end_array().end_object();
    write_file(options.common.json, json.take());
  }
  if (setup::shows_summary(options.common, outputs)) write_file("-", outcome.summary + "\n");
  if (outcome.violation_count == 0) return;
  throw failure(fmt::format("{}, the first at {:.4f} s: {}", counted(outcome.violation_count, "violation"),
                            outcome.violations[0].time_s, outcome.violations[0].what));
}

void add_emulate(cli::Program& program) {
  cli::add_subcommand<Options>(program,
                               {"emulate", "a board made of software, as strict as the real one",
                                "  palpa emulate openmpd --serial EMU1 --view\n"
                                "  palpa emulate autd3 --layout paper",
                                "--serial --port --protocol --processing --fault --tactile --layout --board-files "
                                "--trace --view",
                                "Leave it running, and start palpa run --link openmpd:EMU1 or --link "
                                "autd3:127.0.0.1:8080 in another terminal, with the same --layout if you give one. "
                                "Ctrl-C ends it.",
                                "BOARD"},
                               add_options, run, setup::Computes::on_processor);
}

}  // namespace palpa::driver::emulate
