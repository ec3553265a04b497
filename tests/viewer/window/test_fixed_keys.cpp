// What the keys of a keyboard are to the viewer.
#define GLFW_INCLUDE_NONE
#include "viewer/window/fixed_keys.hpp"

#include <gtest/gtest.h>

#include <set>

namespace palpa::viewer {
namespace {

TEST(FixedKeys, TheNumberPadIsAsTheMainKeyboard) {
  for (int digit = 0; digit < 10; ++digit) {
    EXPECT_EQ(fixed_key(GLFW_KEY_KP_0 + digit), key_of(static_cast<char>('0' + digit)));
    EXPECT_EQ(fixed_key(GLFW_KEY_0 + digit), key_of(static_cast<char>('0' + digit)));
  }
  EXPECT_EQ(fixed_key(GLFW_KEY_KP_ENTER), Key::enter);
  EXPECT_EQ(fixed_key(GLFW_KEY_KP_ADD), key_of('+'));
  EXPECT_EQ(fixed_key(GLFW_KEY_KP_SUBTRACT), key_of('-'));
}

TEST(FixedKeys, EveryKeyThatTypesNothingIsOnTheKeyboard) {
  std::set<Key> keys;
  for (int key = GLFW_KEY_SPACE; key <= GLFW_KEY_LAST; ++key) {
    if (const std::optional<Key> known = fixed_key(key)) keys.insert(*known);
  }
  for (char key = character_of(Key::tab); key <= character_of(Key::f12); ++key)
    EXPECT_TRUE(keys.contains(key_of(key))) << static_cast<int>(key);
  EXPECT_FALSE(fixed_key(GLFW_KEY_Z)) << "where it is depends on the layout";
}

}  // namespace
}  // namespace palpa::viewer
