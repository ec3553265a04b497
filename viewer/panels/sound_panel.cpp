// The panels of sound: where it is shown, and what skin feels of it in time.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "acoustics/felt/skin.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/widgets.hpp"
#include "viewer/picture/chart.hpp"
#include "viewer/picture/field_marks.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

constexpr double lowest_hz = 4, highest_hz = 600;
constexpr std::size_t most_fingers = 4;

/// The frequency bands in which each kind of afferents feels, from skin.hpp.
struct Band {
  const char* name;
  double low_hz, high_hz;
};
constexpr std::array<Band, 2> bands{Band{"flutter", 5, 50}, Band{"vibration (PC)", 40, 400}};

ImU32 packed(const Colour& colour, float alpha = 1) {
  return ImGui::ColorConvertFloat4ToU32({colour.r, colour.g, colour.b, colour.a * alpha});
}

/// Frequencies by octaves to the right, amplitudes upwards.
struct Plot {
  ImVec2 low, high;  ///< top left, bottom right
  double most = 1;   ///< the value at the top

  float x(double hz) const {
    const double part = std::log(std::clamp(hz, lowest_hz, highest_hz) / lowest_hz) / std::log(highest_hz / lowest_hz);
    return low.x + static_cast<float>(part) * (high.x - low.x);
  }
  float y(double value) const { return high.y - static_cast<float>(std::min(value / most, 1.0)) * (high.y - low.y); }
};

void centred(ImDrawList& draw, const ImVec2& top, ImU32 colour, const std::string& text) {
  draw.AddText({top.x - ImGui::CalcTextSize(text.c_str()).x / 2, top.y}, colour, text.c_str());
}

void draw_ground(ImDrawList& draw, const Plot& plot, const Theme& theme) {
  for (std::size_t i = 0; i < bands.size(); ++i) {
    // One above the other, because they overlap.
    const float top = plot.low.y - em(1.15f) * static_cast<float>(bands.size() - i);
    const ImVec2 from{plot.x(bands[i].low_hz), top}, to{plot.x(bands[i].high_hz), top + em(1.05f)};
    const ImU32 shade = packed(finger_colour(static_cast<std::uint32_t>(i) + 4), 0.35f);
    draw.AddRectFilled(from, to, shade);
    draw.AddRectFilled({from.x, plot.low.y}, {to.x, plot.high.y},
                       packed(finger_colour(static_cast<std::uint32_t>(i) + 4), 0.10f));
    draw.AddText({from.x + em(0.3f), top}, packed(theme.ink), bands[i].name);
  }
  for (int i = 0; i <= 2; ++i) {
    const double value = plot.most * i / 2;
    draw.AddLine({plot.low.x, plot.y(value)}, {plot.high.x, plot.y(value)},
                 packed(theme.faint_ink, i == 0 ? 1.0f : 0.4f));
    const std::string text = fmt::format("{:g}{}", 100 * value, i == 2 ? " %" : "");
    draw.AddText({plot.low.x - ImGui::CalcTextSize(text.c_str()).x - em(0.3f), plot.y(value) - em(0.5f)},
                 packed(theme.ink), text.c_str());
  }
  for (const double hz : {5.0, 20.0, 50.0, 100.0, 200.0, 400.0}) {
    draw.AddLine({plot.x(hz), plot.high.y}, {plot.x(hz), plot.high.y + em(0.25f)}, packed(theme.ink));
    centred(draw, {plot.x(hz), plot.high.y + em(0.25f)}, packed(theme.ink),
            fmt::format("{:g}{}", hz, hz == 5 ? " Hz" : ""));
  }
}

void draw_lines(ImDrawList& draw, const Plot& plot, const acoustics::Spectrum& spectrum, std::size_t finger,
                std::size_t fingers, const Theme& theme) {
  const Colour colour = finger_colour(static_cast<std::uint32_t>(finger));
  const float beside = (static_cast<float>(finger) - static_cast<float>(fingers - 1) / 2) * em(0.22f);
  const std::size_t strongest = acoustics::strongest_felt(spectrum);
  for (std::size_t i = 0; i < spectrum.lines.size(); ++i) {
    const acoustics::Line& line = spectrum.lines[i];
    if (line.frequency_hz > highest_hz) break;
    const float x = plot.x(line.frequency_hz) + beside;
    const double felt = line.around * std::max(acoustics::vibration_sensitivity(line.frequency_hz),
                                               acoustics::flutter_sensitivity(line.frequency_hz));
    draw.AddLine({x, plot.high.y}, {x, plot.y(line.around)}, packed(colour, 0.35f), em(0.2f));
    draw.AddLine({x, plot.high.y}, {x, plot.y(felt)}, packed(colour), em(0.2f));
    if (i != strongest) continue;
    const ImVec2 head{x, plot.y(line.around) - em(0.25f)};
    draw.AddCircleFilled(head, em(0.22f), packed(colour));
    if (finger == 0)
      centred(draw, {x, std::max(head.y - em(1.3f), plot.low.y)}, packed(theme.ink),
              fmt::format("{:.0f} Hz", line.frequency_hz));
  }
}

