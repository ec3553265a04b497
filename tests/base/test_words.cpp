// The words of enums, in both directions, and the word that a mistyped one stands for.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/nearest_word.hpp"
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

TEST(NearestWord, IsOneThatDiffersInAThirdOfItsLetters) {
  const std::vector<std::string> known{"touch", "run", "drive", "calibrate"};
  const auto nearest = [&](const char* word) { return nearest_word(word, known); };
  EXPECT_EQ(nearest("tuoch"), "touch");   // swapped
  EXPECT_EQ(nearest("tuch"), "touch");    // missing
  EXPECT_EQ(nearest("touuch"), "touch");  // extra
  EXPECT_EQ(nearest("toych"), "touch");   // wrong
  EXPECT_EQ(nearest("rum"), "run");
  EXPECT_EQ(nearest("calibarte"), "calibrate");
  EXPECT_EQ(nearest("callibratte"), "calibrate");
  EXPECT_EQ(nearest("toxyz"), "");
  EXPECT_EQ(nearest("r"), "");
  EXPECT_EQ(nearest(""), "");
  EXPECT_EQ(nearest_word(std::string(100'000, 'x'), known), "");
}

}  // namespace
}  // namespace palpa
