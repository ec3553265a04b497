// The files of sittings: journals, logs, withdrawals.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "study/files/study_folder.hpp"
#include "study/sitting/record.hpp"
#include "study/sitting/withdrawal.hpp"
#include "study/sitting_plan.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::read_text;

class RecordTest : public testing::Test {
 protected:
  const fs::path folder_ = test::scratch_folder("record");
  const fs::path journal_ = folder_ / "sub-01/sub-01_journal.jsonl";
  const fs::path log_ = folder_ / "sub-01/beh/sub-01_task-shapes_run-01_events.tsv";
  const StudyPlan plan_ = test::small_plan();

  /// Goes on until `entries` entries were written, or to the end.
  void sit(std::uint32_t number, std::size_t entries = 100'000, double accuracy = 1) {
    Record record(plan_, number, folder_, true);
    std::atomic<bool> stop{false};
    std::size_t written = 0;
    const Error error = test::thrown_by([&] {
      rehearse(
          plan_, record.agenda(), {.text = utc_now(), .version = "v", .rehearsal = true},
          ScriptedParticipant(accuracy, number, 1),
          [&](const Entry& entry) {
            if (++written > entries) throw failure("killed");
            record.add(entry);
          },
          &stop);
    });
    EXPECT_STREQ(error.what(), written > entries ? "killed" : "");
  }
  std::string fault_of(std::uint32_t number) {
    return test::thrown_by([&] { Record(plan_, number, folder_, true).refuse_finished(); }).what();
  }
  fs::path file(const std::string& name) const { return folder_ / "sub-01" / name; }
  Study study() const { return read_study(std::vector<std::string>{folder_.string()}); }
};

