#include "study/analysis.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "cli/study/commands.hpp"
#include "cli/study/outputs.hpp"
#include "study/comparison.hpp"
#include "study/files/counts_file.hpp"
#include "study/files/study_folder.hpp"
#include "study/report/reports.hpp"

namespace palpa::cli {
namespace {

struct AnalyseCommand {
  setup::CommonOptions common;
  std::vector<std::string> sources;
  StudyOutputs outputs;
};

void add_options_of_analyse(CLI::App& app, AnalyseCommand& o) {
  const line::Group group(app, "What to analyse");
  group.words(
      "what", o.sources, "DIR...|COUNTS.csv",
      "folders of a study, with the participants' logs in sub-N/beh; or one file with a table of counts, actual "
      "shapes in rows and answers in columns");
  add_study_outputs(app, o.outputs, "one row per participant and method; for counts, one row");
  add_study_script(app, o.outputs);
}

/// Whether the study has questions of its own, which only Python analyses.
bool asks_more(const std::string& source) {
  std::error_code fault;
  return std::filesystem::exists(std::filesystem::path(source) / "trials.tsv", fault);
}

bool is_folder(const std::string& source) {
  std::error_code fault;
  return std::filesystem::is_directory(source, fault);
}

void analyse_counts(const AnalyseCommand& o, const Outputs& outputs) {
  study::CountsFile file = study::read_counts(o.sources[0]);
  leave_to_python("analyse", o.sources, o.common, o.outputs);
  std::vector<std::string> left_out;
  left_out.insert(left_out.end(), file.warnings.begin(), file.warnings.end());
  warn_of(left_out);
  left_out = lines_in_reports(std::move(left_out), o.sources);
  const study::Comparison table = study::compare_tables({{names_in_reports(o.sources)[0], std::move(file.table)}});
  write_reports(o.common, o.outputs, outputs,
                {.text = [&] { return comparison_text(table); },
                 .json = [&] { return comparison_json(table, left_out); },
                 .csv = [&] { return comparison_csv(table); },
                 .html = [&] { return comparison_html(table, left_out); }});
}

void run_analyse(const AnalyseCommand& o) {
  if (o.sources.empty()) throw bad_usage("give palpa study analyse the folder of a study, or a CSV file of counts");
  const std::vector<Output> files = outputs_of(o.common, o.outputs);
  const Outputs outputs(files);
  if (o.sources.size() == 1 && !is_folder(o.sources[0])) {
    analyse_counts(o, outputs);
    return;
  }
  if (std::ranges::any_of(o.sources, asks_more)) leave_to_python("analyse", o.sources, o.common, o.outputs);
  study::Study study = study::read_study(o.sources);
  refuse_participants_folders(o.sources, files);
  leave_to_python("analyse", o.sources, o.common, o.outputs);
  warn_of(study.left_out);
  study.left_out = lines_in_reports(std::move(study.left_out), o.sources);
  const study::Analysis analysis = study::analyse(std::move(study), o.common.seed);
  write_reports(o.common, o.outputs, outputs,
                {.text = [&] { return analysis_text(analysis); },
                 .json = [&] { return analysis_json(analysis); },
                 .csv = [&] { return analysis_csv(analysis); },
                 .html = [&] { return analysis_html(analysis); }});
}

}  // namespace

void add_study_analyse(Program& program) {
  add_subcommand<AnalyseCommand>(
      program,
      {"study analyse", "the results of an experiment: can people tell the shapes apart?",
       "  palpa study analyse my-study --html report.html\n"
       "  palpa study analyse counts.csv --json -",
       "",
       "--seed chooses the resamples of the bootstrap. Logs and rows that cannot be read are left out, with a warning "
       "each. docs/study-analysis.md explains the files and every measure.",
       "DIR...|COUNTS.csv"},
      add_options_of_analyse, run_analyse, setup::Computes::on_processor);
}

}  // namespace palpa::cli
