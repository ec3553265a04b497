// Every option of a run has a field in the panels: what is chosen or typed there is in the options, Escape leaves what
// was there, and the button beside it gives the default back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <string>

#include "every_widget.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/panel_data/option_words.hpp"

namespace palpa::viewer {

/// In the empty window nothing runs, so each option can be set alone.
class EveryField : public WidgetsOfApp {
 protected:
  EveryField() {
    make({});
    unfold("Run");
  }
  std::optional<std::string> text(const line::OptionInfo& info) const { return data().content.edit.text(info.name); }
  std::string command() const { return data().content.edit.command(); }
  /// It differs from the default, and from the number 7 with a unit.
  static std::string value_for(const line::OptionInfo& info);

  void expect_works(const line::OptionInfo& info);
  void expect_reset(const line::OptionInfo& info);
  void expect_words(const line::OptionInfo& info);
  void expect_text(const line::OptionInfo& info);
  void expect_list(const line::OptionInfo& info);
  void expect_picker(const line::OptionInfo& info, const std::string& widget);
};

std::string EveryField::value_for(const line::OptionInfo& info) {
  const std::map<std::string, std::string> values{{"LENGTH", "6"},
                                                  {"TIME", "6"},
                                                  {"TIME|auto", "6"},
                                                  {"FREQUENCY", "41"},
                                                  {"SPEED", "340m/s"},
                                                  {"PRESSURE", "600"},
                                                  {"CELSIUS", "30"},
                                                  {"NUMBER", "0.6"},
                                                  {"N", "6"},
                                                  {"X,Y,Z[,R]", "0.1,0,0"},
                                                  {"PORT|ADDRESS:PORT", "9001"}};
  const auto found = values.find(info.type);
  return found == values.end() ? "some.thing" : found->second;
}

void EveryField::expect_reset(const line::OptionInfo& info) {
  push(info.name + " reset");
  EXPECT_FALSE(text(info));
  EXPECT_FALSE(is_drawn(info.name + " reset")) << "the default has nothing to reset";
}

void EveryField::expect_words(const line::OptionInfo& info) {
  for (const std::string& word : info.words) {
    const bool initial = word == info.initial;
    choose(info.name, info.name + " " + word + (initial ? "  (default)" : ""));
    EXPECT_EQ(text(info), initial ? std::nullopt : std::optional(word));
    const std::string before = command();
    push(info.name);
    tap(Key::escape);
    EXPECT_FALSE(data().places.list);
    EXPECT_EQ(command(), before) << "after Escape";
  }
  if (!text(info)) choose(info.name, info.name + " " + info.words[info.words[0] == info.initial ? 1 : 0]);
  expect_reset(info);
}

void EveryField::expect_text(const line::OptionInfo& info) {
  const std::string before = command(), typed = value_for(info);
  push(info.name);
  send({.kind = Kind::text, .text = "7"});
  draw();
  tap(Key::escape);
  EXPECT_EQ(command(), before) << "after Escape";
  type(info.name, typed);
  const std::string unit = words_of(info).unit;
  EXPECT_EQ(text(info), std::isdigit(static_cast<unsigned char>(typed.back())) ? typed + unit : typed);
  EXPECT_NE(command(), before);
}

void EveryField::expect_picker(const line::OptionInfo& info, const std::string& widget) {
  const FieldKind kind = words_of(info).kind;
  push(widget);
  ASSERT_TRUE(data().picker) << widget;
  EXPECT_EQ(data().picker->option, info.name);
  EXPECT_EQ(data().picker->is_new,
            kind == FieldKind::new_file || kind == FieldKind::new_folder || kind == FieldKind::link);
  const std::string prefix = data().picker->prefix;
  type("name", "chosen.thing");
  EXPECT_FALSE(data().picker);
  ASSERT_TRUE(text(info));
  EXPECT_TRUE(text(info)->starts_with(prefix) && text(info)->ends_with("chosen.thing")) << *text(info);
}

/// Each line of the list beside a field.
void EveryField::expect_list(const line::OptionInfo& info) {
  const std::string list = info.name + " list";
  std::map<std::string, std::string> values{{"mouse: the pointer holds a fingertip", "mouse"},
                                            {"synthetic: a fingertip that dips by itself", "synthetic"},
                                            {"joints: hands from a tracker's program", "joints:udp:9000"},
                                            {"foci:udp: to a program on this computer", "foci:udp:127.0.0.1:9000"}};
  for (const NamedFile& file : data().objects)
    values[file.name] = file.path;
  for (const NamedFile& file : data().rigs)
    values[file.name] = file.path;
  for (const std::string& layout : data().layouts)
    values[layout] = layout;
  push(list);
  std::vector<std::string> lines;
  for (const auto& [name, area] : data().places.named) {
    if (name.starts_with(info.name + " ") && name != list && name != info.name + " reset") lines.push_back(name);
  }
  tap(Key::escape);
  EXPECT_GE(lines.size(), 3u);
  for (const std::string& line : lines) {
    SCOPED_TRACE(line);
    push(list);
    const std::string label = line.substr(info.name.size() + 1);
    if (label.ends_with(" ...")) {
      expect_picker(info, line);
      EXPECT_TRUE(label.find(':') == std::string::npos ||
                  text(info)->starts_with(label.substr(0, label.find(':') + 1)));
      continue;
    }
    push(line);
    if (label.ends_with("  (default)")) {
      EXPECT_FALSE(text(info));
    } else {
      ASSERT_TRUE(values.contains(label));
      EXPECT_EQ(text(info), values[label]);
    }
  }
}

void EveryField::expect_works(const line::OptionInfo& info) {
  EXPECT_FALSE(text(info));
  if (info.flag) {
    expect_toggles(info.name, [&] { return text(info).has_value(); });
    push(info.name);
    return expect_reset(info);
  }
  if (!info.words.empty()) return expect_words(info);
  expect_text(info);
  expect_reset(info);
  const FieldKind kind = words_of(info).kind;
  EXPECT_EQ(is_drawn(info.name + " list"), kind == FieldKind::object || kind == FieldKind::rig ||
                                               kind == FieldKind::layout || kind == FieldKind::source ||
                                               kind == FieldKind::link);
  if (is_drawn(info.name + " list")) expect_list(info);
  if (is_drawn(info.name + " file")) expect_picker(info, info.name + " file");
  if (text(info)) expect_reset(info);
}

TEST_F(EveryField, SetsItsOption) {
  std::string open;
  const auto tries = [&](const line::OptionInfo& info, const std::string& heading) {
    if (heading != open) {
      if (!open.empty()) push(open);
      unfold(open = heading);
    }
    SCOPED_TRACE(info.name);
    expect_works(info);
  };
  for (const line::OptionInfo& info : live_table())
    tries(info, info.heading);
  for (const line::OptionInfo& info : copied_table())
    tries(info, "Only in the copied command");
  EXPECT_EQ(command(), "palpa run") << "all is as it was";
  const auto is_of_option = [](const std::string& widget) {
    const std::string name = widget.substr(0, widget.find(' '));
    return std::ranges::find(live_table(), name, &line::OptionInfo::name) != live_table().end() ||
           std::ranges::find(copied_table(), name, &line::OptionInfo::name) != copied_table().end();
  };
  for (const std::string& widget : drawn_)
    EXPECT_TRUE(!widget.starts_with("--") || is_of_option(widget)) << widget;
}

}  // namespace palpa::viewer
