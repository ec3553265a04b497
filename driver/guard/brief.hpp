// What a guard gets when it is started: which board, with which settings, for which layout. It is passed as bytes,
// because the guard is another process.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "driver/board.hpp"

namespace palpa::driver {

struct Brief {
  std::string kind;  ///< of board_kinds()
  BoardSpec board;
  bool only_silence = false;  ///< open, all off, close: after a guard that died
};

std::vector<std::byte> to_bytes(const Brief& brief);
/// Throws failure() for bytes that are not a brief of this version of palpa.
Brief brief_from(std::span<const std::byte> bytes);

}  // namespace palpa::driver
