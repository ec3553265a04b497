#include <fmt/format.h>

#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "cli/study/commands.hpp"
#include "line/values.hpp"
#include "setup/options/options.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/sessions/study_plan.hpp"
#include "study/sitting/record.hpp"
#include "study/sitting/rehearsal.hpp"

namespace palpa::cli {
namespace {

struct RehearseCommand {
  setup::CommonOptions common;
  std::string plan;
  std::optional<std::uint32_t> participant;
  std::string out;
  double accuracy = 0.5;
};

void add_options_of_rehearse(CLI::App& app, RehearseCommand& o) {
  const line::Group group(app, "Rehearsal");
  group.text("plan", o.plan, "PLAN", "TOML file of the study");
  group.integer("--participant", o.participant, 1, study::most_participant_number, "number of the participant");
  group.text("--out", o.out, "DIR", "folder of the rehearsal; the participant's folder is made in it");
  group.number("--accuracy", o.accuracy, {0, 1}, "NUMBER", "share of right answers, 0 to 1");
}

void run_rehearse(const RehearseCommand& o) {
  if (!o.participant) throw bad_usage("--participant is missing: give a number, such as 1");
  if (o.out.empty()) throw bad_usage("--out is missing: give a folder for the rehearsal");
  const Outputs outputs({{"--json", o.common.json}});
  study::StudyPlan plan = setup::load_plan(o.plan);
  setup::try_files(plan);
  const setup::Interrupt interrupt("ended without finishing, one second after the signal: a disk did not answer");
  study::Record record(plan, *o.participant, o.out, true);
  const study::ScriptedParticipant participant(o.accuracy, *o.participant, o.common.seed);
  const study::Entry start{.text = study::utc_now(), .version = version_and_commit(), .rehearsal = true};
  // A rehearsal that has finished is only reported again.
  const bool finished = record.agenda().finished();
  const bool ended = finished || study::rehearse(
                                     plan, record.agenda(), start, participant,
                                     [&](const study::Entry& entry) { record.add(entry); }, &setup::Interrupt::flag());
  const study::Agenda agenda = record.agenda();
  if (!o.common.json.empty()) write_file(o.common.json, to_json(agenda, *o.participant));
  if (!ended) {
    throw failure(fmt::format("stopped by a signal after {} of {} steps; the same command continues", agenda.complete(),
                              agenda.steps().size()));
  }
  if (setup::shows_summary(o.common, outputs)) {
    write_file("-", fmt::format("participant {}: {} complete, {} void, {}; see {}\n", *o.participant,
                                counted(agenda.complete(), "step"), agenda.voided(), counted(agenda.starts(), "start"),
                                record.folder().beh().string()));
  }
}

}  // namespace

void add_study_rehearse(Program& program) {
  add_subcommand<RehearseCommand>(
      program,
      {"study rehearse", "goes through a plan with a scripted participant, without an array",
       "  palpa study rehearse assets/studies/paper.toml --participant 1 --out rehearsal\n"
       "  palpa study analyse rehearsal",
       "--participant --out --accuracy",
       "Nothing sounds and nothing waits: the times are those of the plan. The logs say that they are a rehearsal. "
       "--seed chooses the answers. A rehearsal that was stopped is continued."},
      add_options_of_rehearse, run_rehearse, setup::Computes::on_processor);
}

}  // namespace palpa::cli
