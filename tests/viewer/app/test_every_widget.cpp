// Each widget of the panels does what its explanation says: a table says how it is operated and what changes. What is
// drawn and not in the table fails, and so does a row whose widget is never drawn. Here: those of one touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "every_widget.hpp"
#include "support/files.hpp"
#include "viewer/live/live_line.hpp"

namespace palpa::viewer {

void EveryWidget::expect_all(const Rows& rows) {
  for (const Row& row : rows) {
    SCOPED_TRACE(row.widget);
    draw(1);
    row.works();
  }
  for (const Row& row : rows)
    EXPECT_TRUE(std::ranges::any_of(drawn_, [&](const std::string& widget) { return is_of(row, widget); }))
        << row.widget << " was never drawn";
  expect_known();
}
void EveryWidget::expect_known() {
  static const Rows options{{"--*", [] {}}};  // test_every_field.cpp
  for (const std::string& widget : drawn_) {
    const auto has = [&](const Rows& rows) {
      return std::ranges::any_of(rows, [&](const Row& row) { return is_of(row, widget); });
    };
    EXPECT_TRUE(has(touch_rows()) || has(run_rows()) || has(recording_rows()) || has(empty_rows()) ||
                has(picker_rows()) || has(opening_rows()) || has(heading_rows()) || has(options))
        << widget << " has no row";
  }
}
Rows EveryWidget::heading_rows() {
  Rows rows;
  for (const char* name : {"Run", "Place", "Time", "View", "Participant", "Statistics", "Sound", "Spectrum", "Log",
                           "passes", "Only in the copied command"})
    rows.push_back(heading(name));
  for (const line::OptionInfo& info : live_table()) {
    if (std::ranges::find(rows, info.heading, &Row::widget) == rows.end()) rows.push_back(heading(info.heading));
  }
  return rows;
}

// ---- one touch ----------------------------------------------------------------------------------------------------

Rows EveryWidget::view_rows() {
  Rows rows{standpoint("front", {0, 0, 1}), standpoint("right", {1, 0, 0}), standpoint("top", {0, 1, 0})};
  rows.push_back({"corner", [this] {
                    push("corner");
                    for (int axis = 0; axis < 3; ++axis)
                      EXPECT_GT(eye()[axis], 0.3);
                  }});
  rows.push_back({"frame all", [this] {
                    push("frame all");
                    const Viewpoint all = view().viewpoint;
                    come_near();
                    EXPECT_LT(view().viewpoint.distance, 0.5 * all.distance);
                    push("frame all");
                    EXPECT_NEAR(view().viewpoint.distance, all.distance, 1e-9);
                  }});
  rows.push_back({"frame touch", [this] {
                    const double all = view().viewpoint.distance;
                    push("frame touch");
                    EXPECT_LT(view().viewpoint.distance, 0.7 * all);
                    EXPECT_LT(glm::length(view().viewpoint.target), 0.02) << "the finger touches there";
                  }});
  rows.push_back({"parallel", [this] { expect_toggles("parallel", [&] { return view().viewpoint.orthographic; }); }});
  rows.push_back({"dark", [this] { expect_toggles("dark", [&] { return view().dark; }); }});
  rows.push_back({"fine pictures",
                  [this] { expect_chooses<FinePictures>("fine pictures", fine_words, [&] { return view().fine; }); }});
  rows.push_back({"fine pictures *", [] {}});
  rows.push_back({"parts apart", [this] { expect_slides("parts apart", 0, 1, [&] { return view().explode; }); }});
  for (const Word<Layer>& layer : layer_words) {
    const auto only_this = [this, layer](const Layers& before) {
      Layers now = view().layers;
      now[layer.value] = before[layer.value];
      EXPECT_EQ(now, before) << "no other layer changes";
    };
    rows.push_back({layer.word, [this, layer, only_this] {
                      const Layers before = view().layers;
                      expect_toggles(layer.word, [&] {
                        only_this(before);
                        return view().layers[layer.value].visible;
                      });
                    }});
    rows.push_back({std::string("opacity ") + layer.word, [this, layer, only_this] {
                      const Layers before = view().layers;
                      expect_slides(std::string("opacity ") + layer.word, 0, 1, [&] {
                        only_this(before);
                        return view().layers[layer.value].opacity;
                      });
                    }});
  }
  return rows;
}

Rows EveryWidget::participant_rows() {
  const auto drags = [this](const std::string& name, double step, std::function<double()> value) {
    return Row{name, [=, this] { expect_drags(name, step, value); }};
  };
  Rows rows{{"participant's window",
             [this] { expect_toggles("participant's window", [&] { return data().participant.open; }); }},
            {"object hidden", [this] { expect_toggles("object hidden", [&] { return data().participant.hidden; }); }},
            {"monitor",
             [this] {
               const auto& window = data().participant;
               expect_chooses("monitor", window.monitors, [&] { return window.monitors.at(window.monitor); });
             }},
            {"monitor *", [] {}},
            {"stereo", [this] { expect_chooses<Stereo>("stereo", stereo_words, [&] { return setting().stereo; }); }},
            {"stereo *", [] {}},
            drags("eyes apart", 0.1e-3, [this] { return setting().eyes_apart_m; }),
            drags("eye x", 0.5e-3, [this] { return setting().screen.eye_m.x; }),
            drags("eye y", 0.5e-3, [this] { return setting().screen.eye_m.y; }),
            drags("eye z", 0.5e-3, [this] { return setting().screen.eye_m.z; })};
  rows.push_back(
      {"eyes apart", [this] { expect_ends("eyes apart", 1e-3, 0.1, [&] { return setting().eyes_apart_m; }); }});
  rows.push_back({"reset the barrier", [this] {
                    choose("stereo", "stereo columns");
                    expect_drags("phase", 0.005, [&] { return setting().barrier_phase; });
                    expect_ends("phase", 0, 1, [&] { return setting().barrier_phase; });
                    const auto barrier = [this] { return barrier_of(setting(), 1920, 1080); };
                    // Before the pitch, from which the usual gap follows.
                    expect_drags("gap", 1e-5, [&] { return barrier().gap_m; });
                    expect_ends("gap", -0.05, 0.05, [&] { return barrier().gap_m; });
                    expect_drags("pitch", 1e-7, [&] { return barrier().pitch_m; });
                    expect_ends("pitch", 1e-5, 5e-3, [&] { return barrier().pitch_m; });
                    const double gap_m = barrier().gap_m;
                    choose("stereo", "stereo rows");
                    EXPECT_FALSE(is_drawn("gap")) << "rows follow from the eyes";
                    EXPECT_EQ(setting().barrier_gap_m, gap_m);
                    push("reset the barrier");
                    EXPECT_FALSE(setting().barrier_pitch_m || setting().barrier_gap_m);
                    EXPECT_EQ(setting().barrier_phase, 0);
                    choose("stereo", "stereo none");
                    EXPECT_FALSE(is_drawn("reset the barrier"));
                  }});
  for (const char* of_barrier : {"phase", "pitch", "gap"})
    rows.push_back({of_barrier, [] {}});
  return rows;
}

Rows EveryWidget::sound_rows() {
  const auto visible = [this](Layer layer) { return view().layers[layer].visible; };
  Rows rows{
      {"on the finger", [=, this] { expect_toggles("on the finger", [&] { return visible(Layer::heat); }); }},
      {"heat of",
       [this] { expect_chooses<SkinColour>("heat of", skin_colour_words, [&] { return view().skin_colour; }); }},
      {"heat of *", [] {}},
      {"field in a plane", [=, this] { expect_toggles("field in a plane", [&] { return visible(Layer::slice); }); }},
      {"side", [this] {
         const double shape = view().slice.size_m.y / view().slice.size_m.x;
         expect_slides("side", 5e-3, 0.3, [&] { return view().slice.size_m.x; });
         EXPECT_NEAR(view().slice.size_m.y / view().slice.size_m.x, shape, 1e-9);
       }}};
  for (const std::string plane : {"xy", "xz", "yz"}) {
    rows.push_back({"plane " + plane, [this, plane] {
                      push("plane " + plane);
                      for (int axis = 0; axis < 2; ++axis)
                        EXPECT_EQ(view().slice.T_world_slice[axis][plane[static_cast<std::size_t>(axis)] - 'x'], 1);
                    }});
  }
  return rows;
}

Rows EveryWidget::touch_rows() {
  Rows rows = view_rows();
  for (const Rows& more : {participant_rows(), sound_rows()})
    rows.insert(rows.end(), more.begin(), more.end());
  const auto stepped = [this](const std::string& name, int by) {
    return Row{name, [=, this] {
                 const std::uint64_t before = view().time.slot;
                 push(name);
                 EXPECT_EQ(view().time.slot, before + static_cast<std::uint64_t>(by));
                 EXPECT_FALSE(view().time.playing);
               }};
  };
  rows.push_back({"slots play", [this] {
                    expect_toggles("slots play", [&] { return view().time.playing; });
                    push("slots play");
                    EXPECT_FALSE(view().time.playing);
                  }});
  rows.push_back(stepped("slots step", 1));
  rows.push_back(stepped("slots back", -1));
  rows.push_back(
      {"slots speed", [this] { expect_slides("slots speed", 0.5, 667, [&] { return view().time.slots_per_s; }); }});
  rows.push_back({"copy picture", [this] {
                    choose("copy", "copy picture");
                    EXPECT_TRUE(copied_.starts_with("palpa-viewer ")) << copied_;
                  }});
  rows.push_back({"close the keys", [this] {
                    key('h');
                    draw();
                    EXPECT_TRUE(data().help);
                    push("close the keys");
                    EXPECT_FALSE(data().help);
                  }});
  rows.push_back({"Start", [this] {
                    EXPECT_FALSE(data().content.live);
                    push("Start");
                    EXPECT_TRUE(data().content.live);
                    EXPECT_EQ(options().source, "mouse");
                    EXPECT_EQ(went_live_, 1);
                  }});
  return rows;
}

TEST_F(EveryWidget, OfOneTouchWorks) {
  make_touch({{"--layout", {"autd3"}}, {"--skin", {test::source_file("assets/finger.ply")}}});
  app_->tell_monitors({"one 1920x1080", "two 1920x1080"});
  draw();
  for (const char* name : {"Time", "View", "Participant", "Sound", "Spectrum", "Log"}) {
    unfold(name);
    SCOPED_TRACE(name);
    heading(name).works();
    // What comes late moves what is below it.
    EXPECT_TRUE(goes_round_until([&] { return !data().wants_spectrum || !data().spectra.empty(); }));
  }
  EXPECT_TRUE(data().wants_spectrum);
  push("on the finger");
  push("field in a plane");
  push("participant's window");
  push("participant's window");
  ASSERT_TRUE(data().participant.setting);
  expect_all(touch_rows());
}

TEST_F(EveryWidget, OfASensationHasARow) {
  make(options_of({{"--sensation", {"circle"}}, {"--layout", {"autd3"}}, {"--backend", {"cpu"}}}));
  draw();
  for (const char* name : {"Time", "View"})
    unfold(name);
  draw();
  EXPECT_TRUE(drawn_.contains("slots play"));
  expect_known();
}

/// Otherwise it would have no name, and none of the tests above would miss it.
TEST(EveryWidgetOfThePanels, IsDrawnByTheFunctionsThatNameIt) {
  const std::set<std::string> known{"state_strip.cpp SliderFloat"};  // the ceiling, which is named there
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(test::source_file("viewer/panels"))) {
    const std::string file = entry.path().filename(), text = test::read_text(entry.path());
    if (file.starts_with("widgets.")) continue;
    for (const std::string widget :
         {"Button",    "SmallButton",      "ImageButton", "Checkbox",     "RadioButton",       "SliderFloat",
          "SliderInt", "DragFloat",        "DragInt",     "InputText",    "InputTextWithHint", "InputFloat",
          "InputInt",  "Selectable",       "BeginCombo",  "Combo",        "ListBox",           "MenuItem",
          "BeginMenu", "CollapsingHeader", "TreeNode",    "BeginTabItem", "ColorEdit3",        "ColorEdit4"}) {
      if (text.find("ImGui::" + widget + "(") != std::string::npos) found.insert(file + " " + widget);
    }
  }
  EXPECT_EQ(found, known);
}

}  // namespace palpa::viewer
