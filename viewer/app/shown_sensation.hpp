// A sensation as a picture, slot by slot: where the focus is, and where it was last.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "base/math.hpp"
#include "sensation/played.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

class ShownSensation {
 public:
  /// `name` is a file or one of palpa's own, and the sound of the array has this period. Throws as palpa play.
  ShownSensation(const std::string& name, std::span<const std::string> parameters, double period_s,
                 const Transform& T_world_array);

  double slot_s() const { return slot_s_; }
  /// Shows the slot, and returns its focus in the world. After a stop, or setup::most_offline_slots, it begins again.
  array::SlotFocus show(Picture& picture, std::uint64_t slot);

 private:
  void evaluate(std::uint64_t slot);

  std::string name_;
  sensation::PatternSensation sensation_;
  double slot_s_;
  Transform T_world_array_;
  sensation::State state_ = sensation::State::at(0);
  std::vector<sensation::Point> points_;  ///< of the slots so far
  bool whole_ = false;                    ///< there are no others
};

}  // namespace palpa::viewer
