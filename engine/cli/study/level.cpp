#include <fmt/format.h>

#include <iterator>
#include <string>

#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "cli/study/commands.hpp"
#include "line/values.hpp"
#include "setup/options/options.hpp"
#include "setup/options/study_options.hpp"
#include "setup/sessions/study_plan.hpp"
#include "study/sitting/ear_level.hpp"

namespace palpa::cli {
namespace {

struct LevelCommand {
  setup::CommonOptions common;
  std::string plan;
  std::string override_by;
};

void add_options_of_level(CLI::App& app, LevelCommand& o) {
  const line::Group group(app, "Level");
  group.text("plan", o.plan, "PLAN", "TOML file of the study");
  setup::add_override(group, o.override_by);
}

std::string level_text(const study::StudyPlan& plan, const study::EarLevel& level) {
  std::string text = fmt::format("predicted within {:.0f} cm of the ears, in dB SPL: left {:.1f}, right {:.1f}\n",
                                 study::ear_ball_m * 100, level.db[0], level.db[1]);
  const auto add = [&](const std::string& line) { text += line + '\n'; };
  add(fmt::format("reflections may add or take away {:.0f} dB: up to {:.1f} dB", study::reflections_db,
                  level.predicted_db() + study::reflections_db));
  add(fmt::format("the loudest drive: {} of {}, {}, at the ceiling {}", counted(level.foci.size(), "focus"),
                  level.layout, level.full_amplitude ? "with equal amplitudes" : "normalised", plan.level.ceiling));
  add(fmt::format("no drive is louder than {:.1f} dB, with all transducers in phase at the ear", level.bound_db));
  if (level.measured) {
    add(fmt::format("measured: {:.1f} dB at the ceiling {}, so {:.1f} dB at {}; this counts", *plan.level.measured_db,
                    plan.level.measured_ceiling, *level.measured, plan.level.ceiling));
  }
  add(fmt::format("equivalent for 8 hours, if the array sounds for {:.3g} min: {:.1f} dB", level.sounding_s / 60,
                  level.equivalent_db()));
  add(fmt::format("limits:\n  {:5.1f} dB  this plan's", plan.level.limit_db));
  for (const study::EarLimit& limit : study::ear_limits())
    add(fmt::format("  {:5.1f} dB  {}: {}", limit.db, limit.who, limit.what));
  return text;
}

std::string level_json(const study::StudyPlan& plan, const study::EarLevel& level) {
  JsonWriter json;
  json.begin_object().member("left_db", level.db[0]).member("right_db", level.db[1]).member("bound_db", level.bound_db);
  if (level.measured) json.member("measured_db", *level.measured);
  json.member("level_db", level.loudest_db())
      .member("equivalent_8h_db", level.equivalent_db())
      .member("reflections_db", study::reflections_db)
      .member("sounding_s", level.sounding_s)
      .member("layout", level.layout)
      .member("foci_m", level.foci)
      .member("ceiling", plan.level.ceiling)
      .member("limit_db", plan.level.limit_db)
      .end_object();
  return json.take();
}

void run_level(const LevelCommand& o) {
  const Outputs outputs({{"--json", o.common.json}});
  study::StudyPlan plan = setup::load_plan(o.plan);
  const std::vector<Box> objects = setup::try_files(plan);
  study::refuse_silent(plan);
  const study::EarLevel level = study::predict_ear_level(plan, objects);
  study::check_signature(plan, level, o.override_by);
  if (!o.common.json.empty()) write_file(o.common.json, level_json(plan, level));
  if (setup::shows_summary(o.common, outputs)) write_file("-", level_text(plan, level));
  study::refuse_loud(plan, level, o.override_by);
}

}  // namespace

void add_study_level(Program& program) {
  add_subcommand<LevelCommand>(program,
                               {"study level", "how loud the array will be at a participant's ears",
                                "  palpa study level assets/studies/paper.toml\n"
                                "  palpa study level loud.toml --override 'ethics 12/2026'",
                                "--override",
                                "It fails if the level is above the limit of the plan. A prediction does not "
                                "replace a measurement: measure the level before the first participant comes."},
                               add_options_of_level, run_level, setup::Computes::on_processor);
}

}  // namespace palpa::cli
