#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/outputs.hpp"
#include "cli/study/commands.hpp"
#include "cli/study/outputs.hpp"
#include "study/comparison.hpp"
#include "study/report/reports.hpp"

namespace palpa::cli {
namespace {

struct CompareCommand {
  setup::CommonOptions common;
  std::vector<std::string> sources;
  StudyOutputs outputs;
};

void add_options_of_compare(CLI::App& app, CompareCommand& o) {
  const line::Group group(app, "What to compare");
  group.words("what", o.sources, "WHAT...",
              "the word paper, folders of studies, CSV files of counts, JSON files of palpa study analyse or compare; "
              "a study has "
              "one table per method");
  add_study_outputs(app, o.outputs, "one row per table");
  add_study_script(app, o.outputs);
}

void run_compare(const CompareCommand& o) {
  if (o.sources.empty())
    throw bad_usage("give palpa study compare at least two tables, such as the word paper and the folder of a study");
  const std::vector<Output> files = outputs_of(o.common, o.outputs);
  const Outputs outputs(files);
  std::vector<std::string> left_out;
  std::vector<study::NamedTable> tables;
  constexpr std::size_t most_tables = 100;
  const std::vector<std::string> names = names_in_reports(o.sources);
  for (std::size_t i = 0; i < o.sources.size(); ++i) {
    for (study::NamedTable& table : study::tables_of(o.sources[i], left_out)) {
      table.name.replace(0, o.sources[i].size(), names[i]);
      tables.push_back(std::move(table));
    }
    if (tables.size() > most_tables) throw bad_usage("these are more than 100 tables: give fewer");
  }
  refuse_participants_folders(o.sources, files);
  if (tables.size() < 2)
    throw bad_usage(
        "one table alone cannot be compared: give palpa study compare at least two, such as the word paper");
  leave_to_python("compare", o.sources, o.common, o.outputs);
  const study::Comparison comparison = study::compare_tables(std::move(tables));
  left_out.insert(left_out.end(), comparison.not_compared.begin(), comparison.not_compared.end());
  warn_of(left_out);
  left_out = lines_in_reports(std::move(left_out), o.sources);
  write_reports(o.common, o.outputs, outputs,
                {.text = [&] { return comparison_text(comparison); },
                 .json = [&] { return comparison_json(comparison, left_out); },
                 .csv = [&] { return comparison_csv(comparison); },
                 .html = [&] { return comparison_html(comparison, left_out); }});
}

}  // namespace

void add_study_compare(Program& program) {
  add_subcommand<CompareCommand>(program,
                                 {"study compare", "compares results with each other, and with the paper's",
                                  "  palpa study compare paper my-study --html beside.html\n"
                                  "  palpa study compare first.csv second.csv --json -",
                                  "",
                                  "The tests of two tables take all trials as independent, so they describe a "
                                  "difference. palpa study analyse tests over participants.",
                                  "WHAT..."},
                                 add_options_of_compare, run_compare, setup::Computes::on_processor);
}

}  // namespace palpa::cli
