// How deep fingers are, moving things by hand, and marks that lie flat on the picture.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <string>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

ImU32 colour_of(const drawing::Colour& colour) {
  return to_pixel(colour);  // red in the lowest byte, as in ImGui
}

ImVec2 place(const Vec2& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y)};
}

void draw_label(ImDrawList& list, const FlatMark& mark) {
  const ImVec2 size = ImGui::CalcTextSize(mark.label.c_str()), at = place(mark.points.front());
  const ImVec2 from(at.x - size.x / 2, at.y - size.y / 2);
  const float room = 0.25f * ImGui::GetFontSize();
  list.AddRectFilled({from.x - room, from.y - room * 0.5f}, {from.x + size.x + room, from.y + size.y + room * 0.5f},
                     ImGui::GetColorU32(ImGuiCol_WindowBg, 0.85f), room);
  list.AddText(from, mark.colour.a > 0 ? colour_of(mark.colour) : ImGui::GetColorU32(ImGuiCol_Text),
               mark.label.c_str());
}

}  // namespace

void draw_marks(const std::vector<FlatMark>& marks) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float point = ImGui::GetFontSize() / static_cast<float>(text_height);
  for (const FlatMark& mark : marks) {
    if (!mark.label.empty()) {
      draw_label(list, mark);
      continue;
    }
    for (const Vec2& p : mark.points)
      list.PathLineTo(place(p));
    mark.filled ? list.PathFillConvex(colour_of(mark.colour))
                : list.PathStroke(colour_of(mark.colour), 0, static_cast<float>(mark.width) * point);
  }
}

void draw_place_panel(Desk& desk) {
  Desk::Placed& placed = desk.placed;
  for (const Depth& depth : desk.depths) {
    ImGui::Text("%s  %.2f mm deep", depth.solid.c_str(), depth.depth_m * 1e3);
    tip("Depth below the solid's surface of a finger's deepest skin point that a camera sees");
  }
  if (desk.depths.empty()) ImGui::TextDisabled("nothing touches");
  if (placed.tip) {
    ImGui::Text("tip  %.1f  %.1f  %.1f mm", placed.tip->x * 1e3, placed.tip->y * 1e3, placed.tip->z * 1e3);
    tip("Where the held finger's tip is in the world");
    ImGui::Checkbox("follows the pointer", &placed.follows);
    tip("The finger goes where the pointer goes, the wheel takes it deeper into the picture, a right drag turns it. "
        "Key: M");
  }
  const char* none = "none";
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.6f);
  if (ImGui::BeginCombo("handles", placed.chosen ? placed.things[*placed.chosen].c_str() : none)) {
    if (ImGui::Selectable(none, !placed.chosen)) placed.chosen.reset();
    for (std::size_t i = 0; i < placed.things.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable(placed.things[i].c_str(), placed.chosen == i)) placed.chosen = i;
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  tip("What is moved and turned by handles in the picture; with Ctrl in steps of 1 mm and 5 degrees. Key: G");
  if (ImGui::SmallButton("undo")) placed.undo = true;
  tip("Undoes the last move. Key: Ctrl Z");
  ImGui::SameLine();
  ImGui::BeginDisabled(!placed.moved);
  if (ImGui::SmallButton("as in the scene")) placed.restore = true;
  tip("Puts all solids back where their file has them");
  ImGui::SameLine();
  if (ImGui::SmallButton("save as")) placed.save = !placed.file.empty();
  tip("Writes the solids as they are now and runs with that file, so the command line includes the moves");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText("##file", &placed.file);
  if (ImGui::IsItemVisible()) desk.places.texts.push_back(last_area());
  tip("A .glb file; an existing one is replaced");
  ImGui::EndDisabled();
}

}  // namespace palpa::viewer
