// The states that a live run can be in, and the transitions between them.
#include <gtest/gtest.h>

#include <atomic>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "heard_link.hpp"
#include "support/begins.hpp"
#include "support/captured.hpp"
#include "support/occurrences.hpp"
#include "support/thrown.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/live/run_control.hpp"

namespace palpa::viewer {
namespace {

using enum RunState;
enum class Act { change, start, switch_off, stay, begin, wait };

/// A run of a synthetic finger in a cube, on the processor.
class RunControls : public testing::Test {
 protected:
  RunControls() {
    LiveSession::Kinds kinds;
    for (const char* name : {"heard", "other"}) {
      kinds.links.push_back(test::heard_link(heard_));
      kinds.links.back().name = name;
    }
    run_ = std::make_unique<RunControl>(std::move(kinds), stop_, [] {});
  }
  static setup::LiveOptions broken() { return live_options({{"--scene", {"/nowhere.glb"}}}); }

  /// Runs the loop like a viewer, but starts nothing.
  bool comes_to(RunState state) {
    return test::begins([&] {
      if (run_->state() == state) return true;
      if (run_->session()) run_->session()->look();
      if (const auto fault = run_->advance()) ends_.push_back(*fault);
      return false;
    });
  }
  struct Step {
    Act act;
    RunState then;
    bool off = true;  ///< what switch_off() says
  };
  /// Does one thing after the other, each with these options, and checks the state after each.
  void goes(std::initializer_list<Step> steps, const setup::LiveOptions& options = test::heard_options()) {
    int number = 0;
    for (const Step& step : steps) {
      SCOPED_TRACE(number++);
      switch (step.act) {
        case Act::change:
          run_->change(options);
          break;
        case Act::start:
          run_->start(options);
          break;
        case Act::switch_off:
          EXPECT_EQ(run_->switch_off(), step.off);
          break;
        case Act::stay:
          run_->stay();
          break;
        case Act::begin:
          ASSERT_TRUE(run_->begin());
          break;
        case Act::wait:
          ASSERT_TRUE(comes_to(step.then));
          break;
      }
      EXPECT_EQ(run_->state(), step.then);
      EXPECT_EQ(run_->restarts(), step.then == restarting || step.then == ready);
      EXPECT_EQ(run_->under_way(),
                step.then == loading || step.then == running || step.then == restarting || step.then == switching_off);
    }
  }

  std::shared_ptr<test::HeardSound> heard_ = std::make_shared<test::HeardSound>();
  std::atomic<bool> stop_{false};
  std::unique_ptr<RunControl> run_;
  std::vector<std::string> ends_;  ///< the fault of each session that has ended
};

TEST_F(RunControls, BeginsWhenItIsAskedTo) {
  EXPECT_FALSE(run_->session());
  EXPECT_FALSE(run_->advance());
  goes({{Act::switch_off, none, false}, {Act::begin, none}});  // nobody has said with which options
  EXPECT_TRUE(run_->finish(0));
  goes({{Act::change, ready}, {Act::begin, loading}, {Act::wait, running}, {Act::stay, running}});
  EXPECT_EQ(run_->options().scene, test::heard_options().scene);
  EXPECT_TRUE(run_->take_scene()) << "it was there before the first frame";
  EXPECT_FALSE(run_->take_scene()) << "once";
  EXPECT_TRUE(run_->scene());
  EXPECT_TRUE(run_->finish(60));
  EXPECT_FALSE(heard_->last_sounds);
}

TEST_F(RunControls, EndsByItselfAndBeginsAgainWithOtherOptions) {
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, ended}}, test::heard_options(3));
  EXPECT_EQ(ends_, std::vector<std::string>{""}) << "without a fault, once";
  EXPECT_FALSE(run_->advance()) << "it was reported already";
  goes({{Act::change, ready}}, broken());
  EXPECT_EQ(run_->options().scene, test::heard_options().scene) << "of the session that is there";
  EXPECT_EQ(run_->next().scene, broken().scene);
  goes({{Act::begin, loading}, {Act::wait, failed}});
  ASSERT_EQ(ends_.size(), 2u);
  EXPECT_CONTAINS(ends_[1], "/nowhere.glb");
  EXPECT_FALSE(run_->take_scene());
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, running}});
}

