#include "viewer/live/run_control.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "setup/process/interrupt.hpp"

namespace palpa::viewer {

RunControl::RunControl(LiveSession::Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake)
    : kinds_(std::move(kinds)), stop_(&stop), wake_(std::move(wake)) {
  if (!wake_) wake_ = [] {};
}

bool RunControl::under_way() const {
  return state_ == RunState::loading || state_ == RunState::running || state_ == RunState::restarting ||
         state_ == RunState::switching_off;
}

void RunControl::change(setup::LiveOptions options) {
  next_ = std::move(options);
  switch (state_) {
    case RunState::loading:
    case RunState::running:
      session_->all_off();
      state_ = RunState::restarting;
      break;
    case RunState::none:
    case RunState::ended:
    case RunState::failed:
      state_ = RunState::ready;
      break;
    default:
      break;
  }
}

void RunControl::start(setup::LiveOptions options) {
  change(std::move(options));
  if (state_ == RunState::switching_off) state_ = RunState::restarting;
  if (state_ == RunState::switched_off) state_ = RunState::ready;
}

void RunControl::set_ceiling(double ceiling) {
  options_.safety.ceiling = next_.safety.ceiling = ceiling;
  if (session_) session_->set_ceiling(ceiling);
}

bool RunControl::switch_off() {
  if (!session_) return false;
  session_->all_off();
  switch (state_) {
    case RunState::loading:
    case RunState::running:
    case RunState::restarting:
      state_ = RunState::switching_off;
      return true;
    case RunState::ended:
    case RunState::failed:
    case RunState::ready:
      state_ = RunState::switched_off;
      return true;
    default:
      return false;
  }
}

std::optional<std::string> RunControl::advance() {
  if (!under_way()) return std::nullopt;
  if (!session_->over()) {
    if (state_ == RunState::loading && session_->state() == LiveState::running) state_ = RunState::running;
    return std::nullopt;
  }
  if (state_ == RunState::restarting) {
    state_ = RunState::ready;
  } else if (state_ == RunState::switching_off) {
    state_ = RunState::switched_off;
  } else {
    state_ = session_->state() == LiveState::failed ? RunState::failed : RunState::ended;
  }
  return session_->fault();
}

std::optional<std::vector<std::string>> RunControl::begin() {
  if (state_ != RunState::ready) return std::vector<std::string>();
  if (loud_ && session_ && session_->scene()) told_loud_.insert(options_.link);  // it came far enough to say so
  session_.reset();
  scene_.reset();
  *stop_ = false;
  if (setup::Interrupt::signalled()) {  // checked after clearing the flag: it may have come just before
    *stop_ = true;
    state_ = RunState::none;
    return std::nullopt;
  }
  options_ = next_;
  setup::LiveOptions options = next_;
  loud_ = setup::is_loud_by_default(options);
  options.ceiling_known |= told_loud_.contains(options.link);
  std::vector<std::string> lines = outputs_.name(options, setup::with_builtin(kinds_.links));
  starter_.run([&] { session_ = std::make_unique<LiveSession>(std::move(options), kinds_, *stop_, wake_); });
  state_ = RunState::loading;
  return lines;
}

void RunControl::stay() {
  if (state_ == RunState::ready) state_ = RunState::ended;
}

bool RunControl::take_scene() {
  if (scene_ || !session_) return false;
  scene_ = session_->scene();
  return scene_ != nullptr;
}

bool RunControl::finish(double patience_s) {
  constexpr double while_loading_s = 0.3;  // loading does not look at the flag
  if (!session_) return true;
  session_->all_off();
  const auto begin = std::chrono::steady_clock::now();
  while (!session_->over()) {
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    if (waited.count() > (loading() ? while_loading_s : patience_s)) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace palpa::viewer
