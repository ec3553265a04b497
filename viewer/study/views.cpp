#include "viewer/study/views.hpp"

namespace palpa::viewer {

std::string button_key(std::size_t button) {
  return std::string(1, static_cast<char>(button < 9 ? '1' + button : 'a' + (button - 9)));
}

std::optional<std::size_t> button_of_key(char key) {
  if (key >= '1' && key <= '9') return static_cast<std::size_t>(key - '1');
  if (key >= 'a' && key <= 'z') return static_cast<std::size_t>(key - 'a') + 9;
  return std::nullopt;
}

}  // namespace palpa::viewer