void say_what_is_felt(const acoustics::Spectrum& spectrum, std::size_t finger) {
  const acoustics::Felt felt = acoustics::felt(spectrum);
  const std::size_t strongest = acoustics::strongest_felt(spectrum);
  std::string text = fmt::format("finger {}: ", finger);
  if (strongest >= spectrum.lines.size()) {
    text += "nothing changes";
  } else {
    text += fmt::format("{:.0f} Hz; vibration {:.0f} %, flutter {:.0f} %", spectrum.lines[strongest].frequency_hz,
                        100 * felt.vibration, 100 * felt.flutter);
  }
  ImGui::TextWrapped("%s", text.c_str());
  tip("The line that is felt most, and the share of the changing energy that each kind of afferents feels. Good for "
      "comparing schedules");
}

}  // namespace

void draw_spectrum_panel(const PanelData& data) {
  if (data.spectra.empty()) {
    ImGui::TextDisabled("no finger touches");
    return;
  }
  const Theme& theme = theme_of(data.state.dark);
  const std::size_t fingers = std::min(data.spectra.size(), most_fingers);
  double most = 0;
  for (std::size_t f = 0; f < fingers; ++f) {
    for (const acoustics::Line& line : data.spectra[f].lines)
      most = std::max(most, line.around);
  }
  const float width = ImGui::GetContentRegionAvail().x, above = em(1.15f) * static_cast<float>(bands.size()) + em(0.2f);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const Plot plot{{at.x + em(2.8f), at.y + above}, {at.x + width - em(1.2f), at.y + above + em(7)}, chart_top(most)};
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw_ground(draw, plot, theme);
  for (std::size_t f = 0; f < fingers; ++f)
    draw_lines(draw, plot, data.spectra[f], f, fingers, theme);
  ImGui::Dummy({width, above + em(8.4f)});
  tip("How strongly the pressure around the foci changes at each frequency, in percent of its mean; in full colour: "
      "the part that is felt");
  for (std::size_t f = 0; f < fingers; ++f)
    say_what_is_felt(data.spectra[f], f);
}

void draw_sound_panel(PanelData& data) {
  const auto layer = [&](const char* name, Layer which, const char* about) {
    check_box(data, name, data.state.layers[which].visible, about);
    if (is_stale(*data.picture, which) && data.state.layers.shows(which)) {
      ImGui::SameLine();
      ImGui::TextDisabled("stale");
      tip("Out of date: the next one is being computed");
    }
  };
  layer("on the finger", Layer::heat, "What the finger feels, on the mesh of --skin");
  if (data.state.layers.shows(Layer::heat)) {
    ImGui::SetNextItemWidth(em(7));
    drop_down(data, "heat of", "##heat", skin_colour_words, data.state.skin_colour);
    tip("The mean radiation pressure, or the rates of a class of afferents: slowly adapting (SA1), rapidly adapting "
        "(RA), Pacinian (PC)");
  }
  layer("field in a plane", Layer::slice,
        "Sound pressure of the slot that is shown. Drag the middle along the arrow, the ends to turn it");
  if (!data.state.layers.shows(Layer::slice)) return;
  for (const Word<setup::Plane>& entry : setup::plane_words) {
    if (button(data, entry.word, "Its axes in the world, through the middle of the touch", true,
               std::string("plane ") + entry.word))
      data.asked.plane = entry.value;
    ImGui::SameLine();
  }
  Vec2& size_m = data.state.slice.size_m;
  double side_m = size_m.x;
  ImGui::SetNextItemWidth(-1);
  if (slider(data, "side", "##size", side_m, 1e3, 5, 300, "side %.0f mm", ImGuiSliderFlags_Logarithmic))
    size_m *= side_m / size_m.x;
  tip("How large it is");
}

}  // namespace palpa::viewer
