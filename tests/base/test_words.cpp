// The words of enums, in both directions.
#include <gtest/gtest.h>

#include "base/words.hpp"

namespace palpa {
namespace {

enum class Size { small, middling, large };
constexpr Word<Size> size_words[] = {{"small", Size::small}, {"middling", Size::middling}, {"large", Size::large}};
enum class Way { on };
constexpr Word<Way> way_words[] = {{"on", Way::on}};

TEST(Words, LeadFromValuesAndBack) {
  for (const auto& [word, size] : size_words) {
    EXPECT_EQ(word_of(size_words, size), word);
    EXPECT_EQ(value_of(size_words, word), size);
  }
  for (const char* other : {"", "Small", "smal", "small "})
    EXPECT_EQ(value_of(size_words, other), std::nullopt) << other;
  EXPECT_EQ(word_of(size_words, Size(7)), "");
}

TEST(Words, AreListedInAMessage) {
  EXPECT_EQ(one_of(size_words), "small, middling or large");
  EXPECT_EQ(one_of(way_words), "on");
}

}  // namespace
}  // namespace palpa
