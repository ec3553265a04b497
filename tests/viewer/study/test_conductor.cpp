// A participant's sitting in front of an array: it sounds during touches only, and is silent after everything else.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/files/sha256.hpp"
#include "setup/files/played_foci.hpp"
#include "sitting_bench.hpp"
#include "study/files/study_folder.hpp"
#include "study/plan/order.hpp"
#include "support/begins.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/thrown.hpp"

namespace palpa::viewer {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using nlohmann::json;
using study::Screen;
using test::answers_in;

class ConductorTest : public testing::Test {
 protected:
  ConductorTest() { test::finger_depth_m = 3e-3; }
  test::SittingBench& prepare(const std::string& blocks, double touch_s = 0.05, const std::string& run = "") {
    const test::PlanParts parts{.touch_s = touch_s, .dwell_ms = dwell_ms_, .run = "predict = false\n" + run};
    bench_ = std::make_unique<test::SittingBench>(folder_, test::write_study_plan(folder_, blocks, parts));
    return *bench_;
  }
  test::SittingBench& begin(const std::string& blocks, double touch_s) {
    prepare(blocks, touch_s).begin();
    return *bench_;
  }
  /// A sitting with one kind of block, whose touches do not end during a test.
  test::SittingBench& long_touches(const std::string& kind = "trial") {
    return begin("[[block]]\nkind = \"" + kind + "\"\n", 600);
  }
  /// Until it pauses by itself, and says why.
  void expect_pause(const std::string& reason) {
    ASSERT_TRUE(bench_->reaches(Screen::paused, false));
    EXPECT_CONTAINS(bench_->sitting().reason(), reason);
  }
  bool sounds() { return bench_->conductor().presentation().gate().sounding(); }
  bool comes_to_sound() {
    return bench_->goes_until([&] { return sounds(); }, false);
  }
  bool touches_and_sounds() { return bench_->reaches(Screen::touching) && comes_to_sound(); }
  bool is_ready() {
    return bench_->goes_until([&] { return bench_->conductor().presentation().ready(); }, false);
  }
  /// A line of the experimenter's window, or one below it.
  StateLine shown(std::string_view name, std::ptrdiff_t below = 0) {
    const ExperimenterView view = bench_->conductor().experimenter_view();
    return std::ranges::find(view.lines, name, &StateLine::name)[below];
  }
  fs::path beh(const std::string& end, int run = 1) const {
    return folder_ / "study" / sub_ / "beh" / (sub_ + "_task-shapes_run-0" + std::to_string(run) + end);
  }

