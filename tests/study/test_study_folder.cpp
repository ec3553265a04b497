// Studies as folders: what is left out, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "study/files/events_file.hpp"
#include "study/files/journal.hpp"
#include "study/files/study_folder.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

using test::events_place;
using test::events_text;
using test::write_events;

/// The usual sidecar with this member more.
std::string sidecar_with(const std::string& member) {
  std::string sidecar = test::events_sidecar;
  return sidecar.insert(sidecar.size() - 1, ", " + member);
}

class StudyFolder : public testing::Test {
 protected:
  const std::filesystem::path folder_ = test::scratch_folder("study");

  Study read() const { return read_study(std::vector<std::string>{folder_.string()}); }
  /// The only line about what was left out.
  std::string left_out() const {
    const Study study = read();
    EXPECT_EQ(study.left_out.size(), 1u) << testing::PrintToString(study.left_out);
    return study.left_out.empty() ? "" : study.left_out[0];
  }
};

TEST_F(StudyFolder, HasParticipantsByNumberWithTheirTrials) {
  test::write_ten(folder_);
  const Study study = read();
  EXPECT_TRUE(study.left_out.empty()) << testing::PrintToString(study.left_out);
  EXPECT_EQ(study.methods, (std::vector<std::string>{"single-focus", "cross-section"}));
  EXPECT_EQ(study.shapes, test::study_shapes);
  ASSERT_EQ(study.participants.size(), 10u);
  EXPECT_EQ(study.participants[1].number, 2u) << "not in the order of the names, in which 10 precedes 2";
  EXPECT_EQ(study.participants[0].trials.size(), 80u);
  EXPECT_EQ(std::ranges::count_if(study.participants[0].trials, [](const Trial& t) { return t.correct(); }), 18 + 28);
  EXPECT_EQ(study.participants[5].trials[0].method, 1u) << "began with cross-section";
}

TEST_F(StudyFolder, WithoutSidecarsTheShapesAreThoseThatWereShown) {
  test::write_text(events_place(folder_, 1), events_text("m", 20));
  const Study study = read();
  EXPECT_EQ(study.shapes, test::study_shapes);
  EXPECT_EQ(study.left_out.size(), 1u);
}

TEST_F(StudyFolder, ACopyOfALogDoesNotCountTwice) {
  test::write_participant(folder_, 1, {{"m", 20}});
  const auto log = events_place(folder_, 1);
  const std::size_t trials = read().participants[0].trials.size();
  const auto copy = log.parent_path() / "sub-1_task-shapes_run-9_events.tsv";
  std::filesystem::copy_file(log, copy);
  EXPECT_CONTAINS(left_out(), copy.string() + ": has the same rows as " + log.string() + "; the log is left out");
  EXPECT_EQ(read().participants[0].trials.size(), trials);
}

/// Somebody saved a participant's log under a second number. Nobody measures the same microseconds twice.
TEST_F(StudyFolder, ACopyUnderAnotherNumberIsNoSecondPerson) {
  test::write_participant(folder_, 1, {{"m", 20}});
  const auto log = events_place(folder_, 1), copy = events_place(folder_, 2);
  write_events(copy, test::read_text(log));
  EXPECT_CONTAINS(left_out(),
                  copy.string() + ": has the same rows as " + log.string() + " of participant 1; the log is left out");
  EXPECT_EQ(read().participants.size(), 1u);
  // Two rehearsals may be equal, and logs without times of answers.
  write_events(copy, test::read_text(log), sidecar_with("\"Rehearsal\": true"));
  EXPECT_EQ(read().participants.size(), 2u);
  EXPECT_CONTAINS(testing::PrintToString(read().left_out),
                  "of participant 1; it is analysed all the same: see whether");
  const std::string untimed = std::string(test::events_header) + "1\t10\ttrial\tm\tcube\tcube\tn/a\tanswered\n";
  write_events(log, untimed);
  write_events(copy, untimed);
  EXPECT_CONTAINS(left_out(), "of participant 1; it is analysed all the same: see whether it is a copy");
  EXPECT_EQ(read().participants.size(), 2u);
}

