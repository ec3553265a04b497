#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "acoustics/body_cache.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/output_file.hpp"
#include "setup/body.hpp"
#include "setup/touch_run.hpp"
#include "viewer/film.hpp"
#include "viewer/offscreen.hpp"
#include "viewer/run.hpp"
#include "viewer/sound/heat.hpp"

namespace palpa::viewer {
namespace {

std::string to_json(const Pixels& pixels, std::uint32_t frames, std::optional<double> difference, double frame_ms) {
  JsonWriter json;
  json.begin_object().member("frames", frames).member("width", pixels.width).member("height", pixels.height);
  if (difference) json.member("difference", *difference);
  json.key("timing_ms").begin_object().member("frame", frame_ms).end_object().end_object();
  return json.take();
}

double compare(const ViewerOptions& options, const Pixels& pixels) {
  const Pixels reference = drawing::read_png(options.reference);
  if (reference.width != pixels.width || reference.height != pixels.height) {
    throw bad_input(options.reference,
                    fmt::format("is {}x{} pixels, the picture is {}x{}: give --size {}x{}", reference.width,
                                reference.height, pixels.width, pixels.height, reference.width, reference.height));
  }
  return mean_difference(pixels, reference);
}

}  // namespace

void report_picture(const ViewerOptions& options, const Outputs& outputs, const Pixels& pixels, std::uint32_t frames,
                    double frame_ms) {
  if (!options.screenshot.empty()) write_png(options.screenshot, pixels);
  std::optional<double> difference;
  if (!options.reference.empty()) difference = compare(options, pixels);
  if (!options.common.json.empty()) write_file(options.common.json, to_json(pixels, frames, difference, frame_ms));
  const double threshold = options.threshold.value_or(0.02);
  if (difference && *difference > threshold) {
    throw failure(fmt::format("the picture differs from {} by {:.4f} on average, more than {}", options.reference,
                              *difference, threshold));
  }
  if (setup::shows_summary(options.common, outputs)) {
    write_file(
        "-", fmt::format("{} frame{} of {}x{} pixels, {:.1f} ms each{}{}{}\n", frames, frames == 1 ? "" : "s",
                         pixels.width, pixels.height, frame_ms, options.video.empty() ? "" : "; in " + options.video,
                         options.screenshot.empty() ? "" : "; the last one is " + options.screenshot,
                         difference ? fmt::format("; differs from {} by {:.4f}", options.reference, *difference) : ""));
  }
}

void run_headless(const ViewerOptions& options) {
  const Outputs outputs({{"--json", options.common.json},
                         {"--screenshot", options.screenshot},
                         {"--video", options.video, Output::Kind::folder}});
  refuse_output_as_input(std::filesystem::path(options.reference));
  std::optional<Participant> participant;
  if (options.participant) participant = participant_of(options);
  Show show(options);
  const gpu::Device device(setup::device_options(options.common));
  const Size size = picture_size(options);
  const double ratio = options.pixel_ratio.value_or(1);
  const EyeSize eye = eye_size(options.stereo, size.width, size.height);
  Offscreen offscreen(device, eye.width, eye.height, ratio);
  DrawnPicture drawn(device);
  ViewState state = first_state(options);
  if (participant) state = for_participant(state);
  place_slice(state, options, show.picture());
  if (state.layers.shows(Layer::heat)) {
    const Sounding now = show.sounding();
    const geometry::Mesh mesh = setup::load_body(options.skin, now.air, false);
    const session::SkinQuestion question = skin_question(options.skin, mesh, now);
    acoustics::BodyCache bodies;
    show_answer(show.picture(), question, session::answer(question, bodies));
  }
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
    if (participant) return draw(*participant, objects, offscreen, drawn);
    offscreen.draw(drawn, views);
    return offscreen.pixels();
  };

  const std::uint32_t frames = options.frames.value_or(1);
  std::vector<double> times;
  Pixels pixels;
  setup::Stopwatch watch;
  for (std::uint32_t i = 0; i < frames; ++i) {
    if (i > 0 && show.changes()) {
      show.go_to(options.slot + i);
      if (field) show.show_field(*field, state.slice);
      drawn.update_marks(show.picture(), state);
    }
    pixels = draw_frame();
    times.push_back(watch.lap_ms());
    if (!film.wanted()) continue;
    film.add(pixels);
    watch.lap_ms();  // files are no part of a frame
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  const double frame_ms = times[times.size() / 2];

  report_picture(options, outputs, pixels, frames, frame_ms);
}

}  // namespace palpa::viewer