  const fs::path folder_ = test::scratch_folder("conductor");
  std::unique_ptr<test::SittingBench> bench_;
  std::array<double, 2> dwell_ms_{1.5, 1.5};
  std::string sub_ = "sub-01";
};

TEST_F(ConductorTest, AWholeStudyKilledTwiceHasTheAnswersOfOneThatIsNot) {
  prepare(test::all_blocks());
  for (const std::size_t steps : {5, 16, 1000}) {
    bench_->begin();
    const std::size_t before = bench_->sitting().agenda().complete();
    ASSERT_TRUE(bench_->goes_until([&] {
      return bench_->conductor().over() || (bench_->sitting().agenda().complete() >= before + steps &&
                                            bench_->sitting().screen() == Screen::touching);
    })) << bench_->sitting().reason()
        << bench_->conductor().experimenter_view().state << ", " << bench_->sitting().agenda().complete()
        << " complete";
    EXPECT_EQ(bench_->conductor().over(), steps == 1000) << bench_->sitting().reason();
    bench_->end();
    EXPECT_FALSE(bench_->heard()->last_sounds);
    EXPECT_TRUE(bench_->heard()->finished);
  }
  // The same person without windows, array and kills.
  const fs::path whole = test::scratch_folder("conductor-whole");
  study::Record record(bench_->plan(), 1, whole, true);
  const study::Entry start{.text = study::utc_now(), .version = "v", .rehearsal = true};
  EXPECT_TRUE(study::rehearse(
      bench_->plan(), record.agenda(), start, study::ScriptedParticipant(0.5, 1, 0),
      [&](const study::Entry& entry) { record.add(entry); }, nullptr));
  EXPECT_EQ(answers_in(folder_ / "study"), answers_in(whole));
  EXPECT_EQ(answers_in(whole).size(), 8u);
  for (const int run : {1, 2})
    EXPECT_CONTAINS(test::read_text(beh("_events.tsv", run)), "\tvoid\t");
  EXPECT_EQ(test::read_text(beh("_events.tsv", 3)).find("\tvoid\t"), std::string::npos);
  EXPECT_EQ(json::parse(test::read_text(beh("_events.json")))["Masking"], "off");
  EXPECT_EQ(json::parse(test::read_text(beh("_events.json")))["Backend"], "cpu");
}

TEST_F(ConductorTest, ACompleteSittingWithoutItsLastLineEndsWithoutAKey) {
  prepare("[[block]]\nkind = \"rest\"\nrest_s = 0.01\n").begin();
  ASSERT_TRUE(bench_->goes_until([&] { return bench_->conductor().over(); }));
  bench_->end();
  const fs::path journal = folder_ / "study/sub-01/sub-01_journal.jsonl";
  std::string text = test::read_text(journal);
  text.pop_back();  // the last line has no end
  test::write_text(journal, text);
  bench_->options().link = "unplugged";
  bench_->level().measured = 150.2;
  bench_->begin();
  EXPECT_EQ(bench_->sitting().screen(), Screen::end);
  bench_->conductor().advance();
  EXPECT_EQ(bench_->conductor().participant_view().text, bench_->plan().text(study::TextId::end));
  EXPECT_EQ(bench_->conductor().experimenter_view().state, "the end");
  EXPECT_EQ(shown("level").value, "150 dB measured at the louder ear, limit 140 dB");
  EXPECT_TRUE(shown("level").warns);
  EXPECT_EQ(shown("level", 1).value, "116 dB equivalent for 8 h; ceiling 0.5");
  EXPECT_TRUE(bench_->sitting().agenda().finished());
  bench_->end();
  EXPECT_ERROR(bench_->begin(), Exit::usage, "participant 1 has finished");
}

TEST_F(ConductorTest, ATouchLeavesEverythingThatWasPlayed) {
  dwell_ms_ = {1.5, 2};
  prepare("[[block]]\nkind = \"trial\"\nrepeats = 1\n", 1, "ask_depth_frames = true\n");
  if (study::methods_of(bench_->plan(), 1)[0] == 0) {  // the plan's second method is the first that is felt
    bench_->options().participant = 2;
    sub_ = "sub-02";
  }
  bench_->begin();
  ASSERT_TRUE(bench_->goes_until([&] { return bench_->sitting().agenda().complete() == 2; }));
  EXPECT_TRUE(fs::is_directory(beh("_touch-001_depth")));
  EXPECT_GT(bench_->heard()->sounding, 0u);
  EXPECT_LE(bench_->heard()->loudest, 0.5F) << "the plan's ceiling";
  const json touches = json::parse(test::read_text(beh("_stimuli.json")))["touches"];
  ASSERT_EQ(touches.size(), 2u);
  EXPECT_NE(touches[0]["shape"], touches[1]["shape"]);
  EXPECT_NE(touches[0]["drives_sha256"], touches[1]["drives_sha256"]);
  for (const json& touch : touches) {
    const bool cube = touch["shape"] == "cube";
    EXPECT_EQ(touch["ceiling"], 0.5);
    EXPECT_EQ(touch["drives_sha256"].get<std::string>().size(), 64u);
    EXPECT_GT(touch["drives"], 10);
    EXPECT_EQ(touch["layout"], "autd3");
    EXPECT_EQ(touch["model_sha256"],
              sha256_of_file(test::source_file(cube ? "assets/cube.glb" : "assets/semi-sphere.glb")));
    const json foci = json::parse(test::read_text(beh("").parent_path() / touch["foci_file"].get<std::string>()));
    EXPECT_EQ(foci["slot_s"], 2e-3) << "that of its method";
    ASSERT_GE(foci["frames"].size(), 2u);
    std::size_t fingers = 0;
    for (const json& frame : foci["frames"]) {
      for (const json& finger : frame["fingers"]) {
        EXPECT_EQ(finger["solid"], cube ? "0 cube" : "1 semi-sphere") << "no other shape is within reach";
        ++fingers;
      }
    }
    EXPECT_GT(fingers, 1u);
    // palpa export can play it again: the file says when each foci begin and when the touch ends.
    const session::PlayedFoci played =
        setup::load_played_foci(beh("").parent_path() / touch["foci_file"].get<std::string>());
    EXPECT_EQ(played.frames.back().schedule.voice_count, 0u);
    EXPECT_GE(played.frames.back().slot - played.frames.front().slot, touch["drives"].get<std::uint64_t>())
        << "slots that were late were skipped";
  }
  const std::string log = test::read_text(beh("_events.tsv"));
  EXPECT_CONTAINS(
      log, "\treason\tlost_drives\tskipped_drives\toutdated_frames\tthinned_frames\tleft_out_frames\tskin_frames\n");
  EXPECT_CONTAINS(log, "\tn/a\t0\t") << "no reason, no drive was lost";
  // The depth of the finger, as the analysis reads it.
  const study::Study study = study::read_study(std::vector<std::string>{(folder_ / "study").string()});
  ASSERT_EQ(study.participants.at(0).trials.size(), 2u);
  double deepest_m = 0;
  for (const study::DepthCourse& course : study.participants[0].depths) {
    for (std::size_t bin = 0; bin < course.samples.size(); ++bin) {
      if (course.samples[bin] > 0) deepest_m = std::max(deepest_m, course.sum_m[bin] / course.samples[bin]);
    }
  }
  EXPECT_NEAR(deepest_m, 3e-3, 1.5e-3) << "with the sensor's noise";
  EXPECT_EQ(test::open_to_others(folder_ / "study" / sub_), std::vector<fs::path>());
}

TEST_F(ConductorTest, AnyKeyOfTheParticipantSilences) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  bench.press(key_of('x'));
  EXPECT_EQ(bench.sitting().screen(), Screen::paused);
  EXPECT_TRUE(bench.is_silent());
  bench.press(Key::space);
  EXPECT_EQ(bench.sitting().screen(), Screen::paused) << "only the experimenter continues";
  const Gate& gate = bench.conductor().presentation().gate();
  EXPECT_GT(gate.counts().drives, 0u);
  bench.press(Key::space, true);
  EXPECT_EQ(bench.sitting().screen(), Screen::ready);
  EXPECT_EQ(bench.sitting().agenda().voided(), 1u);
  ASSERT_TRUE(is_ready());
  bench.press(Key::space);
  ASSERT_EQ(bench.sitting().screen(), Screen::touching) << "and it goes on";
  EXPECT_EQ(gate.counts().drives, 0u) << "what was broken off is no part of the next touch";
  ASSERT_TRUE(comes_to_sound());
}

