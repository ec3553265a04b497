#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "array/schedule.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "cli/commands.hpp"
#include "cli/felt.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/nearest_skin.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/tasks/touch.hpp"

namespace palpa::cli {
namespace {

struct TouchCommand {
  setup::CommonOptions common;
  setup::TouchInputOptions input;
  setup::TouchTask task;
  std::string csv, wav;
  double wav_scale_db = acoustics::usual_full_scale_db;
};

void add_options_of_touch(CLI::App& app, TouchCommand& o) {
  setup::add_touch_input(app, o.input);
  const line::Group group(app, "What touches what");
  setup::add_allow_outside(group, o.common);
  group.text("--csv", o.csv, "FILE|-", "writes the contacts: index,x,y,z,depth,finger,solid");
  setup::add_task_options(app, o.task);
  const line::Group heard(app, "What is heard");
  heard.text("--wav", o.wav, "FILE", "with --audible: writes 3 s of what is heard beside the beam, 48 kHz");
  heard.number("--wav-scale", o.wav_scale_db, {0, 194}, "DB",
               "with --wav: the level of a full-scale sine; give files that you compare the same");
  line::need(app, {"--wav"}, "--audible");
  line::need(app, {"--wav-scale"}, "--wav");
}

std::string order_line(const array::Voice& voice) {
  return fmt::format("order {}, {} ms each", fmt::join(voice.order, " "), voice.dwell_s * 1e3);
}

const char* manner(const touch::Placement& placement) {
  return placement.together ? " at once" : placement.still() ? ", at its centroid" : "";
}

std::string summary_of_touch(const setup::TouchResult& result, const setup::TouchInput& skin,
                             const setup::TouchOptions& options) {
  const touch::Touch& touch = result.touch();
  const session::Session& session = result.session();
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}, {}, {} ({:.1f} ms)\n", counted(result.values.points, "skin point"),
                 counted(touch.contacts.size(), "contact"), counted(touch.finger_count, "finger"),
                 result.values.total_ms);
  if (touch.contacts.empty()) {
    if (const auto nearest = setup::nearest_skin(session.solids(), skin))
      fmt::format_to(out, "the nearest skin is {}\n", setup::place_of(*nearest, session.solids()));
  }
  const array::Voice all = session.scheduler().common_voice();
  const bool still = all.order.size() == all.foci_per_slot;
  bool common = false;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const glm::vec3 c = finger.section.centroid * 1e3f;
    const touch::Placement& placement = session.scheduler().fingers()[f].placement;
    std::size_t sounding = 0;
    for (std::size_t i = 0; i < placement.foci.size(); ++i)
      sounding += placement.has(i);
    fmt::format_to(out, "finger {} on {}: {} around ({:.2f}, {:.2f}, {:.2f}) mm, {} of {}{}\n", f,
                   session.solids()[finger.solid].name, counted(finger.contacts.size(), "contact"), c.x, c.y, c.z,
                   sounding, counted(placement.foci.size(), "focus"), manner(placement));
    if (!result.values.pressures.empty()) {
      const auto [least, most] = std::ranges::minmax(result.values.pressures[f]);
      fmt::format_to(out, "  pressure at its foci: {:.0f} to {:.0f} Pa\n", least, most);
    }
    const bool own = !still && result.values.own_schedule[f];
    if (own) fmt::format_to(out, "  {}\n", order_line(session.schedule().voices[f]));
    common = common || !own;
  }
  if (still) {
    fmt::format_to(out, "modulated at {} Hz, {}; --json gives everything\n", options.modulation_hz,
                   word_of(array::modulation_words, options.modulation));
  } else {
    if (common) text += order_line(all) + "; ";
    text += "--json gives everything\n";
  }
  if (result.values.ear) {
    fmt::format_to(out, "to the ear, {:g} m beside the beam: {} (predicted, 10 dB either way)\n",
                   acoustics::EarOptions().distance_m, acoustics::to_text(*result.values.ear));
  }
  if (result.beyond_linear()) text += setup::linear_line();
  text += felt_lines(session.scheduler().fingers(), result.values.spectra);
  return text;
}

void run_touch(const TouchCommand& given) {
  TouchCommand o = given;
  o.task.compute = o.common;
  check(o.input);
  check(o.task, !o.input.depths.empty());
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}, {"--wav", o.wav}});
  const setup::Stopwatch start;
  std::optional<setup::Preparing> preparing(std::in_place, o.common.quiet);
  std::vector<geometry::Solid> solids = setup::load_solids(o.input.scene, o.input.gltf_scene, o.input.solids);
  const setup::TouchInput skin = setup::load_touch_input(o.input, solids);
  const setup::TouchResult result = setup::touch_scene(o.task, o.input.scene, std::move(solids), skin, start);
  preparing.reset();
  if (result.unreached) log::warning(*result.unreached);
  if (!o.wav.empty()) write_file(o.wav, wav_of(o.task, result.session(), o.wav_scale_db));
  if (!o.csv.empty()) write_file(o.csv, to_csv(result.values));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(result.values));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of_touch(result, skin, o.task.touch));
}

}  // namespace

void add_touch(Program& program) {
  add_subcommand<TouchCommand>(
      program,
      {"touch", "one touch: where skin meets a model, its fingers and their foci",
       "  palpa touch --scene assets/cube.glb --points assets/finger.ply --penetration 3mm\n"
       "  palpa touch --scene assets/cube.glb --depth assets/depth/hand.png \\\n"
       "              --camera assets/depth/camera.toml",
       "--scene --points --depth --camera --penetration --method --foci --layout --spectrum --csv",
       "Depths and coordinates are in metres, in the world (glTF's axes, +y up)."},
      add_options_of_touch, run_touch);
}

}  // namespace palpa::cli
