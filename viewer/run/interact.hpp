// Scripts: what is done to a window, as lines of text that people can read and write. `palpa-viewer --interact FILE`
// plays them.
//
//   # a comment, up to the end of the line; empty lines mean nothing
//   move X Y                  the pointer, pixels from the top left
//   press left|middle|right [shift] [ctrl]      where the pointer is
//   release left|middle|right
//   click X Y                 move, press left, draw, release left: as a hand does it
//   drag X0 Y0 X1 Y1 [BUTTON] [shift] [ctrl]    all of a drag, in two moves
//   scroll STEPS [shift] [ctrl]                 where the pointer is; positive away from the user
//   key NAME [shift] [ctrl]   a character or tab, left, right, up, down, page-up, page-down, home, end, delete,
//                             backspace, enter, escape, space, f12; pressed, drawn, released
//   type TEXT                 what was typed, to the end of the line
//   drop PATH                 a file or folder, to the end of the line
//   resize W H                of the window, pixels
//   draw [N]                  N pictures, 1 if none is given
//   wait SECONDS              of the program's clock, drawing meanwhile: 0 to 600
//   shot FILE                 what was drawn last, as PNG
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/hands/controls.hpp"

namespace palpa::viewer {

struct Interaction {
  enum class Kind { event, draw, wait, resize, shot };
  Kind kind = Kind::draw;
  WindowEvent event{};
  std::uint32_t count = 1;              ///< of draw
  double seconds = 0;                   ///< of wait
  std::uint32_t width = 0, height = 0;  ///< of resize
  std::string file{};                   ///< of shot
  std::uint32_t line = 0;               ///< from 1
};

/// For a line that is not valid, throws bad_input that names `file` and the line.
std::vector<Interaction> parse_interactions(std::string_view text, const std::string& file);
std::vector<Interaction> load_interactions(const std::string& file);

}  // namespace palpa::viewer