TEST_F(ConductorTest, PauseAndStopSilence) {
  const auto begin = std::chrono::steady_clock::now();
  test::SittingBench& bench = long_touches();
  EXPECT_EQ(shown("steps").value, "0 of 8 complete, 0 void");
  EXPECT_EQ(shown("now").value, "step 1: trial");
  EXPECT_EQ(shown("finger").value, "not over the object");
  EXPECT_EQ(shown("overload").value, "none");
  EXPECT_EQ(shown("level").value, "101 dB predicted at the louder ear, limit 140 dB");
  EXPECT_FALSE(shown("level").warns);
  EXPECT_EQ(shown("level", 1).value, "66 dB equivalent for 8 h; reflections +-10 dB; ceiling 0.5");
  EXPECT_EQ(shown("dose").value, "no sound so far");
  EXPECT_TRUE(shown("masking").warns) << "there is none";
  ASSERT_TRUE(touches_and_sounds());
  bench.press(key_of('p'), true);
  EXPECT_EQ(bench.sitting().screen(), Screen::paused);
  EXPECT_TRUE(bench.is_silent());
  bench.press(Key::space, true);
  ASSERT_TRUE(touches_and_sounds());
  bench.press(key_of('q'), true);
  EXPECT_EQ(bench.sitting().screen(), Screen::stopped);
  EXPECT_TRUE(bench.is_silent());
  EXPECT_CONTAINS(test::read_text(beh("_events.tsv")), "paused by the experimenter");
  const json level = json::parse(test::read_text(beh("_events.json")))["SoundLevel"];
  const double sounded_s = level["SoundedSeconds"];
  EXPECT_GT(sounded_s, 0) << "touches that were broken off, too";
  EXPECT_LT(sounded_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  EXPECT_NEAR(level["SoundedEquivalentDb"], level["PredictedPeakDb"].get<double>() + 10 * std::log10(sounded_s / 28800),
              1e-3);
  EXPECT_EQ(shown("dose").value, fmt::format("{:.0f} s of sound so far: at most {:.0f} dB equivalent for 8 h",
                                             sounded_s, 101 + 10 * std::log10(sounded_s / 28800)));
  EXPECT_EQ(shown("steps").value, "0 of 8 complete, 2 void");
}

TEST_F(ConductorTest, AFingerThatIsTooDeepFeelsNothing) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  test::finger_depth_m = 20e-3;
  ASSERT_TRUE(bench.goes_until([&] { return !bench.sitting().presented().sounds; }, false));
  EXPECT_EQ(bench.sitting().screen(), Screen::touching) << "the touch goes on";
  EXPECT_TRUE(bench.is_silent());
  EXPECT_GT(*bench.conductor().presentation().deepest_m(), 15e-3);
  const StateLine deep = shown("finger");
  EXPECT_TRUE(deep.warns);
  EXPECT_NEAR(std::stod(deep.value), 20, 2);
  EXPECT_CONTAINS(deep.value, " mm below the top");
  test::finger_depth_m = 3e-3;
  ASSERT_TRUE(comes_to_sound()) << "it has risen";
  EXPECT_NEAR(std::stod(shown("finger").value), 3, 2);
  EXPECT_FALSE(shown("finger").warns);
}

