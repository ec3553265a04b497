#include "driver/emulate/command.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "driver/openmpd/emulate.hpp"
#include "setup/values.hpp"

namespace palpa::driver::emulate {
namespace {

void add_options(CLI::App& app, Options& o) {
  const setup::Group board(app, "Which board");
  std::string names;
  for (const Kind& kind : kinds())
    names += (names.empty() ? "" : ", ") + kind.name + ": " + kind.help;
  board.text("board", o.board, "BOARD", names);
  board.text("--serial", o.serials, "SERIAL,...", "of USB boards, one board for each [EMU1]");
  board.text("--layout", o.layout, "NAME|FILE", "how the boards stand [one alone, two as a pair]");
  board.text("--board-files", o.files, "DIR",
             "with the boards' own files, board_NAME.pat: how their transducers differ");
  const setup::Group shown(app, "What it tells");
  shown.text("--trace", o.trace, "FILE", "all that comes over the wire, as JSON lines");
  shown.flag("--view", o.view, "twice a second, the focus that the bytes on the wire make");
}

void run(const Options& o) {
  for (const Kind& kind : kinds()) {
    if (kind.name == o.board) return kind.run(o);
  }
  std::string names;
  for (const Kind& kind : kinds())
    names += (names.empty() ? "" : ", ") + kind.name;
  throw bad_usage(o.board.empty() ? fmt::format("which board? palpa emulate BOARD, of {}", names)
                                  : fmt::format("no board is called {}: there are {}", o.board, names));
}

}  // namespace

std::vector<Kind> kinds() {
  return {{"openmpd", "OpenMPD boards on USB", openmpd::emulate}};
}

void add_emulate(cli::Program& program) {
  cli::add_subcommand<Options>(program,
                               {"emulate", "a board made of software, as strict as the real one",
                                "  palpa emulate openmpd --serial EMU1 --view     and beside it: palpa run ... "
                                "--layout openmpd --link openmpd:EMU1\n"
                                "  palpa emulate openmpd --serial A,B --trace wire.jsonl"},
                               add_options, run);
}

}  // namespace palpa::driver::emulate
