#include "base/log.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/stream_writer.hpp"
#include "base/text.hpp"

namespace palpa::log {
namespace {

std::atomic<Level> threshold{Level::warning};

/// Maximum length of a line in bytes.
constexpr std::size_t longest_line = 500;

std::string line_of(Level at, std::string_view line) {
  // Names from files may contain anything; an event stays on one line.
  const std::string text = fmt::format("palpa: {}: {}", word_of(level_words, at), one_line(line));
  return shortened(text, longest_line) + '\n';
}

/// State shared by all relays.
struct Relayed {
  std::mutex mutex;
  int relays = 0;
  std::optional<StreamWriter> writer;  ///< exists while there are relays
  std::uint64_t left_out = 0;

  bool add(std::string_view text) {
    try {
      return writer->add(text);
    } catch (const Error&) {  // a closed pipe: there is no reader
      return false;
    }
  }
  /// The line that reports dropped lines; empty if there were none.
  std::string left_out_line() const {
    if (left_out == 0) return {};
    const bool one = left_out == 1;
    return line_of(Level::warning,
                   fmt::format("{} line{} left out here: nobody read them", left_out, one ? " was" : "s were"));
  }
  void tell_left_out() {
    if (left_out > 0 && add(left_out_line())) left_out = 0;
  }
};
Relayed& relayed() {
  static Relayed instance;
  return instance;
}

/// The contents of a Tail.
struct Kept {
  std::mutex mutex;
  std::atomic<bool> on{false};
  std::deque<Line> lines;
};
Kept& kept() {
  static Kept instance;
  return instance;
}

void keep(Level at, std::string_view line) {
  Kept& k = kept();
  if (!k.on || at > Level::info) return;
  const std::lock_guard lock(k.mutex);
  if (k.lines.size() == Tail::most) k.lines.pop_front();
  k.lines.push_back({at, shortened(one_line(line), longest_line)});
}

/// Blocks until the reader has taken the text.
void put(std::string_view text) {
  std::size_t written = 0;
  write_all(STDERR_FILENO, text, written);  // a failure cannot be reported anywhere
}

/// `least`: the lowest level of the log at which the line is written, usually `at`.
void write(Level at, std::string_view line, Level least) {
  keep(at, line);
  if (least > threshold.load(std::memory_order_relaxed)) return;
  // One write per line keeps lines from different threads apart.
  std::string text = line_of(at, line);
  Relayed& r = relayed();
  {
    const std::lock_guard lock(r.mutex);
    if (r.writer) {
      r.tell_left_out();
      r.left_out += r.left_out > 0 || !r.add(text) ? 1 : 0;
      return;
    }
    text.insert(0, r.left_out_line());
    r.left_out = 0;
  }
  put(text);
}

void write(Level at, std::string_view line) {
  write(at, line, at);
}

/// A malicious file may cause any number of different warnings.
constexpr std::size_t most_kept = 1000;

/// The warnings of one run of a program.
struct Warnings {
  struct Line {
    std::string text;
    std::uint64_t times = 0, told = 0;
  };
  std::mutex mutex;
  bool holding = false, counting = false;
  std::vector<Line> lines;
  std::unordered_map<std::string, std::size_t> index;  ///< indices into lines, by text
  std::uint64_t others = 0;                            ///< warnings beyond the limit of lines
};
Warnings& warnings() {
  static Warnings instance;
  return instance;
}

/// Counts `line`; returns whether it should be written at once.
bool count(std::string_view line) {
  Warnings& w = warnings();
  const std::lock_guard lock(w.mutex);
  if (!w.counting) return true;
  const auto found = w.index.find(std::string(line));
  if (found != w.index.end()) {
    ++w.lines[found->second].times;
    return false;
  }
  if (w.lines.size() == most_kept) {
    ++w.others;
    return false;
  }
  w.index.emplace(line, w.lines.size());
  w.lines.push_back({std::string(line), 1, w.holding ? 0u : 1u});
  return !w.holding;
}

/// The warnings not yet written; marks them as written.
std::vector<std::string> untold() {
  Warnings& w = warnings();
  const std::lock_guard lock(w.mutex);
  w.holding = false;
  std::vector<std::string> texts;
  for (Warnings::Line& line : w.lines) {
    if (line.told == line.times) continue;
    line.told = line.times;
    texts.push_back(line.times == 1 ? line.text : fmt::format("{} ({} times)", line.text, line.times));
  }
  if (w.others > 0) texts.push_back("and " + counted(w.others, "more warning"));
  w.others = 0;
  return texts;
}

void start_counting(bool holding) {
  Warnings& w = warnings();
  const std::lock_guard lock(w.mutex);
  w.holding = w.counting = holding;
  w.others = 0;
  w.lines.clear();
  w.index.clear();
}

}  // namespace

void set_level(Level level) {
  threshold = level;
}
Level level() {
  return threshold;
}

void error(std::string_view line) {
  write(Level::error, line);
  // A program often ends right after it.
  constexpr double patience_s = 0.1;
  Relayed& r = relayed();
  const std::lock_guard lock(r.mutex);
  try {
    if (r.writer) r.writer->flush({.seconds = patience_s});
  } catch (const Error&) {  // a closed pipe
  }
}
void warning(std::string_view line) {
  if (count(line)) write(Level::warning, line);
}
void info(std::string_view line) {
  write(Level::info, line);
}
void debug(std::string_view line) {
  write(Level::debug, line);
}

void at_once(std::string_view line) {
  write(Level::warning, line, Level::error);
}

void hold_warnings() {
  start_counting(true);
}

void release_warnings() {
  for (const std::string& line : untold())
    write(Level::warning, line);
}

void drop_warnings() {
  start_counting(false);
}

Tail::Tail() {
  kept().on = true;
}

Tail::~Tail() {
  Kept& k = kept();
  k.on = false;
  const std::lock_guard lock(k.mutex);
  k.lines.clear();
}

std::vector<Line> Tail::take() {
  Kept& k = kept();
  const std::lock_guard lock(k.mutex);
  std::vector<Line> lines(k.lines.begin(), k.lines.end());
  k.lines.clear();
  return lines;
}

bool draw(std::string_view text) {
  Relayed& r = relayed();
  {
    const std::lock_guard lock(r.mutex);
    if (r.writer) {
      if (r.writer->waiting() != 0) return false;
      r.add(text);
      return true;
    }
  }
  put(text);
  return true;
}

Relay::Relay() {
  constexpr std::size_t room = 1 << 16;
  Relayed& r = relayed();
  const std::lock_guard lock(r.mutex);
  if (r.relays == 0) {
    constexpr bool others_write = true;
    r.writer.emplace(OpenFile("stderr", ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)), room, others_write);
  }
  ++r.relays;
}

Relay::~Relay() {
  Relayed& r = relayed();
  const std::lock_guard lock(r.mutex);
  if (--r.relays > 0) return;
  try {
    const double patience = r.writer->on_disk() ? StreamWriter::disk_patience_s : patience_s;
    if (r.writer->flush({.seconds = patience})) r.tell_left_out();
    r.writer->flush({.seconds = patience_s / 4});
    r.writer->close();
  } catch (const Error&) {  // a closed pipe, or a reader that still does not read
  }
  r.left_out += r.writer->waiting();
  r.writer.reset();
}

std::uint64_t Relay::left_out() {
  Relayed& r = relayed();
  const std::lock_guard lock(r.mutex);
  return r.left_out;
}

}  // namespace palpa::log
