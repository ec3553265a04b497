#include "session/control/live_values.hpp"

#include <algorithm>

namespace palpa::session {

std::string_view LiveValues::change(std::string_view solid, const SolidValues& values) {
  const FeelChange& feel = values.feel;
  {
    const std::lock_guard lock(mutex_);
    const auto is_it = [&](const Known& known) { return known.solid == solid; };
    if (std::ranges::none_of(known_, is_it)) return "the scene has no object of that name";
    const auto may_press = [&](const Known& known) { return is_it(known) && known.may_press; };
    if (feel.click && feel.click->burst_s > 0 && std::ranges::none_of(known_, may_press))
      return "the object has no palpa_press_depth_m, at which it would click";
    const bool vibrates = feel.texture && feel.texture->low + feel.texture->high > 0;
    const bool clicks = feel.click && feel.click->burst_s > 0;
    if (pace_.steady && (vibrates || clicks))
      return "the link cannot change in every slot, so it plays no clicks and no textures";
    if ((clicks && !carries(pace_, feel.click->hz)) || (vibrates && !carries(pace_, fastest_hz(*feel.texture))))
      return "drives are too long for its vibrations, so they are not played: give a shorter dwell";
  }
  Named& named = values_of(solid);
  if (values.T_world_rest) {
    named.values.T_world_rest = values.T_world_rest;
    named.moved = ++changes_;
  }
  if (feel.click) named.values.feel.click = feel.click;
  if (feel.stiffness) named.values.feel.stiffness = feel.stiffness;
  if (feel.texture) named.values.feel.texture = feel.texture;
  if (feel.any()) named.felt = ++changes_;
  newest_.back() = values_;
  newest_.publish();
  return {};
}

LiveValues::Named& LiveValues::values_of(std::string_view solid) {
  const auto found = std::ranges::find(values_, solid, &Named::solid);
  return found != values_.end() ? *found : values_.emplace_back(Named{.solid = std::string(solid), .values = {}});
}

void LiveValues::set_scene(const Session& session) {
  const std::lock_guard lock(mutex_);  // nobody holds it for longer than a search by name
  known_.clear();
  pace_ = {session.scheduler().slot_s(), session.setting().schedule.steady};
  for (const geometry::Solid& solid : session.solids())
    known_.push_back({solid.name, solid.haptics.press_depth_m.has_value()});
  again_ = true;
}

void LiveValues::apply(Session& session, RunObserver& observer) {
  if (!newest_.take() && !again_) return;
  const std::uint64_t had = again_ ? 0 : applied_;
  again_ = false;
  for (const Named& named : newest_.front()) {
    applied_ = std::max({applied_, named.moved, named.felt});
    if (named.moved <= had && named.felt <= had) continue;
    for (std::uint32_t i = 0; i < session.solid_names().size(); ++i) {
      if (session.solid_names()[i] != named.solid) continue;
      if (named.moved > had) {
        session.set_pose(i, *named.values.T_world_rest);
        observer.moved(i, *named.values.T_world_rest);
      }
      if (named.felt > had) session.change_feel(i, named.values.feel);
    }
  }
}

}  // namespace palpa::session
