#include "driver/openmpd/board_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace palpa::driver::openmpd {
namespace {

constexpr std::uint64_t most_bytes = 1 << 20;

/// The file's tokens, one after the other.
class Tokens {
 public:
  Tokens(std::string name, std::string_view text) : name_(std::move(name)), text_(text) {}

  bool ended() {
    while (at_ < text_.size() && parts(text_[at_])) {
      if (text_[at_] == '\n') ++line_;
      ++at_;
    }
    return at_ == text_.size();
  }
  std::string_view next(std::string_view wanted) {
    if (ended()) throw fault(fmt::format("expected {}; the file ends there", wanted));
    const std::size_t first = at_;
    while (at_ < text_.size() && !parts(text_[at_]))
      ++at_;
    return text_.substr(first, at_ - first);
  }
  double number(std::string_view wanted, double low, double high) {
    const std::string_view token = next(wanted);
    const std::optional<double> value = parse_number(token);
    if (!value || *value < low || *value > high) {
      // Until it is recognised as a board file, it may be any file, and nothing of it must be shown.
      const std::string there = recognised_ ? fmt::format("\"{}\"", printable(token, 40)) : "something else";
      throw fault(fmt::format("expected {}, a number from {} to {}; found {}", wanted, low, high, there));
    }
    return *value;
  }
  int whole(std::string_view wanted, int low, int high) {
    const double value = number(wanted, low, high);
    if (value != std::floor(value)) throw fault(fmt::format("expected {}, a whole number", wanted));
    return static_cast<int>(value);
  }
  /// Call when what has been read can only be the beginning of a board file.
  void recognised() { recognised_ = true; }
  Error fault(const std::string& what) const { return bad_input(name_, fmt::format("line {}: {}", line_, what)); }

 private:
  static bool parts(char c) { return std::string_view(" \t\r\n,;()").find(c) != std::string_view::npos; }

  std::string name_;
  std::string_view text_;
  std::size_t at_ = 0;
  unsigned line_ = 1;
  bool recognised_ = false;
};

void read_positions(Tokens& tokens) {
  constexpr double pitch = 0.0105, slack = 1e-4;
  for (std::size_t t = 0; t < transducers; ++t) {
    const std::size_t x = t / 16, y = t % 16;
    const double expected[] = {(static_cast<double>(x) - 7.5) * pitch, (7.5 - static_cast<double>(y)) * pitch, 0};
    for (const double there : expected) {
      const double here = tokens.number(fmt::format("the position of transducer {}", t), -1, 1);
      if (std::abs(here - there) > slack) {
        throw tokens.fault(fmt::format("transducer {} is at {} m; on an OpenMPD board it is at {} m", t, here, there));
      }
    }
  }
}

void read_pins(Tokens& tokens) {
  for (std::size_t t = 0; t < transducers; ++t) {
    const int pin = tokens.whole(fmt::format("the pin of transducer {}", t), 0, 255);
    if (pin != pin_of(t)) {
      throw tokens.fault(fmt::format("transducer {} is wired to pin {}; on an OpenMPD board it is wired to pin {}", t,
                                     pin, pin_of(t)));
    }
  }
}

}  // namespace

BoardFile read_board_file(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, most_bytes);
  Tokens tokens(file.string(), text);
  BoardFile board;
  board.file = file;
  board.serial = printable(tokens.next("the board's serial number"), 64);
  tokens.whole("the number of transducers", transducers, transducers);
  tokens.whole("the number of phase steps", 128, 128);
  tokens.recognised();
  read_positions(tokens);
  read_pins(tokens);
  for (std::size_t t = 0; t < transducers; ++t)
    board.calibration.degrees[t] =
        tokens.whole(fmt::format("the phase offset of transducer {} in degrees", t), -3600, 3600);
  for (std::size_t t = 0; t < transducers; ++t) {
    board.calibration.factors[t] =
        static_cast<float>(tokens.number(fmt::format("the amplitude factor of transducer {}", t), 0, 1));
  }
  if (!tokens.ended()) throw tokens.fault("the file continues after the 256 amplitude factors, where it should end");
  return board;
}

std::vector<BoardFile> read_board_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> names;
  std::error_code code;
  for (std::filesystem::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    if (entry->path().extension() == ".pat") names.push_back(entry->path());
  }
  if (code)
    throw bad_input(folder.string(), fmt::format("cannot be read as a folder of board files: {}", code.message()));
  if (names.empty()) throw bad_input(folder.string(), "has no board files; they are named board_NAME.pat");
  std::sort(names.begin(), names.end());
  std::vector<BoardFile> files;
  files.reserve(names.size());
  for (const auto& name : names)
    files.push_back(read_board_file(name));
  return files;
}

Calibration calibration_of(const std::vector<BoardFile>& files, const std::string& serial) {
  const BoardFile* found = nullptr;
  for (const BoardFile& file : files) {
    if (file.serial != serial) continue;
    if (found != nullptr && !(found->calibration == file.calibration)) {
      throw bad_input(
          file.file.string(),
          fmt::format("has the same serial number {} as {}, but other values: keep only the file of that board", serial,
                      found->file.filename().string()));
    }
    found = &file;
  }
  return found == nullptr ? Calibration{} : found->calibration;
}

}  // namespace palpa::driver::openmpd
