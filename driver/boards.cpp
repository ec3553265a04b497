#include "driver/board.hpp"

namespace palpa::driver {

std::vector<BoardKind> board_kinds() {
  return {};
}

}  // namespace palpa::driver