TEST_F(RecordTest, EachScriptedParticipantAnswersDifferently) {
  for (const std::uint32_t number : {1U, 2U, 3U})
    sit(number, 100'000, 0.5);
  std::set<std::vector<bool>> all;
  for (const Participant& participant : study().participants) {
    std::vector<bool> right;
    for (const Trial& trial : participant.trials)
      right.push_back(trial.correct());
    all.insert(right);
  }
  EXPECT_EQ(all.size(), 3U);
}

TEST_F(RecordTest, WritesALogThatCanBeAnalysed) {
  sit(1);
  const std::string table = read_text(log_);
  EXPECT_EQ(table.substr(0, 33), "onset\tduration\ttrial_type\tmethod\t");
  const json sidecar = json::parse(read_text(file("beh/sub-01_task-shapes_run-01_events.json")));
  EXPECT_TRUE(sidecar.contains("EventsCrc32"));
  EXPECT_EQ(sidecar["Rehearsal"], true);
  EXPECT_EQ(sidecar["LeastTrials"], 3) << "three quarters of four";
  EXPECT_EQ(sidecar["StartTimeUtc"].get<std::string>().back(), 'Z');
  const json stimuli = json::parse(read_text(file("beh/sub-01_task-shapes_run-01_stimuli.json")));
  // Each method: 2 familiarisations, 1 exploration, 1 practice, 4 trials, 4 more practices.
  EXPECT_EQ(stimuli["touches"].size(), 2u * (2 + 1 + 1 + 4 + 4));
  EXPECT_EQ(stimuli["touches"][0]["layout"], "paper");
  const Study read = study();
  ASSERT_EQ(read.participants.size(), 1u);
  EXPECT_EQ(read.participants[0].trials.size(), 8u);
  for (const Trial& trial : read.participants[0].trials) {
    EXPECT_TRUE(trial.correct());
    EXPECT_NEAR(*trial.response_s, 1, 1e-6);
  }
  ASSERT_EQ(read.left_out.size(), 1u);
  EXPECT_CONTAINS(read.left_out[0], "is a rehearsal");
  EXPECT_EQ(read_text(file("sub-01_order.csv")), order_csv(plan_, order_of(plan_, 1)));
}

/// By the table's other columns, and by the touches of the other file.
TEST_F(RecordTest, SaysOfEachStepWhetherItsAnswerIsRight) {
  sit(1, 100'000, 0.5);
  std::istringstream table(read_text(log_));
  std::set<std::string> told;
  std::map<std::string, int> step_at;
  std::string line;
  for (std::getline(table, line); std::getline(table, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '\t');)
      cells.push_back(cell);
    ASSERT_EQ(cells.size(), 18U) << line;
    const bool asks = cells[2] == "trial" || cells[2] == "practice";
    EXPECT_EQ(cells[6], !asks ? "n/a" : cells[5] == cells[4] ? "true" : "false") << line;
    told.insert(cells[6]);
    step_at[cells[0]] = std::stoi(cells[10]);
  }
  EXPECT_EQ(told.size(), 3U);
  const json stimuli = json::parse(read_text(file("beh/sub-01_task-shapes_run-01_stimuli.json")));
  for (const json& touch : stimuli["touches"])
    EXPECT_EQ(touch["step"], step_at[fmt::format("{:.6f}", touch["onset_s"].get<double>())]);
}

TEST_F(RecordTest, OneProcessAtATime) {
  const Record record(plan_, 1, folder_, true);
  EXPECT_CONTAINS(fault_of(1), "another palpa");
}

TEST_F(RecordTest, RefusesWhatIsNotThisParticipantsJournal) {
  sit(1, 10);
  StudyPlan other = test::small_plan();
  other.sha256 = "0";
  EXPECT_ERROR(Record(other, 1, folder_, true), Exit::usage, "was begun with another plan");
  // A person's sitting is not continued by a rehearsal, and the reverse.
  EXPECT_ERROR(Record(plan_, 1, folder_, false), Exit::usage, "is of a rehearsal");
  // Copied from another participant.
  sit(2, 10);
  fs::copy_file(journal_, folder_ / "sub-02/sub-02_journal.jsonl", fs::copy_options::overwrite_existing);
  EXPECT_CONTAINS(fault_of(2), "is the journal of participant 1, not of 2");
  // Edited: the answers before it stay where they are.
  std::string text = read_text(journal_);
  text[text.size() / 2] ^= 1;
  test::write_text(journal_, text);
  EXPECT_CONTAINS(fault_of(1), "is damaged or was changed");
  EXPECT_EQ(read_text(journal_), text);
}

TEST_F(RecordTest, AllParticipantsOfAStudyHaveOnePlan) {
  sit(1, 10);
  sit(2, 10);
  StudyPlan other = test::small_plan();
  other.sha256 = "0";
  EXPECT_ERROR(Record(other, 3, folder_, true), Exit::usage,
               "sub-01_journal.jsonl: participant 1 was begun with another plan, or plan.toml was changed since");
  EXPECT_FALSE(fs::exists(folder_ / "sub-03")) << "the number is not used up";
  EXPECT_EQ(fault_of(3), "");
  // Logs without their journal have the plan, too. Who withdrew has none.
  for (const char* number : {"sub-02", "sub-03"})
    fs::remove_all(folder_ / number);
  fs::remove(journal_);
  EXPECT_ERROR(Record(other, 3, folder_, true), Exit::usage, "_events.json: participant 1 was begun with another plan");
  withdraw(folder_, 1);
  EXPECT_NO_THROW(Record(other, 3, folder_, true));
}

TEST_F(RecordTest, AllTouchesOfAShapeHaveOneModel) {
  StudyPlan plan = plan_;
  for (PlanShape& shape : plan.shapes)
    shape.model_sha256 = "of " + shape.name;
  {
    Record record(plan, 1, folder_, false);
    Entry touched{.kind = EntryKind::touched, .at_ns = 3, .step = 0};
    touched.stimulus = Stimulus{.model_sha256 = plan.shapes[*record.steps()[0].shape].model_sha256};
    record.add({.kind = EntryKind::start, .text = utc_now()});
    record.add({.kind = EntryKind::consent, .at_ns = 1, .accepted = true});
    record.add({.kind = EntryKind::begin, .at_ns = 2, .step = 0});
    record.add(touched);
  }
  const std::size_t touched = *order_of(plan, 1)[0].shape;
  EXPECT_NO_THROW(Record(plan, 1, folder_, false));
  plan.shapes[1 - touched].model_sha256 = "another one";
  EXPECT_NO_THROW(Record(plan, 1, folder_, false)) << "nobody has touched it";
  plan.shapes[touched].model_sha256 = "another one";
  const std::string fault =
      "sub-01_journal.jsonl: the model of '" + plan.shapes[touched].name + "' was another one when it was touched";
  EXPECT_ERROR(Record(plan, 1, folder_, false), Exit::usage, fault);
  EXPECT_ERROR(Record(plan, 2, folder_, false), Exit::usage, fault);
  EXPECT_FALSE(fs::exists(folder_ / "sub-02")) << "the number is not used up";
}

TEST_F(RecordTest, SaysHowLoudATouchWasAndWhatItLost) {
  for (const bool measured : {false, true}) {
    StudyPlan plan = plan_;
    plan.level.limit_db = 121;
    if (measured) plan.level.measured_db = 98;
    fs::remove_all(folder_ / "sub-01");
    {
      Record record(plan, 1, folder_, false);
      record.add({.kind = EntryKind::start, .text = utc_now()});
      record.add({.kind = EntryKind::level, .text = "ethics 12/26", .level_db = 109.5, .dose_db = 104.25});
      record.add({.kind = EntryKind::consent, .at_ns = 1, .accepted = true});
      record.add({.kind = EntryKind::begin, .at_ns = 2, .step = 0});
      record.add({.kind = EntryKind::touched,
                  .at_ns = 3,
                  .sounded_s = 288,
                  .step = 0,
                  .stimulus = Stimulus{.losses = TouchLosses{1, 2, 3, 4}}});
      record.add({.kind = EntryKind::answer, .at_ns = 4, .step = 0, .text = "yes"});
    }
    const std::string table = read_text(log_);
    EXPECT_TRUE(table.ends_with("\tn/a\t1\t2\t3\t4\t0\t0\n")) << table;
    const std::string which = measured ? "Measured" : "Predicted";
    EXPECT_EQ(json::parse(read_text(file("beh/sub-01_task-shapes_run-01_events.json")))["SoundLevel"],
              json({{which + "PeakDb", 109.5},
                    {which + "EquivalentDb", 104.25},
                    {"LimitDb", 121.0},
                    {"SoundedSeconds", 288.0},
                    {"SoundedEquivalentDb", 89.5},
                    {"OverrideSignedBy", "ethics 12/26"}}));
    EXPECT_NO_THROW(Record(plan, 1, folder_, false)) << "it can be continued";
    EXPECT_EQ(read_text(log_), table);
  }
}

TEST_F(RecordTest, RefusesTwoFoldersWithOneNumber) {
  sit(1, 10);
  fs::create_directories(folder_ / "sub-1");
  EXPECT_CONTAINS(fault_of(1), "also has the number 1");
  EXPECT_CONTAINS(fault_of(0), "numbers from 1");
}

TEST_F(RecordTest, RefusesLogsThatTheJournalDoesNotContain) {
  sit(1, 10);
  const std::string journal = read_text(journal_);
  const std::string before = read_text(log_);
  ASSERT_FALSE(before.empty());
  for (const std::size_t left : {std::size_t{20}, journal.find('\n') + 1}) {
    test::write_text(journal_, journal.substr(0, left));
    EXPECT_CONTAINS(fault_of(1), "does not contain the run of " + (folder_ / "sub-01/beh/sub-01_task").string());
    EXPECT_EQ(read_text(log_), before);
  }
  // The start of the run is left, but not what was answered in it.
  std::size_t lines = 0, end = 0;
  while (lines < 3)
    lines += journal[end++] == '\n' ? 1 : 0;
  test::write_text(journal_, journal.substr(0, end));
  EXPECT_CONTAINS(fault_of(1), "does not contain all rows of " + log_.string());
  EXPECT_EQ(read_text(log_), before);
  test::write_text(journal_, "");
  EXPECT_CONTAINS(fault_of(1), "sub-01_journal.jsonl: is empty, but there are 4 files of participant 1 in");
  fs::remove(journal_);
  EXPECT_CONTAINS(fault_of(1), "sub-01_journal.jsonl: is missing, but there are 4 files of participant 1 in");
  EXPECT_FALSE(fs::exists(journal_)) << "nothing was begun";
  EXPECT_EQ(read_text(log_), before);
  // Without its log, too: what was played and where the finger was are data.
  fs::rename(log_, file("log"));
  EXPECT_CONTAINS(fault_of(1), "is missing");
  fs::rename(file("log"), log_);
  test::write_text(journal_, journal);
  sit(1);
  EXPECT_EQ(study().participants[0].trials.size(), 8u);
}

/// The step was begun in what is left of the journal. Without its answer, its row would become void.
TEST_F(RecordTest, RefusesAJournalThatLacksTheLastAnswer) {
  sit(1, 10);
  const std::string journal = read_text(journal_);
  const std::string before = read_text(log_);
  ASSERT_TRUE(before.ends_with("\tn/a\n")) << before;
  const std::size_t answer = journal.rfind("{\"what\":\"answer\"");
  const std::size_t touched = journal.rfind("{\"what\":\"touched\"", answer);
  ASSERT_NE(answer, std::string::npos);
  for (const std::size_t left : {answer, touched, answer + 10}) {
    test::write_text(journal_, journal.substr(0, left));
    EXPECT_CONTAINS(fault_of(1), "does not contain all rows of " + log_.string());
    EXPECT_EQ(read_text(log_), before);
  }
}

/// The journal is on the disk before the log, which is written whole. A power cut may also take a part of it.
TEST_F(RecordTest, ContinuesWithTheLogsThatAKillOrAPowerCutLeaves) {
  sit(1, 10);
  EXPECT_EQ(fault_of(1), "");  // a step is under way: its row is void
  const std::string whole = read_text(log_);
  EXPECT_CONTAINS(whole, "the program ended");
  const std::size_t header = whole.find('\n') + 1;
  const std::string older =
      "step\tonset\tfelt\n1\t" + whole.substr(header, whole.find('\t', header) - header) + "\tyes\n";
  for (const std::string& left : {whole.substr(0, whole.size() - 3), whole.substr(0, header), whole.substr(0, 7),
                                  std::string(), std::string(whole.size(), '\0'), older}) {
    test::write_text(log_, left);
    EXPECT_EQ(fault_of(1), "") << left;
    EXPECT_EQ(read_text(log_), whole) << "it is written again";
  }
  test::write_text(log_, "onset\tstep\n0.5\t1\n");
  EXPECT_CONTAINS(fault_of(1), "does not contain all rows of " + log_.string());
}

TEST_F(RecordTest, RemovesWhatAKilledProgramLeftUnderATemporaryName) {
  sit(1, 10);
  for (const char* left : {"sub-01/.palpa-17-0", "sub-01/beh/.palpa-17-33"}) {
    test::write_text(folder_ / left, "{");
    EXPECT_EQ(fault_of(1), "");
    EXPECT_FALSE(fs::exists(folder_ / left)) << left;
  }
}

TEST_F(RecordTest, FindsTheFolderByItsNumber) {
  sit(1);
  fs::rename(folder_ / "sub-01", folder_ / "sub-1");
  EXPECT_CONTAINS(fault_of(1), "sub-1_journal.jsonl: is missing, but there are 5 files of participant 1 in");
  EXPECT_GE(withdraw(folder_, 1).files, 5u);
  EXPECT_FALSE(fs::exists(folder_ / "sub-01"));
  EXPECT_TRUE(fs::exists(folder_ / "sub-1/sub-1_withdrawn.json"));
  EXPECT_CONTAINS(fault_of(1), "participant 1 withdrew");
}

TEST_F(RecordTest, TriesTheLinkBeforeItWritesOrRemovesALineThatWasCutAndNotAfterTheEnd) {
  const auto refuse = [] { throw failure("no link"); };
  EXPECT_ERROR(Record(plan_, 1, folder_, true, refuse), Exit::failed, "no link");
  EXPECT_FALSE(fs::exists(folder_ / "sub-01")) << "the number is not used up";
  sit(1, 10);
  const std::string text = read_text(journal_), cut = text + "{\"what\":\"answ";
  test::write_text(journal_, cut);
  EXPECT_ERROR(Record(plan_, 1, folder_, true, refuse), Exit::failed, "no link");
  EXPECT_EQ(read_text(journal_), cut);
  EXPECT_EQ(fault_of(1), "");
  EXPECT_EQ(read_text(journal_), text);
  sit(1);
  EXPECT_ERROR(Record(plan_, 1, folder_, true, refuse).refuse_finished(), Exit::usage, "participant 1 has finished");
}

TEST_F(RecordTest, ACompleteJournalWithoutItsLastLineEnds) {
  // Killed before the line was written, while it was, and before its end.
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{5}, std::string::npos}) {
    fs::remove_all(folder_ / "sub-01");
    sit(1);
    const std::string text = read_text(journal_), log = read_text(log_);
    const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
    EXPECT_CONTAINS(text.substr(last), "finish");
    test::write_text(journal_, text.substr(0, last + std::min(bytes, text.size() - 1 - last)));
    const auto refuse = [] { throw failure("no link"); };
    EXPECT_FALSE(Record(plan_, 1, folder_, true, refuse).agenda().current()) << "nothing is left to sound";
    sit(1);
    EXPECT_CONTAINS(fault_of(1), "participant 1 has finished");
    EXPECT_EQ(read_text(log_), log);
  }
}

