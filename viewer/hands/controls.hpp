// What mouse and keyboard do to the view. The events may come from a window, a script or a test.
#pragma once

#include <cstdint>
#include <string>

#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {

enum class Button { left, middle, right };

/// A key that types a character has the value of that character, letters in lower case. These are the other keys.
enum class Key : char {
  other = 0,
  tab = 1,
  left,
  right,
  up,
  down,
  page_up,
  page_down,
  home,
  end,
  del,
  backspace,
  enter,
  escape,
  f12,
  space = ' ',
};
constexpr Key key_of(char character) {
  return static_cast<Key>(character);
}
/// The same backwards, also for the other keys.
constexpr char character_of(Key key) {
  return static_cast<char>(key);
}

/// One event of a window. Positions are pixels from its top left.
struct WindowEvent {
  enum class Kind { press, release, move, scroll, key, text, drop, damage };
  Kind kind = Kind::damage;  ///< damage: the window must be drawn again
  std::int64_t at_ns = 0;    ///< when the window heard of it, on the steady clock; 0: not a window's
  double x = 0, y = 0;       ///< pointer
  double steps = 0;          ///< of scroll, positive away from the user
  Button button = Button::left;
  bool shift = false, ctrl = false;
  Key key = Key::other;
  bool down = true;     ///< of key: pressed or repeated, else released
  bool repeat = false;  ///< of key: a repetition, because it is held down
  std::string text{};   ///< of text: what was typed, UTF-8; of drop: a file's or folder's path
};

/// What the program must do after an event.
enum class Reply { nothing, redraw };

/// Left-drag orbits, the wheel zooms towards the pointer, middle- or shift-drag pans. 1, 3 and 7 are front, right and
/// top, with Ctrl their opposites; 9 is from a corner. 5 toggles the projection, F frames everything.
class Controls {
 public:
  /// `home` is what F frames. `width` and `height` are the window's.
  Reply handle(const WindowEvent& event, Viewpoint& viewpoint, const Box& home, double width, double height);

 private:
  Reply key(const WindowEvent& event, Viewpoint& viewpoint, const Box& home, double aspect);

  enum class Drag { none, orbit, pan };
  Drag drag_ = Drag::none;
  double x_ = 0, y_ = 0;
};

/// Like zoom(), but the point under the pointer, at the target's depth, stays where it is.
void zoom_at(Viewpoint& viewpoint, double steps, double x, double y, double width, double height);

}  // namespace palpa::viewer
