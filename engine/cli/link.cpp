#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layouts/layout.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "line/values.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/links/safe_link.hpp"
#include "setup/options/options.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/sessions/live_run.hpp"

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
  std::string compare;
};

constexpr int compared_steps = 16;  // of a period

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
  group.quantity("--dwell", o.dwell_s, Quantity::time, {1e-3, 0.05},
                 "time from one drive to the next; a link that needs longer gets it");
  group.number("--amplitude", o.amplitude, {0, 1}, "A", "amplitude of the transducer that sounds, 0 to 1");
  group.point(
      "--compare", o.compare,
      "sounds two boards at a time instead, with their focus at this place of the layout's frame, and plays the "
      "second one earlier in 16 steps of a period: where a microphone there is loudest, they are in phase");
}

/// Sounds a drive, or nothing, for some slots. Returns false once the end is requested.
class Sweep {
 public:
  Sweep(session::SafeLink& link, std::size_t transducers, double dwell_s)
      : link_(link), drive_(transducers, {0, 0}), dwell_s_(dwell_s) {
    schedule_.slot_s = dwell_s;
  }

  /// One transducer.
  bool hold(std::size_t transducer, const Vec3& position, float amplitude, double seconds) {
    rest();
    drive_[transducer].amplitude = amplitude;
    return play(position, seconds);
  }
  /// Two boards whose sounds meet at a place, the second one earlier by a part of a period.
  bool hold(const array::Layout& layout, const array::Board& one, const array::Board& other, const Vec3& place,
            double earlier, double seconds) {
    rest();
    const array::SlotFocus focus{.position = place};
    const array::Drive all = array::drive_for(layout, {&focus, 1}, {.weighting = array::Weighting::uniform});
    for (const array::Board* const board : {&one, &other})
      std::copy_n(all.begin() + board->first, board->count, drive_.begin() + board->first);
    for (std::uint32_t t = other.first; t < other.first + other.count; ++t) {
      const double phase = static_cast<double>(drive_[t].phase) - 2 * std::numbers::pi * earlier;
      drive_[t].phase = static_cast<float>(std::remainder(phase, 2 * std::numbers::pi));
    }
    return play(place, seconds);
  }
  bool hold_silence(double seconds) {
    rest();
    return play(std::nullopt, seconds);
  }

 private:
  void rest() { std::fill(drive_.begin(), drive_.end(), array::TransducerDrive{0, 0}); }

  bool play(const std::optional<Vec3>& place, double seconds) {
    schedule_.clear();
    if (place) {
      array::Voice& voice = schedule_.add_voice();
      voice.foci = {*place};
      voice.order = {0};
      voice.dwell_s = dwell_s_;
    }
    const auto slots = static_cast<std::uint64_t>(std::max(1.0, seconds / dwell_s_));
    const session::Cycle cycle = place ? session::Cycle{session::Plays::pattern, 1} : session::Cycle{};
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

  session::SafeLink& link_;
  array::Drive drive_;
  array::Schedule schedule_;
  double dwell_s_;
  session::Clock clock_;
  std::uint64_t slot_ = 0;
};

/// Sounds one transducer after the other. Returns how many.
std::uint32_t sweep_transducers(Sweep& sweep, const LinkCommand& o, std::uint32_t last, const array::Layout& own,
                                const array::Layout& posed, bool tells) {
  std::uint32_t played = 0;
  for (std::uint32_t t = o.first; t <= last; ++t) {
    if (tells) {
      const Vec3& at = own.transducers[t].position;
      write_file("-", fmt::format("{} at {:.1f}, {:.1f}, {:.1f} mm\n", t, 1e3 * at.x, 1e3 * at.y, 1e3 * at.z));
    }
    if (!sweep.hold(t, posed.transducers[t].position, static_cast<float>(o.amplitude), o.each_s)) break;
    ++played;
    if (o.rest_s > 0 && !sweep.hold_silence(o.rest_s)) break;
  }
  return played;
}

Vec3 place_of(const std::string& text) {
  const auto [x, y, z] = line::parse_point("--compare", text);
  return {x, y, z};
}

/// Sounds the first board with each other one, in steps of a period. Returns how many steps.
std::uint32_t compare_boards(Sweep& sweep, const LinkCommand& o, const array::Layout& own, const array::Layout& posed,
                             bool tells) {
  const Vec3 place = transform_point(own.default_T_world_layout, place_of(o.compare));
  std::uint32_t played = 0;
  for (std::size_t board = 1; board < posed.boards.size(); ++board) {
    for (int step = 0; step < compared_steps; ++step) {
      const double earlier = static_cast<double>(step) / compared_steps;
      if (tells)
        write_file("-", fmt::format("boards 1 and {}, board {} another {:.4f} periods earlier\n", board + 1, board + 1,
                                    earlier));
      if (!sweep.hold(posed, posed.boards[0], posed.boards[board], place, earlier, o.each_s)) return played;
      ++played;
      if (o.rest_s > 0 && !sweep.hold_silence(o.rest_s)) return played;
    }
  }
  return played;
}

void check_compare(const LinkCommand& o, const array::Layout& layout, const std::string& name) {
  if (o.compare.empty()) return;
  if (o.first != 0 || o.last || o.amplitude != 1)
    throw bad_usage("--compare sounds whole boards at full amplitude: leave out --first, --last and --amplitude");
  if (layout.boards.size() < 2) {
    throw bad_usage(fmt::format("--compare needs two boards, and the layout {} has {}", name,
                                counted(layout.boards.size(), "board")));
  }
  const Vec3 place = place_of(o.compare);
  setup::refuse_place(layout, place, "--compare");
  for (std::size_t b = 0; b < layout.boards.size(); ++b) {
    if (transform_point(glm::inverse(layout.boards[b].T_layout_board), place).z > 0) continue;
    throw bad_usage(
        fmt::format("--compare {} is behind board {} of the layout {}, which a microphone hardly hears there: "
                    "give a place in front of all boards",
                    o.compare, b + 1, name));
  }
}

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
  check_compare(o, own, layout_name);
  const Outputs outputs({{"--json", o.common.json}, {"--link", session::file_of_link(o.link, links)}});
  const bool tells = setup::shows_summary(o.common, outputs);
  const std::vector<std::string> nothing_solid;
  session::check_board_files(o.link, links, o.board_files);
  // A slow link gets the time that it needs for a drive.
  const double least_s = session::least_moving_slot_s(o.link, links, layout);
  const double dwell_s = std::max(o.dwell_s, std::ceil(1e3 * least_s) * 1e-3);
  session::LinkSetting setting{layout, nothing_solid, dwell_s};
  setting.board_files = o.board_files;
  const std::unique_ptr<session::Link> link = session::open_link(o.link, links, setting);

  std::optional<log::Relay> relay(std::in_place);
  setup::Interrupt interrupt("ended without finishing, one second after the signal: the link did not answer");
  log::release_warnings();
  session::SafeLink safe(*link, layout.transducers.size(), {}, dwell_s);
  Sweep sweep(safe, layout.transducers.size(), dwell_s);
  const std::uint32_t played = !o.compare.empty() ? compare_boards(sweep, o, own, layout, tells)
                                                  : sweep_transducers(sweep, o, last, own, layout, tells);
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