TEST_F(RecordTest, AnEmptyJournalBeginsIfThereIsNoOtherFile) {
  fs::create_directories(folder_ / "sub-01");
  test::write_text(file("kept.txt"), "");
  EXPECT_CONTAINS(fault_of(1), "but there is 1 file of participant 1 in");
  fs::remove(file("kept.txt"));
  test::write_text(journal_, "");
  sit(1);
  EXPECT_EQ(study().participants[0].trials.size(), 8u);
}

TEST_F(RecordTest, AWithdrawalLeavesATombstoneOnly) {
  sit(1);
  sit(2);
  const Withdrawal withdrawal = withdraw(folder_, 1);
  EXPECT_FALSE(withdrawal.before);
  EXPECT_GE(withdrawal.files, 5u);
  std::size_t left = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "sub-01")) {
    EXPECT_EQ(entry.path().filename(), "sub-01_withdrawn.json");
    ++left;
  }
  EXPECT_EQ(left, 1u);
  EXPECT_EQ(json::parse(read_text(file("sub-01_withdrawn.json")))["Withdrawn"], true);
  EXPECT_CONTAINS(fault_of(1), "participant 1 withdrew");
  const Study read = study();
  EXPECT_EQ(read.participants.size(), 1u);
  EXPECT_CONTAINS(read.left_out[0], "the participant withdrew");
  const std::string tombstone = read_text(file("sub-01_withdrawn.json"));
  const Withdrawal again = withdraw(folder_, 1);
  EXPECT_TRUE(again.before);
  EXPECT_EQ(again.files, 0u);
  EXPECT_EQ(read_text(file("sub-01_withdrawn.json")), tombstone);
  EXPECT_REFUSED(withdraw(folder_, 3), "has no participant 3");
}

