// Dear ImGui behind an interface of plain values: window events in, a sheet of triangles out. One at a time.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "viewer/hands/controls.hpp"
#include "viewer/picture/sheet.hpp"

namespace palpa::viewer {

class Ui {
 public:
  /// `dark` as the picture's background. `copy` puts text where other programs find it, `paste` asks for it; neither:
  /// within this program.
  explicit Ui(bool dark, std::function<void(const std::string&)> copy = {}, std::function<std::string()> paste = {});
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  void set_dark(bool dark);

  /// Whether panels want the event for themselves: the pointer is over one, or text is being typed. They see every
  /// event with the next begin(), but for a key's repetitions. `on_text`: a button is pressed where text is typed, so
  /// that the keys that follow are text even where no picture comes between.
  bool take(const WindowEvent& event, bool on_text = false);
  /// What was taken and not yet seen by a picture has never been; a button that is held down is no click any more.
  void forget();

  /// A new picture, of that many pixels, `ratio` of them to a point, `seconds` after the last. What ImGui:: functions
  /// are called between begin() and end() is what it shows.
  void begin(double width, double height, double ratio, double seconds);
  /// Valid until the next begin().
  const Sheet& end();

  /// Whether another picture would look different by itself: a cursor that blinks, events that have not been seen.
  bool restless() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::viewer
