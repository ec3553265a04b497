// The widgets of an empty window and of files that are opened, see test_every_widget.cpp.
#include <gtest/gtest.h>

#include <filesystem>

#include "every_widget.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/panels/panels.hpp"

namespace palpa::viewer {

Rows EveryWidget::empty_rows() {
  Rows rows{{"recent *",
             [this] {
               const auto before = recordings();
               push("recent " + recording().string());
               EXPECT_TRUE(goes_round_until([&] { return recordings() > before; }));
             }},
            {"open", [this] {
               push("open");
               EXPECT_TRUE(data().picker);
               push("cancel");
               EXPECT_FALSE(data().picker);
             }}};
  for (const char* object : {"cube", "pyramid", "prism", "semi-sphere"}) {
    rows.push_back({object, [this, object] {
                      make_empty();
                      push(object);
                      EXPECT_TRUE(goes_round_until([&] { return data().content.live; }));
                      EXPECT_EQ(fs::path(options().scene).stem(), object);
                    }});
  }
  return rows;
}

Rows EveryWidget::picker_rows() {
  Rows rows{{"open a file", [this] { open_picker(); }},
            {"opened before",
             [this] {
               open_picker();
               push("opened before");
               EXPECT_TRUE(data().places.list);
               tap(Key::escape);
               EXPECT_TRUE(data().picker) << "the list was innermost";
             }},
            {"opened before *",
             [this] {
               open_picker();
               const auto before = recordings();
               push("opened before");
               push("opened before " + recording().string());
               EXPECT_FALSE(data().picker);
               EXPECT_TRUE(goes_round_until([&] { return recordings() > before; }));
             }},
            {"file *",
             [this] {
               open_picker();
               EXPECT_EQ(data().picker->folder, folder_.string()) << "where the newest file is";
               push("file deeper");
               EXPECT_EQ(data().picker->folder, (folder_ / "deeper").string());
             }},
            {"folder above",
             [this] {
               open_picker();
               push("folder above");
               EXPECT_EQ(data().picker->folder, folder_.string());
               push("file other.glb");
               EXPECT_EQ(data().picker->name, "other.glb");
             }},
            {"name",
             [this] {
               open_picker();
               write("name", "no such file", Key::escape);
               ASSERT_TRUE(data().picker) << "Escape ends the typing first";
               EXPECT_EQ(data().picker->name, "other.glb") << "as before";
               write("name", "some.glb", Key::tab);
               EXPECT_EQ(data().picker->name, "some.glb");
               push("cancel");
             }},
            {"cancel",
             [this] {
               open_picker();
               push("cancel");
               EXPECT_FALSE(data().picker);
             }},
            {"close the files", [this] {
               open_picker();
               push("close the files");
               EXPECT_FALSE(data().picker);
             }}};
  std::string own;
  if (!data().objects.empty()) own = folder_above(data().objects.front().path);
  for (const NamedFolder& place : starting_folders(own)) {
    rows.push_back({place.name, [this, place] {
                      open_picker();
                      push(place.name);
                      EXPECT_EQ(data().picker->folder, place.folder);
                    }});
  }
  rows.push_back({"choose", [this] {
                    push("cancel");
                    open_picker();
                    push("choose");
                    EXPECT_TRUE(data().picker) << "nothing is chosen yet";
                    push("file take");
                    const auto before = recordings();
                    push("choose");
                    EXPECT_FALSE(data().picker);
                    EXPECT_TRUE(goes_round_until([&] { return recordings() > before; }));
                  }});
  return rows;
}

TEST_F(EveryWidget, OfAnEmptyWindowWorks) {
  fs::create_directory(folder_ / "deeper");
  make_empty();
  drop(recording());
  ASSERT_TRUE(goes_round_until([&] { return recordings() == 1; }));
  heading("Run").works();
  for (const Row& row : heading_rows()) {
    draw();
    if (row.widget == "Run" || !data().places.named.contains(row.widget)) continue;
    SCOPED_TRACE(row.widget);
    row.works();
    push(row.widget);  // folded again
  }
  for (const line::OptionInfo& info : live_table())
    EXPECT_TRUE(drawn_.contains(info.heading)) << info.heading;
  push("Run");
  Rows rows = picker_rows();
  for (const Row& row : empty_rows())
    rows.push_back(row);
  expect_all(rows);
}

/// Panels alone, because a file is often open before its window is drawn.
Rows EveryWidget::opening_rows() {
  return {{"Cancel", [this] {
             app_.reset();
             Ui ui(false);
             Picture picture;
             PanelData shown;
             shown.picture = &picture;
             shown.content.opening = true;
             const auto draw_alone = [&](WindowEvent::Kind kind) {
               const Area area = shown.places.named["Cancel"];
               ui.take({.kind = kind, .x = (area.left + area.right) / 2, .y = (area.top + area.bottom) / 2});
               for (int i = 0; i < 2; ++i) {
                 ui.begin(size_.width, size_.height, 1, 0.1);
                 draw_panels(shown);
                 ui.end();
               }
             };
             for (const Kind kind : {Kind::move, Kind::move, Kind::press})
               draw_alone(kind);
             EXPECT_FALSE(shown.asked.cancel);
             draw_alone(Kind::release);
             EXPECT_TRUE(shown.asked.cancel);
             for (const auto& [name, area] : shown.places.named)
               drawn_.insert(name);
           }}};
}

TEST_F(EveryWidget, OfAnOpeningFileWorks) {
  for (const Row& row : opening_rows())
    row.works();
  EXPECT_TRUE(drawn_.contains("Cancel"));
}

}  // namespace palpa::viewer
