// Pieces of messages. Names come from files, so they must not break a line or flood it.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "base/math.hpp"
#include "base/text.hpp"

namespace palpa::geometry::text {

/// The name in quotes, without control characters, at most 60 bytes long.
inline std::string quoted(std::string_view name) {
  return '"' + printable(name, 60) + '"';
}

inline std::string point(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

}  // namespace palpa::geometry::text
