#include "driver/links.hpp"

#include "driver/board.hpp"
#include "driver/guard/board_link.hpp"

namespace palpa::driver {

std::vector<session::LinkKind> links() {
  std::vector<session::LinkKind> all;
  for (const BoardKind& kind : board_kinds())
    all.push_back(board_link(kind));
  return all;
}

}  // namespace palpa::driver
