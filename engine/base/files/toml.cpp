#include "base/files/toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include "base/files/input_file.hpp"
#include "base/nearest_word.hpp"
#include "base/text.hpp"

namespace palpa {

struct TomlTable::Document {
  std::string file;
  toml::table root;
  /// The fault of a file that gives a key twice; empty otherwise. `root` is then the file without the second. It may be
  /// any file, and then nothing of it must be shown, so `twice_named` is for a file that has a key which is asked for.
  std::string twice{}, twice_named{};
  bool has_lines = true;
};

namespace {

const toml::table& as_table(const void* table) {
  return *static_cast<const toml::table*>(table);
}
const toml::node& as_node(const void* node) {
  return *static_cast<const toml::node*>(node);
}

/// The line for a key's fault: that of the key, or of a table's heading.
std::uint32_t line_of(const toml::key& key, const toml::node& value) {
  const bool headed = value.is_table() || value.is_array_of_tables();
  return headed ? value.source().begin.line : key.source().begin.line;
}

/// NaN for values that are not numbers, which no range contains.
double number_of(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
  return std::nan("");
}

/// The finite numbers of a list; nullopt if it is not a list or contains anything else.
std::optional<std::vector<double>> numbers_of(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::vector<double> values;
  values.reserve(list->size());
  for (const toml::node& item : *list) {
    values.push_back(number_of(item));
    if (!std::isfinite(values.back())) return std::nullopt;
  }
  return values;
}

/// The fault of a pose as a position and orientation; empty if it is valid.
std::string rigidity_fault(const Transform& pose) {
  if (pose[0][3] != 0 || pose[1][3] != 0 || pose[2][3] != 0 || pose[3][3] != 1) {
    return "is not rigid: its last row must be 0 0 0 1";
  }
  constexpr double tolerance = 1e-4;
  const Vec3 x(pose[0]), y(pose[1]), z(pose[2]);
  for (const auto& [a, b, wanted] : {std::tuple(x, x, 1.0), std::tuple(y, y, 1.0), std::tuple(z, z, 1.0),
                                     std::tuple(x, y, 0.0), std::tuple(y, z, 0.0), std::tuple(z, x, 0.0)}) {
    if (!(std::abs(a.x * b.x + a.y * b.y + a.z * b.z - wanted) <= tolerance)) {
      return fmt::format("is not rigid: its rotation's columns must be orthonormal to {}", tolerance);
    }
  }
  const Vec3 turned(x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z, x.x * y.y - x.y * y.x);
  if (turned.x * z.x + turned.y * z.y + turned.z * z.z < 0) {
    return "is not rigid: it is a mirror image";
  }
  constexpr double world = 1e4;  // metres
  for (int i = 0; i < 3; ++i) {
    if (std::abs(pose[3][i]) > world) return fmt::format("lies more than {} m from the origin", world);
  }
  return "";
}

/// Goes down the keys of `path`, into the last table of each array of tables. Returns the line of the value at its end,
/// or of the first one that is not a table; 0 if there is none.
std::uint32_t line_at(const toml::table& table, const toml::table& path) {
  for (const auto& [wanted, below] : path) {  // one key
    const auto found = table.find(wanted.str());
    if (found == table.end()) break;
    const toml::table* further = found->second.as_table();
    if (const toml::array* list = found->second.as_array(); list != nullptr && !list->empty())
      further = list->back().as_table();
    const toml::table* rest = below.as_table();
    return rest == nullptr || further == nullptr ? line_of(found->first, found->second) : line_at(*further, *rest);
  }
  return 0;
}

/// The table that has this key; null if there is none.
const toml::table* owner_of(std::string_view key, const toml::table& table) {
  if (table.contains(key)) return &table;
  for (const auto& [name, value] : table) {
    const toml::table* below = value.as_table();
    if (const toml::array* list = value.as_array(); list != nullptr && !list->empty()) below = list->back().as_table();
    if (below == nullptr) continue;
    if (const toml::table* owner = owner_of(key, *below)) return owner;
  }
  return nullptr;
}

/// The key of a line such as `key = 1` or `[[key]]`, as it stands there.
std::string_view key_of(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of("[ \t"), line.size()));
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote == 0 && (c == '=' || c == ']')) return line.substr(0, line.find_last_not_of(" \t", i - 1) + 1);
    if (c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
    }
  }
  return {};
}

