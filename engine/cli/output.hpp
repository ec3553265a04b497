// Results leave through here: every write is checked, so that a full disk or a closed pipe is an error and not silence.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace palpa::cli {

/// A file, or stdout for "-". Throws failure() naming it when it cannot be opened, written or closed whole.
class Output {
 public:
  explicit Output(const std::string& file);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void write(std::string_view text);
  /// Flushes and, for a file, closes. An Output that was not finished leaves an incomplete file behind.
  void finish();

 private:
  [[noreturn]] void fail(int code) const;

  std::string name_;
  std::FILE* file_ = nullptr;
};

/// Throws bad_usage where more than one of these files is "-": their texts would run into each other.
void refuse_two_on_stdout(const std::string& json, const std::string& csv);

/// The whole of `text` to a file, or to stdout for "-".
void write_output(const std::string& file, std::string_view text);

}  // namespace palpa::cli
