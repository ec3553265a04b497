#include "array/layouts/changes.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "array/layouts/board_types.hpp"

namespace palpa::array {

std::uint32_t ChangeSetting::periods() const {
  return static_cast<std::uint32_t>(std::clamp(slot_s * board_frequency_hz + 1e-9, 1.0, 1e9));
}

Changes changes_of(const BoardType* type, const ChangeSetting& setting) {
  const bool jumps = setting.nulls || type == nullptr || type->changes == nullptr;
  return jumps || (type->may_jump && !setting.steps) ? Changes() : type->changes(setting);
}

std::string why_fewer_steps(const BoardType* type, const ChangeSetting& setting) {
  if (type == nullptr || type->changes == nullptr || (type->may_jump && !setting.steps)) return {};
  const char* const avoid = type->may_jump ? "; --steps off avoids this warning" : "";
  if (setting.nulls) {
    return fmt::format(
        "with nulls, phases jump from drive to drive, because what lies between two drives is not silent there{}",
        avoid);
  }
  if (!type->may_jump) return {};
  const Changes changes = type->changes(setting);
  const std::uint32_t room = std::max(setting.periods() / changes.step_periods, 2U) - 1;
  if (changes.phase_steps >= room && room > 1) return {};
  const double slot_ms = 1e3 * setting.slot_s;
  if (room == 1) {
    return fmt::format("phases jump from drive to drive, because a dwell of {:g} ms has no room for steps{}", slot_ms,
                       avoid);
  }
  if (changes.phase_steps == 1)
    return fmt::format("phases jump from drive to drive, because the USB bus carries one frame for each drive{}",
                       avoid);
  ChangeSetting alone = setting;
  alone.boards_of_bus = 1;
  return fmt::format("phases change in the first {:g} ms of a dwell of {:g} ms, because {}",
                     25e-3 * changes.step_periods * changes.phase_steps, slot_ms,
                     type->changes(alone).phase_steps > changes.phase_steps ? "the USB bus carries no more steps"
                                                                            : "silence must not wait longer");
}

const BoardType* board_type_of(const Layout& layout) {
  const auto unlike = [&](const Board& board) { return board.type != layout.boards.front().type; };
  if (layout.boards.empty() || std::ranges::any_of(layout.boards, unlike)) return nullptr;
  return find_board_type(layout.boards.front().type);
}

double still_slot_s(const Layout& layout) {
  const BoardType* const type = board_type_of(layout);
  if (type == nullptr || type->still_slot_s == 0) return 0;
  const ChangeSetting setting{.slot_s = type->still_slot_s, .boards_of_bus = layout.boards.size()};
  return changes_of(type, setting).phase_steps > 1 ? type->still_slot_s : 0;
}

}  // namespace palpa::array
