// The texts that guide a person through a task.
#pragma once

#include <string>

namespace palpa::viewer {

struct Guidance {
  std::string title;  ///< "focus 3 of 8"
  std::string text;   ///< what to do
  std::string fault;  ///< what kept the last key from its effect; empty: nothing
  std::string keys;   ///< what they do, and where the focus is
};

}  // namespace palpa::viewer
