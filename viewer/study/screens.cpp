#include "viewer/study/screens.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "drawing/canvas.hpp"
#include "drawing/ink.hpp"

namespace palpa::viewer {
namespace {

using drawing::Align;
using drawing::Colour;

const Colour screen_paper = drawing::rgb(0x14181d), screen_ink = drawing::rgb(0xf1f4f7),
             screen_pale = drawing::rgb(0xa9b4c0), button_fill = drawing::rgb(0x2d3742),
             button_rim = drawing::rgb(0x6f8196), warning_ink = drawing::rgb(0xffb454),
             sounding_lamp = drawing::rgb(0xe5484d), silent_lamp = drawing::rgb(0x3d4a57);

/// All lengths of the participant's window are in this unit, so that the text is as large on every screen.
double unit_of(std::uint32_t width, std::uint32_t height) {
  return std::max(0.25, std::min(width / 64.0, height / 40.0));
}
/// And those of the experimenter's, which is read from near by.
double small_unit_of(std::uint32_t width, std::uint32_t height) {
  return std::max(0.25, std::min(width / 90.0, height / 52.0));
}

/// Lines no wider than that. A word that is wider has a line of its own.
std::vector<std::string> lines_of(std::string_view text, double height, double width) {
  std::vector<std::string> lines;
  std::string line;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string word(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    std::string longer = line;
    if (!line.empty()) longer += ' ';
    longer += word;
    if (line.empty() || drawing::text_width(longer, height) <= width) {
      line = longer;
    } else {
      lines.push_back(std::exchange(line, word));
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

/// Text in lines, with letters as large as they may be.
struct Lines {
  std::vector<std::string> lines;
  double letters = 0, step = 0;  ///< height of a letter, and from line to line
  double high() const { return step * static_cast<double>(lines.size()); }
};

/// No wider and no higher than that, if letters of half the size are enough for it.
Lines fitted_lines(std::string_view text, double unit, double width, double height) {
  Lines fitted;
  for (double part = 1; part >= 0.5; part -= 0.05) {
    fitted.letters = 1.15 * unit * part;
    fitted.step = 2.4 * unit * part;
    fitted.lines = lines_of(text, fitted.letters, width);
    if (fitted.high() <= height) break;
  }
  return fitted;
}

/// The highest row of a picture in which there is anything on its ground; its height if there is nothing.
std::uint32_t highest_row(const drawing::Pixels& picture) {
  const auto differs = [&](std::size_t at) {
    return !std::equal(picture.at(0, 0), picture.at(0, 0) + 3, &picture.rgba[at]);
  };
  for (std::size_t at = 0; at < picture.rgba.size(); at += 4) {
    if (differs(at)) return static_cast<std::uint32_t>(at / 4 / picture.width);
  }
  return picture.height;
}

std::uint32_t whole(double value, std::uint32_t most) {
  return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(most)));
}

/// The part of it within a window of that size.
ButtonPlace rectangle(double left, double top, double wide, double high, std::uint32_t width, std::uint32_t height) {
  return {whole(left, width - 1), whole(top, height - 1), whole(left + wide, width - 1), whole(top + high, height - 1)};
}

class ScreenPage {
 public:
  explicit ScreenPage(drawing::Canvas& canvas) : canvas_(canvas), pen_(1, screen_paper, strokes_) {}

  void text(std::string_view words, const Vec2& at, double height, const Colour& colour, Align align) {
    pen_.text(words, at, height, colour, align);
  }
  void box(const ButtonPlace& place, const Colour& fill, const Colour& edge) {
    if (place.right <= place.left + 4 || place.bottom <= place.top + 4) return;
    canvas_.fill(place.left, place.top, place.right, place.bottom, edge);
    canvas_.fill(place.left + 2, place.top + 2, place.right - 2, place.bottom - 2, fill);
  }

  /// Text lies on all boxes.
  const drawing::Pixels& pixels() {
    canvas_.draw(strokes_);
    strokes_.clear();
    return canvas_.pixels();
  }

 private:
  drawing::Canvas& canvas_;
  std::vector<shader::ViewStroke> strokes_;
  drawing::Ink pen_;
};

/// The text is as small as it must be to fit.
double fitted(std::string_view words, double height, double width) {
  const double wide = drawing::text_width(words, height);
  return wide > width ? height * width / wide : height;
}

}  // namespace

std::vector<ButtonPlace> button_places(const ParticipantView& view, std::uint32_t width, std::uint32_t height) {
  const std::size_t count = view.buttons.size();
  if (count == 0) return {};
  const double unit = unit_of(width, height);
  const std::size_t columns = count <= 4 ? count : (count + (count > 8 ? 3 : 1)) / (count > 8 ? 4 : 2);
  const std::size_t rows = (count + columns - 1) / columns;
  const double gap = unit, room = width - 8 * unit;
  const double wide =
      std::min(14 * unit, (room - gap * static_cast<double>(columns - 1)) / static_cast<double>(columns));
  const double high = std::min(7 * unit, (17 * unit - gap * static_cast<double>(rows - 1)) / static_cast<double>(rows));
  const double all = wide * static_cast<double>(columns) + gap * static_cast<double>(columns - 1);
  std::vector<ButtonPlace> places;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const double left = (width - all) / 2 + static_cast<double>(column) * (wide + gap);
    const double top = height / 2.0 + static_cast<double>(row) * (high + gap);
    places.push_back(rectangle(left, top, wide, high, width, height));
  }
  return places;
}

std::vector<ButtonPlace> button_places(const ExperimenterView& view, std::uint32_t width, std::uint32_t height) {
  const double unit = small_unit_of(width, height), wide = 22 * unit, high = 5 * unit, gap = 2 * unit;
  std::vector<ButtonPlace> places;
  for (std::size_t i = 0; i < view.buttons.size(); ++i) {
    const double left = 3 * unit + static_cast<double>(i) * (wide + gap), top = height - 3 * unit - high;
    places.push_back(rectangle(left, top, wide, high, width, height));
  }
  return places;
}

std::optional<std::size_t> button_at(const std::vector<ButtonPlace>& places, double x, double y) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ButtonPlace& place = places[i];
    if (x >= place.left && x <= place.right && y >= place.top && y <= place.bottom) return i;
  }
  return std::nullopt;
}

