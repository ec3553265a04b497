// Pieces of messages. Names come from files: they must not break the line nor flood it.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "base/math.hpp"

namespace palpa::geometry::text {

/// The name in quotes, without control characters, at most 60 bytes of it.
inline std::string quoted(std::string_view name) {
  std::size_t length = name.size() < 60 ? name.size() : 60;
  // Not in the middle of a UTF-8 character.
  while (length < name.size() && length > 0 && (static_cast<unsigned char>(name[length]) & 0xc0) == 0x80)
    --length;
  std::string out = "\"";
  for (const char c : name.substr(0, length))
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  if (length < name.size()) out += "...";
  return out + "\"";
}

inline std::string point(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

}  // namespace palpa::geometry::text
