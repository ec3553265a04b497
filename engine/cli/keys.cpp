#include "cli/keys.hpp"

#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "setup/process/interrupt.hpp"

namespace palpa::cli {
namespace {

constexpr char escape = '\x1b';
constexpr std::size_t longest_sequence = 16;
constexpr std::size_t most_keys = 100'000;

struct Named {
  std::string_view name;
  Key key;
  bool moves;  ///< with shift: smaller steps
};
constexpr Named named[] = {{"left", Key::left, true}, {"right", Key::right, true}, {"up", Key::up, true},
                           {"down", Key::down, true}, {"pageup", Key::away, true}, {"pagedown", Key::nearer, true},
                           {"f", Key::finer, false},  {"0", Key::back, false},     {"enter", Key::save, false},
                           {"q", Key::leave, false},  {"wait", Key::wait, false}};

Error unknown(const std::string& option, std::string_view word) {
  return bad_usage(fmt::format(
      "{}: unknown key '{}'; the known keys are left, right, up, down, pageup, pagedown, any of these with shift+, "
      "f, 0, enter, q and wait, each with *TIMES",
      option, printable(word, 40)));
}

/// Adds one word of a script, as often as it is repeated.
void add_word(const std::string& option, std::string_view word, std::vector<KeyPress>& keys) {
  std::string_view name = word;
  std::uint32_t times = 1;
  if (const std::size_t star = word.find('*'); star != std::string_view::npos) {
    name = word.substr(0, star);
    times = parse_whole<std::uint32_t>(word.substr(star + 1)).value_or(0);
    if (times == 0) throw unknown(option, word);
  }
  constexpr std::string_view shift = "shift+";
  const bool fine = name.starts_with(shift);
  if (fine) name.remove_prefix(shift.size());
  const auto found = std::find_if(std::begin(named), std::end(named), [&](const Named& n) { return n.name == name; });
  if (found == std::end(named) || (fine && !found->moves)) throw unknown(option, word);
  if (times > most_keys || keys.size() + times > most_keys)
    throw bad_usage(fmt::format("{}: more than {} keys", option, most_keys));
  keys.insert(keys.end(), times, {found->key, fine});
}

termios terminal_before;

/// May be called from any thread.
void restore_terminal() {
  tcsetattr(STDIN_FILENO, TCSANOW, &terminal_before);
}

}  // namespace

std::vector<KeyPress> parse_keys(const std::string& option, const std::string& text) {
  std::vector<KeyPress> keys;
  constexpr std::string_view between = ", \t\n";
  for (std::size_t at = text.find_first_not_of(between); at != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(between, at), text.size());
    add_word(option, std::string_view(text).substr(at, end - at), keys);
    at = text.find_first_not_of(between, end);
  }
  return keys;
}

void KeyReader::feed(std::string_view bytes, std::vector<KeyPress>& keys) {
  for (const char byte : bytes) {
    if (byte == escape) {  // even within another sequence, which is then discarded
      sequence_ = byte;
      continue;
    }
    if (!sequence_.empty()) {
      sequence_ += byte;
      // ESC [ or ESC O, parameters, and a last byte that is a letter or ~.
      if (sequence_.size() == 2) {
        if (byte != '[' && byte != 'O') sequence_.clear();
      } else if ((byte >= '@' && byte <= '~')) {
        end_sequence(keys);
      } else if (sequence_.size() >= longest_sequence) {
        sequence_.clear();
      }
      continue;
    }
    switch (byte) {
      case '\r':
      case '\n':
        keys.push_back({Key::save});
        break;
      case 'q':
        keys.push_back({Key::leave});
        break;
      case 'f':
        keys.push_back({Key::finer});
        break;
      case '0':
        keys.push_back({Key::back});
        break;
      default:
        break;
    }
  }
}

void KeyReader::end_sequence(std::vector<KeyPress>& keys) {
  const std::string_view parameters = std::string_view(sequence_).substr(2, sequence_.size() - 3);
  const char last = sequence_.back();
  const bool fine = parameters.ends_with(";2");
  constexpr std::array<std::pair<char, Key>, 4> arrows{
      {{'A', Key::up}, {'B', Key::down}, {'C', Key::right}, {'D', Key::left}}};
  const auto arrow = std::find_if(arrows.begin(), arrows.end(), [&](const auto& a) { return a.first == last; });
  if (arrow != arrows.end()) keys.push_back({arrow->second, fine});
  if (last == '~' && parameters.starts_with('5')) keys.push_back({Key::away, fine});
  if (last == '~' && parameters.starts_with('6')) keys.push_back({Key::nearer, fine});
  sequence_.clear();
}

RawTerminal::RawTerminal(const std::string& fault) {
  if (tcgetattr(STDIN_FILENO, &terminal_before) != 0) throw bad_usage(fault);
  termios raw = terminal_before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_iflag &= ~static_cast<tcflag_t>(IXON);  // Ctrl-S would stop the display
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  setup::Interrupt::at_the_end(restore_terminal);
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

RawTerminal::~RawTerminal() {
  restore_terminal();
  setup::Interrupt::at_the_end(nullptr);
}

void RawTerminal::forget() {
  tcflush(STDIN_FILENO, TCIFLUSH);
}

std::string RawTerminal::read() {
  std::array<char, 256> bytes;
  const ssize_t got = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  return got > 0 ? std::string(bytes.data(), static_cast<std::size_t>(got)) : std::string();
}

}  // namespace palpa::cli
