#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/files/sha256.hpp"
#include "cli/study/commands.hpp"
#include "cli/study/outputs.hpp"
#include "experiment/observe.hpp"
#include "observer/comparison.hpp"
#include "observer/predicted/prediction_reports.hpp"
#include "observer/prediction.hpp"
#include "setup/files/assets.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/study_plan.hpp"
#include "study/comparison.hpp"
#include "study/plan/plan_file.hpp"

namespace palpa::cli {
namespace {

struct StudySimulateCommand {
  setup::CommonOptions common;
  std::vector<std::string> beside;
  std::string plan, finger, prediction;
  StudyOutputs outputs;
};

void add_options_of_study_simulate(CLI::App& app, StudySimulateCommand& o) {
  const line::Group group(app, "What to predict");
  group.text("plan", o.plan, "PLAN", "TOML file of the study");
  setup::add_finger(group, o.finger, " [the paper's]");
  group.texts("--beside", o.beside, "WHAT",
              "results of people beside the prediction: the word paper, the folder of a study, a JSON of palpa study "
              "analyse, or a CSV of counts that has a method's name");
  add_study_outputs(app, o.outputs, "one row per variant and method");
  const line::Group results(app, "Results");
  results.text("--prediction", o.prediction, "FILE|-",
               "writes the prediction alone, the text that has the reported SHA-256");
}

/// The method of a table that came from this source: what follows the source in its name, or a CSV's own name.
std::string method_of(const std::string& table, const std::string& source) {
  const std::string before = source + ": ";
  return table.starts_with(before) ? table.substr(before.size()) : std::filesystem::path(source).stem().string();
}

void run_study_simulate(const StudySimulateCommand& o) {
  std::vector<Output> declared = outputs_of(o.common, o.outputs);
  declared.push_back({"--prediction", o.prediction});
  const Outputs outputs(declared);
  const study::StudyPlan plan = setup::load_plan(o.plan);
  study::refuse_without_fit(plan);
  // Results of people are read first, so that a fault in them is told at once. The prediction does not get them.
  std::vector<std::string> left_out;
  std::vector<observer::ObservedTable> tables;
  const std::vector<std::string> names = names_in_reports(o.beside);
  for (std::size_t i = 0; i < o.beside.size(); ++i) {
    const std::string& source = o.beside[i];
    for (study::NamedTable& table : study::tables_of(source, left_out))
      tables.push_back({method_of(table.name, source), names[i], std::move(table.table)});
  }
  experiment::ObservedFinger finger(o.finger.empty() ? setup::find_asset("finger.ply") : o.finger);
  std::optional<setup::Preparing> progress(std::in_place, o.common.quiet);
  const observer::Prediction prediction =
      observer::predict(experiment::observe(plan, finger),
                        {.fitted = {plan.fit.method, plan.fit.accuracy, plan.fit.trials},
                         .observers = plan.counts.participants,
                         .trials_per_shape = plan.counts.trials_per_shape,
                         .touch_s = plan.counts.touch_s,
                         .seed = o.common.seed},
                        {.keep = true});
  progress.reset();
  const std::string document = observer::prediction_document(prediction), hash = sha256(document);
  observer::Comparison comparison = observer::compare(prediction, tables);
  comparison.left_out.insert(comparison.left_out.begin(), left_out.begin(), left_out.end());
  warn_of(comparison.left_out);
  comparison.left_out = lines_in_reports(std::move(comparison.left_out), o.beside);
  if (!o.prediction.empty()) write_file(o.prediction, document);
  write_reports(o.common, o.outputs, outputs,
                {.text = [&] { return prediction_text(prediction, comparison, hash); },
                 .json = [&] { return prediction_json(prediction, comparison, hash); },
                 .csv = [&] { return prediction_csv(prediction, comparison); },
                 .html = [&] { return prediction_html(prediction, comparison, hash); }});
}

}  // namespace

void add_study_simulate(Program& program) {
  add_subcommand<StudySimulateCommand>(
      program,
      {"study simulate", "what an ideal observer would answer in a planned experiment",
       "  palpa study simulate assets/studies/paper.toml --beside paper --html prediction.html\n"
       "  palpa study simulate my-plan.toml --prediction prediction.json",
       "",
       "The observer's only fitted number is in the plan. Touches are computed once and kept. --seed chooses the "
       "simulated studies. docs/observer.md says what the prediction is worth.",
       "PLAN"},
      add_options_of_study_simulate, run_study_simulate, setup::Computes::on_processor);
}

}  // namespace palpa::cli
