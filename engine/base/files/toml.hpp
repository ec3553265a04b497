// Strict reading of TOML files that people write and that may come from strangers. Files are limited in size before
// they are parsed, unknown keys are refused, and every number must be finite and within range. Every error names file,
// line and key. Keeps toml++ out of the files that use it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/math.hpp"

namespace palpa {

/// The limits of a file.
struct TomlLimits {
  std::uint64_t bytes = 1u << 20;
  /// Number of values and lines. The parser needs a microsecond and up to 300 bytes for each. A layout of 65,000
  /// transducers, three lines and six numbers each, has 850,000.
  std::uint64_t items = 1'200'000;
  /// Number of parts of a dotted key. The parser nests one table per part and destroys them recursively, so a line of a
  /// million dots would exhaust the stack.
  std::uint32_t key_parts = 8;
};

/// Throws bad_input if `text` exceeds any limit, naming the line. Distinguishes strings and comments from structure,
/// but does not check that the text is TOML.
void guard_toml(std::string_view text, const std::string& file, const TomlLimits& limits = {});

/// One table. Every getter throws bad_input; `done()` at the end refuses keys that were never read. The first getter
/// that finds its key, or else `done()`, refuses a file that gives a key twice.
class TomlTable {
 public:
  /// Reads a regular file; `what` names its kind in messages: "a rig".
  static TomlTable load(const std::filesystem::path& file, std::string_view what, const TomlLimits& limits = {});
  /// The same from a text; `file` is its source, for messages. Without `has_lines`, nobody has seen the text, and
  /// messages name no lines of it.
  static TomlTable parse(std::string_view text, const std::string& file, std::string_view what,
                         const TomlLimits& limits = {}, bool has_lines = true);

  bool has(std::string_view key);
  /// All keys, in the file's order.
  std::vector<std::string> keys() const;
  /// Any finite number.
  double number(std::string_view key);
  double number(std::string_view key, double low, double high);
  double number_or(std::string_view key, double fallback, double low, double high);
  std::uint64_t whole(std::string_view key, std::uint64_t low, std::uint64_t high);
  std::string text(std::string_view key);
  std::string text_or(std::string_view key, std::string fallback);
  bool flag_or(std::string_view key, bool fallback);
  /// Exactly `count` numbers, or any number of them if `count` is 0.
  std::vector<double> numbers(std::string_view key, std::size_t count);
  std::vector<std::string> texts(std::string_view key);
  /// Four rows of four: rigid, i.e. last row 0 0 0 1, rotation orthonormal to 1e-4 and not mirrored.
  Transform pose(std::string_view key);
  /// `[key]`, if present.
  std::optional<TomlTable> table(std::string_view key);
  /// Every `[[key]]`.
  std::vector<TomlTable> tables(std::string_view key);
  /// Refuses a key that was not read, and lists the keys that were asked for.
  void done() const;

  /// "FILE: line N" of a key, or of this table if the key is absent.
  std::string place(std::string_view key) const;
  /// "FILE: line N: fault" for the line of a key, or of this table if the key is absent.
  Error fault(std::string_view key, const std::string& fault) const;

 private:
  struct Document;
  /// A key that was asked for.
  struct Asked {
    std::string key;
    bool read;
  };

  TomlTable(std::shared_ptr<const Document> document, const void* table, std::string name);
  void ask(std::string_view key, bool read);
  /// Throws for a file that gives a key twice.
  void refuse_twice() const;
  /// Throws for a key that is not known so far and may stand for this one, which is missing.
  void refuse_misspelt(std::string_view key) const;
  /// These return toml++'s nodes.
  const void* find(std::string_view key);
  const void* need(std::string_view key);

  std::shared_ptr<const Document> document_;
  const void* table_;  ///< toml++'s table within the document
  std::string name_;   ///< as in the file, "[[camera]]", or the file's kind for the top level
  std::vector<Asked> asked_;
};

/// A double as TOML text that reads back as the same bits.
std::string toml_number(double value);
/// A quoted TOML string.
std::string toml_string(std::string_view text);
/// Four rows of four.
std::string toml_pose(const Transform& pose);

}  // namespace palpa
