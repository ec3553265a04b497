// Dear ImGui behind an interface of plain values: window events in, a sheet of triangles out. There is one at a time.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "viewer/hands/controls.hpp"
#include "viewer/picture/sheet.hpp"

namespace palpa::viewer {

class Ui {
 public:
  /// `dark` as the picture's background. `copy` gives text to other programs, `paste` gets it from them. Without both,
  /// text is copied only within this program.
  explicit Ui(bool dark, std::function<void(const std::string&)> copy = {}, std::function<std::string()> paste = {});
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  void set_dark(bool dark);
  /// The bytes of a TrueType font to be used from the next picture on. If they are invalid, palpa's own strokes are
  /// used.
  void use_font(std::string ttf);

  /// Whether the panels want the event for themselves: the pointer is over one, or text is being typed. They see every
  /// event at the next begin(), except for a key's repetitions. `on_text`: a button is pressed where text is typed, so
  /// the keys that follow are text even if no picture is drawn in between.
  bool take(const WindowEvent& event, bool on_text = false);
  /// Discards events that were taken but that no picture has seen yet. A button that is held down is not a click any
  /// more.
  void forget();

  /// Whether a list has dropped down.
  bool has_list() const;
  /// Closes the innermost list that has dropped down. Returns false if there is none.
  bool close_list();
  /// Lets go of what the pointer drags in a panel, such as a slider. Returns false if it drags nothing.
  bool let_go();

  /// Begins a picture of that many pixels, with `ratio` pixels per point, `seconds` after the last. It shows what the
  /// ImGui:: functions called between begin() and end() draw.
  void begin(double width, double height, double ratio, double seconds);
  /// Valid until the next begin().
  const Sheet& end();

  /// Whether the next picture would look different without new input: a cursor blinks, or events have not been seen.
  bool restless() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::viewer
