// A participant's sitting as a state machine, key by key.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "study/sitting/events_table.hpp"
#include "study/sitting/sitting.hpp"
#include "study/sitting_plan.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

constexpr std::int64_t ms = 1'000'000;

class SittingTest : public testing::Test {
 protected:
  StudyPlan plan_ = test::small_plan();
  std::vector<Entry> written_;
  bool disk_is_full_ = false;
  std::int64_t now_ = 0;

  Sitting sitting(std::span<const Entry> before = {}) {
    return Sitting(plan_, agenda_after(order_of(plan_, 1), before, "journal"), {.text = "2026-11-25T00:00:00Z"},
                   [this](const Entry& entry) {
                     if (disk_is_full_) throw failure("the disk is full");
                     written_.push_back(entry);
                   });
  }
  void consent(Sitting& one) {
    one.act(Act::go_on, now_);
    one.act(Act::accept, now_);
  }
  /// Until the next step of this kind is ready.
  void skip_to(Sitting& one, BlockKind kind) {
    const ScriptedParticipant participant(1, 1, 0);
    while (one.screen() != Screen::ready || one.block().kind != kind)
      participant.go_on(plan_, one, now_);
  }
  void begin(Sitting& one, BlockKind kind) {
    consent(one);
    skip_to(one, kind);
    one.act(Act::go_on, now_);
  }
  std::size_t count(EntryKind kind) const {
    return static_cast<std::size_t>(std::ranges::count(written_, kind, &Entry::kind));
  }
};

/// A step that the machine breaks off three times stays void. People break off as often as they like.
TEST_F(SittingTest, WhatAMachineBreaksOffIsRepeatedTwice) {
  const TouchLosses enough{.thinned_frames = 1, .skin_frames = 10}, lack{.left_out_frames = 11, .skin_frames = 100};
  Sitting one = sitting();
  consent(one);
  skip_to(one, BlockKind::trial);
  const std::uint32_t step = *one.agenda().current();
  const auto touch = [&](const TouchLosses& losses) {
    one.act(Act::go_on, now_);
    now_ += 50 * ms;
    one.played({.losses = losses});
    one.advance(now_);
  };
  const auto come_to_it = [&] {
    while (one.agenda().current() != step) {
      touch(enough);
      ASSERT_EQ(one.screen(), Screen::question);
      one.answer(0, now_);
    }
  };
  for (int people = 0; people < 4; ++people) {
    come_to_it();
    one.act(Act::go_on, now_);
    one.act(people % 2 == 0 ? Act::pause : Act::any_key, now_ += 10 * ms);
    one.act(Act::go_on, now_);
    EXPECT_TRUE(one.agenda().stay_void().empty());
  }
  come_to_it();
  touch(lack);
  EXPECT_EQ(one.screen(), Screen::ready) << "nothing is asked, and nobody has to continue";
  EXPECT_EQ(one.reason(),
            "the touch lacked its stimulus: of 100 frames with skin over the object, 0 were thinned, 0 outdated and 11 "
            "left out, and at most a tenth may be: end other programs");
  EXPECT_EQ(written_.back().kind, EntryKind::broken);
  EXPECT_TRUE(written_.back().by_machine);
  EXPECT_EQ(written_[written_.size() - 2].kind, EntryKind::touched) << "with its counts";
  come_to_it();
  one.act(Act::go_on, now_);
  one.fault("the array is gone", now_ += 10 * ms);
  EXPECT_EQ(one.screen(), Screen::paused) << "somebody has to repair it";
  one.act(Act::go_on, now_);
  come_to_it();
  touch(lack);
  EXPECT_EQ(one.agenda().stay_void(), std::vector<std::uint32_t>{step});
  EXPECT_NE(one.agenda().current(), step);
  EXPECT_CONTAINS(written_.back().text, "; it was repeated often enough and stays void");
  EXPECT_EQ(one.agenda().voided(), 7u);
  // The same from the journal, and the rest of the sitting follows.
  const Agenda again = agenda_after(order_of(plan_, 1), written_, "journal");
  EXPECT_EQ(again.stay_void(), one.agenda().stay_void());
  EXPECT_EQ(again.current(), one.agenda().current());
  const ScriptedParticipant participant(1, 1, 0);
  while (one.screen() != Screen::end)
    participant.go_on(plan_, one, now_);
  EXPECT_EQ(one.agenda().complete() + 1, one.agenda().steps().size());
  EXPECT_CONTAINS(events_table(plan_, one.agenda().steps(), written_), "stays void\t0\t0\t0\t0\t11\t100\n");
}