/// A line that gives a key for the second time.
struct Second {
  std::string_view key{};
  std::uint32_t first_line = 0;
  toml::table rest{};  ///< the file without it, or only what comes before it
};

/// nullopt if there is no first line: both keys are in one pair of braces.
std::optional<Second> find_first(std::string_view text, std::uint32_t second_line) try {
  std::size_t begin = 0;
  for (std::uint32_t line = 1; line < second_line; ++line)
    begin = text.find('\n', begin) + 1;
  const std::size_t end = std::min(text.find('\n', begin), text.size());
  const std::string_view line = text.substr(begin, end - begin);
  Second second{key_of(line)};
  // A key that the file does not have shows which table the second line belongs to.
  constexpr std::string_view probe = "palpa looks for this table";
  const toml::table before = toml::parse(fmt::format("{}\n\"{}\" = 0\n", text.substr(0, begin), probe));
  const bool heading = line.find_first_not_of(" \t") == line.find('[');
  const toml::table* place = heading ? &before : owner_of(probe, before);
  if (place != nullptr) second.first_line = line_at(*place, toml::parse(fmt::format("{} = 0", second.key)));
  if (second.first_line == 0) return std::nullopt;
  try {
    second.rest = toml::parse(fmt::format("{}{}", text.substr(0, begin), text.substr(end)));
  } catch (const toml::parse_error&) {
    second.rest = toml::parse(text.substr(0, begin));
  }
  return second;
} catch (const toml::parse_error&) {
  return std::nullopt;
}

}  // namespace

TomlTable TomlTable::load(const std::filesystem::path& file, std::string_view what, const TomlLimits& limits) {
  return parse(read_text_file(file, limits.bytes), file.string(), what, limits);
}

TomlTable TomlTable::parse(std::string_view text, const std::string& file, std::string_view what,
                           const TomlLimits& limits, bool has_lines) {
  text = text_in(text, file);
  guard_toml(text, file, limits);
  if (const std::uint64_t line = line_that_is_not_utf8(text); line != 0) {
    throw bad_input(file,
                    fmt::format("line {}: not TOML: it has bytes that are not UTF-8; save the file as UTF-8", line));
  }
  try {
    const auto document =
        std::make_shared<const Document>(Document{.file = file, .root = toml::parse(text), .has_lines = has_lines});
    return {document, &document->root, std::string(what)};
  } catch (const toml::parse_error& error) {
    // Its description would quote the file, which is untrusted and may contain anything.
    const toml::source_position at = error.source().begin;
    if (error.description().find("redefine existing") != std::string_view::npos) {
      std::optional<Second> second = find_first(text, at.line);
      if (!second) throw bad_input(file, fmt::format("line {}: a key is given twice", at.line));
      const auto fault = [&](const std::string& key) {
        return fmt::format("line {}: {} is already given in line {}", at.line, key, second->first_line);
      };
      const auto document = std::make_shared<const Document>(Document{
          file, std::move(second->rest), fault("its key"), fault(fmt::format("key {}", printable(second->key, 40)))});
      return {document, &document->root, std::string(what)};
    }
    if (error.description().find("not representable") != std::string_view::npos)
      throw bad_input(file,
                      fmt::format("line {}: the number before column {} has too many digits", at.line, at.column));
    throw bad_input(file, fmt::format("line {}: not TOML: a syntax error at column {}", at.line, at.column));
  }
}

TomlTable::TomlTable(std::shared_ptr<const Document> document, const void* table, std::string name)
    : document_(std::move(document)), table_(table), name_(std::move(name)) {}