TEST_F(StudyFolder, LogsWithoutAnswersAreNoCopies) {
  test::write_participant(folder_, 1, {{"m", 20}});
  for (const std::uint32_t number : {2u, 3u})
    write_events(events_place(folder_, number, 1), test::events_header);
  const std::vector<std::string> left_out = read().left_out;
  EXPECT_EQ(left_out.size(), 2u);
  for (const std::string& line : left_out)
    EXPECT_CONTAINS(line, "has no answered trial");
}

TEST_F(StudyFolder, DifferentPlansAreNamed) {
  const auto with_plan = [](const std::string& plan) { return sidecar_with("\"PlanSha256\": \"" + plan + "\""); };
  for (std::uint32_t number = 1; number <= 14; ++number)
    write_events(events_place(folder_, number), events_text("m", 20, 40, number), with_plan("0123456789"));
  EXPECT_TRUE(read().left_out.empty()) << testing::PrintToString(read().left_out);
  write_events(events_place(folder_, 2), events_text("m", 20, 40, 2), with_plan("abcdef0123"));
  EXPECT_EQ(left_out(),
            "the participants had different plans, by PlanSha256 of their logs (01234567: participants 1, 3, 4, 5, 6, "
            "7, 8, 9, 10 and 4 more; abcdef01: participant 2); they are analysed as one study all the same");
  EXPECT_EQ(read().participants.size(), 14u);
}

TEST_F(StudyFolder, ALogThatCannotBeReadIsLeftOut) {
  test::write_participant(folder_, 1, {{"m", 20}});
  const auto log = events_place(folder_, 2);
  write_events(log, events_text("m", 20), R"({"PalpaStudyVersion": 7})");
  EXPECT_CONTAINS(left_out(), "the log has version 7, this palpa reads version 1; the log is left out");
  write_events(log, std::string(17 << 20, ' '));
  EXPECT_CONTAINS(left_out(), "has 17825792 bytes, at most 16777216 are expected; the log is left out");
  write_events(log, test::events_header);
  EXPECT_CONTAINS(left_out(),
                  "sub-2: has no row of a block 'trial', so it has no answered trial; the participant is left out");
  std::filesystem::remove_all(folder_ / "sub-2" / "beh");
  EXPECT_CONTAINS(left_out(), "there is no such folder; the participant is left out");
  std::filesystem::create_directory(folder_ / "sub-2" / "beh");
  EXPECT_CONTAINS(left_out(), "has no log, such as sub-2_task-shapes_events.tsv");
  EXPECT_EQ(read().participants.size(), 1u);
}

