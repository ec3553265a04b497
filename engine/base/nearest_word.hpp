// Finds the word that a mistyped one stands for, for "did you mean touch?".
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpa {

/// The word of `known` that differs least from `word`. A difference is a letter that is missing, extra, wrong, or
/// swapped with the next one. At most a third of the letters may differ, but always one; otherwise the result is empty.
/// If several words are equally near, the result is the first of them.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

}  // namespace palpa
