// What mouse and keyboard do, without knowing where they come from: a window, a recording, a test.
#pragma once

#include "viewer/viewpoint.hpp"

namespace palpa::viewer {

enum class Button { left, middle, right };
enum class Key { other, one, three, five, seven, frame, space, quit };

/// One thing that happened to a window. Positions are pixels from its top left.
struct WindowEvent {
  enum class Kind { press, release, move, scroll, key, damage };
  Kind kind = Kind::damage;  ///< damage: the window must be drawn anew
  double x = 0, y = 0;       ///< pointer; for scroll, y is the number of steps, positive away from the user
  Button button = Button::left;
  bool shift = false;
  Key key = Key::other;
};

/// What the program is to do after an event.
enum class Reply { nothing, redraw, quit, toggle_pause };

/// Left-drag orbits, wheel zooms, middle- or shift-drag pans, 1 3 7 are front, right and top, 5 toggles the projection,
/// F frames everything, space pauses, Escape and q quit.
class Controls {
 public:
  /// `home` is what F frames. `width` and `height` are the window's.
  Reply handle(const WindowEvent& event, Viewpoint& viewpoint, const Box& home, double width, double height);

 private:
  enum class Drag { none, orbit, pan };
  Drag drag_ = Drag::none;
  double x_ = 0, y_ = 0;
};

}  // namespace palpa::viewer