TEST_F(RunControls, ASessionThatIsUnderWayEndsBeforeTheNext) {
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, running}, {Act::change, restarting}});
  EXPECT_TRUE(stop_) << "it is silent";
  goes({{Act::begin, restarting}, {Act::change, restarting}, {Act::wait, ready}});
  EXPECT_EQ(ends_.size(), 1u);
  EXPECT_TRUE(run_->session()) << "it is there until the next begins";
  goes({{Act::begin, loading}});
  EXPECT_FALSE(stop_);
  EXPECT_FALSE(run_->scene());
  goes({{Act::wait, running}, {Act::change, restarting}, {Act::wait, ready}, {Act::stay, ended}});
}

TEST_F(RunControls, WhatIsSwitchedOffStaysSoUntilItIsStarted) {
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, running}, {Act::switch_off, switching_off}});
  goes({{Act::switch_off, switching_off, false}, {Act::change, switching_off}, {Act::wait, switched_off}});
  EXPECT_EQ(ends_.size(), 1u);
  goes({{Act::change, switched_off}, {Act::begin, switched_off}}, test::heard_options(7));
  EXPECT_TRUE(stop_);
  EXPECT_EQ(run_->next().frames, 7u) << "with these it would start";
  goes({{Act::switch_off, switched_off, false}, {Act::start, ready}, {Act::switch_off, switched_off}});
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, running}});
  // While it is being switched off, the last word counts.
  goes({{Act::switch_off, switching_off}, {Act::start, restarting}, {Act::switch_off, switching_off}});
  goes({{Act::start, restarting}, {Act::wait, ready}, {Act::begin, loading}, {Act::wait, running}});
}

/// How often a board's run says that it plays at full amplitude.
std::size_t told_of(const std::string& messages, const std::string& link = "heard") {
  return test::occurrences(messages, "--link " + link + ": plays at full amplitude");
}

TEST_F(RunControls, EachBoardAtFullAmplitudeIsToldOnce) {
  heard_->board = true;
  const auto runs = [&](const setup::LiveOptions& options) {
    return test::stderr_of([&] {
      goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, running}}, options);
      goes({{Act::switch_off, switching_off}, {Act::wait, switched_off}});
    });
  };
  setup::LiveOptions quiet = test::heard_options();
  quiet.safety.ceiling = 0.3;
  EXPECT_EQ(told_of(runs(quiet)), 0u);
  goes({{Act::start, ready}}, broken());
  EXPECT_EQ(told_of(test::stderr_of([&] { goes({{Act::begin, loading}, {Act::wait, failed}}); })), 0u);
  EXPECT_EQ(told_of(runs(test::heard_options())), 1u) << "the run that failed did not say so";
  EXPECT_EQ(told_of(runs(test::heard_options())), 0u) << "its user knows";
  setup::LiveOptions other = test::heard_options();
  other.link = "other";
  EXPECT_EQ(told_of(runs(other), "other"), 1u) << "these boards have not sounded yet";
  EXPECT_EQ(told_of(runs(other), "other"), 0u);
}

TEST_F(RunControls, SwitchedOffBeforeOrAfterItsRunItBeginsNothing) {
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::switch_off, switching_off}, {Act::wait, switched_off}});
  EXPECT_FALSE(heard_->sounded()) << "it was loading";
  goes({{Act::start, ready}, {Act::begin, loading}, {Act::wait, ended}}, test::heard_options(3));
  goes({{Act::switch_off, switched_off}, {Act::change, switched_off}});
}

}  // namespace
}  // namespace palpa::viewer
