#include "cli/study/outputs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/study/in_python.hpp"

namespace palpa::cli {

void add_study_outputs(CLI::App& app, StudyOutputs& options, const std::string& rows) {
  const line::Group group(app, "Results");
  group.text("--html", options.html, "FILE|-",
             "writes a report with figures: one file, without scripts, for print, too");
  group.text("--csv", options.csv, "FILE|-", fmt::format("writes a table: {}", rows));
}

void add_study_script(CLI::App& app, StudyOutputs& options) {
  const line::Group group(app, "A report of your own");
  group.text("--script", options.script, "FILE",
             "writes a Python program that makes the report, for changes of your own; Python does all of the command");
}

void leave_to_python(const std::string& command, const std::vector<std::string>& sources,
                     const setup::CommonOptions& common, const StudyOutputs& options) {
  if (options.script.empty()) return;
  std::vector<std::string> words{command, "--script=" + options.script, "--seed=" + std::to_string(common.seed)};
  for (const auto& [option, file] :
       {std::pair("--json=", &common.json), {"--html=", &options.html}, {"--csv=", &options.csv}}) {
    if (!file->empty()) words.push_back(option + *file);
  }
  if (common.quiet) words.emplace_back("--quiet");
  words.emplace_back("--");
  words.insert(words.end(), sources.begin(), sources.end());
  run_in_python(std::move(words));
}

std::vector<Output> outputs_of(const setup::CommonOptions& common, const StudyOutputs& options) {
  return {{"--json", common.json}, {"--html", options.html}, {"--csv", options.csv}, {"--script", options.script}};
}

void refuse_participants_folders(const std::vector<std::string>& studies, const std::vector<Output>& outputs) {
  namespace fs = std::filesystem;
  std::error_code fault;
  for (const Output& output : outputs) {
    if (output.target.empty() || output.target == "-") continue;
    const fs::path file = fs::weakly_canonical(output.target, fault);
    for (const std::string& study : studies) {
      const fs::path within = file.lexically_relative(fs::canonical(study, fault));
      if (!within.has_parent_path() || !within.begin()->string().starts_with("sub-")) continue;
      throw bad_usage(fmt::format("{} {}: is in the folder of a participant; give a file that is not in one",
                                  output.option, output.target));
    }
  }
}

std::vector<std::string> names_in_reports(const std::vector<std::string>& sources) {
  namespace fs = std::filesystem;
  const auto name_of = [](const std::string& source, std::size_t parts) {
    fs::path rest = fs::path(source).lexically_normal();
    if (!rest.has_filename()) rest = rest.parent_path();  // it ended with a slash
    fs::path name;
    for (std::size_t i = 0; i < parts && rest.has_filename(); ++i, rest = rest.parent_path())
      name = name.empty() ? rest.filename() : rest.filename() / name;
    return name.empty() ? source : name.string();
  };
  constexpr std::size_t most_parts = 64;
  std::vector<std::string> names;
  for (const std::string& source : sources) {
    const auto is_alone = [&](std::size_t parts) {
      return std::ranges::none_of(sources, [&](const std::string& other) {
        return other != source && name_of(other, parts) == name_of(source, parts);
      });
    };
    std::size_t parts = 1;
    while (parts < most_parts && !is_alone(parts))
      ++parts;
    names.push_back(name_of(source, parts));
  }
  return names;
}

std::vector<std::string> lines_in_reports(std::vector<std::string> lines, const std::vector<std::string>& sources) {
  const std::vector<std::string> names = names_in_reports(sources);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    std::string path = sources[i];
    while (path.size() > 1 && path.ends_with('/'))
      path.pop_back();
    for (std::string& line : lines) {
      for (std::size_t at = 0; (at = line.find(path, at)) != std::string::npos;) {
        const std::size_t end = at + path.size();
        const bool whole =
            (at == 0 || line[at - 1] == ' ') && end < line.size() && (line[end] == '/' || line[end] == ':');
        if (whole) line.replace(at, path.size(), names[i]);
        at += whole ? names[i].size() : path.size();
      }
    }
  }
  return lines;
}

void write_reports(const setup::CommonOptions& common, const StudyOutputs& options, const Outputs& declared,
                   const Reports& reports) {
  if (!common.json.empty()) write_file(common.json, reports.json());
  if (!options.html.empty()) write_file(options.html, reports.html());
  if (!options.csv.empty()) write_file(options.csv, reports.csv());
  if (setup::shows_summary(common, declared)) write_file("-", reports.text());
}

void warn_of(const std::vector<std::string>& lines) {
  for (const std::string& line : lines)
    log::warning(line);
}

}  // namespace palpa::cli
