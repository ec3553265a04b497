// `palpa-guard`: holds a board for a `palpa` that may end in any way. Started by palpa, never by hand.
#include "driver/board.hpp"
#include "driver/guard/guard.hpp"

int main() {
  palpa::driver::guard_main(palpa::driver::board_kinds());
}
