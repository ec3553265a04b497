// How deep fingers are, moving things by hand, and marks that lie flat on the picture.
#include <imgui.h>

#include <algorithm>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"
#include "viewer/panels/widgets.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

ImU32 colour_of(const drawing::Colour& colour) {
  return to_pixel(colour);  // red in the lowest byte, as in ImGui
}

ImVec2 place(const Vec2& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y)};
}

void draw_label(ImDrawList& list, const FlatMark& mark, const Area& free) {
  const ImVec2 size = ImGui::CalcTextSize(mark.label.c_str()), at = place(mark.points.front());
  const float room = 0.25f * ImGui::GetFontSize();
  const auto within = [&](float from, float length, double low, double high) {
    const float least = static_cast<float>(low) + room;
    return std::clamp(from, least, std::max(static_cast<float>(high) - length - room, least));
  };
  const ImVec2 from(within(at.x - size.x / 2, size.x, free.left, free.right),
                    within(at.y - size.y / 2, size.y, free.top, free.bottom));
  list.AddRectFilled({from.x - room, from.y - room * 0.5f}, {from.x + size.x + room, from.y + size.y + room * 0.5f},
                     ImGui::GetColorU32(ImGuiCol_WindowBg, 0.85f), room);
  list.AddText(from, mark.colour.a > 0 ? colour_of(mark.colour) : ImGui::GetColorU32(ImGuiCol_Text),
               mark.label.c_str());
}

}  // namespace

void draw_marks(const std::vector<FlatMark>& marks, const Area& free) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float point = ImGui::GetFontSize() / static_cast<float>(text_height);
  for (const FlatMark& mark : marks) {
    if (!mark.label.empty()) {
      draw_label(list, mark, free);
      continue;
    }
    for (const Vec2& p : mark.points)
      list.PathLineTo(place(p));
    mark.filled ? list.PathFillConvex(colour_of(mark.colour))
                : list.PathStroke(colour_of(mark.colour), 0, static_cast<float>(mark.width) * point);
  }
}

void draw_place_panel(PanelData& data) {
  Placing& placing = *data.placing;
  for (const Depth& depth : data.depths) {
    ImGui::Text("%s  %.2f mm deep", depth.solid.c_str(), depth.depth_m * 1e3);
    tip("Depth below the solid's surface of a finger's deepest skin point that a camera sees");
  }
  if (data.depths.empty()) ImGui::TextUnformatted("nothing touches");
  if (placing.holds_finger()) {
    const Vec3 tip_mm = Vec3(placing.finger()[3]) * 1e3;
    ImGui::Text("tip  %.1f  %.1f  %.1f mm", tip_mm.x, tip_mm.y, tip_mm.z);
    tip("Where the held finger's tip is in the world");
    bool follows = placing.follows();
    check_box(data, "follows the pointer", follows,
              "The finger goes where the pointer goes, the wheel takes it deeper into the picture, a right drag turns "
              "it. Key: M");
    placing.follow(follows);
  }
  const char* none = "none";
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.6f);
  drop_down(data, "handles", "handles", placing.chosen() ? placing.names()[*placing.chosen()] : none, [&] {
    if (choice(data, "handles none", none, !placing.chosen())) placing.choose(std::nullopt);
    if (const auto chosen = select_of(data, "handles", placing.names(), placing.chosen())) placing.choose(chosen);
  });
  tip("What is moved and turned by handles in the picture; with Ctrl in steps of 1 mm and 5 degrees. Key: G");
  if (button(data, "undo", "Undoes the last move. Key: Ctrl Z", placing.can_undo())) placing.undo();
  ImGui::SameLine();
  if (button(data, "as in the file", "Puts all solids back where their file has them", placing.moved()))
    placing.restore();
  if (button(data, "save as",
             "Writes the solids as they are now and runs with that file, so the command line includes the moves",
             placing.moved()))
    data.asked.save_scene = !data.moved_file.empty();
  ImGui::SameLine();
  const float wide = ImGui::GetFrameHeight(), gap = ImGui::GetStyle().ItemInnerSpacing.x;
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - wide - gap, 1.0f));
  text_field(data, "moved file", "##file", data.moved_file);
  tip("A .glb file; an existing one is replaced");
  ImGui::SameLine(0, gap);
  if (button(data, "...", "Chooses a folder and a name", true, "name of moved objects", {wide, 0}))
    data.picker = FilePicker{.title = "a name for the moved objects",
                             .option = save_as,
                             .endings = {".glb"},
                             .is_new = true,
                             .folder = ".",
                             .name = data.moved_file};
}

}  // namespace palpa::viewer
