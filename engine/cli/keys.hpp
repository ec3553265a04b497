// Keys that are pressed while palpa runs, on a terminal or from a script.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "setup/tasks/nudge.hpp"

namespace palpa::cli {

using Key = setup::NudgeKey;
using KeyPress = setup::NudgePress;

/// Decodes the bytes that terminals send: arrows, PageUp (away) and PageDown (nearer), also with shift, f (finer), 0
/// (back), Enter (save), q (leave). Other keys are ignored.
class KeyReader {
 public:
  /// Appends the keys that these bytes complete.
  void feed(std::string_view bytes, std::vector<KeyPress>& keys);

 private:
  void end_sequence(std::vector<KeyPress>& keys);

  std::string sequence_;  ///< the bytes received so far of a key that sends several
};

/// "right*3 shift+up pageup f enter": left, right, up, down, pageup, pagedown, shift+ any of these, f, 0, enter, q, and
/// wait, which presses nothing. Words are separated by commas or spaces. At most 100000 keys. Throws bad_usage naming
/// the word.
std::vector<KeyPress> parse_keys(const std::string& option, const std::string& text);

/// Puts the terminal at stdin into a mode that delivers each key when it is pressed and echoes none. Ctrl-C and similar
/// keys remain signals. The terminal is restored however palpa exits by itself: by the destructor, and also if an
/// Interrupt ends the program. Only one object may exist at a time.
class RawTerminal {
 public:
  /// Throws bad_usage with `fault` if stdin is not a terminal.
  explicit RawTerminal(const std::string& fault);
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// The bytes received since the last call, without waiting.
  std::string read();
  /// Discards all keys pressed so far.
  void forget();
};

}  // namespace palpa::cli
