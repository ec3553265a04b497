#include "hand_chain.hpp"

#include <cmath>

namespace palpa::test {
namespace {

session::SessionSetting setting_of(const RatedHand& hand) {
  session::SessionSetting setting{.solids = hand.solids, .cameras = hand.cameras, .frame_by_frame = true};
  if (hand.predict_s) setting.predict = {session::Predict::automatic, hand.predict_s};
  return setting;
}

touch::StageSetting stage_of(const session::SessionSetting& setting, const touch::HysteresisRules& rules) {
  touch::StageSetting stage = session::stage_setting(setting);
  stage.rules = rules;
  if (rules == touch::no_rules) stage.hysteresis = touch::Hysteresis::off;
  return stage;
}

}  // namespace

HandChain::HandChain(const RatedHand& hand, const touch::HysteresisRules& rules)
    : setting_(setting_of(hand)),
      scheduler_(setting_.scene, setting_.solids, setting_.touch, setting_.schedule),
      stage_(setting_.solids, setting_.cameras, stage_of(setting_, rules)),
      tracker_(setting_.solids, *setting_.events, setting_.hold_s) {
  if (!hand.predict_s) return;
  const session::PredictorSetting predictor = session::predictor_setting(
      setting_, scheduler_, {stage_.cameras(), stage_.rays(), &stage_.setting().surroundings}, stage_.solids());
  cycle_ = predictor.cycle;
  predictor_.emplace(predictor);
  kept_ = predictor_->make_kept();
}

void HandChain::see(std::span<const sensing::DepthFrame> images, double time_s) {
  stage_.start(images, time_s);
  if (predictor_) predictor_->keep(images, kept_);
  stage_.finish(touch_);
  const double slot_s = scheduler_.slot_s();
  const std::optional<session::FirstSlot> first =
      session::FirstSlot{static_cast<std::uint64_t>(std::ceil(time_s / slot_s - 1e-6)), {}};
  const touch::Touch& ahead = predictor_ ? predictor_->see(touch_, time_s, first, kept_) : touch_;
  scheduler_.make(ahead, time_s, schedule_);
  if (predictor_) {
    predictor_->advance(schedule_);
    ahead_s_ = session::ahead_of(first, *setting_.predict.latency_s, cycle_, slot_s).foci_s;
  }
  events_ = tracker_.update(touch_, time_s);
}

}  // namespace palpa::test