TEST_F(SittingTest, TheFreeExplorationIsNotRepeatedForItsFrames) {
  Sitting one = sitting();
  begin(one, BlockKind::free);
  one.played({.losses = TouchLosses{.left_out_frames = 100, .skin_frames = 100}});
  const ScriptedParticipant participant(1, 1, 0);
  while (one.screen() == Screen::touching)
    participant.go_on(plan_, one, now_);
  EXPECT_EQ(count(EntryKind::broken), 0u);
  EXPECT_EQ(written_.back().kind, EntryKind::done);
}

TEST_F(SittingTest, NothingSoundsBeforeConsent) {
  Sitting one = sitting();
  EXPECT_EQ(one.screen(), Screen::setup);
  one.act(Act::go_on, now_);
  EXPECT_EQ(one.screen(), Screen::consent);
  EXPECT_EQ(one.text(), plan_.text(TextId::consent));
  for (const Act act : {Act::go_on, Act::any_key, Act::next_shape})
    one.act(act, now_);
  EXPECT_EQ(one.screen(), Screen::consent);
  one.act(Act::decline, now_);
  EXPECT_EQ(one.screen(), Screen::end);
  EXPECT_FALSE(one.presented().sounds);
  EXPECT_EQ(count(EntryKind::begin), 0u);
  EXPECT_EQ(count(EntryKind::finish), 1u);
}

TEST_F(SittingTest, ATrialSoundsForItsTimeAndKeepsTheAnswer) {
  Sitting one = sitting();
  consent(one);
  skip_to(one, BlockKind::trial);
  EXPECT_FALSE(one.presented().sounds);
  EXPECT_TRUE(one.shows_marker());
  const std::int64_t begin = now_;
  one.act(Act::go_on, now_);
  EXPECT_EQ(one.screen(), Screen::touching);
  EXPECT_EQ(written_.back().kind, EntryKind::begin) << "before anything sounds";
  EXPECT_TRUE(one.presented().sounds);
  EXPECT_FALSE(one.shows_object());
  EXPECT_EQ(one.next_ns(), begin + 50 * ms);
  one.advance(begin + 49 * ms);
  EXPECT_TRUE(one.presented().sounds);
  one.advance(begin + 50 * ms);
  EXPECT_FALSE(one.presented().sounds);
  EXPECT_EQ(one.screen(), Screen::question);
  EXPECT_EQ(one.choices(), (std::vector<std::string>{"cube", "ball"}));
  one.answer(2, begin + 60 * ms);
  EXPECT_EQ(one.screen(), Screen::question) << "there is no third answer";
  one.answer(1, begin + 70 * ms);
  EXPECT_EQ(written_.back().kind, EntryKind::answer) << "on the disk before the next trial";
  EXPECT_EQ(written_.back().text, "ball");
  EXPECT_EQ(written_.back().at_ns, begin + 70 * ms);
  EXPECT_EQ(one.screen(), Screen::ready) << "trials have no feedback";
}

TEST_F(SittingTest, FamiliarisationShowsTheObjectAndPracticeMayTellTheAnswer) {
  Sitting one = sitting();
  begin(one, BlockKind::familiarise);
  EXPECT_TRUE(one.shows_object());
  skip_to(one, BlockKind::practice);
  one.act(Act::go_on, now_);
  one.advance(now_ += 50 * ms);
  one.answer(1, now_);
  EXPECT_EQ(one.screen(), Screen::feedback);
  EXPECT_EQ(one.text(), plan_.text(TextId::wrong_answer));
  one.act(Act::go_on, now_);
  EXPECT_EQ(one.screen(), Screen::ready);
}

TEST_F(SittingTest, AFamiliarisationAsksWhetherAnythingIsFelt) {
  Sitting one = sitting();
  begin(one, BlockKind::familiarise);
  EXPECT_TRUE(one.has_choice(1)) << "already during the touch";
  EXPECT_FALSE(one.has_choice(2));
  one.advance(now_ += 50 * ms);
  EXPECT_EQ(one.text(), "Did you feel anything?");
  EXPECT_EQ(one.choices(), (std::vector<std::string>{"yes", "no"}));
  one.answer(1, now_);
  EXPECT_EQ(written_.back().kind, EntryKind::answer);
  EXPECT_EQ(written_.back().text, "no");
  // A plan in another language may leave the question out.
  plan_.language = "de";
  one.act(Act::go_on, now_);
  one.advance(now_ += 50 * ms);
  EXPECT_EQ(written_.back().kind, EntryKind::done);
}

