// Contacts beyond the edges of a shell, around fingers that are about to end.
#pragma once

#include <cstdint>

#include "shaders/touch/contacts/reach.h"

namespace palpa::touch {

/// Fingers of the frame before around which contacts reach beyond the shell's edges.
struct FingerReach {
  const shader::ReachTable* table = nullptr;  ///< null or empty: no contact may lie beyond the edges
  std::uint32_t elapsed_us = 0;               ///< from the frame before to this one
};

}  // namespace palpa::touch