TEST_F(ConductorTest, AnArrayThatFailsIsAPauseAndCanContinue) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  bench.heard()->breaks = true;
  expect_pause("heard: broken");
  EXPECT_FALSE(bench.conductor().presentation().gate().is_open());
  EXPECT_TRUE(bench.conductor().experimenter_view().may_sound);
  bench.heard()->breaks = false;
  bench.press(Key::space, true);
  ASSERT_TRUE(touches_and_sounds());
}

TEST_F(ConductorTest, ADiskThatIsFullEndsTheTouchInSilence) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  // The journal cannot grow: its folder is on a disk without room, so to speak.
  const test::FileSizeLimit full(1);
  EXPECT_ERROR(bench.press(key_of('p'), true), Exit::failed, "journal");
  EXPECT_EQ(bench.sitting().screen(), Screen::stopped);
  EXPECT_TRUE(bench.is_silent());
}

TEST_F(ConductorTest, AProgramThatStandsStillIsSilent) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  // The program's thread stands still for longer than the gate stays open, but not so long that the touch is void. A
  // busy machine may let it stand still for longer.
  bool goes_on = false;
  for (int attempt = 0; attempt < 20 && !goes_on; ++attempt) {
    bench.clock().forward(0.6);
    EXPECT_FALSE(bench.conductor().presentation().gate().is_open());
    EXPECT_TRUE(test::begins([&] { return !bench.heard()->last_sounds; }));
    ASSERT_TRUE(bench.goes_until(
        [&] { return bench.sitting().screen() == Screen::paused || (bench.conductor().advance(), sounds()); }, false));
    goes_on = bench.sitting().screen() == Screen::touching;
    if (!goes_on) {
      bench.press(Key::space, true);
      ASSERT_TRUE(touches_and_sounds());
    }
  }
  EXPECT_TRUE(goes_on);
  bench.clock().forward(1.2);
  expect_pause("stood still");
}

