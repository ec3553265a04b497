#include "session/plan/setting.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"

namespace palpa::session {

std::vector<sensing::Slab> slabs_of(const array::Layout& layout) {
  std::vector<sensing::Slab> slabs;
  for (const array::Board& board : layout.boards)
    slabs.push_back({sensing::NoSkin::board, board.width_m, board.height_m, board.T_layout_board});
  return slabs;
}

sensing::Surroundings surroundings_of(const SessionSetting& setting) {
  sensing::Surroundings all = setting.surroundings;
  if (setting.keep_boards) return all;
  const std::vector<sensing::Slab> boards = slabs_of(setting.layout);
  all.slabs.insert(all.slabs.begin(), boards.begin(), boards.end());
  return all;
}

bool drops_points(const SessionSetting& setting) {
  const bool learned =
      std::ranges::any_of(setting.cameras, [](const auto& camera) { return camera.background != nullptr; });
  return !setting.cameras.empty() && (learned || !surroundings_of(setting).empty());
}

void check_run(const SessionSetting& setting, bool asks_for_events, const char* what) {
  if (setting.schedule.tune == Tune::all) {
    throw bad_usage(fmt::format("a session that {} can tune strides only: the length of its slots is fixed", what));
  }
  if (asks_for_events && !setting.events) throw bad_usage("a session whose setting has no events cannot report any");
}

}  // namespace palpa::session
