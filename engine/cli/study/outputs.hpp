// What the subcommands of `palpa study` share: their outputs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "line/values.hpp"
#include "setup/options/options.hpp"

namespace palpa::cli {

/// --html and --csv, beside the common --json; of some commands, --script.
struct StudyOutputs {
  std::string html, csv, script;
};
/// `rows`: what a row of the CSV is about, such as "one row per participant and method".
void add_study_outputs(CLI::App& app, StudyOutputs& options, const std::string& rows);
/// --script, with which the analysis in Python does the work.
void add_study_script(CLI::App& app, StudyOutputs& options);
/// If the line has --script, Python does all of it, and this does not return. The inputs must have been read, so that
/// an output that is one of them has been refused.
void leave_to_python(const std::string& command, const std::vector<std::string>& sources,
                     const setup::CommonOptions& common, const StudyOutputs& options);

/// The reports of a result, computed only if they are written.
struct Reports {
  std::function<std::string()> text, json, csv, html;
};
/// The outputs on the line, to be declared before anything is read.
std::vector<Output> outputs_of(const setup::CommonOptions& common, const StudyOutputs& options);
/// Throws bad_usage for an output in the folder of a participant, sub-N, of one of these studies. A report reads only
/// the logs there, but it must not replace the other files, such as the journal, either.
void refuse_participants_folders(const std::vector<std::string>& studies, const std::vector<Output>& outputs);
/// Writes the reports that the line asks for, and the text if nothing else goes to stdout.
void write_reports(const setup::CommonOptions& common, const StudyOutputs& options, const Outputs& declared,
                   const Reports& reports);

/// What reports call these files and folders: the last part of each path, or as many parts as tell them apart.
std::vector<std::string> names_in_reports(const std::vector<std::string>& sources);
/// Lines about these files and folders, and about files in them, with the names that reports use.
std::vector<std::string> lines_in_reports(std::vector<std::string> lines, const std::vector<std::string>& sources);

/// One warning per line.
void warn_of(const std::vector<std::string>& lines);

}  // namespace palpa::cli
