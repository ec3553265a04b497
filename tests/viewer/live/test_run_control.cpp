// The states that a live run can be in, and the transitions between them.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "heard_link.hpp"
#include "support/shared_data.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/live/run_control.hpp"

namespace palpa::viewer {
namespace {

using namespace std::chrono_literals;

/// A run of a synthetic finger in a cube, on the processor.
class RunControls : public testing::Test {
 protected:
  RunControls() {
    LiveSession::Kinds kinds;
    kinds.links.push_back(test::heard_link(heard_));
    run_ = std::make_unique<RunControl>(std::move(kinds), stop_, [] {});
  }
  static setup::LiveOptions broken() { return live_options({{"--scene", {"/nowhere.glb"}}}); }

  /// Runs the loop like a viewer, but starts nothing.
  bool comes_to(RunState state) {
    const auto until = std::chrono::steady_clock::now() + 60s;
    while (run_->state() != state) {
      if (std::chrono::steady_clock::now() > until) return false;
      if (run_->session()) run_->session()->look();
      if (const auto fault = run_->advance()) ends_.push_back(*fault);
      std::this_thread::sleep_for(2ms);
    }
    return true;
  }
  /// From no run, or an ended one, to a running one.
  bool runs(const setup::LiveOptions& options) {
    run_->start(options);
    return run_->begin() && comes_to(RunState::running);
  }