TEST_F(SittingTest, HeadphonesArePutOnOnlyForASound) {
  EXPECT_CONTAINS(sitting().text(), "headphones");
  plan_.run.masking = "off";
  EXPECT_EQ(sitting().text(), "The study begins as soon as you are ready.");
}

TEST_F(SittingTest, KeysChangeTheShapeOfTheFreeExploration) {
  Sitting one = sitting();
  one.choose(1, now_ += ms);
  EXPECT_EQ(count(EntryKind::choose), 0u) << "nothing is touched yet";
  begin(one, BlockKind::free);
  EXPECT_EQ(one.presented().shape, 0u);
  one.act(Act::next_shape, now_ += ms);
  EXPECT_EQ(one.presented().shape, 1u);
  EXPECT_TRUE(one.presented().sounds);
  one.act(Act::next_shape, now_ += ms);
  EXPECT_EQ(one.presented().shape, 0u);
  one.act(Act::other_shape, now_ += ms);
  EXPECT_EQ(one.presented().shape, 1u);
  EXPECT_EQ(count(EntryKind::choose), 3u);
  one.choose(0, now_ += ms);
  EXPECT_EQ(one.presented().shape, 0u);
  one.choose(2, now_ += ms);
  EXPECT_EQ(one.presented().shape, 0u) << "there is no third shape";
  one.act(Act::any_key, now_ += ms);
  EXPECT_FALSE(one.presented().sounds) << "every other key silences";
}

TEST_F(SittingTest, NothingIsPresentedWhileAPointIsTooDeep) {
  Sitting one = sitting();
  begin(one, BlockKind::trial);
  const std::int64_t begin = now_;
  one.captured(15e-3, begin + 10 * ms);
  EXPECT_TRUE(one.presented().sounds) << "15 mm is not deeper than 15 mm";
  one.captured(15.1e-3, begin + 20 * ms);
  EXPECT_FALSE(one.presented().sounds);
  EXPECT_EQ(one.screen(), Screen::touching) << "the time goes on";
  one.captured(3e-3, begin + 35 * ms);
  EXPECT_TRUE(one.presented().sounds);
  one.captured(std::nan(""), begin + 36 * ms);
  EXPECT_FALSE(one.presented().sounds);
  one.captured(std::nullopt, begin + 37 * ms);
  EXPECT_TRUE(one.presented().sounds);
  one.advance(begin + 50 * ms);
  ASSERT_EQ(written_.back().kind, EntryKind::touched);
  EXPECT_NEAR(*written_.back().deep_s, 0.016, 1e-9);
}

TEST_F(SittingTest, SilenceOnEveryWayOutOfATouch) {
  const std::vector<std::pair<const char*, std::function<void(Sitting&)>>> ways{
      {"any key", [&](Sitting& one) { one.act(Act::any_key, now_); }},
      {"the participant's go_on", [&](Sitting& one) { one.act(Act::go_on, now_); }},
      {"an arrow key in a trial", [&](Sitting& one) { one.act(Act::next_shape, now_); }},
      {"pause", [&](Sitting& one) { one.act(Act::pause, now_); }},
      {"stop", [&](Sitting& one) { one.act(Act::stop, now_); }},
      {"a camera that dies", [&](Sitting& one) { one.fault("the camera was unplugged", now_); }},
      {"a finger that is too deep, and pause",
       [&](Sitting& one) {
         one.captured(16e-3, now_);
         one.captured(std::nullopt, now_ += 5 * ms);
         one.act(Act::pause, now_);
       }},
      {"a clock that jumps", [&](Sitting& one) { one.advance(now_ += 5000 * ms); }},
      {"a clock that jumps, and a frame first",
       [&](Sitting& one) {
         one.captured(std::nullopt, now_ += 5000 * ms);
         one.advance(now_);
       }},
  };
  for (const auto& [name, way] : ways) {
    written_.clear();
    now_ = 0;
    Sitting one = sitting();
    begin(one, BlockKind::trial);
    const std::uint32_t step = *one.agenda().current();
    ASSERT_TRUE(one.presented().sounds);
    now_ += 10 * ms;
    way(one);
    EXPECT_FALSE(one.presented().sounds) << name;
    EXPECT_EQ(count(EntryKind::broken), 1u) << name;
    EXPECT_EQ(one.agenda().voided(), 1u) << name;
    EXPECT_NE(one.agenda().current(), step) << name << ": it is repeated at the end of its block";
    EXPECT_FALSE(one.reason().empty()) << name;
    if (one.screen() == Screen::stopped) continue;
    ASSERT_EQ(one.screen(), Screen::paused) << name;
    one.act(Act::go_on, now_);
    EXPECT_EQ(one.screen(), Screen::ready) << name;
    // Nothing of it is left in the next touch.
    one.act(Act::go_on, now_);
    one.advance(now_ += 49 * ms);
    EXPECT_TRUE(one.presented().sounds) << name << ": " << one.reason();
    one.advance(now_ += ms);
    EXPECT_EQ(one.screen(), Screen::question) << name;
    EXPECT_EQ(written_.back().deep_s, 0) << name;
  }
}

