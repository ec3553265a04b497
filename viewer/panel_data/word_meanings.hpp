// What the words mean that an option can be set to.
#pragma once

#include <string>

namespace palpa::viewer {

/// One part of a sentence: "one focus in the middle of the contacts, modulated". Empty for a word that needs no
/// explanation.
std::string meaning_of(const std::string& option, const std::string& word);

}  // namespace palpa::viewer