  std::shared_ptr<test::Heard> heard_ = std::make_shared<test::Heard>();
  std::atomic<bool> stop_{false};
  std::unique_ptr<RunControl> run_;
  std::vector<std::string> ends_;  ///< the fault of each session that has ended
};

TEST_F(RunControls, BeginsWhenItIsAskedTo) {
  EXPECT_EQ(run_->state(), RunState::none);
  EXPECT_FALSE(run_->session());
  EXPECT_FALSE(run_->switch_off()) << "there is nothing to switch off";
  EXPECT_FALSE(run_->advance());
  ASSERT_TRUE(run_->begin());
  EXPECT_EQ(run_->state(), RunState::none) << "nobody has said with which options";
  EXPECT_TRUE(run_->finish(0));

  run_->change(test::heard_options());
  EXPECT_EQ(run_->state(), RunState::ready);
  EXPECT_TRUE(run_->restarts());
  ASSERT_TRUE(run_->begin());
  EXPECT_EQ(run_->state(), RunState::loading);
  EXPECT_TRUE(run_->under_way());
  EXPECT_FALSE(run_->restarts());
  ASSERT_TRUE(comes_to(RunState::running));
  EXPECT_EQ(run_->options().scene, test::heard_options().scene);
  EXPECT_TRUE(run_->take_scene()) << "it was there before the first frame";
  EXPECT_FALSE(run_->take_scene()) << "once";
  EXPECT_TRUE(run_->scene());
  EXPECT_TRUE(run_->finish(60));
  EXPECT_FALSE(heard_->last_sounds);
}

TEST_F(RunControls, EndsByItselfAndBeginsAgainWithOtherOptions) {
  run_->start(test::heard_options(3));
  ASSERT_TRUE(run_->begin());
  ASSERT_TRUE(comes_to(RunState::ended));
  EXPECT_EQ(ends_, std::vector<std::string>{""}) << "without a fault, once";
  EXPECT_FALSE(run_->under_way());
  EXPECT_FALSE(run_->advance()) << "it was reported already";

  run_->change(broken());
  EXPECT_EQ(run_->state(), RunState::ready);
  EXPECT_EQ(run_->options().scene, test::heard_options().scene) << "of the session that is there";
  EXPECT_EQ(run_->next().scene, broken().scene);
  ASSERT_TRUE(run_->begin());
  ASSERT_TRUE(comes_to(RunState::failed));
  ASSERT_EQ(ends_.size(), 2u);
  EXPECT_NE(ends_[1].find("/nowhere.glb"), std::string::npos) << ends_[1];
  EXPECT_FALSE(run_->take_scene());

  EXPECT_TRUE(runs(test::heard_options()));
}

TEST_F(RunControls, ASessionThatIsUnderWayEndsBeforeTheNext) {
  ASSERT_TRUE(runs(test::heard_options()));
  run_->change(test::heard_options());
  EXPECT_EQ(run_->state(), RunState::restarting);
  EXPECT_TRUE(stop_) << "it is silent";
  EXPECT_TRUE(run_->restarts());
  EXPECT_TRUE(run_->under_way());
  ASSERT_TRUE(run_->begin());
  EXPECT_EQ(run_->state(), RunState::restarting) << "it is not over";
  run_->change(test::heard_options());
  EXPECT_EQ(run_->state(), RunState::restarting);
  ASSERT_TRUE(comes_to(RunState::ready));
  EXPECT_EQ(ends_.size(), 1u);
  EXPECT_TRUE(run_->session()) << "it is there until the next begins";
  ASSERT_TRUE(run_->begin());
  EXPECT_FALSE(stop_);
  EXPECT_FALSE(run_->scene());
  ASSERT_TRUE(comes_to(RunState::running));
}

TEST_F(RunControls, WhatIsReadyNeedNotBegin) {
  ASSERT_TRUE(runs(test::heard_options()));
  run_->stay();
  EXPECT_EQ(run_->state(), RunState::running);
  run_->change(test::heard_options());
  ASSERT_TRUE(comes_to(RunState::ready));
  run_->stay();
  EXPECT_EQ(run_->state(), RunState::ended);
  EXPECT_FALSE(run_->restarts());
}

TEST_F(RunControls, WhatIsSwitchedOffStaysSoUntilItIsStarted) {
  ASSERT_TRUE(runs(test::heard_options()));
  EXPECT_TRUE(run_->switch_off());
  EXPECT_EQ(run_->state(), RunState::switching_off);
  EXPECT_FALSE(run_->switch_off()) << "it was";
  run_->change(test::heard_options(5));
  EXPECT_EQ(run_->state(), RunState::switching_off) << "other options begin nothing";
  ASSERT_TRUE(comes_to(RunState::switched_off));
  EXPECT_EQ(ends_.size(), 1u);
  run_->change(test::heard_options(7));
  EXPECT_EQ(run_->state(), RunState::switched_off);
  ASSERT_TRUE(run_->begin());
  EXPECT_EQ(run_->state(), RunState::switched_off);
  EXPECT_TRUE(stop_);
  EXPECT_EQ(run_->next().frames, 7u) << "with these it would start";
  EXPECT_FALSE(run_->switch_off());
  run_->start(test::heard_options());
  EXPECT_EQ(run_->state(), RunState::ready);
  EXPECT_TRUE(run_->switch_off()) << "it is never too late";
  EXPECT_EQ(run_->state(), RunState::switched_off);
  EXPECT_TRUE(runs(test::heard_options()));
}

TEST_F(RunControls, StartedWhileItIsBeingSwitchedOffItRestarts) {
  ASSERT_TRUE(runs(test::heard_options()));
  EXPECT_TRUE(run_->switch_off());
  run_->start(test::heard_options());
  EXPECT_EQ(run_->state(), RunState::restarting);
  EXPECT_TRUE(run_->switch_off());
  EXPECT_EQ(run_->state(), RunState::switching_off) << "the last word counts";
  run_->start(test::heard_options());
  ASSERT_TRUE(comes_to(RunState::ready));
  ASSERT_TRUE(run_->begin());
  EXPECT_TRUE(comes_to(RunState::running));
}

TEST_F(RunControls, SwitchedOffAfterItsEndItBeginsNothing) {
  run_->start(test::heard_options(3));
  ASSERT_TRUE(run_->begin());
  ASSERT_TRUE(comes_to(RunState::ended));
  EXPECT_TRUE(run_->switch_off());
  EXPECT_EQ(run_->state(), RunState::switched_off);
  run_->change(test::heard_options());
  EXPECT_EQ(run_->state(), RunState::switched_off);
}

TEST_F(RunControls, WhatLoadsCanBeSwitchedOff) {
  run_->start(test::heard_options());
  ASSERT_TRUE(run_->begin());
  EXPECT_TRUE(run_->switch_off());
  ASSERT_TRUE(comes_to(RunState::switched_off));
  EXPECT_FALSE(heard_->sounded());
}

}  // namespace
}  // namespace palpa::viewer
