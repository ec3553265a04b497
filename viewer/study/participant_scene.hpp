// The objects of a study as the participant sees them on the rig's screen: the marker tile, and in the familiarisation
// the shape.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.hpp"
#include "sensing/rig.hpp"
#include "study/plan/plan.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/render/participant.hpp"
#include "viewer/study/views.hpp"

namespace palpa::viewer {

class ParticipantScene {
 public:
  /// The screen is that of the rig; without a rig, that of the paper's. Throws bad_input for a rig without a screen,
  /// and as setup::load_solids does.
  ParticipantScene(const study::StudyPlan& plan, const std::string& rig);

  const Participant& setting() const { return participant_; }
  /// A picture of that size; nullopt if the view shows neither object nor marker. `eye` is used again from call to
  /// call, and must end before the device.
  std::optional<drawing::Pixels> draw(const gpu::Device& device, std::optional<Offscreen>& eye,
                                      const ParticipantView& view, std::uint32_t width, std::uint32_t height) const;

 private:
  Participant participant_;
  std::vector<Picture> pictures_;  ///< of each shape
};

}  // namespace palpa::viewer
