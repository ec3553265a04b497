#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "base/outputs.hpp"
#include "cli/commands.hpp"
#include "line/values.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/links/safe_link.hpp"
#include "setup/interrupt.hpp"
#include "setup/live_run.hpp"
#include "setup/options.hpp"

namespace palpa::cli {
namespace {

struct LinkCommand {
  setup::CommonOptions common;
  std::string what;
  std::string link, layout, board_files;
  std::uint32_t first = 0;
  std::optional<std::uint32_t> last;
  double each_s = 0.5, rest_s = 0.1, dwell_s = 0.02;
  double amplitude = 1;
};

void add_options_of_link(CLI::App& app, LinkCommand& o) {
  const line::Group group(app, "What to try out");
  group.text("what", o.what, "test",
             "the word test: sounds one transducer after the other, so that you can see, hear or measure each");
  group.text("--link", o.link, "LINK", "the board or other link to test, as for palpa run");
  setup::add_layout(group, o.layout, "the link's array", " [the board's own]");
  setup::add_board_files(group, o.board_files);
  constexpr std::uint32_t most = array::max_transducers - 1;
  group.integer("--first", o.first, 0, most, "first transducer to sound, by its number in the layout");
  group.integer("--last", o.last, 0, most, "last transducer to sound [the layout's last]");
  group.quantity("--each", o.each_s, Quantity::time, line::positive(3600), "how long each transducer sounds");
  group.quantity("--rest", o.rest_s, Quantity::time, {0, 3600}, "how long it is silent after each transducer");
  group.quantity("--dwell", o.dwell_s, Quantity::time, {1e-3, 0.05}, "time from one drive to the next");
  group.number("--amplitude", o.amplitude, {0, 1}, "A", "amplitude of the transducer that sounds, 0 to 1");
}

/// Sounds one transducer, or none, for some slots. Returns false once the end is requested.
class Sweep {
 public:
  Sweep(session::SafeLink& link, std::size_t transducers, double dwell_s)
      : link_(link), drive_(transducers, {0, 0}), dwell_s_(dwell_s) {
    schedule_.slot_s = dwell_s;
  }

  bool hold(std::optional<std::size_t> transducer, const Vec3& position, float amplitude, double seconds) {
    std::fill(drive_.begin(), drive_.end(), array::TransducerDrive{0, 0});
    schedule_.clear();
    if (transducer) {
      drive_[*transducer].amplitude = amplitude;
      array::Voice& voice = schedule_.add_voice();
      voice.foci = {position};
      voice.order = {0};
      voice.dwell_s = dwell_s_;
    }
    const auto slots = static_cast<std::uint64_t>(std::max(1.0, seconds / dwell_s_));
    const session::Cycle cycle = transducer ? session::Cycle{session::Plays::pattern, 1} : session::Cycle{};
    link_.plan({.schedule = schedule_, .slots = {slot_, slot_ + slots, cycle}, .drives = drive_});
    for (std::uint64_t i = 0; i < slots; ++i) {
      if (setup::Interrupt::flag()) return false;
      link_.send(slot_, drive_);
      clock_.sleep_until(static_cast<double>(++slot_) * dwell_s_);
      // Missed slots are skipped, as in the loop.
      slot_ = std::max(slot_, static_cast<std::uint64_t>(clock_.now() / dwell_s_));
    }
    return true;
  }

 private:
  session::SafeLink& link_;
  array::Drive drive_;
  array::Schedule schedule_;
  double dwell_s_;
  session::Clock clock_;
  std::uint64_t slot_ = 0;
};

void run_link(const Extensions& extensions, const LinkCommand& o) {
  if (o.what != "test") throw bad_usage("give palpa link test, which is the only form of this command");
  if (o.link.empty()) throw bad_usage("--link is missing: give a link of palpa run, such as null or a board");
  const std::vector<session::LinkKind> links = setup::with_builtin(extensions.links);
  std::string layout_name = o.layout;
  if (layout_name.empty()) {
    layout_name = session::layout_of_link(o.link, links);
    if (layout_name.empty()) throw bad_usage("--layout is missing: give the link's array, such as openmpd");
    log::info(fmt::format("--link {}: palpa uses the link's own array, --layout {}", o.link, layout_name));
  }
  const array::Layout own = array::load_layout(layout_name);
  const array::Layout layout = array::transformed(own, own.default_T_world_layout);
  const auto end = static_cast<std::uint32_t>(layout.transducers.size());
  const std::uint32_t last = o.last.value_or(end - 1);
  if (last >= end || o.first > last) {
    throw bad_usage(fmt::format("--first {} --last {}: the layout {} has the transducers 0 to {}", o.first, last,
                                layout_name, end - 1));
  }
  const Outputs outputs({{"--json", o.common.json}, {"--link", session::file_of_link(o.link, links)}});
  const bool tells = setup::shows_summary(o.common, outputs);
  const std::vector<std::string> nothing_solid;
  session::LinkSetting setting{layout, nothing_solid, o.dwell_s};
  setting.board_files = o.board_files;
  const std::unique_ptr<session::Link> link = session::open_link(o.link, links, setting);

  std::optional<log::Relay> relay(std::in_place);
  setup::Interrupt interrupt("ended without finishing, one second after the signal: the link did not answer");
  log::release_warnings();
  session::SafeLink safe(*link, layout.transducers.size(), {}, o.dwell_s);
  Sweep sweep(safe, layout.transducers.size(), o.dwell_s);
  std::uint32_t played = 0;
  for (std::uint32_t t = o.first; t <= last; ++t) {
    if (tells) {
      const Vec3& at = own.transducers[t].position;
      write_file("-", fmt::format("{} at {:.1f}, {:.1f}, {:.1f} mm\n", t, 1e3 * at.x, 1e3 * at.y, 1e3 * at.z));
    }
    if (!sweep.hold(t, layout.transducers[t].position, static_cast<float>(o.amplitude), o.each_s)) break;
    ++played;
    if (o.rest_s > 0 && !sweep.hold(std::nullopt, {}, 0, o.rest_s)) break;
  }
  safe.finish();
  relay.reset();
  if (!o.common.json.empty()) {
    JsonWriter json;
    json.begin_object().member("first", o.first).member("played", played).end_object();
    write_file(o.common.json, json.finish());
  }
}

}  // namespace

void add_link(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<LinkCommand>(
      program,
      {"link", "try a link out: one transducer after the other",
       "  palpa link test --link openmpd:FT43NK5M --each 1s\n"
       "  palpa link test --link openmpd:EMU1 --first 16 --last 31",
       "", "", "test"},
      add_options_of_link, [&extensions](const LinkCommand& o) { run_link(extensions, o); },
      setup::Computes::on_processor);
}

}  // namespace palpa::cli
