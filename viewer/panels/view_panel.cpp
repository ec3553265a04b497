// What is drawn, and from where.
#include <imgui.h>

#include <algorithm>
#include <string>
#include <utility>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

const char* about(Layer layer) {
  switch (layer) {
    case Layer::solids:
      return "The objects' surfaces";
    case Layer::edges:
      return "Outlines and sharp edges of the objects";
    case Layer::skin:
      return "The surface of the finger or hand, if there is a mesh of it";
    case Layer::points:
      return "Skin points near the objects: where cameras or a file have skin";
    case Layer::contacts:
      return "Skin points in the shell under an object's surface, in the colour of their finger";
    case Layer::sections:
      return "Cross-sections: the plane of a finger's contacts and its principal axes. w1 is the longer axis in the "
             "plane, w2 the shorter, w3 stands on the plane";
    case Layer::foci:
      return "Where the sound converges, numbered in the order in which they play";
    case Layer::transducers:
      return "The array's transducers. Hue is the phase of the drive, brightness its amplitude";
    case Layer::cameras:
      return "Where the cameras stand and what they see";
    case Layer::depth:
      return "The cameras' depth images, at the ends of what they see. Nearer is lighter";
    case Layer::slice:
      return "The sound pressure of the slot that is shown, in a plane";
    case Layer::heat:
      return "What the finger gets from the whole schedule, on its mesh: the mean radiation pressure, or the rates of "
             "its afferents";
    case Layer::tile:
      return "The marker on top of the highest object, 10 mm wide: where a participant puts the finger";
    case Layer::grid:
      return "A grid of 10 mm on the ground";
    case Layer::legend:
      return "Names and counts, the axes of the world, the scale, and what colours mean";
  }
  return "";
}

/// The layer's name in the panel.
const char* name_of(Layer layer) {
  switch (layer) {
    case Layer::sections:
      return "cross-sections";
    case Layer::skin:
      return "finger";
    case Layer::points:
      return "skin points";
    case Layer::depth:
      return "depth images";
    case Layer::slice:
      return "field in a plane";
    case Layer::heat:
      return "on the finger";
    case Layer::tile:
      return "marker tile";
    default:
      return word_of(layer_words, layer).data();
  }
}

void draw_standpoints(PanelData& data) {
  for (const auto& [name, view] : {std::pair("front", StandardView::front), std::pair("right", StandardView::right),
                                   std::pair("top", StandardView::top), std::pair("corner", StandardView::iso)}) {
    if (ImGui::Button(name)) data.asked.view = view;
    tip("Keys: 1 front, 3 right, 7 top, 9 corner; with Ctrl from the other side");
    ImGui::SameLine();
  }
  ImGui::NewLine();
  if (ImGui::Button("frame all")) data.asked.frame = true;
  tip("Fits everything into the picture. Key: F");
  ImGui::SameLine();
  ImGui::BeginDisabled(data.picture->fingers.empty());
  if (ImGui::Button("frame touch")) data.asked.frame_touch = true;
  data.places.named["frame touch"] = last_area();
  ImGui::EndDisabled();
  tip("Comes close to where fingers touch. Key: T");
  ImGui::Checkbox("parallel", &data.state.viewpoint.orthographic);
  tip("Parallel projection in place of perspective. Key: 5");
  ImGui::SameLine();
  ImGui::Checkbox("dark", &data.state.dark);
  data.places.named["dark"] = last_area();
  tip("Dark background");
}

}  // namespace

void draw_view_panel(PanelData& data) {
  draw_standpoints(data);
  ImGui::SetNextItemWidth(em(7));
  drop_down("fine pictures", std::string(word_of(fine_words, data.state.fine)), [&] {
    for (const Word<FinePictures>& entry : fine_words) {
      if (ImGui::Selectable(entry.word, entry.value == data.state.fine)) data.state.fine = entry.value;
    }
  });
  tip("Four samples for each pixel. auto: if drawing is slow, one sample while the picture moves, and four when it "
      "rests");
  auto explode = static_cast<float>(data.state.explode) * 100;
  ImGui::SetNextItemWidth(em(7));
  if (ImGui::SliderFloat("parts apart", &explode, 0, 100, "%.0f %%", ImGuiSliderFlags_NoInput))
    data.state.explode = std::clamp(explode / 100, 0.0f, 1.0f);
  tip("How far convex parts are drawn apart, as a share of their solid's size");
  if (!ImGui::BeginTable("layers", 2, ImGuiTableFlags_SizingStretchSame)) return;
  for (const Word<Layer>& entry : layer_words) {
    LayerState& layer = data.state.layers[entry.value];
    ImGui::TableNextColumn();
    ImGui::PushID(entry.word);
    ImGui::Checkbox(name_of(entry.value), &layer.visible);
    data.places.named[entry.word] = last_area();
    tip(std::string(about(entry.value)) + ". In --show and --hide: " + entry.word);
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1);
    float percent = layer.opacity * 100;
    if (ImGui::SliderFloat("##opacity", &percent, 0, 100, "%.0f %%", ImGuiSliderFlags_NoInput))
      layer.opacity = std::clamp(percent / 100, 0.0f, 1.0f);
    tip("How opaque the layer is, relative to its usual look");
    ImGui::PopID();
  }
  ImGui::EndTable();
}

}  // namespace palpa::viewer