TEST_F(SittingTest, ADiskThatIsFullIsSilence) {
  for (const bool while_touching : {false, true}) {
    written_.clear();
    disk_is_full_ = false;
    now_ = 0;
    Sitting one = sitting();
    consent(one);
    skip_to(one, BlockKind::trial);
    if (while_touching) one.act(Act::go_on, now_);
    disk_is_full_ = true;
    if (while_touching) {
      EXPECT_ERROR(one.advance(now_ += 50 * ms), Exit::failed, "the disk is full");
    } else {
      EXPECT_ERROR(one.act(Act::go_on, now_), Exit::failed, "the disk is full");
    }
    EXPECT_FALSE(one.presented().sounds);
    EXPECT_EQ(one.screen(), Screen::stopped);
    EXPECT_EQ(one.reason(), "the disk is full");
    one.act(Act::go_on, now_);
    one.advance(now_ += 1000 * ms);
    EXPECT_FALSE(one.presented().sounds);
  }
}

TEST_F(SittingTest, AClockThatGoesBackStandsStill) {
  Sitting one = sitting();
  begin(one, BlockKind::trial);
  one.advance(now_ - 10'000 * ms);
  EXPECT_TRUE(one.presented().sounds);
  EXPECT_EQ(one.next_ns(), now_ + 50 * ms);
}

TEST_F(SittingTest, PauseBetweenTrialsVoidsNothing) {
  Sitting one = sitting();
  consent(one);
  skip_to(one, BlockKind::trial);
  one.act(Act::pause, now_);
  EXPECT_EQ(one.screen(), Screen::paused);
  EXPECT_EQ(count(EntryKind::broken), 0u);
  one.act(Act::pause, now_);
  one.act(Act::go_on, now_);
  EXPECT_EQ(one.screen(), Screen::ready);
}

TEST_F(SittingTest, AsksForDepthImagesSeparately) {
  plan_.run.ask_depth_frames = true;
  for (const bool accepts : {true, false}) {
    Sitting one = sitting();
    one.act(Act::go_on, now_);
    one.act(Act::accept, now_);
    EXPECT_EQ(one.screen(), Screen::depth_consent);
    one.act(accepts ? Act::accept : Act::decline, now_);
    EXPECT_EQ(one.screen(), Screen::ready);
    EXPECT_TRUE(one.agenda().consent()->accepted);
    EXPECT_EQ(one.agenda().consent()->depth_frames, accepts);
  }
}

TEST_F(SittingTest, ContinuesWithSetUpButWithoutAskingForConsentAgain) {
  {
    Sitting one = sitting();
    begin(one, BlockKind::trial);
  }
  const std::vector<Entry> before = written_;
  Sitting one = sitting(before);
  EXPECT_EQ(one.agenda().starts(), 2u);
  EXPECT_EQ(one.agenda().voided(), 1u) << "the trial that was under way";
  EXPECT_EQ(one.screen(), Screen::setup);
  one.act(Act::go_on, 0);
  EXPECT_EQ(one.screen(), Screen::ready);
}

TEST_F(SittingTest, EndsAtOnceIfItWasKilledBetweenItsLastAnswerAndItsEnd) {
  for (const bool accepts : {true, false}) {
    written_.clear();
    {
      Sitting one = sitting();
      one.act(Act::go_on, now_);
      one.act(accepts ? Act::accept : Act::decline, now_);
      const ScriptedParticipant participant(1, 1, 0);
      while (one.screen() != Screen::end)
        participant.go_on(plan_, one, now_);
    }
    ASSERT_EQ(written_.back().kind, EntryKind::finish);
    std::vector<Entry> before = std::exchange(written_, {});
    before.pop_back();
    const Sitting one = sitting(before);
    EXPECT_EQ(one.screen(), Screen::end);
    EXPECT_FALSE(one.agenda().current());
    ASSERT_EQ(written_.size(), 2u);
    EXPECT_EQ(written_[0].kind, EntryKind::start);
    EXPECT_EQ(written_[1].kind, EntryKind::finish);
  }
}

}  // namespace
}  // namespace palpa::study
