// "name" or "name:argument", the form of links and sources on the command line.
#pragma once

#include <span>
#include <string>

#include "base/error.hpp"

namespace palpa::session {

struct Spec {
  std::string name;
  std::string argument;
};

inline Spec parse_spec(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, {}};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// The kind of that name. Throws bad_usage with all kinds' help if there is none; `what` is "link" or "source".
template <typename Kind>
const Kind& find_kind(std::span<const Kind> kinds, const std::string& name, const char* what) {
  std::string known;
  for (const Kind& kind : kinds) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : "; ") + kind.help;
  }
  throw bad_usage(std::string("unknown ") + what + " '" + name + "'; known are " + known);
}

}  // namespace palpa::session