/// A participant whose program was started again and again has more than 99 logs.
TEST_F(StudyFolder, DigitsInNamesCountAsNumbers) {
  const auto log = [&](int run) {
    return folder_ / "sub-1" / "beh" / ("sub-1_task-shapes_run-" + std::to_string(run) + "_events.tsv");
  };
  std::filesystem::create_directories(log(1).parent_path());
  for (int run = 2; run < 99; ++run)
    write_events(log(run), test::events_header);
  write_events(log(1), test::events_header);
  write_events(log(99), events_text("a", 20));
  write_events(log(100), events_text("b", 20));
  write_events(log(101), test::events_header);
  const Study study = read();
  EXPECT_TRUE(study.left_out.empty()) << testing::PrintToString(study.left_out);
  EXPECT_EQ(study.methods, (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(study.participants.size(), 1u);
  EXPECT_EQ(study.participants[0].trials.front().method, 0u) << "run-100 follows run-99";
  EXPECT_EQ(study.participants[0].trials.back().method, 1u);
}

TEST_F(StudyFolder, FoldersAndLogsHaveTheParticipantsNumber) {
  test::write_participant(folder_, 1, {{"m", 20}});
  std::filesystem::create_directories(folder_ / "sub-anna" / "beh");
  EXPECT_CONTAINS(left_out(), "sub-anna: is not a participant with a number, such as sub-7");
  std::filesystem::remove_all(folder_ / "sub-anna");
  std::filesystem::copy_file(events_place(folder_, 1), folder_ / "sub-1" / "beh" / "sub-2_task-shapes_events.tsv");
  EXPECT_CONTAINS(left_out(), "the name is not that of a log of participant 1");
}

TEST_F(StudyFolder, AnUnknownShapeOrAnswerIsLeftOutWithItsLine) {
  std::string text = events_text("m", 20);
  write_events(events_place(folder_, 1), text.replace(text.rfind("prism\tprism"), 11, "prism\tcone!"));
  const std::string told = left_out();
  EXPECT_CONTAINS(told, ": line ");
  EXPECT_CONTAINS(told, "the answer 'cone!' is not one of cube, semi-sphere, pyramid, prism; the row is left out");
  EXPECT_EQ(read().participants[0].trials.size(), 39u);
}

TEST_F(StudyFolder, ALogOfOtherShapesIsLeftOut) {
  test::write_participant(folder_, 1, {{"m", 20}});
  write_events(events_place(folder_, 2), events_text("m", 20),
               R"({"PalpaStudyVersion": 1, "shape": {"Levels": {"cube": "", "cone": ""}}})");
  EXPECT_CONTAINS(left_out(), "its shapes are cube, cone, but those of");
}

TEST_F(StudyFolder, TheShapesAreThoseOfMostLogs) {
  for (const std::uint32_t number : {1u, 2u, 3u})
    test::write_participant(folder_, number, {{"m", 20}});
  std::string odd = test::events_sidecar;
  odd.replace(odd.find("cube"), 4, "cubo");
  write_events(events_place(folder_, 1), events_text("m", 20, 40, 1e-3), odd);
  EXPECT_CONTAINS(
      left_out(),
      "sub-1_task-shapes_run-1_events.tsv: its shapes are cubo, semi-sphere, pyramid, prism, but those of " +
          events_place(folder_, 2).string() +
          " are cube, semi-sphere, pyramid, prism (only here: cubo; missing here: cube); the log is left out");
  EXPECT_EQ(read().participants.size(), 2u);
  EXPECT_EQ(read().shapes, test::study_shapes);
  // With as many of both kinds, the first log tells.
  std::filesystem::remove_all(folder_ / "sub-3");
  EXPECT_CONTAINS(testing::PrintToString(read_study(std::vector<std::string>{folder_.string()}).shapes), "cubo");
}

/// A journal with one run for each list of answered steps. A machine broke off step 4 so often.
std::string journal_of(const std::vector<std::vector<std::uint32_t>>& runs, bool finished, int broken = 0) {
  std::string text = head_line({.participant = 1, .plan_sha256 = "ab"}), digits(digits_of(text));
  const auto add = [&](const Entry& entry) {
    const std::string line = entry_line(entry, digits);
    digits = digits_of(line);
    text += line;
  };
  for (const std::vector<std::uint32_t>& steps : runs) {
    add({.kind = EntryKind::start});
    for (const std::uint32_t step : steps)
      add({.kind = EntryKind::answer, .step = step, .text = "cube"});
  }
  for (int i = 0; i < broken; ++i)
    add({.kind = EntryKind::broken, .step = 4, .by_machine = true, .text = "why"});
  if (finished) add({.kind = EntryKind::finish});
  return text;
}

TEST_F(StudyFolder, AnswersThatAJournalHasAndNoLogAreNamed) {
  test::write_ten(folder_);
  const auto journal = folder_ / "sub-1/sub-1_journal.jsonl";
  const auto log = [&](const char* run) { return folder_ / ("sub-1/beh/sub-1_task-shapes" + std::string(run)); };
  const auto rows = static_cast<std::uint32_t>(
      std::ranges::count(read_events(events_place(folder_, 1)).rows, EventStatus::answered, &EventRow::status));
  std::filesystem::rename(events_place(folder_, 1), log("_run-01_events.tsv"));
  std::string sidecar = events_place(folder_, 1).string();
  sidecar.replace(sidecar.size() - 3, 3, "json");
  std::filesystem::rename(sidecar, log("_run-01_events.json"));
  std::vector<std::uint32_t> answered(rows);
  for (std::uint32_t step = 0; step < rows; ++step)
    answered[step] = step;
  test::write_text(journal, journal_of({answered}, true));
  EXPECT_TRUE(read().left_out.empty());
  answered.push_back(98);
  answered.push_back(99);
  test::write_text(journal, journal_of({answered}, true));
  EXPECT_CONTAINS(left_out(), "sub-1_journal.jsonl: the answers of run 1 to step 99, 100 are in no log");
  answered.resize(rows);
  test::write_text(journal, journal_of({answered, {7}}, true));
  EXPECT_CONTAINS(left_out(), "sub-1_journal.jsonl: the answer of run 2 to step 8 is in no log");
  test::write_text(journal, journal_of({answered, {}}, false));
  EXPECT_CONTAINS(left_out(), "sub-1_journal.jsonl: the sitting is not finished");
  test::write_text(journal, journal_of({answered}, true, 2));
  EXPECT_TRUE(read().left_out.empty()) << "it was repeated";
  test::write_text(journal, journal_of({answered}, true, 3));
  EXPECT_CONTAINS(left_out(), "sub-1_journal.jsonl: step 5 stays void, because its stimulus was missing");
  test::write_text(journal, journal_of({answered}, true) + "x");
  EXPECT_TRUE(read().left_out.empty()) << "a line that was cut off while it was written";
  std::string damaged = journal_of({answered}, true);
  damaged[damaged.size() / 2] ^= 1;
  test::write_text(journal, damaged);
  EXPECT_CONTAINS(left_out(), "its answers are not compared with the logs");
}

TEST_F(StudyFolder, TwoParticipantsWithOneNumberAreRefused) {
  test::write_participant(folder_, 3, {{"m", 20}});
  const auto other = folder_ / "more";
  test::write_participant(other, 3, {{"m", 20}});
  EXPECT_REFUSED(read_study(std::vector<std::string>{folder_.string(), other.string()}), "participant 3 is also in");
  EXPECT_REFUSED(read_study(std::vector<std::string>{folder_.string(), folder_.string()}), "participant 3 is also in");
  std::filesystem::rename(other / "sub-3", folder_ / "sub-03");
  EXPECT_REFUSED(read(), "give each participant a number of their own");
}

TEST_F(StudyFolder, WithoutLogsIsRefused) {
  EXPECT_REFUSED(read(), "has no participants: their logs are in folders such as sub-1/beh");
  EXPECT_REFUSED(read_study(std::vector<std::string>{(folder_ / "none").string()}), "none: no such folder");
  const auto log = events_place(folder_, 1);
  EXPECT_REFUSED(read_study(std::vector<std::string>{log.parent_path().string()}), "has no participants");
  write_events(log, "nothing\n");
  EXPECT_REFUSED(read(), "nothing can be analysed: ");
  std::string practice = events_text("m", 20);
  for (std::size_t at; (at = practice.find("\ttrial\t")) != std::string::npos;)
    practice.replace(at, 7, "\tpractice\t");
  write_events(log, practice, sidecar_with("\"Rehearsal\": true"));
  EXPECT_REFUSED(read(), "nothing can be analysed: " + (folder_ / "sub-1").string() +
                             ": has no row of a block 'trial', so it has no answered trial");
  EXPECT_REFUSED(read_study(std::vector<std::string>{log.string()}), "is not a folder");
}

}  // namespace
}  // namespace palpa::study