TEST_F(RecordTest, AWithdrawalWaitsForTheEndOfASittingAndFollowsNoLinks) {
  const fs::path elsewhere = test::scratch_folder("record-elsewhere");
  test::write_text(elsewhere / "kept.txt", "kept");
  {
    const Record record(plan_, 1, folder_, true);
    EXPECT_ERROR(withdraw(folder_, 1), Exit::usage, "another palpa is writing this file");
  }
  fs::create_directory_symlink(elsewhere, file("link"));
  fs::create_directory_symlink(file("beh"), file("own"));
  fs::create_symlink(elsewhere / "kept.txt", file("beh") / "log.tsv");
  fs::create_symlink("nowhere", file("beh") / "dangling");
  const Withdrawal withdrawal = withdraw(folder_, 1);
  std::vector<fs::path> remaining = withdrawal.remaining;
  std::ranges::sort(remaining);
  EXPECT_EQ(remaining, (std::vector<fs::path>{fs::canonical(elsewhere), fs::canonical(elsewhere / "kept.txt")}));
  EXPECT_EQ(read_text(elsewhere / "kept.txt"), "kept");
  EXPECT_FALSE(fs::exists(fs::symlink_status(file("link"))));
}

TEST_F(RecordTest, OnlyItsOwnerReadsAParticipantsFiles) {
  const mode_t before = ::umask(0);
  sit(1, 10);
  EXPECT_EQ(test::open_to_others(folder_ / "sub-01"), std::vector<fs::path>());
  EXPECT_TRUE(fs::exists(log_));
  // As an older palpa left them, or a copy.
  for (const fs::path& path : fs::recursive_directory_iterator(folder_))
    fs::permissions(path, fs::perms(fs::is_directory(path) ? 0755 : 0644));
  sit(1);
  EXPECT_EQ(test::open_to_others(folder_ / "sub-01"), std::vector<fs::path>());
  withdraw(folder_, 1);
  EXPECT_EQ(test::open_to_others(folder_ / "sub-01"), std::vector<fs::path>()) << "the tombstone";
  ::umask(before);
}

