// What a guard is told when it is started: which board, with what, for which layout. As bytes, for it is another
// process.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "array/layout.hpp"

namespace palpa::driver {

struct Brief {
  std::string kind;      ///< of board_kinds()
  std::string argument;  ///< as in BoardSetting
  std::string files;
  array::Layout layout;
  double slot_s = 1.5e-3;
  bool foci_move = true;
  double sound_speed_m_s = 343.21;
  double ramp_s = 0;
  bool only_silence = false;  ///< open, all off, close: after a guard that died
};

std::vector<std::byte> to_bytes(const Brief& brief);
/// Throws failure() for bytes that are no brief of this version of palpa.
Brief brief_from(std::span<const std::byte> bytes);

}  // namespace palpa::driver
