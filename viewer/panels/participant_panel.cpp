// What the participant sees, and where.
#include <imgui.h>

#include <string>

#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"

namespace palpa::viewer {
namespace {

constexpr double mm = 1e3;  ///< per metre

void draw_barrier(PanelData& data, Participant& setting) {
  // For a full HD screen. The picture itself is computed with the window's own pixels.
  Barrier barrier = barrier_of(setting, 1920, 1080);
  if (drag(data, "pitch", barrier.pitch_m, mm, 1e-4f, 0.01f, 5, "%.4f mm")) setting.barrier_pitch_m = barrier.pitch_m;
  tip("Distance from slit to slit; with rows, of two rows");
  if (setting.stereo == Stereo::columns) {
    if (drag(data, "gap", barrier.gap_m, mm, 0.01f, -50, 50, "%.2f mm") && barrier.gap_m != 0)
      setting.barrier_gap_m = barrier.gap_m;
    tip("From the screen to its barrier, towards the eyes");
  }
  drag(data, "phase", setting.barrier_phase, 1, 0.005f, 0, 1, "%.3f");
  tip("Position of the slits, as a part of the pitch");
  if (button(data, "reset the barrier", "Pitch and gap at which each eye sees every other pixel")) {
    setting.barrier_pitch_m.reset();
    setting.barrier_gap_m.reset();
    setting.barrier_phase = 0;
  }
}

}  // namespace

void draw_participant_panel(PanelData& data) {
  PanelData::ParticipantWindowState& view = data.participant;
  if (button(
          data, view.open ? "close" : "open",
          "A second window that fills a monitor: objects and marker tile alone, where they are felt. Key: P, in both "
          "windows",
          true, "participant's window"))
    data.asked.participant = !view.open;
  if (view.monitors.size() == 1) {
    ImGui::TextWrapped("There is one monitor: it will cover this window. P or Escape closes it.");
  }
  check_box(data, "object hidden", view.hidden, "The participant sees the marker tile alone. Key: V");
  ImGui::BeginDisabled(view.open);
  ImGui::SetNextItemWidth(-1);
  const std::string now = view.monitor < view.monitors.size() ? view.monitors[view.monitor] : "no monitor";
  drop_down(data, "monitor", "##monitor", now, [&] {
    if (const auto chosen = select_of(data, "monitor", view.monitors, view.monitor)) view.monitor = *chosen;
  });
  ImGui::EndDisabled();
  tip("Which monitor it fills");
  if (!view.setting) return;
  Participant& setting = *view.setting;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.5f);
  drop_down(data, "stereo", "stereo", stereo_words, setting.stereo);
  tip("How the two eyes' pictures become one");
  drag(data, "eyes apart", setting.eyes_apart_m, mm, 0.1f, 1, 100, "%.1f mm");
  tip("From eye to eye");
  Participant moved = setting;
  bool changed = false;
  for (int i = 0; i < 3; ++i) {
    const char* const names[] = {"eye x", "eye y", "eye z"};
    changed = drag(data, names[i], moved.screen.eye_m[i], mm, 0.5f, -3000, 3000, "%.0f mm") || changed;
    tip("Between the participant's eyes, in the world");
  }
  if (changed && in_front(moved.screen)) setting = moved;
  if (setting.stereo == Stereo::columns || setting.stereo == Stereo::rows) draw_barrier(data, setting);
}

}  // namespace palpa::viewer
