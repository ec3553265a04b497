// What this process knows of the sound of its boards. Whatever ends a program says it, so the links write it down where
// any thread can read it without a lock, also while the thread of a link waits.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpa::session {

enum class BoardSound : std::uint8_t {
  silent,   ///< all off was the last data on its wire
  unknown,  ///< drives have gone to it since
  told,     ///< it was told to be silent, and it is not known whether that arrived
  gone      ///< the same, and it takes nothing
};

/// What is known of the board behind the link `name` (`openmpd:SERIAL`). The link writes it, first when the board is
/// open. It exists until the process ends.
std::atomic<BoardSound>& board_sound(const std::string& name);

/// "the array (openmpd:SERIAL) is silent", or what else is known, and what to do.
std::string to_text(const std::string& name, BoardSound sound);

/// The line, and then what is known of each board that this process has opened, unless the line says that already.
std::string with_board_sounds(std::string_view line);

/// What is known of the boards that may still sound; empty if there are none.
std::string boards_that_may_sound();

}  // namespace palpa::session
