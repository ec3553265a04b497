#include "viewer/study/participant_scene.hpp"

#include <fmt/core.h>

#include <cstddef>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "setup/sessions/load.hpp"
#include "viewer/study/screens.hpp"

namespace palpa::viewer {

namespace {

/// A part of a picture, from its top left corner on.
drawing::Pixels part_of(const drawing::Pixels& whole, std::uint32_t left, std::uint32_t top, const EyeSize& size) {
  drawing::Pixels part{size.width, size.height, {}};
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const std::uint8_t* const row = whole.at(left, top + y);
    part.rgba.insert(part.rgba.end(), row, row + std::size_t{4} * size.width);
  }
  return part;
}

}  // namespace

ParticipantScene::ParticipantScene(const study::StudyPlan& plan, const setup::StudyRunOptions& run) {
  const std::optional<Stereo> stereo =
      run.stereo.empty() ? std::optional(Stereo::none) : value_of(stereo_words, run.stereo);
  if (!stereo)
    throw bad_usage(fmt::format("--stereo: '{}' is not {}", printable(run.stereo, 40), one_of(stereo_words)));
  participant_ =
      participant_before(run.rig, ", on which the participant sees the marker: add one (docs/files.md)", run, *stereo);
  for (const study::PlanShape& shape : plan.shapes)
    show_solids(pictures_.emplace_back(), setup::load_solids(shape.model));
}

std::optional<drawing::Pixels> ParticipantScene::objects(const gpu::Device& device, std::optional<Offscreen>& eye,
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
  const EyeSize size = eye_size(participant_.stereo, width, height);
  if (!eye || eye->width() != size.width || eye->height() != size.height) eye.emplace(device, size.width, size.height);
  return viewer::draw(participant_, extent(picture, Extent::objects, state), width, height, *eye, drawn);
}

drawing::Pixels ParticipantScene::draw(const gpu::Device& device, std::optional<Offscreen>& eye,
                                       const ParticipantView& view, std::uint32_t width, std::uint32_t height) const {
  const std::optional<drawing::Pixels> under = objects(device, eye, view, width, height);
  const EyeSize half = eye_size(participant_.stereo, width, height);
  if (half.width == width && half.height == height) return viewer::draw(view, width, height, under ? &*under : nullptr);
  // Each eye sees one half of the picture, so that both halves have the text.
  std::vector<drawing::Pixels> halves;
  halves.reserve(2);
  for (const std::uint32_t second : {0u, 1u}) {
    std::optional<drawing::Pixels> scene;
    if (under)
      scene = part_of(*under, half.width < width ? second * half.width : 0,
                      half.height < height ? second * half.height : 0, half);
    halves.push_back(viewer::draw(view, half.width, half.height, scene ? &*scene : nullptr));
  }
  return grown_to(combine(halves[0], halves[1], participant_.screen, {}, {}, participant_.stereo), width, height);
}

std::optional<std::size_t> ParticipantScene::button_at(const ParticipantView& view, std::uint32_t width,
                                                       std::uint32_t height, double x, double y) const {
  const EyeSize half = eye_size(participant_.stereo, width, height);
  if (half.width < width && x >= half.width) x -= half.width;
  if (half.height < height && y >= half.height) y -= half.height;
  return viewer::button_at(button_places(view, half.width, half.height), x, y);
}

}  // namespace palpa::viewer
