#include "driver/autd3/board.hpp"
#include "driver/autd3_udp/board.hpp"
#include "driver/board.hpp"
#include "driver/openmpd/board.hpp"
#include "driver/sonicsurface/board.hpp"

namespace palpa::driver {

std::vector<BoardKind> board_kinds() {
  return {autd3::board_kind(), autd3_udp::board_kind(), openmpd::board_kind(), sonicsurface::board_kind()};
}

}  // namespace palpa::driver
