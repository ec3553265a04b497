#include "session/chain.hpp"

namespace palpa::session {

Box touchable_box(const std::vector<geometry::Solid>& solids) {
  constexpr double hair = 1e-4;
  Box box;
  for (const geometry::Solid& solid : solids) {
    box.add(solid.bounds.low - Vec3(hair));
    box.add(solid.bounds.high + Vec3(hair));
  }
  return box;
}

void make_schedule(const touch::Touch& touch, double time_s, const ChainSetting& setting, array::Schedule& schedule) {
  schedule.clear();
  schedule.slot_s = setting.slot_s;
  schedule.time_s = time_s;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    array::make_voice(touch.fingers[f], f, setting.voice, schedule.add_voice());
  }
}

}  // namespace palpa::session
