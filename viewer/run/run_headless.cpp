#include <optional>
#include <string>

#include "acoustics/bodies/body_cache.hpp"
#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "experiment/skin_rates.hpp"
#include "setup/files/body.hpp"
#include "setup/sessions/touch_run.hpp"
#include "viewer/app/shown_touch.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/run/film.hpp"
#include "viewer/run/report.hpp"
#include "viewer/run/run.hpp"
#include "viewer/run/viewer_files.hpp"
#include "viewer/sound/heat.hpp"

namespace palpa::viewer {
namespace {

void warn_if_stretched(const Participant& participant, const Size& size) {
  const std::string line = stretched(participant.screen, size.width, size.height);
  if (!line.empty()) log::warning(line);
}

/// Colours the skin by the pressure on it, or by the rates of afferents.
void colour_skin(ShownTouch& show, const std::string& skin, SkinColour colour) {
  const Sounding now = show.sounding();
  const geometry::Mesh mesh = setup::load_body(skin, now.air, false);
  session::SkinQuestion question = skin_question(skin, mesh, now);
  question.afferents = colour != SkinColour::pressure;
  acoustics::BodyCache bodies;
  show_answer(show.picture(), question, experiment::SkinRates().answer(question, bodies), colour);
}

}  // namespace

void run_headless(const ViewerOptions& options) {
  const Outputs outputs(outputs_of(options, Script(options), {}));
  refuse_outputs_as_inputs(options);
  std::optional<Participant> participant;
  if (options.participant) participant = participant_of(options);
  const Size size = picture_size(options);
  if (participant) warn_if_stretched(*participant, size);
  ShownTouch show(options);
  setup::ComputeOptions drawing = options.common;
  drawing.backend = setup::Backend::gpu;  // it draws there, whatever computes the touch
  const setup::UsedDevice used(drawing);
  const gpu::Device& device = *used.get();
  const double ratio = options.pixel_ratio.value_or(1);
  const EyeSize eye = eye_size(options.stereo, size.width, size.height);
  Offscreen offscreen(device, eye.width, eye.height, ratio, fineness_without_window(options));
  DrawnPicture drawn(device);
  ViewState state = first_state(options);
  if (participant) state = for_participant(state);
  place_slice(state, options.slice, show.picture());
  if (state.layers.shows(Layer::heat)) colour_skin(show, options.skin, state.skin_colour);
  std::optional<FieldSlice> field;
  if (state.layers.shows(Layer::slice)) {
    field.emplace(device, show.layout(), setup::air(options.drive.medium, {}), options.drive.directivity);
    show.show_field(*field, state.slice);
  }
  drawn.update(show.picture(), state);
  const Viewpoint viewpoint = first_viewpoint(options, show.picture(), state, size);
  Film film(options.video);
  const auto views = views_from(viewpoint, options, show.picture(), size, ratio);
  const Box objects = extent(show.picture(), Extent::objects, state);
  const auto draw_frame = [&] {
    if (participant) return draw(*participant, objects, size.width, size.height, offscreen, drawn);
    offscreen.draw(drawn, views);
    return offscreen.pixels();
  };

  const std::uint32_t frames = options.frames.value_or(1);
  PicturesDrawn made;
  Pixels pixels;
  setup::Stopwatch watch;
  for (std::uint32_t i = 0; i < frames; ++i) {
    if (i > 0 && show.picture().changes()) {
      show.go_to(options.slot + i);
      if (field) show.show_field(*field, state.slice);
      drawn.update_marks(show.picture(), state);
    }
    pixels = draw_frame();
    made.ms.add(watch.lap_ms());
    if (!film.wanted()) continue;
    film.add(pixels);
    watch.lap_ms();  // writing files does not count as part of a frame
  }
  made.size = {pixels.width, pixels.height};
  report_picture(options, outputs, pixels, made);
}

}  // namespace palpa::viewer
