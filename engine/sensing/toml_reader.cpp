#include "sensing/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include "base/input_file.hpp"

namespace palpa::sensing {

struct TomlNode {
  enum class Kind { table, array, text, number, flag, other };
  Kind kind = Kind::other;
  std::uint32_t line = 0;
  double number = 0;  ///< also a flag's 0 or 1
  std::string text;
  std::vector<std::string> keys;  ///< of a table, one per item
  std::vector<TomlNode> items;
};

namespace {

constexpr int most_depth = 32;

TomlNode copy(const toml::node& from, const std::string& file, int depth) {
  TomlNode node;
  node.line = from.source().begin.line;
  if (depth > most_depth) throw bad_input(file, fmt::format("line {}: values nested too deeply", node.line));
  if (const toml::table* table = from.as_table()) {
    node.kind = TomlNode::Kind::table;
    for (const auto& [key, value] : *table) {
      node.keys.emplace_back(key.str());
      node.items.push_back(copy(value, file, depth + 1));
      if (value.is_table() || value.is_array_of_tables()) continue;
      node.items.back().line = key.source().begin.line;
    }
  } else if (const toml::array* array = from.as_array()) {
    node.kind = TomlNode::Kind::array;
    node.items.reserve(array->size());
    for (const toml::node& value : *array)
      node.items.push_back(copy(value, file, depth + 1));
  } else if (const auto* text = from.as_string()) {
    node.kind = TomlNode::Kind::text;
    node.text = text->get();
  } else if (const auto* real = from.as_floating_point()) {
    node.kind = TomlNode::Kind::number;
    node.number = real->get();
  } else if (const auto* whole = from.as_integer()) {
    node.kind = TomlNode::Kind::number;
    node.number = static_cast<double>(whole->get());
  } else if (const auto* flag = from.as_boolean()) {
    node.kind = TomlNode::Kind::flag;
    node.number = flag->get() ? 1 : 0;
  }
  return node;
}

/// One line of printable text, whatever a broken file brings into a message.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  if (text.size() > 200) text = text.substr(0, 200) + "...";
  return text;
}

/// A dotted key nests one table per part, and toml++ destroys them recursively: a line of a million dots would exhaust
/// the stack. No line that people write has so many.
void refuse_dotted_lines(std::string_view text, const std::string& file) {
  constexpr int most_dots = 1000;
  std::size_t line = 1;
  int dots = 0;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      dots = 0;
    } else if (c == '.' && ++dots > most_dots) {
      throw bad_input(file, fmt::format("line {}: more than {} dots in one line", line, most_dots));
    }
  }
}

}  // namespace

TomlTable TomlTable::load(const std::filesystem::path& file, std::uint64_t most_bytes) {
  const std::string text = read_file(file, most_bytes);
  refuse_dotted_lines(text, file.string());
  try {
    const toml::table root = toml::parse(text, file.string());
    auto copied = std::make_shared<const TomlNode>(copy(root, file.string(), 0));
    const TomlNode* top = copied.get();
    return {std::move(copied), top, file.string(), ""};
  } catch (const toml::parse_error& error) {
    throw bad_input(file.string(), fmt::format("line {}: not TOML: {}", error.source().begin.line,
                                               one_line(std::string(error.description()))));
  }
}

TomlTable::TomlTable(std::shared_ptr<const TomlNode> root, const TomlNode* table, std::string file, std::string name)
    : root_(std::move(root)),
      table_(table),
      file_(std::move(file)),
      name_(std::move(name)),
      asked_(table->keys.size(), false) {}

const TomlNode* TomlTable::find(std::string_view key) {
  const auto found = std::find(table_->keys.begin(), table_->keys.end(), key);
  if (found == table_->keys.end()) return nullptr;
  const auto index = found - table_->keys.begin();
  asked_[index] = true;
  return &table_->items[index];
}

bool TomlTable::has(std::string_view key) const {
  return std::find(table_->keys.begin(), table_->keys.end(), key) != table_->keys.end();
}

const TomlNode& TomlTable::need(std::string_view key) {
  const TomlNode* node = find(key);
  if (!node) throw fault(key, fmt::format("{}{}{} is missing", name_, name_.empty() ? "" : " ", key));
  return *node;
}

Error TomlTable::fault(std::string_view key, const std::string& fault) const {
  std::uint32_t line = table_->line;
  const auto found = std::find(table_->keys.begin(), table_->keys.end(), key);
  if (found != table_->keys.end()) line = table_->items[found - table_->keys.begin()].line;
  return bad_input(file_, line == 0 ? fault : fmt::format("line {}: {}", line, fault));
}

double TomlTable::number(std::string_view key, double low, double high) {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::number) throw fault(key, fmt::format("{} must be a number", key));
  if (!(node.number >= low && node.number <= high)) {
    throw fault(key, fmt::format("{} is {}, expected {} to {}", key, node.number, low, high));
  }
  return node.number;
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
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::text || node.text.empty()) {
    throw fault(key, fmt::format("{} must be a text in quotes, not empty", key));
  }
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (node.text.size() > 1024 || std::any_of(node.text.begin(), node.text.end(), control)) {
    throw fault(key, fmt::format("{} must be one line of at most 1024 characters", key));
  }
  return node.text;
}

