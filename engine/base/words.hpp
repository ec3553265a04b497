// The words of an enum, each written once and used by options, help texts and results.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpa {

/// A value and its word. The table of an enum stands beside the enum, in the order in which help lists the words:
///   inline constexpr Word<Solver> solver_words[] = {{"naive", Solver::naive}, {"greedy", Solver::greedy}};
template <typename Enum>
struct Word {
  const char* word;
  Enum value;
};

/// The word of a value; empty if it is not in the table.
template <typename Enum, std::size_t count>
constexpr std::string_view word_of(const Word<Enum> (&words)[count], std::type_identity_t<Enum> value) {
  for (const Word<Enum>& entry : words) {
    if (entry.value == value) return entry.word;
  }
  return "";
}

/// The value of a word, if the table has it.
template <typename Enum, std::size_t count>
constexpr std::optional<Enum> value_of(const Word<Enum> (&words)[count], std::string_view word) {
  for (const Word<Enum>& entry : words) {
    if (entry.word == word) return entry.value;
  }
  return std::nullopt;
}

/// A list of the valid words for a message: "naive, gs-pat or greedy".
template <typename Enum, std::size_t count>
std::string one_of(const Word<Enum> (&words)[count]) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i)
    text += std::string(i == 0 ? "" : i + 1 == count ? " or " : ", ") + words[i].word;
  return text;
}

}  // namespace palpa