void TomlTable::ask(std::string_view key, bool read) {
  if (!document_->twice.empty() && as_table(table_).contains(key))
    throw bad_input(document_->file, document_->twice_named);
  const auto known = std::find_if(asked_.begin(), asked_.end(), [&](const Asked& asked) { return asked.key == key; });
  if (known == asked_.end()) {
    asked_.push_back({std::string(key), read});
  } else {
    known->read |= read;
  }
}

const void* TomlTable::find(std::string_view key) {
  ask(key, true);
  return as_table(table_).get(key);
}

bool TomlTable::has(std::string_view key) {
  ask(key, false);
  return as_table(table_).contains(key);
}

namespace {

/// The keys of a table in the order in which the file has them.
std::vector<const toml::key*> in_order(const toml::table& table) {
  std::vector<const toml::key*> keys;
  for (const auto& [key, value] : table)
    keys.push_back(&key);
  std::ranges::sort(
      keys, {}, [](const toml::key* key) { return std::pair(key->source().begin.line, key->source().begin.column); });
  return keys;
}

}  // namespace

std::vector<std::string> TomlTable::keys() const {
  refuse_twice();
  std::vector<std::string> names;
  for (const toml::key* key : in_order(as_table(table_)))
    names.emplace_back(key->str());
  return names;
}

const void* TomlTable::need(std::string_view key) {
  const void* node = find(key);
  if (node == nullptr) {
    refuse_twice();
    refuse_misspelt(key);
    throw fault(
        key, name_.starts_with('[') ? fmt::format("{} {} is missing", name_, key) : fmt::format("{} is missing", key));
  }
  return node;
}

void TomlTable::refuse_misspelt(std::string_view key) const {
  for (const auto& [name, value] : as_table(table_)) {
    const std::string word(name.str());
    if (std::ranges::any_of(asked_, [&](const Asked& asked) { return asked.key == word; })) continue;
    // A short key with another letter is another key: fy for fx.
    constexpr std::size_t shortest = 4;
    if (key.size() < shortest && word.size() == key.size()) continue;
    if (nearest_word(word, std::array{std::string(key)}).empty()) continue;
    throw fault(word, fmt::format("unknown key {} in {}; did you mean {}?", printable(word, 40), name_, key));
  }
}

std::string TomlTable::place(std::string_view key) const {
  const toml::table& table = as_table(table_);
  const auto found = table.find(key);
  const std::uint32_t line = found == table.end() ? table.source().begin.line : line_of(found->first, found->second);
  // The top level has no line where it begins.
  const bool placed = document_->has_lines && line != 0 && (found != table.end() || table_ != &document_->root);
  return placed ? fmt::format("{}: line {}", document_->file, line) : document_->file;
}

Error TomlTable::fault(std::string_view key, const std::string& fault) const {
  return bad_input(place(key), fault);
}

double TomlTable::number(std::string_view key) {
  const double value = number_of(as_node(need(key)));
  if (!std::isfinite(value)) throw fault(key, fmt::format("{} must be a finite number", key));
  return value;
}

double TomlTable::number(std::string_view key, double low, double high) {
  const toml::node& node = as_node(need(key));
  if (!node.is_number()) throw fault(key, fmt::format("{} must be a number", key));
  const double value = number_of(node);
  if (!(value >= low && value <= high)) {
    throw fault(key, fmt::format("{} is {}, expected {} to {}", key, value, low, high));
  }
  return value;
}

double TomlTable::number_or(std::string_view key, double fallback, double low, double high) {
  return has(key) ? number(key, low, high) : fallback;
}

std::uint64_t TomlTable::whole(std::string_view key, std::uint64_t low, std::uint64_t high) {
  const double value = number(key, static_cast<double>(low), static_cast<double>(high));
  if (value != std::floor(value)) throw fault(key, fmt::format("{} is {}, expected a whole number", key, value));
  return static_cast<std::uint64_t>(value);
}

std::string TomlTable::text(std::string_view key) {
  const auto* node = as_node(need(key)).as_string();
  if (node == nullptr || node->get().empty()) {
    throw fault(key, fmt::format("{} must be a text in quotes, not empty", key));
  }
  if (printable(node->get(), 1024) != node->get()) {
    throw fault(key, fmt::format("{} must be one line of at most 1024 characters, without tabs and the like", key));
  }
  return node->get();
}

