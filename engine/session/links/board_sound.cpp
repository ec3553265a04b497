#include "session/links/board_sound.hpp"

#include <fmt/core.h>

#include <mutex>

#include "base/text.hpp"

namespace palpa::session {
namespace {

struct Known {
  std::string name;
  std::atomic<BoardSound> sound{BoardSound::unknown};
  Known* next = nullptr;
};

/// Boards are only added, and never freed: the end of a program may look at them at any time.
std::atomic<Known*> newest_board{nullptr};

template <typename Visit>
void each_board(Visit visit) {
  for (Known* board = newest_board; board != nullptr; board = board->next)
    visit(*board);
}

}  // namespace

std::atomic<BoardSound>& board_sound(const std::string& name) {
  static std::mutex adding;
  const std::lock_guard lock(adding);
  Known* found = nullptr;
  each_board([&](Known& board) { found = board.name == name ? &board : found; });
  if (found == nullptr) {
    found = new Known{name};
    found->next = newest_board;
    newest_board = found;
  }
  return found->sound;
}

std::string to_text(const std::string& name, BoardSound sound) {
  const std::string array = fmt::format("the array ({})", printable(name, 80));
  constexpr const char* advice = ": it may still sound, switch it off";
  switch (sound) {
    case BoardSound::silent:
      return array + " is silent";
    case BoardSound::told:
      return array + " was told to be silent, but has not answered" + advice;
    case BoardSound::gone:
      return array + " is out of reach" + advice;
    default:
      return fmt::format("it is not known whether {} is silent{}", array, advice);
  }
}

std::string with_board_sounds(std::string_view line) {
  std::string text(line);
  each_board([&](const Known& board) {
    const std::string sound = to_text(board.name, board.sound);
    if (line.find(sound) == std::string_view::npos) text += "; " + sound;
  });
  return text;
}

std::string boards_that_may_sound() {
  std::string text;
  each_board([&](const Known& board) {
    const BoardSound sound = board.sound;
    if (sound == BoardSound::silent) return;
    text += (text.empty() ? "" : "; ") + to_text(board.name, sound);
  });
  return text;
}

}  // namespace palpa::session
