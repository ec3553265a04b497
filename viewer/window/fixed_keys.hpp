// The keys of GLFW that are the same on every keyboard.
#pragma once

#include <GLFW/glfw3.h>

#include <optional>
#include <utility>

#include "viewer/hands/controls.hpp"

namespace palpa::viewer {

inline constexpr std::pair<int, Key> keys_without_text[] = {{GLFW_KEY_TAB, Key::tab},
                                                            {GLFW_KEY_LEFT, Key::left},
                                                            {GLFW_KEY_RIGHT, Key::right},
                                                            {GLFW_KEY_UP, Key::up},
                                                            {GLFW_KEY_DOWN, Key::down},
                                                            {GLFW_KEY_PAGE_UP, Key::page_up},
                                                            {GLFW_KEY_PAGE_DOWN, Key::page_down},
                                                            {GLFW_KEY_HOME, Key::home},
                                                            {GLFW_KEY_END, Key::end},
                                                            {GLFW_KEY_DELETE, Key::del},
                                                            {GLFW_KEY_BACKSPACE, Key::backspace},
                                                            {GLFW_KEY_ENTER, Key::enter},
                                                            {GLFW_KEY_KP_ENTER, Key::enter},
                                                            {GLFW_KEY_ESCAPE, Key::escape},
                                                            {GLFW_KEY_F12, Key::f12}};

/// Digits, also from the number pad, its + and -, and the keys that type nothing. nullopt for all others.
inline std::optional<Key> fixed_key(int key) {
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) return key_of(static_cast<char>('0' + key - GLFW_KEY_KP_0));
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return key_of(static_cast<char>(key));
  if (key == GLFW_KEY_KP_ADD) return key_of('+');
  if (key == GLFW_KEY_KP_SUBTRACT) return key_of('-');
  for (const auto& [theirs, ours] : keys_without_text) {
    if (key == theirs) return ours;
  }
  return std::nullopt;
}

}  // namespace palpa::viewer
