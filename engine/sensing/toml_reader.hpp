// Strict reading of small TOML files that people write: every key is known, every number finite and within range, and
// every fault names file, line and key. Keeps toml++ out of the files that use it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/math.hpp"

namespace palpa::sensing {

struct TomlNode;

/// One table. Every getter throws bad_input; `done()` at the end refuses the keys that nobody asked for.
class TomlTable {
 public:
  /// Reads a regular file of at most `most_bytes`.
  static TomlTable load(const std::filesystem::path& file, std::uint64_t most_bytes = 1u << 20);

  bool has(std::string_view key) const;
  double number(std::string_view key, double low, double high);
  double number_or(std::string_view key, double fallback, double low, double high);
  std::uint64_t whole(std::string_view key, std::uint64_t low, std::uint64_t high);
  std::string text(std::string_view key);
  std::string text_or(std::string_view key, std::string fallback);
  bool flag_or(std::string_view key, bool fallback);
  /// Exactly `count` numbers, or any number of them where `count` is 0.
  std::vector<double> numbers(std::string_view key, std::size_t count);
  std::vector<std::string> texts(std::string_view key);
  /// Four rows of four: rigid, i.e. last row 0 0 0 1, rotation orthonormal to 1e-4 and not mirrored.
  Transform pose(std::string_view key);
  /// `[key]`, if present.
  std::optional<TomlTable> table(std::string_view key);
  /// Every `[[key]]`.
  std::vector<TomlTable> tables(std::string_view key);
  void done() const;

  /// "FILE: line N: fault" for the line of a key, or of this table where the key is absent.
  Error fault(std::string_view key, const std::string& fault) const;

 private:
  TomlTable(std::shared_ptr<const TomlNode> root, const TomlNode* table, std::string file, std::string name);
  const TomlNode* find(std::string_view key);
  const TomlNode& need(std::string_view key);

  std::shared_ptr<const TomlNode> root_;
  const TomlNode* table_;
  std::string file_;
  std::string name_;  ///< as it stands in the file, e.g. "[[camera]]"; empty for the top level
  std::vector<bool> asked_;
};

/// A double as TOML text that reads back to the same bits.
std::string toml_number(double value);
/// A quoted TOML string.
std::string toml_string(std::string_view text);
/// Four rows of four.
std::string toml_pose(const Transform& pose);

}  // namespace palpa::sensing