drawing::Pixels draw(const ParticipantView& view, std::uint32_t width, std::uint32_t height,
                     const drawing::Pixels* scene) {
  drawing::Canvas canvas = scene != nullptr ? drawing::Canvas(*scene) : drawing::Canvas(width, height, screen_paper);
  const double unit = unit_of(width, height), margin = (scene != nullptr ? 2.6 : 3) * unit;
  // Over a scene, at its edges; otherwise above the middle, where the buttons are.
  const double room = scene != nullptr ? highest_row(*scene) - 1.5 * unit : height / 2.0 - 4.5 * unit;
  const Lines text = fitted_lines(view.text, unit, width - 8 * unit, room);
  double y = scene != nullptr ? margin : std::max(margin, height / 2.0 - 3 * unit - text.high());
  if (scene != nullptr) {
    canvas.fill(0, 0, width - 1, whole(y + text.high() - text.letters, height - 1), screen_paper);
    if (!view.hint.empty()) canvas.fill(0, whole(height - 4 * unit, height - 1), width - 1, height - 1, screen_paper);
  }
  const std::vector<ButtonPlace> places = button_places(view, width, height);
  ScreenPage page(canvas);
  for (const std::string& line : text.lines) {
    page.text(line, {width / 2.0, y}, text.letters, screen_ink, Align::centre);
    y += text.step;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ButtonPlace& place = places[i];
    page.box(place, button_fill, button_rim);
    const double middle = (place.left + place.right) / 2.0, wide = place.right - place.left - unit;
    const double centre = (place.top + place.bottom) / 2.0;
    const double letters = 1.15 * unit, key = 0.7 * unit;
    if (place.bottom - place.top > 4.5 * unit) {
      page.text(view.buttons[i], {middle, centre + 0.2 * unit}, fitted(view.buttons[i], letters, wide), screen_ink,
                Align::centre);
      page.text(button_key(i), {middle, place.bottom - key}, key, screen_pale, Align::centre);
    } else {
      // There is no room for the key below the label.
      page.text(view.buttons[i], {middle, centre + letters / 2}, fitted(view.buttons[i], letters, wide - 4 * key),
                screen_ink, Align::centre);
      page.text(button_key(i), {place.left + key, centre + key / 2}, key, screen_pale, Align::left);
    }
  }
  const double hint_y = scene != nullptr ? height - 1.5 * unit : height / 2.0 + 3 * unit;
  if (!view.hint.empty())
    page.text(view.hint, {width / 2.0, hint_y}, fitted(view.hint, unit, width - 4 * unit), screen_pale, Align::centre);
  return page.pixels();
}

drawing::Pixels draw(const ExperimenterView& view, std::uint32_t width, std::uint32_t height) {
  drawing::Canvas canvas(width, height, screen_paper);
  const double unit = small_unit_of(width, height), letters = 0.95 * unit, step = 2.1 * unit, names = 3 * unit,
               values = 16 * unit;
  const std::vector<ButtonPlace> places = button_places(view, width, height);
  ScreenPage page(canvas);
  page.text(view.title, {names, 3 * unit}, fitted(view.title, 1.1 * unit, width - 6 * unit), screen_pale, Align::left);
  page.text(view.state, {names, 6.5 * unit}, 1.7 * unit, screen_ink, Align::left);
  const ButtonPlace lamp{whole(width - 24 * unit, width - 1), whole(4.4 * unit, height - 1),
                         whole(width - 3 * unit, width - 1), whole(7.4 * unit, height - 1)};
  const Colour lamp_fill = view.may_sound || view.sounds ? sounding_lamp : silent_lamp;
  page.box(lamp, lamp_fill, lamp_fill);
  const char* lamp_text = view.may_sound ? "may sound: switch it off" : view.sounds ? "the array sounds" : "silence";
  page.text(lamp_text, {(lamp.left + lamp.right) / 2.0, 6.4 * unit},
            fitted(lamp_text, unit, lamp.right - lamp.left - unit), screen_ink, Align::centre);
  const double last = height - 10 * unit;
  double y = 10 * unit;
  for (const StateLine& line : view.lines) {
    page.text(line.name, {names, y}, letters, screen_pale, Align::left);
    for (const std::string& part : lines_of(line.value, letters, width - values - 3 * unit)) {
      if (y > last) break;
      page.text(part, {values, y}, letters, line.warns ? warning_ink : screen_ink, Align::left);
      y += step;
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ButtonPlace& place = places[i];
    page.box(place, button_fill, button_rim);
    const std::string words = view.buttons[i].label + "  (" + view.buttons[i].key + ")";
    page.text(words, {(place.left + place.right) / 2.0, (place.top + place.bottom) / 2.0 + 0.5 * unit},
              fitted(words, unit, place.right - place.left - unit), screen_ink, Align::centre);
  }
  return page.pixels();
}

}  // namespace palpa::viewer
