// How options are called in the panels.
#include <gtest/gtest.h>

#include <cctype>
#include <set>

#include "viewer/live/live_line.hpp"
#include "viewer/panel_data/option_words.hpp"

namespace palpa::viewer {
namespace {

std::vector<line::OptionInfo> all_options() {
  std::vector<line::OptionInfo> all = live_table();
  all.insert(all.end(), copied_table().begin(), copied_table().end());
  return all;
}

/// Whether a word of the text is one of the placeholders of --help.
bool has_placeholder(const std::string& text) {
  for (const char* word : {"DIR", "FILE", "NUMBER", "LENGTH", "TIME", "WORD", "NAME", "INDEX", "SOURCE", "LINK",
                           "[:", "HOST", "PORT", "MESH", "SERIAL", "CELSIUS"}) {
    if (text.find(word) != std::string::npos) return true;
  }
  return text == "N";
}

TEST(OptionWords, EveryOptionHasALabelOfItsOwnWithoutPlaceholders) {
  std::set<std::string> labels;
  for (const line::OptionInfo& info : all_options()) {
    const OptionWords words = words_of(info);
    EXPECT_FALSE(words.label.empty()) << info.name;
    EXPECT_FALSE(words.label.starts_with("--")) << info.name;
    EXPECT_FALSE(has_placeholder(label_of(words))) << info.name << ": " << label_of(words);
    EXPECT_FALSE(has_placeholder(words.about)) << info.name << ": " << words.about;
    EXPECT_FALSE(has_placeholder(shown_default(info))) << info.name << ": " << shown_default(info);
    EXPECT_TRUE(labels.insert(words.label).second) << words.label << " is there twice";
    EXPECT_LE(words.label.size(), 24u) << words.label;
  }
}

TEST(OptionWords, EveryWordIsExplained) {
  for (const line::OptionInfo& info : live_table()) {
    for (const std::string& word : info.words)
      EXPECT_FALSE(meaning_of(info.name, word).empty()) << info.name << " " << word;
  }
}

TEST(OptionWords, ABareNumberGetsTheUnitOfTheLabel) {
  const OptionWords dwell = words_of({.name = "--dwell"});
  EXPECT_EQ(label_of(dwell), "dwell, ms");
  EXPECT_EQ(with_unit("2", dwell), "2ms");
  EXPECT_EQ(with_unit("0.5", dwell), "0.5ms");
  EXPECT_EQ(with_unit("2s", dwell), "2s");
  EXPECT_EQ(with_unit("auto", words_of({.name = "--hold"})), "auto");
  EXPECT_EQ(with_unit("7", words_of({.name = "--foci"})), "7");
}

TEST(OptionWords, TheUnitIsOneThatTheOptionTakes) {
  for (const line::OptionInfo& info : live_table()) {
    const OptionWords words = words_of(info);
    if (words.unit.empty()) continue;
    const std::string number = words.unit == "m/s" ? "340" : words.unit == "kHz" ? "40" : "0.4";
    EXPECT_NO_THROW(values_of({{info.name, {with_unit(number, words)}}})) << info.name;
  }
}

}  // namespace
}  // namespace palpa::viewer
