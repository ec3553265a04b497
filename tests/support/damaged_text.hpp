// Texts with a few faults, as hands, programs and disks make them.
#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace palpa::test {

/// The text with up to four faults: characters that are others, more or missing, a part twice, its end cut off.
inline std::string damaged(std::string text, std::mt19937_64& random) {
  static const std::string alphabet = "[]{}=.,\"'#\n\\ \t019-+eEnaif_:TZ\x7f\xc3\xa9\xffx" + std::string(1, '\0');
  const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random() % end); };
  for (std::size_t faults = 1 + below(4); faults > 0 && !text.empty(); --faults) {
    const std::size_t at = below(text.size()), kind = below(17);
    if (kind == 16)
      text.resize(at + 1);
    else if (kind % 4 == 0)
      text[at] = alphabet[below(alphabet.size())];
    else if (kind % 4 == 1)
      text.erase(at, 1 + below(40));
    else if (kind % 4 == 2)
      text.insert(at, 1, alphabet[below(alphabet.size())]);
    else
      text.insert(at, text.substr(below(text.size()), below(60)));
  }
  return text;
}

}  // namespace palpa::test
