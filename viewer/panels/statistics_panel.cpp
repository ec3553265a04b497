// How long frames take, and how many there are.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

/// Times below a histogram of TimeBins, under the places that they mean.
void draw_time_axis(float width) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
  constexpr int budgets = 3;
  for (int i = 0; i <= budgets; ++i) {
    const std::string text = fmt::format("{:.0f}{}", i * TimeBins::budget_s * 1e3, i == budgets ? " ms" : "");
    const float wide = ImGui::CalcTextSize(text.c_str()).x;
    const float x = std::min(width * static_cast<float>(i) / budgets, width - wide / 2) - (i == 0 ? 0 : wide / 2);
    list.AddText({at.x + x, at.y}, ink, text.c_str());
  }
  ImGui::Dummy({width, ImGui::GetFontSize()});
}

}  // namespace

void draw_statistics_panel(PanelData& data) {
  const LiveNumbers& n = data.content.run.numbers;
  const auto share = static_cast<float>(n.last_s / TimeBins::budget_s);
  const std::string text = fmt::format("{:.1f} of {:.1f} ms", n.last_s * 1e3, TimeBins::budget_s * 1e3);
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram,
                        share <= 1 ? ImVec4{0.20f, 0.50f, 0.78f, 1} : ImVec4{0.85f, 0.37f, 0, 1});
  ImGui::ProgressBar(std::min(share, 1.0f), {-1, 0}, text.c_str());
  ImGui::PopStyleColor();
  tip("Time from a frame in memory to its drives, and the budget at 90 frames a second");
  ImGui::Text("%s, %.0f a second, %llu dropped", counted(n.frames, "frame").c_str(), n.rate_hz,
              static_cast<unsigned long long>(n.dropped));
  tip("Dropped: frames that were left out for newer ones");
  ImGui::Text("median %.1f ms, p99 %.1f ms", n.bins.quantile(0.5) * 1e3, n.bins.quantile(0.99) * 1e3);
  std::vector<float> bars;
  for (const std::uint32_t count : n.bins.counts)
    bars.push_back(static_cast<float>(count));
  ImGui::PlotHistogram("##times", bars.data(), static_cast<int>(bars.size()), 0, nullptr, 0, FLT_MAX,
                       {ImGui::GetContentRegionAvail().x, em(3)});
  draw_time_axis(ImGui::GetContentRegionAvail().x);
  tip("How long frames took: each bar is a tenth of the budget of 11.1 ms, and the last bar all that took longer than "
      "three budgets");
  if (subheading(data, "passes", "The computations of a frame on the device")) {
    if (ImGui::BeginTable("passes", 2, ImGuiTableFlags_SizingStretchSame)) {
      for (const PassTimes& pass : n.passes) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(pass.name.c_str());
        ImGui::TableNextColumn();
        ImGui::Text("%.2f ms", pass.mean_ms);
        tip("On average over about the last fifty frames");
      }
      ImGui::EndTable();
    }
    ImGui::TreePop();
  }
  ImGui::Text("%s, %llu silent", counted(data.content.run.drives, "drive").c_str(),
              static_cast<unsigned long long>(data.content.run.silent_drives));
  tip("What has left for the link, a drive for each slot");
  ImGui::Text("picture %.1f ms", data.picture_ms);
  tip("Time to draw the picture, which gives way to the loop");
}

}  // namespace palpa::viewer
