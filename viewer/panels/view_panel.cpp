// What is drawn, and from where.
#include <imgui.h>

#include <string>
#include <utility>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

struct LayerRow {
  Layer layer;
  const char* name;  ///< in the panel
  const char* about;
};
constexpr LayerRow layer_rows[] = {
    {Layer::solids, "solids", "The objects' surfaces"},
    {Layer::edges, "edges", "Outlines and sharp edges of the objects"},
    {Layer::skin, "finger", "The surface of the finger or hand, if there is a mesh of it"},
    {Layer::points, "skin points", "Skin points near the objects: where cameras or a file have skin"},
    {Layer::contacts, "contacts", "Skin points in the shell under an object's surface, in the colour of their finger"},
    {Layer::sections, "cross-sections",
     "Cross-sections: the plane of a finger's contacts and its principal axes. w1 is the longer axis in the plane, w2 "
     "the shorter, w3 stands on the plane"},
    {Layer::foci, "foci", "Where the sound converges, numbered in the order in which they play"},
    {Layer::transducers, "array", "The array's transducers. Hue is the phase of the drive, brightness its amplitude"},
    {Layer::cameras, "cameras", "Where the cameras stand and what they see"},
    {Layer::depth, "depth images", "The cameras' depth images, at the ends of what they see. Nearer is lighter"},
    {Layer::slice, "field in a plane", "The sound pressure of the slot that is shown, in a plane"},
    {Layer::heat, "on the finger",
     "What the finger gets from the whole schedule, on its mesh: the mean radiation pressure, or the rates of its "
     "afferents"},
    {Layer::tile, "marker tile",
     "The marker on top of the highest object, 10 mm wide: where a participant puts the finger"},
    {Layer::grid, "grid", "A grid of 10 mm on the ground"},
    {Layer::legend, "legend", "Names and counts, the axes of the world, the scale, and what colours mean"},
};

void draw_standpoints(PanelData& data) {
  for (const auto& [name, view] : {std::pair("front", StandardView::front), std::pair("right", StandardView::right),
                                   std::pair("top", StandardView::top), std::pair("corner", StandardView::iso)}) {
    if (button(data, name, "Keys: 1 front, 3 right, 7 top, 9 corner; with Ctrl from the other side"))
      data.asked.view = view;
    ImGui::SameLine();
  }
  ImGui::NewLine();
  if (button(data, "frame all", "Fits everything into the picture. Key: F")) data.asked.frame = true;
  ImGui::SameLine();
  if (button(data, "frame touch", "Comes close to where fingers touch. Key: T", !data.picture->fingers.empty()))
    data.asked.frame_touch = true;
  check_box(data, "parallel", data.state.viewpoint.orthographic, "Parallel projection in place of perspective. Key: 5");
  ImGui::SameLine();
  check_box(data, "dark", data.state.dark, "Dark background");
}

}  // namespace

void draw_view_panel(PanelData& data) {
  draw_standpoints(data);
  ImGui::SetNextItemWidth(em(7));
  drop_down(data, "fine pictures", "fine pictures", fine_words, data.state.fine);
  tip("Four samples for each pixel. auto: if drawing is slow, one sample while the picture moves, and four when it "
      "rests");
  ImGui::SetNextItemWidth(em(7));
  slider(data, "parts apart", "parts apart", data.state.explode, 100, 0, 100, "%.0f %%");
  tip("How far convex parts are drawn apart, as a share of their solid's size");
  if (!ImGui::BeginTable("layers", 2, ImGuiTableFlags_SizingStretchSame)) return;
  for (const LayerRow& row : layer_rows) {
    const std::string word(word_of(layer_words, row.layer));
    LayerState& layer = data.state.layers[row.layer];
    ImGui::TableNextColumn();
    ImGui::PushID(word.c_str());
    check_box(data, row.name, layer.visible, std::string(row.about) + ". In --show and --hide: " + word, word);
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1);
    slider(data, "opacity " + word, "##opacity", layer.opacity, 100, 0, 100, "%.0f %%");
    tip("How opaque the layer is, relative to its usual look");
    ImGui::PopID();
  }
  ImGui::EndTable();
}

}  // namespace palpa::viewer
