// The objects of a study as the participant sees them on the rig's screen: the marker tile, and in the familiarisation
// the shape.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/device.hpp"
#include "setup/options/study_options.hpp"
#include "study/plan/plan.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/render/participant.hpp"
#include "viewer/study/views.hpp"

namespace palpa::viewer {

class ParticipantScene {
 public:
  /// The screen is that of the rig; without a rig, that of the paper's. Throws bad_input for a rig without a screen,
  /// bad_usage for an unknown way of stereo, and as setup::load_solids does.
  ParticipantScene(const study::StudyPlan& plan, const setup::StudyRunOptions& run);

  const Participant& setting() const { return participant_; }
  /// The window's whole picture: objects as the rig's screen shows them, text and buttons. `eye` is used again from
  /// call to call, and must end before the device.
  drawing::Pixels draw(const gpu::Device& device, std::optional<Offscreen>& eye, const ParticipantView& view,
                       std::uint32_t width, std::uint32_t height) const;
  /// The button at a place of that picture.
  std::optional<std::size_t> button_at(const ParticipantView& view, std::uint32_t width, std::uint32_t height, double x,
                                       double y) const;

 private:
  std::optional<drawing::Pixels> objects(const gpu::Device& device, std::optional<Offscreen>& eye,
                                         const ParticipantView& view, std::uint32_t width, std::uint32_t height) const;

  Participant participant_;
  std::vector<Picture> pictures_;  ///< of each shape
};

}  // namespace palpa::viewer
