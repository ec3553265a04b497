#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "drawing/png.hpp"
#include "line/values.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/play.hpp"

namespace palpa::cli {
namespace {

using setup::PlayOptions;

void add_options_of_play(CLI::App& app, PlayOptions& o) {
  line::Group(app, "What to play")
      .words("sensation", o.names, "FILE|NAME",
             fmt::format("a pattern of Adaptics, or {}", fmt::join(setup::sensation_names(), ", ")));
  setup::add_play_options(app, o);
}

struct PlayResult {
  std::string name;
  double slot_s = 0;
  std::optional<std::uint64_t> slots;  ///< if files were written
  std::optional<session::OutputStats> played;
  const sensation::PatternSensation* sensation = nullptr;
};

std::string to_json(const PlayResult& result) {
  JsonWriter json;
  json.begin_object(JsonWriter::Style::rows).member("sensation", result.name).member("slot_s", result.slot_s);
  json.key("parameters").begin_object();
  for (const auto& [name, value] : result.sensation->parameters())
    json.member(name, value);
  json.end_object();
  if (result.slots) json.member("slots", *result.slots);
  if (result.played) {
    const session::OutputStats& played = *result.played;
    json.key("drives").begin_object().member("sent", played.drives).member("silent", played.silent_drives);
    json.member("skipped_slots", played.skipped_slots).member("lost", played.hand_over.lost()).end_object();
  }
  json.end_object();
  return json.take();
}

std::string summary(const PlayResult& result) {
  std::string text;
  if (result.slots) {
    text = fmt::format("{}: {} of {:g} ms, {:g} s\n", result.name, counted(*result.slots, "slot"), 1e3 * result.slot_s,
                       static_cast<double>(*result.slots) * result.slot_s);
  }
  if (!result.played) return text;
  const session::OutputStats& played = *result.played;
  return text + fmt::format("{} of {:g} ms, {} of them silent, {} overslept\n{}\n", counted(played.drives, "drive"),
                            1e3 * result.slot_s, played.silent_drives, counted(played.skipped_slots, "slot"),
                            session::to_text(played.hand_over));
}

void run_play(const Extensions& extensions, const PlayOptions& o) {
  check(o);
  const std::vector<session::LinkKind> links = setup::with_builtin(extensions.links);
  const Outputs outputs(setup::outputs_of(o, links));
  sensation::Pattern pattern = setup::load_sensation(o.names[0]);
  const std::map<std::string, double> given = setup::parameters_of(o.parameters, pattern);
  sensation::PatternSensation sensation(std::move(pattern), given, o.speed);
  const auto playing = setup::prepare_play(o, sensation.fastest_hz(), o.names[0], links);
  std::vector<sensation::Point> points;
  PlayResult result{.name = o.names[0], .slot_s = playing->setting.output.slot_s, .sensation = &sensation};
  if (setup::is_offline(o) || !o.csv.empty() || !o.png.empty()) {
    points = setup::offline_points(sensation, playing->setting, o.names[0]);
    result.slots = points.size();
    if (!o.csv.empty()) write_file(o.csv, setup::sensation_csv(points, playing->setting));
    if (!o.png.empty() && !points.empty())
      drawing::write_png(o.png, setup::sensation_picture(points, playing->setting, o.names[0]));
  }
  if (!setup::is_offline(o) || o.link != "null") {
    std::optional<log::Relay> relay(std::in_place);
    std::optional<setup::Interrupt> interrupt(
        std::in_place,
        fmt::format("ended without finishing, one second after the signal: --link {} did not answer", o.link));
    log::release_warnings();
    session::SensationControl control;
    result.played =
        setup::play(o, sensation, control, *playing, points, extensions.sources, links, setup::Interrupt::flag());
    interrupt.reset();
    relay.reset();
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(result));
}

}  // namespace

void add_play(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<PlayOptions>(
      program,
      {"play", "a sensation: a focus that moves in time, on an array or on a hand",
       "  palpa play heartbeat --param rate=90 --duration 5s --csv - --png heartbeat.png\n"
       "  palpa play circle --link openmpd:FT43NK5M --ceiling 0.5",
       "--param --speed --duration --at --on --source --link --layout --ceiling --csv",
       "Plays until a stop of the pattern, --duration or Ctrl-C. At its end, palpa silences the array.", "FILE|NAME"},
      add_options_of_play, [&extensions](const PlayOptions& o) { run_play(extensions, o); },
      setup::Computes::on_processor);
}

}  // namespace palpa::cli