TEST_F(RecordTest, AWithdrawalNamesHardLinks) {
  const fs::path elsewhere = test::scratch_folder("record-elsewhere");
  sit(1);
  fs::create_hard_link(log_, elsewhere / "copy.tsv");
  fs::create_hard_link(log_, elsewhere / "again.tsv");
  fs::create_hard_link(journal_, file("beh") / "own.jsonl");
  const Withdrawal withdrawal = withdraw(folder_, 1);
  ASSERT_EQ(withdrawal.other_names.size(), 1u) << "both names of the journal were in the folder";
  EXPECT_EQ(withdrawal.other_names[0].file, log_);
  EXPECT_EQ(withdrawal.other_names[0].names, 2u);
  struct stat status {};
  ASSERT_EQ(::stat((elsewhere / "copy.tsv").c_str(), &status), 0);
  EXPECT_EQ(withdrawal.other_names[0].inode, status.st_ino);
  EXPECT_TRUE(withdraw(folder_, 1).other_names.empty());
}

TEST_F(RecordTest, AJournalThatIsGoneIsNotWrittenOn) {
  Record record(plan_, 1, folder_, true);
  const Entry start{.text = utc_now(), .version = "v", .rehearsal = true};
  record.add(start);
  const fs::path elsewhere = folder_ / "elsewhere";
  const std::string before = read_text(journal_);
  fs::rename(journal_, elsewhere);
  EXPECT_ERROR(record.add({.kind = EntryKind::stop}), Exit::failed, "was removed or replaced while it was written");
  test::write_text(journal_, before);
  EXPECT_ERROR(record.add({.kind = EntryKind::stop}), Exit::failed, "was removed or replaced");
  EXPECT_EQ(read_text(elsewhere), before);
  fs::rename(elsewhere, journal_);
  record.add({.kind = EntryKind::stop});
  EXPECT_GT(read_text(journal_).size(), before.size());
}

TEST_F(RecordTest, AppendsAndCuts) {
  const OpenFile file = open_to_append(folder_ / "appended");
  file.write("one\n", true);
  file.write("two\n", true);
  EXPECT_EQ(read_text(folder_ / "appended"), "one\ntwo\n");
  file.cut(4);
  file.write("three\n", true);
  EXPECT_EQ(read_text(folder_ / "appended"), "one\nthree\n");
  EXPECT_ERROR(open_to_append("/dev/full"), Exit::failed, "is not a regular file");
  EXPECT_ERROR(open_to_append(folder_ / "no such folder" / "file"), Exit::failed, "no such folder");
}

TEST_F(RecordTest, AFileThatCannotGrowKeepsItsRecords) {
  const OpenFile file = open_to_append(folder_ / "appended");
  file.write("one\n", true);
  {
    const test::FileSizeLimit limit(6);  // the first bytes of a record still fit
    EXPECT_ERROR(file.write("three\n", true), Exit::failed, "appended");
  }
  EXPECT_EQ(read_text(folder_ / "appended"), "one\n");
  file.write("four\n", true);
  EXPECT_EQ(read_text(folder_ / "appended"), "one\nfour\n");
}

}  // namespace
}  // namespace palpa::study
