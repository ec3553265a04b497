// Whether depth frames still show the hand whose fingers have gone. A finger that lifts is seen beside the solid, or
// its hand is; after a press, this tells it from a hand that the cameras have lost (touches.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "sensing/rays.hpp"
#include "sensing/skin_twin.hpp"
#include "sensing/surroundings.hpp"
#include "touch/types.hpp"

namespace palpa::session {

class HandWatch {
 public:
  /// The arguments must outlive it. Skin outside the room counts, too: a finger may leave it as it lifts.
  HandWatch(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables,
            const std::vector<sensing::Slab>& slabs);

  /// For the next frame: 0 if it has no finger, the last fingers went within lost_press_s, and nothing is seen within
  /// near_m of them; otherwise 1. Other things that stand there count as a hand unless the rig knows them, by a
  /// background or as a slab. Allocates nothing.
  std::uint32_t hands_in(std::span<const sensing::DepthFrame> images, const touch::Touch& touch, double time_s);

  static constexpr double near_m = 0.1;

 private:
  std::span<const sensing::Camera> cameras_;
  const sensing::RayTables& tables_;
  sensing::Surroundings surroundings_;
  double last_s_ = -1e300;  ///< when there were fingers, and where
  Box box_;
  // Scratch that keeps its storage.
  std::vector<sensing::Crop> crops_;
  std::vector<shader::SkinVolume> volumes_;
  sensing::SkinOfFrame skin_;
};

}  // namespace palpa::session