/// The link of a board that was unplugged does not fail: it waits for the board.
TEST_F(ConductorTest, AnArrayThatTakesNoDrivesIsAPauseAndCanContinue) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  bench.heard()->swallows = true;
  expect_pause("the array takes no drives");
  EXPECT_TRUE(bench.conductor().experimenter_view().may_sound);
  EXPECT_EQ(bench.conductor().participant_view().text.find("othing sounds"), std::string::npos) << "who knows";
  EXPECT_TRUE(bench.is_silent());
  EXPECT_TRUE(bench.conductor().experimenter_view().may_sound) << "until it is known";
  EXPECT_FALSE(bench.heard()->finished) << "somebody has to silence it when it takes drives again";
  const std::uint64_t before = bench.heard()->drives;
  EXPECT_TRUE(bench.goes_until([&] { return bench.heard()->drives > before; }, false)) << "drives of silence";
  EXPECT_EQ(bench.sitting().agenda().voided(), 1u);
  EXPECT_CONTAINS(test::read_text(beh("_events.tsv")), "\tvoid\t");
  bench.heard()->swallows = false;
  bench.press(Key::space, true);
  ASSERT_TRUE(touches_and_sounds()) << "it is plugged in again";
  EXPECT_FALSE(bench.conductor().experimenter_view().may_sound);
  EXPECT_EQ(bench.heard()->opened, 2);
}

TEST_F(ConductorTest, AnArrayThatIsOutOfReachIsToldBeforeTheFirstTouch) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(is_ready());
  bench.heard()->gone = true;
  const auto told = [&] {
    const StateLine array = shown("array");
    return array.warns && array.value.starts_with("heard is out of reach");
  };
  ASSERT_TRUE(bench.goes_until(told, false));
  EXPECT_FALSE(bench.conductor().experimenter_view().may_sound) << "it has not sounded";
  bench.heard()->gone = false;
  EXPECT_TRUE(bench.goes_until([&] { return !told(); }, false));
}

TEST_F(ConductorTest, AnArrayThatMaySoundOnIsToldBeforeTheNextTouchAndAtTheEnd) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  bench.heard()->swallows = true;
  ASSERT_TRUE(bench.reaches(Screen::paused, false));
  bench.heard()->unsure = true;
  bench.press(Key::space, true);
  ASSERT_TRUE(bench.goes_until([&] { return bench.heard()->finished.load(); }));
  expect_pause("it is not known whether the last silence reached the board");
  bench.press(Key::space, true);
  bench.heard()->swallows = false;
  ASSERT_TRUE(touches_and_sounds());
  bench.conductor().stop();
  ASSERT_TRUE(bench.conductor().presentation().end(std::chrono::seconds(60)));
  EXPECT_CONTAINS(bench.conductor().presentation().end_fault(), "it is not known whether the last silence");
}

/// The array is gone before the touch begins: nobody feels anything, and the window does not say that it sounds.
TEST_F(ConductorTest, ATouchWithoutAnArrayIsVoid) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(bench.reaches(Screen::ready));
  bench.heard()->swallows = true;
  bool said_sounds = false;
  ASSERT_TRUE(bench.goes_until([&] {
    said_sounds = said_sounds || bench.conductor().experimenter_view().sounds;
    return bench.sitting().screen() == Screen::paused;
  }));
  EXPECT_FALSE(said_sounds);
  EXPECT_CONTAINS(bench.sitting().reason(), "the array takes no drives");
  EXPECT_EQ(bench.sitting().agenda().voided(), 1u);
}

TEST_F(ConductorTest, ATouchOfWhichTooLittleArrivesIsVoid) {
  begin("[[block]]\nkind = \"trial\"\n", 1);
  bench_->heard()->halves = true;
  ASSERT_TRUE(bench_->reaches(Screen::paused));
  EXPECT_CONTAINS(bench_->sitting().reason(), "did not reach the array");
  EXPECT_EQ(bench_->sitting().agenda().complete(), 0u);
  EXPECT_CONTAINS(test::read_text(beh("_events.tsv")), "did not reach the array");
  EXPECT_CONTAINS(shown("overload").value, "lost");
  bench_->heard()->halves = false;
  bench_->press(Key::space, true);
  ASSERT_TRUE(bench_->goes_until([&] { return bench_->sitting().agenda().complete() == 1; }));
  EXPECT_EQ(bench_->sitting().agenda().voided(), 1u);
}

