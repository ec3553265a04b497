#include "viewer/run/interact.hpp"

#include <fmt/core.h>

#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "base/words.hpp"

namespace palpa::viewer {
namespace {

constexpr Word<Button> button_words[] = {{"left", Button::left}, {"middle", Button::middle}, {"right", Button::right}};
constexpr Word<Key> named_keys[] = {
    {"tab", Key::tab},       {"left", Key::left},       {"right", Key::right},         {"up", Key::up},
    {"down", Key::down},     {"page-up", Key::page_up}, {"page-down", Key::page_down}, {"home", Key::home},
    {"end", Key::end},       {"delete", Key::del},      {"backspace", Key::backspace}, {"enter", Key::enter},
    {"escape", Key::escape}, {"f12", Key::f12},         {"space", Key::space}};

std::optional<Key> key_named(std::string_view name) {
  if (name.size() == 1 && name[0] > ' ' && name[0] < 127 && !(name[0] >= 'A' && name[0] <= 'Z')) return key_of(name[0]);
  return value_of(named_keys, name);
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
    text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
    text.remove_suffix(1);
  return text;
}

/// One line, word by word.
class Line {
 public:
  Line(std::string_view text, const std::string& file, std::uint32_t number)
      : rest_(trimmed(text)), file_(file), number_(number) {}

  bool empty() const { return rest_.empty(); }
  std::string_view word() {
    const std::size_t end = rest_.find_first_of(" \t");
    const std::string_view word = rest_.substr(0, end);
    rest_ = trimmed(end == std::string_view::npos ? std::string_view() : rest_.substr(end));
    return word;
  }
  std::string all() { return std::string(std::exchange(rest_, {})); }
  double number(const char* what, double low, double high) {
    const std::string_view text = word();
    const std::optional<double> value = parse_number(text);
    if (!value || *value < low || *value > high)
      throw wrong(fmt::format("'{}' is not a {}: give a number from {} to {}", printable(text, 40), what, low, high));
    return *value;
  }
  std::uint32_t whole(const char* what, std::uint32_t low, std::uint32_t high) {
    const double value = number(what, low, high);
    if (value != static_cast<std::uint32_t>(value)) throw wrong(fmt::format("{} must be a whole number", what));
    return static_cast<std::uint32_t>(value);
  }
  Button button() {
    const std::string_view text = word();
    if (const std::optional<Button> button = value_of(button_words, text)) return *button;
    throw wrong(fmt::format("'{}' is not a button: give {}", printable(text, 40), one_of(button_words)));
  }
  void modifiers(WindowEvent& event) {
    while (!empty()) {
      const std::string_view text = word();
      if (text != "shift" && text != "ctrl")
        throw wrong(fmt::format("'{}' is unexpected: only shift or ctrl may come here", printable(text, 40)));
      (text == "shift" ? event.shift : event.ctrl) = true;
    }
  }
  void end() {
    if (!empty()) throw wrong(fmt::format("'{}' is unexpected: nothing may come here", printable(rest_, 40)));
  }
  Error wrong(const std::string& fault) const { return bad_input(fmt::format("{}:{}", file_, number_), fault); }

 private:
  std::string_view rest_;
  const std::string& file_;
  std::uint32_t number_;
};

constexpr double most_pixels = 32768;

class Parser {
 public:
  explicit Parser(std::vector<Interaction>& out) : out_(out) {}

