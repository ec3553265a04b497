// The widgets of a live run and its recording, see test_every_widget.cpp.
#include <gtest/gtest.h>

#include <filesystem>

#include "every_widget.hpp"
#include "viewer/hands/gizmo.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {

/// Drags the arrow of the chosen object's handles upwards.
void EveryWidget::move_object() {
  const double width = size_.width, height = size_.height, top = strip_height(text_height);
  const Sight sight{view().viewpoint, width - panels_width(width, text_height), height - top, 1};
  const Gizmo gizmo = gizmo_at(Vec3(0, -0.02, 0), sight);
  const Projected tip =
      project(projection(sight.viewpoint, sight.width, sight.height), gizmo.at + Vec3(0, 0.8 * gizmo.size_m, 0));
  press_at(tip.x, tip.y + top);
  button(Kind::move, tip.x, tip.y + top - 17);
  draw();
  release_at(tip.x, tip.y + top - 17);
  EXPECT_TRUE(data().placing->moved());
}

Rows EveryWidget::place_rows() {
  return {{"follows the pointer",
           [this] { expect_toggles("follows the pointer", [&] { return data().placing->follows(); }); }},
          {"handles",
           [this] {
             const Placing& placing = *data().placing;
             const auto chosen = [&] { return placing.chosen() ? placing.names()[*placing.chosen()] : "none"; };
             EXPECT_EQ(placing.names().size(), 2u) << "the cube, and the finger";
             expect_chooses("handles", placing.names(), chosen);
             choose("handles", "handles " + placing.names().front());
           }},
          {"handles *", [] {}},
          {"undo",
           [this] {
             move_object();
             push("undo");
             EXPECT_FALSE(data().placing->moved() || data().placing->can_undo());
           }},
          {"as in the file",
           [this] {
             move_object();
             push("as in the file");
             EXPECT_FALSE(data().placing->moved());
           }},
          {"moved file",
           [this] {
             write("moved file", "discarded.glb", Key::escape);
             EXPECT_EQ(data().moved_file, "moved.glb");
             const std::string file = folder_ / "saved.glb";
             write("moved file", file, Key::enter);
             EXPECT_EQ(data().moved_file, file);
           }},
          {"name of moved objects",
           [this] {
             push("name of moved objects");
             ASSERT_TRUE(data().picker);
             EXPECT_TRUE(data().picker->is_new);
             EXPECT_EQ(data().picker->name, data().moved_file);
             push("cancel");
             EXPECT_FALSE(data().picker);
             EXPECT_TRUE(data().moved_file.ends_with("/saved.glb"));
             push("name of moved objects");
             push("choose");
             EXPECT_EQ(data().moved_file, "saved.glb") << "its own name was offered, and is short from here";
           }},
          {"save as", [this] {
             const std::string file = data().moved_file;
             const int runs = heard_->opened;
             push("save as");
             EXPECT_EQ(options().scene, scene_.string()) << "nothing was moved";
             move_object();
             push("save as");
             EXPECT_EQ(options().scene, file);
             EXPECT_TRUE(fs::exists(file));
             EXPECT_TRUE(goes_round_until([&] { return heard_->opened > runs; })) << "a run of it";
             EXPECT_TRUE(comes_to(LiveState::running) && shows_frame());
           }}};
}