std::string TomlTable::text_or(std::string_view key, std::string fallback) {
  return has(key) ? text(key) : std::move(fallback);
}

bool TomlTable::flag_or(std::string_view key, bool fallback) {
  const TomlNode* node = find(key);
  if (!node) return fallback;
  if (node->kind != TomlNode::Kind::flag) throw fault(key, fmt::format("{} must be true or false", key));
  return node->number != 0;
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t count) {
  const TomlNode& node = need(key);
  const auto finite = [](const TomlNode& item) {
    return item.kind == TomlNode::Kind::number && std::isfinite(item.number);
  };
  if (node.kind != TomlNode::Kind::array || (count != 0 && node.items.size() != count) ||
      !std::all_of(node.items.begin(), node.items.end(), finite)) {
    throw fault(key, count == 0 ? fmt::format("{} must be a list of finite numbers", key)
                                : fmt::format("{} must be {} finite numbers in brackets", key, count));
  }
  std::vector<double> values;
  values.reserve(node.items.size());
  for (const TomlNode& item : node.items)
    values.push_back(item.number);
  return values;
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  const TomlNode& node = need(key);
  std::vector<std::string> values;
  if (node.kind != TomlNode::Kind::array) throw fault(key, fmt::format("{} must be a list of texts", key));
  values.reserve(node.items.size());
  for (const TomlNode& item : node.items) {
    if (item.kind != TomlNode::Kind::text) throw fault(key, fmt::format("{} must be a list of texts", key));
    values.push_back(item.text);
  }
  return values;
}

Transform TomlTable::pose(std::string_view key) {
  const TomlNode& node = need(key);
  const Error shape = fault(key, fmt::format("{} must be four rows of four finite numbers", key));
  if (node.kind != TomlNode::Kind::array || node.items.size() != 4) throw shape;
  Transform pose;
  for (int row = 0; row < 4; ++row) {
    const TomlNode& values = node.items[row];
    if (values.kind != TomlNode::Kind::array || values.items.size() != 4) throw shape;
    for (int column = 0; column < 4; ++column) {
      const TomlNode& value = values.items[column];
      if (value.kind != TomlNode::Kind::number || !std::isfinite(value.number)) throw shape;
      pose[column][row] = value.number;
    }
  }
  if (pose[0][3] != 0 || pose[1][3] != 0 || pose[2][3] != 0 || pose[3][3] != 1) {
    throw fault(key, fmt::format("{} is not rigid: its last row must be 0 0 0 1", key));
  }
  constexpr double tolerance = 1e-4;
  const Vec3 x(pose[0]), y(pose[1]), z(pose[2]);
  for (const auto& [a, b, wanted] : {std::tuple(x, x, 1.0), std::tuple(y, y, 1.0), std::tuple(z, z, 1.0),
                                     std::tuple(x, y, 0.0), std::tuple(y, z, 0.0), std::tuple(z, x, 0.0)}) {
    if (!(std::abs(a.x * b.x + a.y * b.y + a.z * b.z - wanted) <= tolerance)) {
      throw fault(key,
                  fmt::format("{} is not rigid: its rotation's columns must be orthonormal to {}", key, tolerance));
    }
  }
  const Vec3 turned(x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z, x.x * y.y - x.y * y.x);
  if (turned.x * z.x + turned.y * z.y + turned.z * z.z < 0) {
    throw fault(key, fmt::format("{} is not rigid: it mirrors", key));
  }
  constexpr double world = 1e4;  // metres
  for (int i = 0; i < 3; ++i) {
    if (std::abs(pose[3][i]) > world) throw fault(key, fmt::format("{} lies more than {} m away", key, world));
  }
  return pose;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const TomlNode* node = find(key);
  if (!node) return std::nullopt;
  if (node->kind != TomlNode::Kind::table) throw fault(key, fmt::format("{} must be a table: [{}]", key, key));
  return TomlTable(root_, node, file_, fmt::format("[{}]", key));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  std::vector<TomlTable> tables;
  const TomlNode* node = find(key);
  if (!node) return tables;
  const auto is_table = [](const TomlNode& item) { return item.kind == TomlNode::Kind::table; };
  if (node->kind != TomlNode::Kind::array || !std::all_of(node->items.begin(), node->items.end(), is_table)) {
    throw fault(key, fmt::format("{} must be a list of tables: [[{}]]", key, key));
  }
  for (const TomlNode& item : node->items)
    tables.push_back(TomlTable(root_, &item, file_, fmt::format("[[{}]]", key)));
  return tables;
}

void TomlTable::done() const {
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (!asked_[i]) {
      const std::string& key = table_->keys[i];
      throw fault(key, fmt::format("unknown key {}{}{}", one_line(key), name_.empty() ? "" : " in ", name_));
    }
  }
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  // "3" would read back as an integer, and "-0" as one without its sign.
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_pose(const Transform& pose) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row) {
    text += row == 0 ? "[" : ",\n  [";
    for (int column = 0; column < 4; ++column) {
      text += (column == 0 ? "" : ", ") + toml_number(pose[column][row]);
    }
    text += "]";
  }
  return text + "]";
}

}  // namespace palpa::sensing
