// The journal: what is on the disk is the state, wherever a program was killed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "study/files/gzip.hpp"
#include "study/files/journal.hpp"
#include "study/sitting_plan.hpp"
#include "support/exhaustive.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

using test::MemoryJournal;

const ScriptedParticipant scripted(0.5, 1, 3);

void go_to_the_end(const StudyPlan& plan, MemoryJournal& journal) {
  const std::vector<Entry> before = journal.entries();
  const Agenda agenda = agenda_after(order_of(plan, 1), before, "journal");
  rehearse(plan, agenda, {.text = "t", .rehearsal = true}, scripted, [&](const Entry& entry) { journal.add(entry); });
}

/// The answers by step.
std::map<std::uint32_t, std::vector<std::string>> answers_in(const std::vector<Entry>& entries) {
  std::map<std::uint32_t, std::vector<std::string>> answers;
  for (const Entry& entry : entries) {
    if (entry.kind == EntryKind::answer || entry.kind == EntryKind::done) answers[*entry.step].push_back(entry.text);
  }
  return answers;
}

std::string whole_journal(const StudyPlan& plan) {
  MemoryJournal journal(1, plan.sha256);
  go_to_the_end(plan, journal);
  return journal.text;
}

TEST(Journal, ReadsWhatItWrites) {
  const std::vector<Entry> entries{
      {.kind = EntryKind::start,
       .text = "2026-11-25T00:00:00Z",
       .version = "1.0 (abc)",
       .rehearsal = true,
       .masking = "noise.wav",
       .backend = "gpu"},
      {.kind = EntryKind::consent, .at_ns = 5, .accepted = true, .depth_frames = true},
      {.kind = EntryKind::level, .at_ns = 6, .text = "ethics 12/26", .level_db = 109.5, .dose_db = 104.25},
      {.kind = EntryKind::touched,
       .at_ns = 7,
       .sounded_s = 9.75,
       .step = 3,
       .deep_s = 0.125,
       .stimulus = Stimulus{"ab", 0.05, "foci.json", "cd", 6667, "openmpd", TouchLosses{1, 2, 3, 4}}},
      {.kind = EntryKind::broken,
       .at_ns = 8,
       .sounded_s = 0.5,
       .step = 3,
       .text = "line\nwith \"everything\"\tin it, \xc3\xa4"},
  };
  MemoryJournal journal(7, "sha");
  for (const Entry& entry : entries)
    journal.add(entry);
  const Journal read = read_journal(journal.text, "j");
  EXPECT_EQ(read.head, (JournalHead{7, "sha"}));
  EXPECT_EQ(read.entries, entries);
  EXPECT_EQ(sounded_s(read.entries), 10.25);
  EXPECT_EQ(read.whole, journal.text.size());
  EXPECT_EQ(read.last_digits, journal.digits);
}

TEST(Journal, KilledAtAnyByteNoTrialIsLostOrDoubled) {
  const StudyPlan plan = test::small_plan();
  const std::string whole = whole_journal(plan);
  const std::vector<Entry> all = read_journal(whole, "j").entries;
  const auto wanted = answers_in(all);
  ASSERT_EQ(wanted.size(), order_of(plan, 1).size());
  // Every byte at which the file may end. After the first line, the journal has a head.
  const std::size_t head = whole.find('\n') + 1;
  for (std::size_t bytes = head; bytes <= whole.size(); ++bytes) {
    const bool after_line = whole[bytes - 1] == '\n', after_next = bytes > head && whole[bytes - 2] == '\n';
    if (!after_line && !after_next && bytes % 13 != 0 && !test::exhaustive()) continue;
    MemoryJournal journal(whole.substr(0, bytes));
    const std::vector<Entry> before = journal.entries();
    const auto kept = answers_in(before);
    if (agenda_after(order_of(plan, 1), before, "j").finished()) {
      EXPECT_EQ(bytes, whole.size());
      continue;
    }
    go_to_the_end(plan, journal);
    const std::vector<Entry> after = journal.entries();
    ASSERT_TRUE(std::equal(before.begin(), before.end(), after.begin())) << "entries are only added";
    const auto answers = answers_in(after);
    ASSERT_EQ(answers, wanted) << "cut at byte " << bytes;
    for (const auto& [step, given] : answers)
      ASSERT_EQ(given.size(), 1u) << "step " << step << ", cut at byte " << bytes;
    // At most the step that was under way is void.
    const Agenda agenda = agenda_after(order_of(plan, 1), after, "j");
    ASSERT_TRUE(agenda.finished());
    ASSERT_LE(agenda.voided(), 1u);
  }
}

