// Tables of the widgets of the panels: how each is operated, and what must have changed afterwards.
#pragma once

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "live_app.hpp"

namespace palpa::viewer {

/// A window in which all panels have room, and the names of all widgets that were drawn in it.
class WidgetsOfApp : public LiveAppWithPanels {
 protected:
  WidgetsOfApp() : LiveAppWithPanels({1000, 3000}) {}

  void draw(int pictures = 3) override {
    for (int i = 0; i < pictures; ++i) {
      LiveAppWithPanels::draw(1);
      for (const auto& [name, area] : app_->data().places.named)
        drawn_.insert(name);
    }
  }
  const PanelData& data() const { return app_->data(); }
  const ViewState& view() const { return app_->data().state; }
  bool is_drawn(const std::string& name) { return place_of_widget(name).has_value(); }
  /// A click that waits for nothing. A line of a list is scrolled into sight.
  void push(const std::string& name) {
    std::optional<Area> area = place_of_widget(name);
    const auto in_sight = [](const Area& of) { return of.bottom - of.top > 6; };
    for (int i = 0; i < 100 && area && !in_sight(*area); ++i) {
      const std::string kind = name.substr(0, name.find(' ') + 1);
      for (const auto& [line, other] : data().places.named) {
        if (line.starts_with(kind) && in_sight(other) && !line.ends_with(" list") && !line.ends_with(" reset"))
          send({.kind = Kind::scroll, .x = other.left + 9, .y = other.bottom - 3, .steps = -0.5});
      }
      area = place_of_widget(name);
    }
    ASSERT_TRUE(area) << name << " is not drawn";
    ASSERT_TRUE(in_sight(*area)) << name << " is out of sight";
    click(*area);
  }
  void unfold(const std::string& heading) {
    const auto is_open = [&] {
      const auto known = data().headings.find(heading);
      return known != data().headings.end() && known->second;
    };
    for (int i = 0; i < 2 && !is_open(); ++i)
      push(heading);
  }
  /// Chooses a line of a list.
  void choose(const std::string& list, const std::string& line) {
    push(list);
    push(line);
    EXPECT_FALSE(data().places.list) << line;
  }
  void release_at(double x, double y) {
    button(Kind::release, x, y);
    draw();
  }

  // ---- kinds of widgets --------------------------------------------------------------------------------------------
  /// One click changes it, and the next one gives it back.
  void expect_toggles(const std::string& name, const std::function<bool()>& value) {
    const bool before = value();
    push(name);
    EXPECT_NE(value(), before);
    push(name);
    EXPECT_EQ(value(), before);
  }
  /// Escape during a drag gives the value back.
  void expect_escapable(const Area& area, double from_x, double to_x, const std::function<double()>& value) {
    const double before = value(), y = (area.top + area.bottom) / 2;
    press_at(from_x, y);
    draw();
    button(Kind::move, to_x, y);
    draw();
    EXPECT_NE(value(), before) << "it is dragged";
    tap(Key::escape);
    EXPECT_DOUBLE_EQ(value(), before) << "after Escape";
    release_at(to_x, y);
    EXPECT_DOUBLE_EQ(value(), before) << "after Escape and the release";
  }
  /// A slider. A drag beyond its ends gives `low` and `high`.
  void expect_slides(const std::string& name, double low, double high, const std::function<double()>& value) {
    const std::optional<Area> area = place_of_widget(name);
    ASSERT_TRUE(area);
    const double x = area->left + 0.2 * (area->right - area->left), y = (area->top + area->bottom) / 2;
    press_at(x, y);
    draw();
    EXPECT_GT(value(), low);
    EXPECT_LT(value(), high);
    for (const auto& [to, end] : {std::pair(1e4, high), {-1e4, low}}) {
      button(Kind::move, to, y);
      draw();
      EXPECT_NEAR(value(), end, 1e-6 * std::abs(high));
    }
    button(Kind::move, x, y);
    draw();
    release_at(x, y);
    expect_escapable(*area, x, 1e4, value);
  }
  /// A field that is dragged: ten pixels are ten steps.
  void expect_drags(const std::string& name, double step, const std::function<double()>& value) {
    const std::optional<Area> area = place_of_widget(name);
    ASSERT_TRUE(area);
    const double x = area->left + 9, y = (area->top + area->bottom) / 2, before = value();
    expect_escapable(*area, x, x + 30, value);
    for (const double way : {10.0, -10.0}) {
      press_at(x, y);
      draw();
      button(Kind::move, x + way, y);
      draw();
      release_at(x + way, y);
      EXPECT_NEAR(value(), way > 0 ? before + 10 * step : before, 0.6 * step);
    }
  }
  /// The ends of what a field can be dragged to.
  void expect_ends(const std::string& name, double low, double high, const std::function<double()>& value) {
    const std::optional<Area> area = place_of_widget(name);
    ASSERT_TRUE(area);
    const double x = area->left + 9, y = (area->top + area->bottom) / 2;
    for (const auto& [to, end] : {std::pair(-2e5, low), {2e5, high}}) {
      press_at(x, y);
      draw();
      button(Kind::move, to, y);
      draw();
      release_at(to, y);
      EXPECT_NEAR(value(), end, 1e-6 * std::abs(high));
    }
  }
  /// A list, of which each line sets a value. Escape closes it and changes nothing.
  void expect_chooses(const std::string& list, const std::vector<std::string>& lines,
                      const std::function<std::string()>& value) {
    const std::string before = value();
    for (const std::string& line : lines) {
      choose(list, list + " " + line);
      EXPECT_EQ(value(), line);
      push(list);
      EXPECT_TRUE(data().places.list);
      tap(Key::escape);
      EXPECT_FALSE(data().places.list);
      EXPECT_EQ(value(), line) << "after Escape";
    }
    choose(list, list + " " + before);
    EXPECT_EQ(value(), before);
  }
  template <typename Enum, std::size_t count>
  void expect_chooses(const std::string& list, const Word<Enum> (&words)[count], const std::function<Enum()>& value) {
    std::vector<std::string> lines;
    for (const Word<Enum>& word : words)
      lines.emplace_back(word.word);
    expect_chooses(list, lines, [&] { return std::string(word_of(words, value())); });
  }

