#include "viewer/study/participant_scene.hpp"

#include "base/error.hpp"
#include "setup/assets.hpp"
#include "setup/load.hpp"

namespace palpa::viewer {

ParticipantScene::ParticipantScene(const study::StudyPlan& plan, const std::string& rig) {
  const std::string file = rig.empty() ? setup::find_asset("rigs/paper.toml") : rig;
  const sensing::Rig own = sensing::load_rig(file);
  if (!own.screen)
    throw bad_input(file, "has no [screen], on which the participant sees the marker: add one (docs/files.md)");
  participant_.screen = *own.screen;
  for (const study::PlanShape& shape : plan.shapes)
    show_solids(pictures_.emplace_back(), setup::load_solids(shape.model));
}

std::optional<drawing::Pixels> ParticipantScene::draw(const gpu::Device& device, std::optional<Offscreen>& eye,
                                                      const ParticipantView& view, std::uint32_t width,
                                                      std::uint32_t height) const {
  if (!view.marker && !view.object) return std::nullopt;
  ViewState state;
  state.dark = true;
  state = for_participant(state);
  if (!view.object) state.layers.hide({Layer::solids, Layer::edges});
  const Picture& picture = pictures_[view.shape];
  DrawnPicture drawn(device);
  drawn.update(picture, state);
  if (!eye || eye->width() != width || eye->height() != height) eye.emplace(device, width, height);
  return viewer::draw(participant_, extent(picture, Extent::objects, state), width, height, *eye, drawn);
}

}  // namespace palpa::viewer
