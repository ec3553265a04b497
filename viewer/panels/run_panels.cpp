// The panels of the run: its options, its time, its numbers.
#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cfloat>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viewer/live/live_line.hpp"
#include "viewer/panels/panels.hpp"

namespace palpa::viewer {
namespace {

float em(float lines) {
  return lines * ImGui::GetFontSize();
}

using OptionTexts = std::vector<OptionText>;

void choose(OptionTexts& asked, const setup::OptionInfo& info, const std::string& now) {
  const std::string usual = info.initial.empty() ? "as usual" : info.initial;
  if (!ImGui::BeginCombo("##value", now.empty() ? usual.c_str() : now.c_str())) return;
  if (ImGui::Selectable((usual + " (usual)").c_str(), now.empty())) asked.push_back({info.name, std::nullopt});
  for (const std::string& word : info.words) {
    if (ImGui::Selectable(word.c_str(), word == now)) asked.push_back({info.name, word});
  }
  ImGui::EndCombo();
}

void draw_option(Desk& desk, const setup::OptionInfo& info) {
  OptionTexts& asked = desk.asked.options;
  const std::optional<std::string> value = desk.edit.text(info.name);
  const bool set = value.has_value();
  const std::string now = value.value_or("");
  const char* label = info.name.c_str() + 2;
  ImGui::PushID(info.name.c_str());
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  set ? ImGui::TextUnformatted(label) : ImGui::TextDisabled("%s", label);
  tip(info.help.c_str());
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1);
  if (info.flag) {
    bool on = set;
    if (ImGui::Checkbox("##value", &on)) asked.push_back({info.name, on ? std::optional(std::string()) : std::nullopt});
  } else if (!info.words.empty()) {
    choose(asked, info, now);
  } else {
    std::string text = now;
    const std::string hint = info.initial.empty() ? info.type : info.initial;
    ImGui::InputTextWithHint("##value", hint.c_str(), &text);
    if (ImGui::IsItemVisible()) desk.places.texts.push_back(last_area());
    // Typed text is not used until it is finished.
    if (ImGui::IsItemDeactivatedAfterEdit() && text != now)
      asked.push_back({info.name, text.empty() ? std::nullopt : std::optional(text)});
  }
  tip(info.help.c_str());
  ImGui::PopID();
}

/// Two columns: names, values.
void draw_options(Desk& desk, std::span<const setup::OptionInfo> options) {
  if (!ImGui::BeginTable("options", 2, ImGuiTableFlags_SizingStretchSame)) return;
  for (const setup::OptionInfo& info : options)
    draw_option(desk, info);
  ImGui::EndTable();
}

}  // namespace

void draw_options_panel(Desk& desk) {
  if (ImGui::SmallButton("copy as command line")) desk.asked.copy = true;
  tip("The palpa run that does the same without a window. Key: C");
  const std::vector<setup::OptionInfo>& table = live_table();
  for (auto first = table.begin(); first != table.end();) {
    const auto last =
        std::find_if(first, table.end(), [&](const auto& info) { return info.heading != first->heading; });
    if (ImGui::TreeNode(first->heading.c_str())) {
      draw_options(desk, {first, last});
      ImGui::TreePop();
    }
    first = last;
  }
  const bool open = ImGui::TreeNode("Only in the copied command");
  tip("How long palpa run runs and what it prints in a terminal: the viewer runs until it is closed, and has panels");
  if (!open) return;
  draw_options(desk, copied_table());
  ImGui::TreePop();
}