  std::set<std::string> drawn_;
};

/// A name that ends with * is that of all widgets that begin so.
struct Row {
  std::string widget;
  std::function<void()> works;
};
using Rows = std::vector<Row>;

inline bool is_of(const Row& row, const std::string& widget) {
  const std::string_view name = row.widget;
  return name.ends_with('*') ? widget.starts_with(name.substr(0, name.size() - 1)) : widget == name;
}

class EveryWidget : public WidgetsOfApp {
 protected:
  /// Tries each of the rows, which are of what is open now.
  void expect_all(const Rows& rows);
  /// What was drawn so far is in one of the tables.
  void expect_known();

  // ---- the tables ------------------------------------------------------------------------------------------------
  Rows heading_rows();
  Rows view_rows();
  Rows participant_rows();
  Rows sound_rows();
  Rows touch_rows();
  Rows place_rows();
  Rows run_rows();
  Rows recording_rows();
  Rows empty_rows();
  Rows picker_rows();
  Rows opening_rows();

  Row heading(const std::string& name) {
    return {name, [this, name] {
              unfold(name);
              expect_toggles(name, [&] { return data().headings.at(name); });
            }};
  }
  Vec3 eye() const {
    const Viewpoint& viewpoint = view().viewpoint;
    return glm::normalize(basis(viewpoint).eye - viewpoint.target);
  }
  Row standpoint(const std::string& name, const Vec3& from) {
    return {name, [this, name, from] {
              push(name);
              EXPECT_LT(glm::distance(eye(), from), 1e-3);
            }};
  }
  void come_near() {
    button(Kind::move, 200, 1500);
    draw();
    for (int i = 0; i < 10; ++i)
      send({.kind = Kind::scroll, .x = 200, .y = 1500, .steps = 1});
    draw();
  }
  const Participant& setting() const { return data().participant.setting.value(); }
  const Playback& playback() const { return data().content.run.playback.value(); }
  bool playing() const { return data().content.run.playback.has_value(); }
  void move_object();
  /// Types a text in place of that of a field.
  void write(const std::string& field, const std::string& text, Key end) {
    push(field);
    key('a', true);
    draw();
    send({.kind = Kind::key, .key = key_of('a'), .down = false});
    send({.kind = Kind::text, .text = text});
    draw();
    tap(end);
  }
  void make_empty() {
    ViewerOptions options;
    options.given = {{"--backend", {"cpu"}}, {"--layout", {"autd3"}}, {"--link", {"heard"}}, {"--noise-free", {}}};
    now_s_ = 0;
    make(options);
    draw();
  }
  /// How often the empty window has opened a recording. A line that is still in sight is not said again.
  auto recordings() {
    now_s_ += 7;
    go_round();
    return std::ranges::count_if(data().messages.log(), [](const log::Line& line) {
      return line.text.find("plays with the object that you open next") != std::string::npos;
    });
  }
  void open_picker() {
    if (!data().picker) push("open a file");
    ASSERT_TRUE(data().picker);
  }
};

}  // namespace palpa::viewer
