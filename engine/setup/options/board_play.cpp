#include "setup/options/board_play.hpp"

#include <fmt/core.h>

#include <cmath>

#include "array/layouts/board_types.hpp"
#include "array/layouts/changes.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "touch/methods/method.hpp"

namespace palpa::setup {

void take_method_of_boards(TouchOptions& touch, double least_s, const std::string& boards, bool own_method) {
  touch.steady_gains = true;
  if (touch.dwell_s >= least_s) return;
  if (touch.method_given || touch::stands_still(touch.method.method)) return;
  const char* const instead =
      own_method
          ? "your own method must place one focus, which does not move; if it places more, give"
          : "palpa plays --method single-focus, whose focus does not move; give --method single-focus to avoid this "
            "warning, or";
  log::warning(fmt::format("{}: takes {:.1f} ms for each focus, longer than the dwell of {:g} ms, so {} --dwell {:g}ms",
                           boards, 1e3 * least_s, 1e3 * touch.dwell_s, instead, std::ceil(1e3 * least_s)));
  touch.method.method = touch::Method::single_focus;
}

void take_dwell_of_boards(TouchOptions& touch, const array::Layout& layout, Steps steps) {
  if (steps == Steps::off || touch.dwell_given || !touch::stands_still(touch.method.method)) return;
  if (const double slot_s = array::still_slot_s(layout); slot_s > 0) touch.dwell_s = slot_s;
}

void take_play_of_boards(TouchOptions& touch, const array::Layout& layout, Steps steps, bool own_method) {
  const array::BoardType* const type = array::board_type_of(layout);
  if (type != nullptr && type->moving_slot_s != nullptr) {
    const double least_s = type->moving_slot_s(layout.boards.size());
    if (touch.method_given && !touch::stands_still(touch.method.method) && touch.dwell_s < least_s) {
      throw bad_usage(
          fmt::format("--audible: {} boards take {:.1f} ms for each focus, so a dwell of {:g} ms is too short for foci "
                      "that move; use --dwell {:g}ms, or --method single-focus",
                      type->title, 1e3 * least_s, 1e3 * touch.dwell_s, std::ceil(1e3 * least_s)));
    }
    take_method_of_boards(touch, least_s, "--layout " + layout.name, own_method);
  }
  take_dwell_of_boards(touch, layout, steps);
}

}  // namespace palpa::setup
