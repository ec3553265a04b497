#include "array/layouts/layout_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/builtin_layouts.hpp"
#include "array/medium.hpp"
#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/toml.hpp"
#include "base/text.hpp"
#include "base/words.hpp"

namespace palpa::array {
namespace {

Vec3 read_position(TomlTable& table) {
  const std::vector<double> position = table.numbers("position_m", 3);
  for (const double metres : position) {
    if (std::abs(metres) > most_layout_m) {
      throw table.fault("position_m",
                        fmt::format("position_m has a coordinate of {} m; the limit is {} m", metres, most_layout_m));
    }
  }
  return {position[0], position[1], position[2]};
}

Transform read_pose(TomlTable& table) {
  const Vec3 position = read_position(table);
  const std::vector<double> q = table.numbers("quaternion_wxyz", 4);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) <= axis_tolerance)) {
    throw table.fault("quaternion_wxyz", fmt::format("quaternion_wxyz has length {}, not 1", length));
  }
  Transform pose = glm::mat4_cast(glm::dquat(q[0] / length, q[1] / length, q[2] / length, q[3] / length));
  pose[3] = Vec4(position, 1);
  return pose;
}

void read_unit(TomlTable& table, Layout& layout) {
  const std::string type = table.text("type");
  const Transform pose = read_pose(table);
  table.done();
  if (!add_board(layout, type, pose)) {
    throw table.fault("type", fmt::format("type is not a known board; known: {}", known_board_types()));
  }
}

void read_transducer(TomlTable& table, Layout& layout) {
  const Vec3 position = read_position(table);
  const std::vector<double> given = table.numbers("axis", 3);
  const Vec3 axis(given[0], given[1], given[2]);
  const double length = glm::length(axis);
  if (!(std::abs(length - 1) <= axis_tolerance)) {
    throw table.fault("axis", fmt::format("axis has length {}, not 1", length));
  }
  table.done();
  layout.transducers.push_back({position, axis / length});
}

/// A table of the file and the index of its first transducer.
struct Origin {
  std::size_t first;
  TomlTable table;
};

template <typename Read>
void read_each(TomlTable& top, std::string_view key, const Read& read, Layout& layout, std::vector<Origin>& origins) {
  for (TomlTable& table : top.tables(key)) {
    origins.push_back({layout.transducers.size(), std::move(table)});
    read(origins.back().table, layout);
    if (layout.transducers.size() > max_transducers) {
      throw origins.back().table.fault("", fmt::format("more than {} transducers", max_transducers));
    }
  }
}

void refuse_coinciding(const Layout& layout, const std::vector<Origin>& origins) {
  const auto pair = coinciding(layout.transducers);
  if (!pair) return;
  const auto past = std::ranges::upper_bound(origins, std::size_t{pair->second}, {}, &Origin::first);
  throw std::prev(past)->table.fault(
      "", fmt::format("transducers {} and {} are at the same place", pair->first, pair->second));
}

}  // namespace

Layout parse_layout_toml(std::string_view text, const std::string& file) {
  TomlTable top = TomlTable::parse(text, file, "a layout", {.bytes = max_layout_bytes});
  Layout layout;
  layout.name = top.text_or("name", std::filesystem::path(file).stem().string());
  layout.default_T_world_layout = below_facing_up();
  if (top.has("source_level_pa_m")) {
    layout.source_level_pa_m = top.number("source_level_pa_m");
    if (!(layout.source_level_pa_m > 0 && layout.source_level_pa_m <= most_source_level_pa_m)) {
      throw top.fault("source_level_pa_m",
                      fmt::format("source_level_pa_m is {}; it must be above 0 and at most 10000 Pa m, such as 4.386",
                                  layout.source_level_pa_m));
    }
  }
  if (top.has("transducer_radius_m")) {
    layout.transducer_radius_m = top.number("transducer_radius_m");
    if (!(layout.transducer_radius_m > 0 && layout.transducer_radius_m <= most_transducer_radius_m)) {
      throw top.fault("transducer_radius_m",
                      fmt::format("transducer_radius_m is {}; it must be above 0 and at most 0.1 m, such as 0.0045",
                                  layout.transducer_radius_m));
    }
  }
  if (top.has("amplitude_law")) {
    const std::string law = top.text("amplitude_law");
    const std::optional<Weighting> known = value_of(weighting_words, law);
    if (!known) {
      throw top.fault("amplitude_law",
                      fmt::format("amplitude_law is {}; it must be {}", printable(law, 40), one_of(weighting_words)));
    }
    layout.amplitude_law = *known;
  }
  layout.frequency_hz = top.number_or("frequency_hz", layout.frequency_hz, least_frequency, most_frequency);
  std::vector<Origin> origins;
  read_each(top, "unit", read_unit, layout, origins);
  read_each(top, "transducer", read_transducer, layout, origins);
  top.done();
  if (!layout.boards.empty() && layout.frequency_hz != board_frequency_hz) {
    throw top.fault("frequency_hz",
                    fmt::format("frequency_hz is {}, but the boards of [[unit]] emit {:g} Hz only; transducers with "
                                "another frequency are [[transducer]] tables",
                                layout.frequency_hz, board_frequency_hz));
  }
  if (layout.transducers.empty()) throw bad_input(file, "no transducers: write [[unit]] or [[transducer]] tables");
  refuse_coinciding(layout, origins);
  return layout;
}

Layout load_layout_toml(const std::string& file) {
  return parse_layout_toml(read_text_file(file, max_layout_bytes), file);
}

}  // namespace palpa::array
