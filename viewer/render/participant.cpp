#include "viewer/render/participant.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.hpp"
#include "drawing/canvas.hpp"
#include "drawing/ink.hpp"
#include "sensing/rig.hpp"
#include "setup/files/assets.hpp"

namespace palpa::viewer {

Participant participant_before(const std::string& rig, const std::string& advice, const setup::EyesOptions& eyes,
                               Stereo stereo) {
  const std::string file = rig.empty() ? setup::find_asset("rigs/paper.toml") : rig;
  const sensing::Rig read = sensing::load_rig(file);
  if (!read.screen) throw bad_input(file, "has no [screen]" + advice);
  return {.screen = *read.screen,
          .eyes_apart_m = eyes.eyes_apart_m,
          .stereo = stereo,
          .barrier_pitch_m = eyes.barrier_pitch_m,
          .barrier_gap_m = eyes.barrier_gap_m,
          .barrier_phase = eyes.barrier_phase};
}

std::string stretched(const sensing::Screen& screen, std::uint32_t width, std::uint32_t height) {
  constexpr double tolerance = 0.02;
  const double factor = screen.width_m / screen.height_m / (static_cast<double>(width) / height);
  if (std::abs(factor - 1) <= tolerance) return {};
  return fmt::format(
      "the participant's picture of {}x{} pixels is stretched {:.2f} times in width, because the rig's screen is {:g} "
      "x "
      "{:g} mm: objects do not appear where they are felt",
      width, height, factor, screen.width_m * 1e3, screen.height_m * 1e3);
}

void write_line(drawing::Pixels& picture, std::string_view text, double ratio) {
  const auto rows = std::min(static_cast<std::uint32_t>(std::lround(28 * ratio)), picture.height);
  const drawing::Colour paper = drawing::rgb(0x1c2127);
  std::vector<shader::ViewStroke> strokes;
  drawing::Ink(ratio, paper, strokes)
      .text(text, {picture.width / 2.0, 19 * ratio}, drawing::text_size, drawing::rgb(0xffffff),
            drawing::Align::centre);
  drawing::Canvas line(picture.width, rows, paper);
  line.draw(strokes);
  const auto& written = line.pixels().rgba;
  std::copy(written.begin(), written.end(), picture.rgba.begin());
}

Barrier barrier_of(const Participant& p, std::uint32_t width, std::uint32_t height) {
  Barrier barrier = default_barrier(p.screen, eyes_before(p.screen, p.eyes_apart_m), p.stereo, width, height);
  barrier.pitch_m = p.barrier_pitch_m.value_or(barrier.pitch_m);
  barrier.gap_m = p.barrier_gap_m.value_or(barrier.gap_m);
  barrier.phase = p.barrier_phase;
  return barrier;
}

ViewState for_participant(const ViewState& state) {
  ViewState out = state;
  for (const Word<Layer>& entry : layer_words) {
    const bool kept = entry.value == Layer::solids || entry.value == Layer::edges;
    LayerState& layer = out.layers[entry.value];
    layer.visible = entry.value == Layer::tile || (kept && layer.visible);
  }
  out.picked.reset();
  return out;
}

Viewpoint eye_view(const sensing::Screen& screen, const Vec3& eye, const Box& objects) {
  Viewpoint viewpoint;
  look(viewpoint, onto(screen, eye), objects.empty() ? Vec3(screen.T_world_screen[3]) : objects.centre());
  return viewpoint;
}

drawing::Pixels draw(const Participant& participant, const Box& objects, std::uint32_t width, std::uint32_t height,
                     Offscreen& offscreen, DrawnPicture& drawn) {
  const auto seen_by = [&](const Vec3& eye) {
    offscreen.draw(drawn, eye_view(participant.screen, eye, objects));
    return offscreen.pixels();
  };
  if (participant.stereo == Stereo::none) return seen_by(participant.screen.eye_m);
  const Eyes eyes = eyes_before(participant.screen, participant.eyes_apart_m);
  const drawing::Pixels left = seen_by(eyes.left);
  // If pixels are interleaved, an eye's picture is as large as the whole.
  const Barrier barrier = barrier_of(participant, offscreen.width(), offscreen.height());
  return grown_to(combine(left, seen_by(eyes.right), participant.screen, eyes, barrier, participant.stereo), width,
                  height);
}

}  // namespace palpa::viewer
