// What the array does now, in words.
#pragma once

#include <string>

#include "viewer/panel_data/content.hpp"

namespace palpa::viewer {

enum class ArrayState {
  off,       ///< no run drives it
  silent,    ///< a run drives it, and nothing sounds
  sounding,  ///< a drive that sounds has just arrived at it
  unknown,   ///< it takes no drives, and may play its last sound on
};

struct ArrayStatus {
  ArrayState state = ArrayState::off;
  std::string word;  ///< OFF, SILENT, SOUNDING or MAY SOUND
  std::string more;  ///< the link, or why it is off
};
ArrayStatus array_status(const Content& content);

}  // namespace palpa::viewer