/// The frames that are left out are made up, and the clock is put forward: it does not matter how many real ones a busy
/// machine leaves out, nor how long it stands still.
TEST_F(ConductorTest, ATrialWithoutItsStimulusIsRepeatedTwiceAndThenStaysVoid) {
  prepare("[[block]]\nkind = \"trial\"\nrepeats = 1\n", 2);
  bench_->options().hold_s = 0.1;
  bench_->begin();
  std::uint64_t sequence = 1'000'000;
  ASSERT_TRUE(bench_->goes_until([&] {
    if (bench_->sitting().screen() == Screen::paused) bench_->press(Key::space, true);
    if (bench_->sitting().screen() == Screen::touching) {
      TouchFrames& frames = bench_->conductor().presentation().gate().frames();
      for (int i = 0; i < 100; ++i)
        frames.arrived(++sequence);
      frames.seen(sequence, true, false);
      bench_->clock().forward(0.4);
    }
    return bench_->conductor().over();
  })) << bench_->sitting().reason();
  EXPECT_EQ(bench_->sitting().screen(), Screen::end);
  const study::Agenda& agenda = bench_->sitting().agenda();
  EXPECT_EQ(agenda.complete(), 0u) << "nothing was asked";
  EXPECT_EQ(agenda.voided(), 3 * agenda.steps().size());
  EXPECT_EQ(agenda.stay_void().size(), agenda.steps().size());
  EXPECT_CONTAINS(shown("steps").value, "4 steps stay void");
  EXPECT_TRUE(shown("steps").warns);
  const std::string log = test::read_text(beh("_events.tsv"));
  EXPECT_CONTAINS(log, "\tvoid\t");
  EXPECT_CONTAINS(log, "the touch lacked its stimulus: of ");
  EXPECT_CONTAINS(log, "; it was repeated often enough and stays void\t");
  EXPECT_EQ(log.find("\tanswered\t"), std::string::npos);
  bench_->end();
  EXPECT_FALSE(bench_->heard()->last_sounds);
}

TEST_F(ConductorTest, AnAnswerBeforeTheQuestionIsIgnored) {
  test::SittingBench& bench = long_touches();
  ASSERT_TRUE(touches_and_sounds());
  EXPECT_EQ(bench.conductor().participant_view().hint, "");
  EXPECT_TRUE(bench.conductor().participant_view().marker) << "where the finger begins";
  bench.press(key_of('2'));
  EXPECT_EQ(bench.sitting().screen(), Screen::touching);
  EXPECT_EQ(bench.conductor().participant_view().hint, "Please wait for the question.");
  EXPECT_EQ(bench.sitting().agenda().voided(), 0u);
  bench.press(key_of('3'));
  EXPECT_EQ(bench.sitting().screen(), Screen::paused) << "there is no third answer, so it is a wish for silence";
}

/// The participant's number is not used up, and the plan can still be changed or mended.
TEST_F(ConductorTest, WithoutItsSoundOrSourceNoFileIsBegun) {
  const fs::path plan = test::write_study_plan(folder_, "");
  test::SittingBench bench(folder_, plan);
  bench.options().source = "camera:/dev/none";
  EXPECT_ERROR(bench.begin(), Exit::usage, "camera");
  bench.options().source = "pressed:" + (folder_ / "none.ply").string();
  EXPECT_ERROR(bench.begin(), Exit::bad_input, "none.ply");
  test::write_text(folder_ / "noise.wav", "no sound");
  std::string text = test::read_text(plan);
  test::write_text(plan, text.replace(text.find("\"off\""), 5, "\"noise.wav\""));
  test::SittingBench noisy(folder_, plan);
  EXPECT_CONTAINS(test::thrown_by([&] { noisy.begin(); }).what(), "noise.wav");  // palpa may be built without sound
  EXPECT_FALSE(fs::exists(folder_ / "study"));
}

