#include "viewer/options/view_line.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "viewer/live/held_finger.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {
namespace {

/// Whether the view itself says it.
bool is_of_view(const line::OptionInfo& option) {
  constexpr std::string_view headings[] = {"Picture", "View", "What the participant sees", "Mouse and keys, panels",
                                           "Without a window"};
  constexpr std::string_view kept[] = {"--skin", "--title", "--inset"};
  if (std::ranges::find(kept, option.name) != std::end(kept)) return false;
  return std::ranges::find(headings, option.heading) != std::end(headings) || option.name == "--slot" ||
         option.name == "--json";
}

std::string point_text(const Vec3& p) {
  return fmt::format("{},{},{}", p.x, p.y, p.z);
}

void add_item(std::string& list, const std::string& item) {
  list += (list.empty() ? "" : ",") + item;
}

void give_layers(line::Given& given, const Layers& layers) {
  std::string shown, hidden, opacities;
  const Layers usual;
  for (const Word<Layer>& entry : layer_words) {
    const LayerState &now = layers[entry.value], &before = usual[entry.value];
    if (now.visible && !before.visible) add_item(shown, entry.word);
    if (!now.visible && before.visible) add_item(hidden, entry.word);
    if (now.visible && now.opacity != before.opacity)
      add_item(opacities, fmt::format("{}={:g}", entry.word, now.opacity));
  }
  if (!shown.empty()) given["--show"] = {shown};
  if (!hidden.empty()) given["--hide"] = {hidden};
  if (!opacities.empty()) given["--opacity"] = {opacities};
}

/// A camera's own view is named, because it is no orbit.
void give_viewpoint(line::Given& given, const ViewerOptions& options, const Viewpoint& viewpoint) {
  if (viewpoint.frustum) {
    given["--view"] = {options.view};
  } else {
    const Basis seen = basis(viewpoint);
    given["--eye"] = {point_text(seen.eye)};
    given["--target"] = {point_text(viewpoint.target)};
  }
  if (viewpoint.orthographic) given["--ortho"] = {};
}

void give_slice(line::Given& given, const SeenView& seen) {
  if (!seen.state.layers.shows(Layer::slice)) return;
  if (seen.plane) given["--slice"] = {std::string(word_of(setup::plane_words, *seen.plane))};
  if (seen.placed) given["--slice-at"] = {point_text(Vec3(seen.state.slice.T_world_slice[3]))};
  given["--slice-size"] = {fmt::format("{}", seen.state.slice.size_m.x)};
}

}  // namespace

std::string picture_command(const ViewerOptions& options, const line::Given& run, const SeenView& seen) {
  line::Given given = options.given;
  if (!run.empty()) {
    for (const line::OptionInfo& info : live_table())
      given.erase(info.name);
    given.insert(run.begin(), run.end());
    HeldFinger::without_hand(given);
  }
  for (const line::OptionInfo& option : viewer_table()) {
    if (is_of_view(option)) given.erase(option.name);
  }
  give_layers(given, seen.state.layers);
  give_viewpoint(given, options, seen.state.viewpoint);
  give_slice(given, seen);
  if (seen.state.layers.shows(Layer::heat) && seen.state.skin_colour != SkinColour::pressure)
    given["--heat"] = {std::string(word_of(skin_colour_words, seen.state.skin_colour))};
  if (seen.state.dark) given["--dark"] = {};
  if (seen.state.explode > 0) given["--explode"] = {fmt::format("{:g}", seen.state.explode)};
  constexpr std::uint64_t most_frames = 300;
  if (!run.empty()) given["--frames"] = {fmt::format("{}", std::clamp<std::uint64_t>(seen.frames, 1, most_frames))};
  if (run.empty() && seen.state.time.slot > 0) given["--slot"] = {fmt::format("{}", seen.state.time.slot)};
  if (seen.ratio != 1) given["--pixel-ratio"] = {fmt::format("{:g}", seen.ratio)};
  given["--size"] = {fmt::format("{}x{}", seen.size.width, seen.size.height)};
  given["--headless"] = {};
  given["--screenshot"] = {"picture.png"};
  return line::command_line("palpa-viewer", viewer_table(), given);
}

}  // namespace palpa::viewer
