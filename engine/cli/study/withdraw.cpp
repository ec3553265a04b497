#include "study/sitting/withdrawal.hpp"

#include <fmt/format.h>

#include <string>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "cli/study/commands.hpp"
#include "line/values.hpp"
#include "setup/options/options.hpp"
#include "study/plan/order.hpp"

namespace palpa::cli {
namespace {

struct WithdrawCommand {
  setup::CommonOptions common;
  std::vector<std::string> participant;
  std::string out;
};

void add_options_of_withdraw(CLI::App& app, WithdrawCommand& o) {
  const line::Group group(app, "Who withdraws");
  group.words("participant", o.participant, "N", "number of the participant");
  group.text("--out", o.out, "DIR", "folder of the study");
}

/// Names are refused: a number is all that palpa knows of a participant.
std::uint32_t number_in(const std::string& word) {
  const std::optional<double> number = parse_number(word);
  if (!number || *number < 1 || *number > study::most_participant_number ||
      *number != static_cast<double>(static_cast<std::uint32_t>(*number)) || word.find('.') != std::string::npos) {
    throw bad_usage(fmt::format("participants are numbers from 1 to {}, and '{}' is not one",
                                study::most_participant_number, printable(word, 40)));
  }
  return static_cast<std::uint32_t>(*number);
}

void run_withdraw(const WithdrawCommand& o) {
  if (o.participant.size() != 1) throw bad_usage("give palpa study withdraw the number of one participant");
  if (o.out.empty()) throw bad_usage("--out is missing: give the folder of the study");
  const std::uint32_t number = number_in(o.participant.front());
  const Outputs outputs({{"--json", o.common.json}});
  const study::Withdrawal withdrawal = study::withdraw(o.out, number);
  for (const std::filesystem::path& place : withdrawal.remaining)
    log::warning(fmt::format("{} remains, because only a link to it was in the folder: erase it, too", place.string()));
  for (const study::OtherNames& file : withdrawal.other_names) {
    log::warning(fmt::format(
        "the content of {} remains under {} elsewhere (hard links), which find -inum {} finds: erase "
        "{}, too",
        file.file.string(), counted(file.names, "other name"), file.inode, file.names == 1 ? "it" : "them"));
  }
  if (!o.common.json.empty()) {
    JsonWriter json;
    json.begin_object()
        .member("participant", number)
        .member("erased", withdrawal.files)
        .member("withdrew_before", withdrawal.before)
        .key("remaining")
        .begin_array();
    for (const std::filesystem::path& place : withdrawal.remaining)
      json.value(place.string());
    json.end_array().key("other_names").begin_array();
    for (const study::OtherNames& file : withdrawal.other_names) {
      json.begin_object()
          .member("file", file.file.string())
          .member("names", file.names)
          .member("inode", file.inode)
          .end_object();
    }
    json.end_array().end_object();
    write_file(o.common.json, json.take());
  }
  if (setup::shows_summary(o.common, outputs)) {
    const bool nothing = withdrawal.before && withdrawal.files == 0;
    write_file("-", nothing ? fmt::format("participant {} had withdrawn before; nothing was left to erase\n", number)
                            : fmt::format("participant {} has withdrawn: {} files and folders erased\n", number,
                                          withdrawal.files));
  }
}

}  // namespace

void add_study_withdraw(Program& program) {
  add_subcommand<WithdrawCommand>(
      program,
      {"study withdraw", "erases all files of a participant, and reserves the number",
       "  palpa study withdraw 7 --out my-study\n"
       "  palpa study withdraw 7 --out my-study --json withdrawn.json",
       "--out", "Files are removed from the folder. Copies elsewhere, such as backups, are yours to erase.", "N"},
      add_options_of_withdraw, run_withdraw, setup::Computes::on_processor);
}

}  // namespace palpa::cli
