#include "study/power.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "cli/study/commands.hpp"
#include "cli/study/outputs.hpp"
#include "study/report/reports.hpp"

namespace palpa::cli {
namespace {

struct PowerCommand {
  setup::CommonOptions common;
  study::PowerSetting setting;
  StudyOutputs outputs;
};

void add_options_of_power(CLI::App& app, PowerCommand& o) {
  study::PowerSetting& s = o.setting;
  const line::Group effect(app, "Effect");
  effect.number("--baseline", s.a, {0, 1}, "NUMBER", "mean accuracy with the first method, 0 to 1");
  effect.number("--accuracy", s.b, {0, 1}, "NUMBER", "mean accuracy with the second method, 0 to 1");
  effect.number("--spread", s.spread, {0, 0.5}, "NUMBER",
                "standard deviation of participants' accuracies, without the chance in their trials");
  effect.number("--correlation", s.correlation, {-1, 1}, "NUMBER",
                "correlation of a participant's accuracies with both methods");
  const line::Group plan(app, "Study");
  plan.integer("--trials", s.trials, 1, 1000, "trials of each participant with each method");
  plan.number("--alpha", s.alpha, line::positive(0.5), "NUMBER", "a difference is found if p is at most this");
  plan.number("--power", s.power, line::positive(1), "NUMBER", "share of studies that are to find the difference");
  plan.integer("--people", s.most_people, 2, study::most_simulated_people, "the most participants that are tried");
  plan.integer("--studies", s.studies, 100, 20'000, "studies simulated for each number of participants");
  add_study_outputs(app, o.outputs, "one row per number of participants");
}

/// Warns of a mean so near to 0 or 1 that the simulated participants have another one.
void warn_of_bounds(const char* option, double mean, double spread) {
  constexpr double little = 0.002;
  const double simulated = study::mean_within_bounds(mean, spread);
  if (std::abs(simulated - mean) < little) return;
  log::warning(
      fmt::format("{} {:g}: with --spread {:g}, some participants would have an accuracy {}; they get {}, so "
                  "the simulated mean is {:.3f}: give a smaller --spread",
                  option, mean, spread, mean > 0.5 ? "above 1" : "below 0", mean > 0.5 ? 1 : 0, simulated));
}

void run_power(const PowerCommand& o) {
  study::PowerSetting setting = o.setting;
  setting.seed = o.common.seed;
  if (std::uint64_t{setting.studies} * setting.most_people * setting.trials > study::most_simulated_trials) {
    throw bad_usage(fmt::format("--studies times --people times --trials is more than {} million: give less of one",
                                study::most_simulated_trials / 1'000'000));
  }
  const Outputs outputs(outputs_of(o.common, o.outputs));
  warn_of_bounds("--baseline", setting.a, setting.spread);
  warn_of_bounds("--accuracy", setting.b, setting.spread);
  const study::PowerResult result = study::find_power(setting);
  const std::vector<study::OtherCorrelation> others = study::at_other_correlations(setting);
  write_reports(o.common, o.outputs, outputs,
                {.text = [&] { return power_text(setting, result, others); },
                 .json = [&] { return power_json(setting, result, others); },
                 .csv = [&] { return power_csv(result); },
                 .html = [&] { return power_html(setting, result, others); }});
}

}  // namespace

void add_study_power(Program& program) {
  add_subcommand<PowerCommand>(
      program,
      {"study power", "how many participants an experiment needs, by simulation",
       "  palpa study power\n"
       "  palpa study power --baseline 0.5 --accuracy 0.6 --trials 40 --power 0.9",
       "--baseline --accuracy --spread --correlation --trials --alpha --power --people --html --csv",
       "The defaults are the paper's accuracies, trials and correlation; its spread is not known. --seed chooses the "
       "simulated studies."},
      add_options_of_power, run_power, setup::Computes::on_processor);
}

}  // namespace palpa::cli