TEST_F(ConductorTest, ADoubleClickOnAnAnswerBeginsNothing) {
  test::SittingBench& bench = prepare("[[block]]\nkind = \"trial\"\nrepeats = 1\n", 0.05, "ask_depth_frames = true\n");
  bench.options().rehearse.reset();
  bench.begin();
  ASSERT_TRUE(bench.reaches(Screen::consent));
  // The presentation is ready only now and then on a busy machine; until it is, no click has an effect.
  const std::chrono::nanoseconds accepted = bench.click(0);
  bench.click(0, accepted + 299ms);
  EXPECT_EQ(bench.sitting().screen(), Screen::depth_consent) << "nobody has read it yet";
  bench.passes(310ms);
  bench.click(1);
  bench.passes(310ms);
  ASSERT_TRUE(is_ready());
  bench.click(std::nullopt);
  ASSERT_TRUE(bench.reaches(Screen::question, false));
  EXPECT_FALSE(bench.conductor().participant_view().marker);
  const std::chrono::nanoseconds answered = bench.click(1);
  ASSERT_EQ(bench.sitting().screen(), Screen::ready);
  ASSERT_TRUE(is_ready());
  bench.click(1, answered + 299ms);
  EXPECT_EQ(bench.sitting().screen(), Screen::ready);
  bench.passes(310ms);
  ASSERT_TRUE(is_ready());
  bench.click(1);
  EXPECT_EQ(bench.sitting().screen(), Screen::touching);
  bench.click(1);
  EXPECT_EQ(bench.sitting().screen(), Screen::paused) << "during a touch, every click silences";
}

TEST_F(ConductorTest, KeysChangeTheShapeOfTheFreeExploration) {
  test::SittingBench& bench = long_touches("free");
  ASSERT_TRUE(touches_and_sounds());
  EXPECT_EQ(bench.conductor().participant_view().hint, "cube");
  const std::optional<std::int64_t> end = bench.sitting().next_ns();
  bench.press(key_of('2'));
  EXPECT_EQ(bench.sitting().presented().shape, 1u);
  EXPECT_EQ(bench.conductor().participant_view().hint, "semi-sphere");
  EXPECT_EQ(bench.sitting().next_ns(), end) << "the time goes on";
  bench.press(key_of('1'));
  bench.press(Key::right);
  EXPECT_EQ(bench.sitting().presented().shape, 1u);
  bench.conductor().advance();
  EXPECT_FALSE(bench.conductor().presentation().ready()) << "this shape has not been placed yet";
  ASSERT_TRUE(is_ready());
  ASSERT_TRUE(comes_to_sound());
  EXPECT_EQ(bench.sitting().screen(), Screen::touching);
  bench.press(Key::up);
  const study::Presented next = bench.sitting().presented();
  EXPECT_EQ(next.shape, 0u);
  Presentation& presentation = bench.conductor().presentation();
  presentation.prepare(next.method, next.shape);
  EXPECT_FALSE(presentation.gate().is_open()) << "nobody feels the shape before";
}

TEST_F(ConductorTest, WindowsSayWhatCanBeDone) {
  test::SittingBench& bench = long_touches();
  EXPECT_EQ(bench.conductor().experimenter_view().state, "set-up");
  bench.press(Key::space, true);
  EXPECT_EQ(bench.sitting().screen(), Screen::setup) << "the array is not ready yet";
  ASSERT_TRUE(bench.reaches(Screen::consent));
  EXPECT_EQ(bench.conductor().participant_view().buttons, (std::vector<std::string>{"yes", "no"}));
  bench.press(key_of('2'));
  EXPECT_EQ(bench.sitting().screen(), Screen::end) << "no consent";
  EXPECT_EQ(bench.heard()->sounding, 0u) << "nothing sounds before consent";
  EXPECT_TRUE(bench.conductor().experimenter_view().buttons.empty());
  EXPECT_TRUE(bench.goes_until([&] { return bench.heard()->finished.load(); })) << "the array is left alone at the end";
}

}  // namespace
}  // namespace palpa::viewer
