// The numbers and names that panels say.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "viewer/app/flat_marks.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/ui.hpp"

namespace palpa::viewer {
namespace {

/// All text of a panel that has room for it.
std::string text_of(const std::function<void()>& panel) {
  std::string text;
  Ui ui(false, [&](const std::string& copied) { text = copied; });
  ui.begin(1000, 2000, 1, 0.1);
  ImGui::SetNextWindowSize({900, 1900});
  ImGui::Begin("panel");
  ImGui::LogToClipboard();
  panel();
  ImGui::LogFinish();
  ImGui::End();
  ui.end();
  return text;
}

TEST(PanelTexts, StatisticsAreThoseOfTheRun) {
  PanelData data;
  LiveNumbers& numbers = data.content.run.numbers;
  numbers.frames = 734;
  numbers.dropped = 5;
  numbers.rate_hz = 87.2;
  numbers.last_s = 7.31e-3;
  numbers.bins.counts[4] = 90;  // a tenth of 11.1 ms each
  numbers.bins.counts[9] = 8;
  numbers.bins.counts[20] = 2;
  numbers.passes = {{"contacts", 1.25}, {"solver", 3.5}};
  data.headings["passes"] = true;
  data.content.run.drives = 987;
  data.content.run.silent_drives = 65;
  data.picture_ms = 12.34;
  const std::string text = text_of([&] { draw_statistics_panel(data); });
  for (const char* part : {"7.3 of 11.1 ms", "734 frames, 87 a second, 5 dropped", "median 5.6 ms, p99 23.3 ms",
                           "987 drives, 65 silent", "picture 12.3 ms"})
    EXPECT_CONTAINS(text, part);
  EXPECT_LT(text.find("contacts"), text.find("1.25 ms"));
  EXPECT_LT(text.find("1.25 ms"), text.find("solver"));
  EXPECT_LT(text.find("solver"), text.find("3.50 ms"));
}

TEST(PanelTexts, WhatEachFingerFeelsIsWhatItFeelsAlone) {
  const auto line = [](double hz, double around) {
    return acoustics::Line{.frequency_hz = hz, .amplitude = around, .around = around};
  };
  std::vector<acoustics::Spectrum> spectra(3);
  spectra[0].lines = {line(66.7, 0.2), line(200, 0.9)};
  spectra[0].variance = 0.5;
  spectra[2].lines = {line(40, 0.6), line(80, 0.1)};
  spectra[2].variance = 0.2;
  PanelData data;
  const auto said = [&] { return text_of([&] { draw_spectrum_panel(data); }); };
  std::vector<std::string> alone;
  for (std::size_t f = 0; f < spectra.size(); ++f) {
    data.spectra = {spectra[f]};
    const std::string text = said(), before = "finger 0: ";
    const std::size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << text;
    alone.push_back("finger " + std::to_string(f) + ": " + text.substr(at + before.size(), 20));
  }
  EXPECT_CONTAINS(alone[0], "200 Hz");
  EXPECT_CONTAINS(alone[1], "nothing changes");
  EXPECT_CONTAINS(alone[2], "40 Hz");
  data.spectra = spectra;
  const std::string together = said();
  for (const std::string& one : alone)
    EXPECT_CONTAINS(together, one);
  data.spectra.clear();
  EXPECT_CONTAINS(said(), "no finger touches");
}

/// Two options of each heading are set, or the only one.
TEST(PanelTexts, HeadingsOfOptionsSayHowManyHaveChanged) {
  std::map<std::string, std::vector<line::OptionInfo>> by_heading;
  for (const line::OptionInfo& info : live_table())
    by_heading[info.heading].push_back(info);
  EXPECT_GE(by_heading.size(), 4U);
  for (const auto& [heading, options] : by_heading) {
    PanelData data;
    int set = 0;
    for (const line::OptionInfo& info : options) {
      try {
        data.content.edit.set(info.name, info.flag ? "" : info.words.empty() ? "6" : info.words.back());
      } catch (const Error&) {  // 6 is no speed, for example
        continue;
      }
      if (++set == 2) break;
    }
    ASSERT_GT(set, 0) << heading;
    const std::string text = text_of([&] { draw_options_panel(data); }),
                      told = fmt::format("{} ({} changed)", heading, set);
    EXPECT_CONTAINS(text, told);
    EXPECT_EQ(text.find(" changed)"), text.rfind(" changed)")) << "the other headings";
  }
}

/// In the panel Place, and beside the fingers.
TEST(PanelTexts, EachFingersDepthIsThatInItsSolid) {
  touch::Touch touch;
  touch.fingers.resize(4);
  touch.finger_count = 3;  // the last is a leftover
  for (std::uint32_t f = 0; f < 4; ++f) {
    touch.fingers[f].solid = 2 - f % 3;
    touch.fingers[f].depth_m = 1e-3F * static_cast<float>(f + 1);
    touch.fingers[f].section.centroid = {0.02F * static_cast<float>(f), 0, 0};
  }
  const Sight sight{.viewpoint = {}, .width = 800, .height = 600, .ratio = 1};
  PanelData data;
  Placing placing;
  data.placing = &placing;
  show_depths(touch, {"plate", "ball", "ring"}, sight, data.depths, data.marks);
  const std::string text = text_of([&] { draw_place_panel(data); });
  for (const char* part : {"ring  1.00 mm deep", "ball  2.00 mm deep", "plate  3.00 mm deep"})
    EXPECT_CONTAINS(text, part);
  EXPECT_EQ(text.find("4.00 mm"), std::string::npos) << text;
  ASSERT_EQ(data.marks.size(), 3U);
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_EQ(data.marks[f].label, std::to_string(f + 1) + ".0 mm");
    const Projected at =
        project(projection(sight.viewpoint, sight.width, sight.height), Vec3(touch.fingers[f].section.centroid));
    EXPECT_NEAR(data.marks[f].points.at(0).x, at.x + 48, 1e-3);
    EXPECT_NEAR(data.marks[f].points.at(0).y, at.y, 1e-3);
  }
}

}  // namespace
}  // namespace palpa::viewer