void draw_time_panel(Desk& desk) {
  SlotTime& time = desk.state.time;
  if (ImGui::SmallButton(time.playing ? "stop" : "play")) time.playing = !time.playing;
  tip("The schedule, slowed down. Key: Space");
  ImGui::SameLine();
  if (ImGui::SmallButton("<")) desk.asked.slots -= 1;
  tip("One slot back. Key: ,");
  ImGui::SameLine();
  if (ImGui::SmallButton(">")) desk.asked.slots += 1;
  tip("One slot on. Key: .");
  ImGui::SameLine();
  ImGui::Text("slot %llu", static_cast<unsigned long long>(time.slot));
  auto rate = static_cast<float>(time.slots_per_s);
  ImGui::SetNextItemWidth(em(8));
  if (ImGui::SliderFloat("slots/s", &rate, 0.5f, 667, "%.1f", ImGuiSliderFlags_Logarithmic))
    time.slots_per_s = std::clamp(rate, 0.5f, 667.0f);
  tip("Speed at which the schedule is shown; 667 is real time for a dwell of 1.5 ms. The array's speed does not "
      "change.");
  if (!desk.playback) return;
  ImGui::Separator();
  Playback play = *desk.playback;
  bool changed = false;
  if (ImGui::SmallButton(play.playing ? "pause" : "go on")) {
    play.playing = !play.playing;
    changed = true;
  }
  tip("The recording: while it pauses, the array falls silent after the hold. Key: Space");
  ImGui::SameLine();
  if (ImGui::SmallButton("|<")) desk.asked.step -= 1;
  tip("One frame back. Key: left");
  ImGui::SameLine();
  if (ImGui::SmallButton(">|")) desk.asked.step += 1;
  tip("One frame on. Key: right");
  ImGui::SameLine();
  ImGui::Text("%.2f of %.2f s", play.time_s, play.length_s);
  int frame = static_cast<int>(play.frame);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##frame", &frame, 0, std::max(static_cast<int>(play.frames) - 1, 1), "frame %d")) {
    desk.asked.go_to = static_cast<std::uint64_t>(std::clamp(frame, 0, static_cast<int>(play.frames) - 1));
  }
  tip("Where the recording is");
  auto speed = static_cast<float>(play.speed);
  ImGui::SetNextItemWidth(em(8));
  if (ImGui::SliderFloat("speed", &speed, 0.05f, 4, "%.2f", ImGuiSliderFlags_Logarithmic)) {
    play.speed = std::clamp(speed, 0.05f, 4.0f);
    changed = true;
  }
  tip("Speed; 1 is as recorded");
  ImGui::SameLine();
  changed = ImGui::Checkbox("again", &play.loop) || changed;
  tip("Start again at the end");
  if (changed) desk.asked.play = play;
}

void draw_statistics_panel(const Desk& desk) {
  const LiveNumbers& n = desk.numbers;
  const auto share = static_cast<float>(n.last_s / TimeBins::budget_s);
  const std::string text = fmt::format("{:.1f} of {:.1f} ms", n.last_s * 1e3, TimeBins::budget_s * 1e3);
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram,
                        share <= 1 ? ImVec4{0.20f, 0.50f, 0.78f, 1} : ImVec4{0.85f, 0.37f, 0, 1});
  ImGui::ProgressBar(std::min(share, 1.0f), {-1, 0}, text.c_str());
  ImGui::PopStyleColor();
  tip("Time from a frame in memory to its drives, and the budget at 90 frames a second");
  ImGui::Text("%llu frames, %.0f a second, %llu dropped", static_cast<unsigned long long>(n.frames), n.rate_hz,
              static_cast<unsigned long long>(n.dropped));
  ImGui::Text("median %.1f ms, p99 %.1f ms", n.bins.quantile(0.5) * 1e3, n.bins.quantile(0.99) * 1e3);
  std::vector<float> bars;
  for (const std::uint32_t count : n.bins.counts)
    bars.push_back(static_cast<float>(count));
  ImGui::PlotHistogram("##times", bars.data(), static_cast<int>(bars.size()), 0, nullptr, 0, FLT_MAX,
                       {ImGui::GetContentRegionAvail().x, em(3)});
  tip("How long frames took: each bar is a tenth of the budget of 11.1 ms, and the last bar all that took longer than "
      "three budgets");
  if (ImGui::TreeNode("passes")) {
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
  ImGui::Text("%llu drives, %llu silent", static_cast<unsigned long long>(desk.drives),
              static_cast<unsigned long long>(desk.silent_drives));
  ImGui::TextDisabled("picture %.1f ms", desk.picture_ms);
  tip("Time to draw the picture, which gives way to the loop");
}

}  // namespace palpa::viewer