  void take(Line& line, std::uint32_t number) {
    number_ = number;
    const std::string_view verb = line.word();
    if (verb == "move") {
      x_ = line.number("place", -most_pixels, most_pixels);
      y_ = line.number("place", -most_pixels, most_pixels);
      add(pointer(WindowEvent::Kind::move));
    } else if (verb == "press" || verb == "release") {
      WindowEvent event = pointer(verb == "press" ? WindowEvent::Kind::press : WindowEvent::Kind::release);
      event.button = line.button();
      line.modifiers(event);
      add(event);
    } else if (verb == "click") {
      click(line);
    } else if (verb == "drag") {
      drag(line);
    } else if (verb == "scroll") {
      WindowEvent event = pointer(WindowEvent::Kind::scroll);
      event.steps = line.number("number of steps", -1000, 1000);
      line.modifiers(event);
      add(event);
    } else if (verb == "key") {
      key(line);
    } else if (verb == "type" || verb == "drop") {
      WindowEvent event;
      event.kind = verb == "type" ? WindowEvent::Kind::text : WindowEvent::Kind::drop;
      event.text = line.all();
      if (event.text.empty()) throw line.wrong(fmt::format("{} needs a value: the rest of the line", verb));
      add(event);
    } else if (verb == "resize") {
      Interaction& step = add(Interaction::Kind::resize);
      step.width = line.whole("width", 1, 16384);
      step.height = line.whole("height", 1, 16384);
    } else if (verb == "draw") {
      add(Interaction::Kind::draw).count = line.empty() ? 1 : line.whole("number of pictures", 1, 1'000'000);
    } else if (verb == "wait") {
      add(Interaction::Kind::wait).seconds = line.number("time in seconds", 0, 600);
    } else if (verb == "shot") {
      std::string file = line.all();
      if (file.empty()) throw line.wrong("shot needs a file");
      add(Interaction::Kind::shot).file = std::move(file);
    } else {
      // If no line was understood before, this may be any file, and nothing of it must be shown.
      throw line.wrong(fmt::format(
          "{} is not one of move, press, release, click, drag, scroll, key, type, drop, resize, draw, wait and shot",
          out_.empty() ? "the first word" : "'" + printable(verb, 40) + "'"));
    }
    line.end();
  }

 private:
  WindowEvent pointer(WindowEvent::Kind kind) const {
    WindowEvent event;
    event.kind = kind;
    event.x = x_;
    event.y = y_;
    return event;
  }
  Interaction& add(Interaction::Kind kind) {
    Interaction& step = out_.emplace_back();
    step.kind = kind;
    step.line = number_;
    return step;
  }
  void add(const WindowEvent& event) { add(Interaction::Kind::event).event = event; }
  void go(double x, double y, const WindowEvent& how = {}) {
    x_ = x;
    y_ = y;
    WindowEvent event = pointer(WindowEvent::Kind::move);
    event.shift = how.shift, event.ctrl = how.ctrl;
    add(event);
  }
  void click(Line& line) {
    const double x = line.number("place", -most_pixels, most_pixels);
    go(x, line.number("place", -most_pixels, most_pixels));
    add(Interaction::Kind::draw);  // what lies under the pointer is known only after a picture with the pointer there
    add(pointer(WindowEvent::Kind::press));
    add(Interaction::Kind::draw);
    add(pointer(WindowEvent::Kind::release));
    add(Interaction::Kind::draw);
  }
  void drag(Line& line) {
    double at[4];
    for (double& v : at)
      v = line.number("place", -most_pixels, most_pixels);
    WindowEvent how;
    if (!line.empty()) how.button = line.button();
    line.modifiers(how);
    go(at[0], at[1]);
    add(Interaction::Kind::draw);
    WindowEvent event = pointer(WindowEvent::Kind::press);
    event.button = how.button, event.shift = how.shift, event.ctrl = how.ctrl;
    add(event);
    go((at[0] + at[2]) / 2, (at[1] + at[3]) / 2, how);
    add(Interaction::Kind::draw);
    go(at[2], at[3], how);
    event = pointer(WindowEvent::Kind::release);
    event.button = how.button;
    add(event);
    add(Interaction::Kind::draw);
  }
  void key(Line& line) {
    WindowEvent event = pointer(WindowEvent::Kind::key);
    const std::string_view name = line.word();
    const std::optional<Key> key = key_named(name);
    if (!key) throw line.wrong(fmt::format("unknown key '{}'", printable(name, 40)));
    event.key = *key;
    line.modifiers(event);
    add(event);
    add(Interaction::Kind::draw);
    event.down = false;
    add(event);
  }

  std::vector<Interaction>& out_;
  std::uint32_t number_ = 0;
  double x_ = 0, y_ = 0;
};

}  // namespace

std::vector<Interaction> parse_interactions(std::string_view text, const std::string& file) {
  std::vector<Interaction> steps;
  Parser parser(steps);
  std::uint32_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view here = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    // A '#' begins a comment at the line's beginning or after a space: paths may have one.
    for (std::size_t at = here.find('#'); at != std::string_view::npos; at = here.find('#', at + 1)) {
      if (at != 0 && here[at - 1] != ' ' && here[at - 1] != '\t') continue;
      here = here.substr(0, at);
      break;
    }
    Line line(here, file, ++number);
    if (!line.empty()) parser.take(line, number);
  }
  return steps;
}

std::vector<Interaction> load_interactions(const std::string& file) {
  constexpr std::uint64_t most = 16 << 20;
  return parse_interactions(read_text_file(file, most), file);
}

}  // namespace palpa::viewer