Rows EveryWidget::run_rows() {
  Rows rows = place_rows();
  rows.push_back(heading("passes"));
  rows.push_back({"copy", [this] {
                    push("copy");
                    EXPECT_TRUE(data().places.list);
                    tap(Key::escape);
                    EXPECT_EQ(copied_, "");
                  }});
  rows.push_back({"copy run", [this] {
                    choose("copy", "copy run");
                    EXPECT_TRUE(copied_.starts_with("palpa run ")) << copied_;
                  }});
  rows.push_back({"ceiling", [this] {
                    const Area area = place_of_widget("ceiling").value();
                    const double x = (area.left + area.right) / 2, y = (area.top + area.bottom) / 2;
                    for (const auto& [to, ceiling] : {std::pair(-1e4, 0.0), {1e4, 1.0}}) {
                      press_at(x, y);
                      button(Kind::move, to, y);
                      draw();
                      release_at(to, y);
                      EXPECT_EQ(options().safety.ceiling, ceiling);
                    }
                  }});
  rows.push_back({"ALL OFF", [this] {
                    push("ALL OFF");
                    EXPECT_TRUE(comes_to(LiveState::ended));
                    EXPECT_TRUE(stop_);
                  }});
  rows.push_back({"record", [this] {  // in the next run
                    click("Start");
                    EXPECT_TRUE(comes_to(LiveState::running));
                    const RunStatus& run = data().content.run;
                    EXPECT_TRUE(goes_round_until([&] { return shows_frame(); }));
                    push("record");
                    EXPECT_TRUE(goes_round_until([&] { return run.recorded > 5; }));
                    push("record");
                    EXPECT_TRUE(goes_round_until([&] { return run.recording.empty(); }));
                  }});
  return rows;
}

Rows EveryWidget::recording_rows() {
  const auto steps = [this](const std::string& name, std::uint64_t by) {
    const std::uint64_t before = playback().frame;
    push(name);
    EXPECT_TRUE(goes_round_until([&] { return playback().frame != before; }));
    EXPECT_EQ(playback().frame, before + by);
    EXPECT_FALSE(playback().playing);
  };
  return {{"play made",
           [this] {
             ASSERT_TRUE(goes_round_until([&] { return is_drawn("play made"); }));
             push("play made");
             // Lines above the buttons go.
             ASSERT_TRUE(goes_round_until([&] {
               return playing() && state() == LiveState::running && !is_drawn("play made") &&
                      data().content.doing.empty();
             }));
           }},
          {"recording play",
           [this] {
             expect_toggles("recording play", [&] { return playback().playing; });
             push("recording play");
             EXPECT_FALSE(playback().playing);
           }},
          {"recording frame",
           [this] {
             const Area area = place_of_widget("recording frame").value();
             const double y = (area.top + area.bottom) / 2;
             const auto comes_to_frame = [&](std::uint64_t frame) {
               return goes_round_until([&] { return playback().frame == frame; });
             };
             const std::uint64_t last = playback().frames - 1;
             const auto hold = [&](double to) {
               press_at(area.left + 9, y);
               button(Kind::move, to, y);
               draw();
             };
             hold(1e4);
             EXPECT_TRUE(comes_to_frame(last));
             release_at(1e4, y);
             EXPECT_EQ(playback().frame, last);
             hold(-1e4);
             EXPECT_TRUE(comes_to_frame(0));
             tap(Key::escape);
             EXPECT_TRUE(comes_to_frame(last)) << "where it was before the drag";
             release_at(-1e4, y);
             EXPECT_EQ(playback().frame, last);
             hold(-1e4);
             EXPECT_TRUE(comes_to_frame(0));
             release_at(-1e4, y);
           }},
          {"recording step", [=] { steps("recording step", 1); }},
          {"recording back", [=] { steps("recording back", static_cast<std::uint64_t>(-1)); }},
          {"loop", [this] { expect_toggles("loop", [&] { return playback().loop; }); }},
          {"recording speed", [this] { expect_slides("recording speed", 0.05, 4, [&] { return playback().speed; }); }},
          {"close recording", [this] {
             push("close recording");
             EXPECT_TRUE(goes_round_until([&] { return !playing(); }));
             EXPECT_EQ(options().source, "mouse");
           }}};
}

TEST_F(EveryWidget, OfALiveRunAndItsRecordingWorks) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  begin("mouse");
  ASSERT_TRUE(comes_to(LiveState::running));
  ASSERT_TRUE(shows_frame());
  for (const char* name : {"Place", "Time", "Statistics", "Sound", "Spectrum"}) {
    unfold(name);
    SCOPED_TRACE(name);
    heading(name).works();
  }
  Rows rows = run_rows();
  for (const Row& row : recording_rows())
    rows.push_back(row);
  expect_all(rows);
  app_.reset();
  fs::current_path(before);
}

}  // namespace palpa::viewer