TEST(Journal, KilledAgainAndAgainItStillEnds) {
  const StudyPlan plan = test::small_plan();
  const std::string whole = whole_journal(plan);
  const auto wanted = answers_in(read_journal(whole, "j").entries);
  // Each time, the program gets a little further before it is killed in the middle of a line.
  std::string text = whole.substr(0, whole.find('\n') + 1);
  for (int kills = 0;; ++kills) {
    ASSERT_LT(kills, 200);
    MemoryJournal journal(text);
    go_to_the_end(plan, journal);
    const std::size_t grown = text.size() + 700;
    if (grown >= journal.text.size()) {
      const std::vector<Entry> entries = journal.entries();
      EXPECT_EQ(answers_in(entries), wanted);
      EXPECT_GT(agenda_after(order_of(plan, 1), entries, "j").voided(), 3u);
      break;
    }
    text = journal.text.substr(0, grown);
  }
}

TEST(Journal, AVoidStepIsRepeatedAtTheEndOfItsBlock) {
  const StudyPlan plan = test::small_plan();
  const std::vector<Step> steps = order_of(plan, 1);
  const auto first = static_cast<std::uint32_t>(
      std::ranges::find_if(steps, [&](const Step& s) { return plan.blocks[s.block].kind == BlockKind::trial; }) -
      steps.begin());
  Agenda agenda(steps);
  agenda.take({.kind = EntryKind::start});
  agenda.take({.kind = EntryKind::consent, .accepted = true});
  const auto do_one = [&](std::uint32_t step) {
    EXPECT_EQ(agenda.current(), step);
    EXPECT_EQ(agenda.take({.kind = EntryKind::begin, .step = step}), "");
    EXPECT_EQ(agenda.take({.kind = EntryKind::answer, .step = step, .text = "cube"}), "");
  };
  for (std::uint32_t step = 0; step < first; ++step)
    do_one(step);
  EXPECT_EQ(agenda.take({.kind = EntryKind::begin, .step = first}), "");
  EXPECT_EQ(agenda.take({.kind = EntryKind::broken, .step = first}), "");
  for (std::uint32_t step = first + 1; step < first + 4; ++step)
    do_one(step);
  do_one(first);  // the fourth trial of four
  EXPECT_EQ(steps[*agenda.current()].round, steps[first].round + 1);
}

TEST(Journal, EveryChangeShows) {
  const StudyPlan plan = test::small_plan();
  const std::string whole = whole_journal(plan);
  for (std::size_t i = 0; i + 1 < whole.size(); i += 7) {  // without its last LF, a line does not count
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    EXPECT_REFUSED(read_journal(changed, "sub-01_journal.jsonl"), "sub-01_journal.jsonl: line ");
  }
  // A line removed, or two exchanged.
  const std::size_t a = whole.find('\n') + 1, b = whole.find('\n', a) + 1, c = whole.find('\n', b) + 1;
  EXPECT_REFUSED(read_journal(whole.substr(0, a) + whole.substr(b), "j"), "line 2");
  EXPECT_REFUSED(read_journal(whole.substr(0, a) + whole.substr(b, c - b) + whole.substr(a, b - a), "j"), "line 2");
}

TEST(Journal, RefusesAnotherVersionAndForeignLines) {
  const auto line = [](const std::string& json) {
    return fmt::format("{}\t{:08x}\n", json, crc32_of(json));  // a first line: no digits come before it
  };
  EXPECT_REFUSED(read_journal(line(R"({"palpa_journal":2,"participant":1,"plan_sha256":"x"})"), "j"), "has version 2");
  EXPECT_REFUSED(read_journal("onset\tduration\n", "j"), "j: line 1");
  const Journal empty = read_journal("", "j");
  EXPECT_FALSE(empty.head);
  EXPECT_EQ(read_journal("{\"palpa_jou", "j").whole, 0u) << "cut within the first line";
}

TEST(Journal, RefusesEntriesThatCannotFollow) {
  const std::vector<Step> steps = order_of(test::small_plan(), 1);
  const Entry start{.kind = EntryKind::start}, consent{.kind = EntryKind::consent, .accepted = true};
  agenda_after(steps, std::vector<Entry>{start, consent, {.kind = EntryKind::begin, .step = 0}}, "j");
  const std::vector<std::pair<std::vector<Entry>, const char*>> cases{
      {{consent}, "has not been started"},
      {{start, {.kind = EntryKind::begin, .step = 0}}, "line 3: 'begin'"},
      {{start, consent, {.kind = EntryKind::begin, .step = 1}}, "another step"},
      {{start, consent, {.kind = EntryKind::answer, .step = 0}}, "not under way"},
      {{start, consent, {.kind = EntryKind::finish}}, "steps are left"}};
  for (const auto& each : cases)
    EXPECT_REFUSED(agenda_after(steps, each.first, "j"), each.second);
}

}  // namespace
}  // namespace palpa::study
