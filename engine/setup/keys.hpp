// Keys that somebody presses while palpa runs: on a terminal, or from a script.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpa::setup {

enum class Key { left, right, up, down, away, nearer, finer, back, save, leave, wait };

struct KeyPress {
  Key key;
  bool fine = false;  ///< with shift
  bool operator==(const KeyPress&) const = default;
};

/// From the bytes that terminals send: arrows, PageUp (away) and PageDown (nearer), with shift too, f (finer), 0
/// (back), Enter (save), q (leave). Other keys are nothing.
class KeyReader {
 public:
  /// Appends what has become complete with these bytes.
  void feed(std::string_view bytes, std::vector<KeyPress>& keys);

 private:
  void end_sequence(std::vector<KeyPress>& keys);

  std::string sequence_;  ///< of a key that sends several bytes, as far as it came
};

/// "right*3 shift+up pageup f enter": left, right, up, down, pageup, pagedown, shift+ any of these, f, 0, enter, q, and
/// wait, which presses nothing; commas or spaces between them. Throws bad_usage naming the word; at most 100000 keys.
std::vector<KeyPress> parse_keys(const std::string& option, const std::string& text);

/// The terminal that stdin is, handing over each key when it is pressed and showing none of them, while it lives.
/// Ctrl-C and its like remain signals. It is restored on every way out that a program can take itself: by the
/// destructor, and where an Interrupt ends the program. One at a time.
class RawTerminal {
 public:
  /// Throws bad_usage with `fault` where stdin is no terminal.
  explicit RawTerminal(const std::string& fault);
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// What has been pressed since, without waiting.
  std::string read();
  /// Whatever has been pressed up to now has not been.
  void forget();
};

}  // namespace palpa::setup
