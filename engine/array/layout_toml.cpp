#include "array/layout_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <initializer_list>
#include <optional>

#include "array/builtin_layouts.hpp"
#include "array/toml_guard.hpp"
#include "base/error.hpp"
#include "base/input_file.hpp"

namespace palpa::array {
namespace {

// Farther out an array's phases have no meaning in this medium, and floats no digits for them.
constexpr double most_metres = 10;
// What people type: 0.7071 for the root of a half.
constexpr double unit_tolerance = 1e-3;

/// One table of the file and the words to complain about it.
class Reader {
 public:
  Reader(const std::string& file, const toml::table& table, std::string where)
      : file_(&file), table_(&table), where_(std::move(where)) {}

  Error fault(const toml::node& node, std::string_view text) const {
    return bad_input(*file_, fmt::format("line {}: {}", node.source().begin.line, text));
  }
  Error fault(std::string_view text) const { return fault(*table_, text); }

  void refuse_unknown(std::initializer_list<std::string_view> known) const {
    for (const auto& [key, node] : *table_) {
      if (std::ranges::find(known, key.str()) != known.end()) continue;
      throw bad_input(*file_, fmt::format("line {}: unknown key {} in {}; known: {}", key.source().begin.line,
                                          printable(key.str()), where_, fmt::join(known, ", ")));
    }
  }

  const toml::node* optional(std::string_view key) const { return table_->get(key); }
  const toml::node& required(std::string_view key) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) throw fault(fmt::format("{} lacks {}", where_, key));
    return *node;
  }

  std::string text(const toml::node& node, std::string_view key) const {
    if (!node.is_string()) throw fault(node, fmt::format("{} is not a string", key));
    return **node.as_string();
  }
  double number(const toml::node& node, std::string_view key) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) throw fault(node, fmt::format("{} is not a finite number", key));
    return *value;
  }
  template <std::size_t Count>
  std::array<double, Count> numbers(std::string_view key) const {
    const toml::node& node = required(key);
    const toml::array* list = node.as_array();
    if (list == nullptr || list->size() != Count) {
      throw fault(node, fmt::format("{} is not a list of {} numbers", key, Count));
    }
    std::array<double, Count> values{};
    for (std::size_t i = 0; i < Count; ++i)
      values[i] = number((*list)[i], key);
    return values;
  }

 private:
  static std::string printable(std::string_view key) {
    std::string shown;
    for (const char c : key.substr(0, 40))
      shown += c >= ' ' && c <= '~' ? c : '?';
    return shown;
  }

  const std::string* file_;
  const toml::table* table_;
  std::string where_;
};

Vec3 read_position(const Reader& reader) {
  const auto [x, y, z] = reader.numbers<3>("position_m");
  for (const double metres : {x, y, z}) {
    if (std::abs(metres) > most_metres) {
      throw reader.fault(*reader.optional("position_m"),
                         fmt::format("position_m has {} m; at most {} m from the origin", metres, most_metres));
    }
  }
  return {x, y, z};
}

Transform read_pose(const Reader& reader) {
  const auto [w, x, y, z] = reader.numbers<4>("quaternion_wxyz");
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(std::abs(length - 1) <= unit_tolerance)) {
    throw reader.fault(*reader.optional("quaternion_wxyz"),
                       fmt::format("quaternion_wxyz has length {}, not 1", length));
  }
  Transform pose = glm::mat4_cast(glm::dquat(w / length, x / length, y / length, z / length));
  pose[3] = Vec4(read_position(reader), 1);
  return pose;
}

void read_unit(const Reader& reader, Layout& layout) {
  reader.refuse_unknown({"type", "position_m", "quaternion_wxyz"});
  const toml::node& type = reader.required("type");
  if (!add_board(layout, reader.text(type, "type"), read_pose(reader))) {
    throw reader.fault(type, fmt::format("type is no known board; known: {}", fmt::join(board_types(), ", ")));
  }
}

void read_transducer(const Reader& reader, Layout& layout) {
  reader.refuse_unknown({"position_m", "axis"});
  const Vec3 position = read_position(reader);
  const auto [x, y, z] = reader.numbers<3>("axis");
  const Vec3 axis(x, y, z);
  const double length = glm::length(axis);
  if (!(std::abs(length - 1) <= unit_tolerance)) {
    throw reader.fault(*reader.optional("axis"), fmt::format("axis has length {}, not 1", length));
  }
  layout.transducers.push_back({position, axis / length});
}

template <typename Read>
void read_each(const std::string& file, const Reader& top, std::string_view key, const Read& read, Layout& layout) {
  const toml::node* node = top.optional(key);
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr) throw top.fault(*node, fmt::format("{0} is not a list: write [[{0}]]", key));
  for (const toml::node& entry : *list) {
    const toml::table* table = entry.as_table();
    if (table == nullptr) throw top.fault(entry, fmt::format("{} is not a table: write [[{}]]", key, key));
    const Reader reader(file, *table, fmt::format("[[{}]]", key));
    read(reader, layout);
    if (layout.transducers.size() > max_transducers) {
      throw reader.fault(fmt::format("more than {} transducers", max_transducers));
    }
  }
}

void refuse_coinciding(const std::string& file, const Layout& layout) {
  std::vector<std::uint32_t> order(layout.transducers.size());
  for (std::uint32_t i = 0; i < order.size(); ++i)
    order[i] = i;
  const auto key = [&](std::uint32_t i) {
    const Vec3& p = layout.transducers[i].position;
    return std::array{p.x, p.y, p.z};
  };
  std::ranges::sort(order,
                    [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i - 1]) != key(order[i])) continue;
    throw bad_input(file, fmt::format("transducers {} and {} are at the same place", order[i - 1], order[i]));
  }
}

}  // namespace

Layout parse_layout_toml(std::string_view text, const std::string& file) {
  if (text.size() > max_layout_bytes) {
    throw bad_input(file, fmt::format("larger than {} MiB, too large for a layout", max_layout_bytes >> 20));
  }
  guard_toml(text, file);
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw bad_input(file, fmt::format("line {}: {}", error.source().begin.line, one_line(error.description())));
  }
  const Reader top(file, root, "a layout");
  top.refuse_unknown({"name", "source_level_pa_m", "unit", "transducer"});

  Layout layout;
  layout.name = std::filesystem::path(file).stem().string();
  layout.default_T_world_layout = below_facing_up();
  if (const toml::node* name = top.optional("name")) layout.name = top.text(*name, "name");
  if (const toml::node* level = top.optional("source_level_pa_m")) {
    layout.source_level_pa_m = top.number(*level, "source_level_pa_m");
    if (!(layout.source_level_pa_m > 0 && layout.source_level_pa_m <= 1e4)) {
      throw top.fault(*level, fmt::format("source_level_pa_m is {}; above 0 and at most 10000 Pa m, such as 4.386",
                                          layout.source_level_pa_m));
    }
  }
  read_each(file, top, "unit", read_unit, layout);
  read_each(file, top, "transducer", read_transducer, layout);
  if (layout.transducers.empty()) throw bad_input(file, "no transducers: write [[unit]] or [[transducer]] tables");
  refuse_coinciding(file, layout);
  return layout;
}

Layout load_layout_toml(const std::string& file) {
  return parse_layout_toml(read_file(file, max_layout_bytes), file);
}

}  // namespace palpa::array
