#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "cli/study/commands.hpp"
#include "experiment/observe.hpp"
#include "line/values.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/study_plan.hpp"
#include "study/plan/order.hpp"
#include "study/sitting/ear_level.hpp"

namespace palpa::cli {
namespace {

struct PlanCommand {
  setup::CommonOptions common;
  std::string plan;
  std::uint32_t participant = 1;
  std::string csv;
};

void add_options_of_plan(CLI::App& app, PlanCommand& o) {
  const line::Group group(app, "Plan");
  group.text("plan", o.plan, "PLAN", "TOML file of the study");
  group.integer("--participant", o.participant, 1, study::most_participant_number, "number of the participant");
  group.text("--csv", o.csv, "FILE", "writes the participant's order, one row per step");
}

std::string time_text(double seconds) {
  return seconds < 120 ? fmt::format("{:.3g} s", seconds) : fmt::format("{:.3g} min", seconds / 60);
}

/// How loud and how strong the plan's sound is.
struct Strength {
  study::EarLevel level;
  double crest_n = 0;        ///< of a single focus on a finger
  double paper_ceiling = 0;  ///< at which that would be the paper's
  double paper_db = 0;       ///< with exact amplitudes
};

constexpr double paper_n = 16e-3;

Strength strength_of(const study::StudyPlan& plan, std::span<const Box> objects) {
  experiment::ObservedFinger finger(setup::find_asset("finger.ply"));
  const double paper_ceiling = experiment::ceiling_for_n(plan, paper_n, finger);
  double full_db = 0;
  study::EarLevel level = study::predict_ear_level(plan, objects, nullptr, &full_db);
  // Boards play full amplitude exactly, and sound pressure follows the ceiling.
  const double paper_db = full_db + 20 * std::log10(paper_ceiling);
  return {std::move(level), experiment::crest_force_n(plan, finger), paper_ceiling, paper_db};
}

std::string plan_text(const study::StudyPlan& plan, std::uint32_t participant, const std::vector<study::Step>& steps,
                      const Strength& strength) {
  std::string text =
      fmt::format("{}: {} shapes, {}, {}\n", plan.title.empty() ? plan.file : plan.title, plan.shapes.size(),
                  counted(plan.methods.size(), "method"), counted(plan.counts.participants, "participant"));
  fmt::format_to(std::back_inserter(text), "participant {}: {}, {} of touch\n", participant,
                 counted(steps.size(), "step"), time_text(study::sounding_s(plan)));
  fmt::format_to(std::back_inserter(text),
                 "at the ceiling {:g}: {:.1f} dB {} at the louder ear (limit {:g} dB), a force of {:.2g} mN at the "
                 "crest of a single focus\n",
                 plan.level.ceiling, strength.level.loudest_db(), strength.level.word(), plan.level.limit_db,
                 strength.crest_n * 1e3);
  fmt::format_to(std::back_inserter(text), "the paper's force, {:g} mN, needs a ceiling of about {:.2g}{}, {:.0f} dB\n",
                 paper_n * 1e3, strength.paper_ceiling, strength.paper_ceiling > 1 ? ", more than the array has" : "",
                 strength.paper_db);
  for (std::size_t i = 0; i < steps.size();) {
    const study::PlanBlock& block = plan.blocks[steps[i].block];
    std::size_t end = i;
    while (end < steps.size() && steps[end].round == steps[i].round)
      ++end;
    fmt::format_to(std::back_inserter(text), "  {:<14} {:<14} {:>3} x {}\n", plan.methods[steps[i].method].name,
                   word_of(study::block_words, block.kind), end - i, time_text(block.touch_s));
    i = end;
  }
  return text;
}

std::string plan_json(const study::StudyPlan& plan, std::uint32_t participant, const std::vector<study::Step>& steps,
                      const Strength& strength) {
  JsonWriter json;
  json.begin_object()
      .member("title", plan.title)
      .member("sha256", plan.sha256)
      .member("participant", participant)
      .member("participants", plan.counts.participants)
      .member("touch_s", study::sounding_s(plan))
      .member("masking", plan.run.masking)
      .member("ceiling", plan.level.ceiling)
      .member("limit_db", plan.level.limit_db)
      .member("level_db", strength.level.loudest_db())
      .member("crest_n", strength.crest_n)
      .member("paper_n", paper_n)
      .member("paper_ceiling", strength.paper_ceiling)
      .member("least_trials", plan.counts.least_trials)
      .key("steps")
      .begin_array(JsonWriter::Style::rows);
  for (const study::Step& step : steps) {
    const study::BlockKind kind = plan.blocks[step.block].kind;
    json.begin_object()
        .member("kind", word_of(study::block_words, kind))
        .member("method", plan.methods[step.method].name);
    if (step.shape && kind != study::BlockKind::free) json.member("shape", plan.shapes[*step.shape].name);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

void run_plan(const PlanCommand& o) {
  if (o.common.seed != 0) throw bad_usage("--seed belongs to the plan: set seed in its [run]");
  const Outputs outputs({{"--json", o.common.json}, {"--csv", o.csv}});
  study::StudyPlan plan = setup::load_plan(o.plan);
  const std::vector<Box> objects = setup::try_files(plan);
  study::refuse_silent(plan);
  const std::vector<study::Step> steps = study::order_of(plan, o.participant);
  const Strength strength = strength_of(plan, objects);
  if (!o.common.json.empty()) write_file(o.common.json, plan_json(plan, o.participant, steps, strength));
  if (!o.csv.empty()) write_file(o.csv, study::order_csv(plan, steps));
  if (setup::shows_summary(o.common, outputs)) write_file("-", plan_text(plan, o.participant, steps, strength));
}

}  // namespace

void add_study_plan(Program& program) {
  add_subcommand<PlanCommand>(
      program,
      {"study plan", "checks the plan of a study, and lists a participant's steps",
       "  palpa study plan assets/studies/paper.toml --participant 6\n"
       "  palpa study plan assets/studies/five-minutes.toml --csv order.csv",
       "--participant --csv", "The order depends on the plan and on the participant's number only."},
      add_options_of_plan, run_plan, setup::Computes::on_processor);
}

}  // namespace palpa::cli