std::string TomlTable::text_or(std::string_view key, std::string fallback) {
  return has(key) ? text(key) : std::move(fallback);
}

bool TomlTable::flag_or(std::string_view key, bool fallback) {
  if (!has(key)) return fallback;
  const auto* flag = as_node(need(key)).as_boolean();
  if (flag == nullptr) throw fault(key, fmt::format("{} must be true or false", key));
  return flag->get();
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t count) {
  auto values = numbers_of(as_node(need(key)));
  if (!values || (count != 0 && values->size() != count)) {
    throw fault(key, count == 0 ? fmt::format("{} must be a list of finite numbers", key)
                                : fmt::format("{} must be {} finite numbers in brackets", key, count));
  }
  return std::move(*values);
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  const toml::array* list = as_node(need(key)).as_array();
  std::vector<std::string> values;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const auto* text = list->get(i)->as_string();
    if (text == nullptr) break;
    values.push_back(text->get());
  }
  if (list == nullptr || values.size() != list->size()) {
    throw fault(key, fmt::format("{} must be a list of texts", key));
  }
  return values;
}

Transform TomlTable::pose(std::string_view key) {
  const toml::array* rows = as_node(need(key)).as_array();
  const Error shape = fault(key, fmt::format("{} must be four rows of four finite numbers", key));
  if (rows == nullptr || rows->size() != 4) throw shape;
  Transform pose;
  for (int row = 0; row < 4; ++row) {
    const auto values = numbers_of(*rows->get(static_cast<std::size_t>(row)));
    if (!values || values->size() != 4) throw shape;
    for (int column = 0; column < 4; ++column)
      pose[column][row] = (*values)[static_cast<std::size_t>(column)];
  }
  const std::string fault_text = rigidity_fault(pose);
  if (!fault_text.empty()) throw fault(key, fmt::format("{} {}", key, fault_text));
  return pose;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const void* node = find(key);
  if (node == nullptr) return std::nullopt;
  const toml::table* table = as_node(node).as_table();
  if (table == nullptr) throw fault(key, fmt::format("{} must be a table: [{}]", key, key));
  return TomlTable(document_, table, fmt::format("[{}]", key));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> tables;
  const void* node = find(key);
  if (node == nullptr) return tables;
  const toml::array* list = as_node(node).as_array();
  const std::string name = fmt::format("[[{}]]", key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const toml::table* table = list->get(i)->as_table();
    if (table == nullptr) break;
    tables.push_back(TomlTable(document_, table, name));
  }
  if (list == nullptr || tables.size() != list->size()) {
    throw fault(key, fmt::format("{} must be a list of tables: {}", key, name));
  }
  return tables;
}

void TomlTable::refuse_twice() const {
  if (!document_->twice.empty()) throw bad_input(document_->file, document_->twice);
}

void TomlTable::done() const {
  refuse_twice();
  std::vector<std::string_view> keys;
  for (const Asked& asked : asked_)
    keys.emplace_back(asked.key);
  const toml::table& table = as_table(table_);
  const auto is_known = [this](std::string_view name) {
    return std::ranges::any_of(asked_, [name](const Asked& asked) { return asked.read && asked.key == name; });
  };
  // A file of another kind, which somebody else's rig may name: no message repeats its content.
  const bool whole_file = &table == &document_->root;
  if (whole_file && !table.empty() &&
      std::ranges::none_of(asked_, [&](const Asked& asked) { return table.contains(asked.key); })) {
    throw bad_input(document_->file,
                    fmt::format("is not {}: it has none of the keys {}", name_, fmt::join(keys, ", ")));
  }
  for (const auto& [key, value] : table) {
    if (is_known(key.str())) continue;
    throw fault(key.str(),
                fmt::format("unknown key {} in {}; known: {}", printable(key.str(), 40), name_, fmt::join(keys, ", ")));
  }
}

}  // namespace palpa
