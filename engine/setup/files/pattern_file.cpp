#include "setup/files/pattern_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <optional>
#include <system_error>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/toml.hpp"
#include "base/text.hpp"
#include "setup/files/assets.hpp"

namespace palpa::setup {
namespace {

constexpr std::size_t most_bytes = 1u << 20;
constexpr double farthest_m = 100;
constexpr double same_place_m = 1e-6;
constexpr double least_amplitude = 1e-4;  // relative to the loudest point

/// A pattern being read. Amplitudes are the file's.
struct Reader {
  Pattern pattern;
  std::vector<double> amplitudes;

  void add(TomlTable& table, const Vec3& place, double amplitude, double radius_m) {
    const auto is_here = [&](const Vec3& other) { return glm::distance(other, place) < same_place_m; };
    if (std::ranges::any_of(pattern.points, is_here, &Pattern::Point::position) ||
        std::ranges::any_of(pattern.nulls, is_here, &array::Null::position)) {
      throw table.fault("", fmt::format("a second point is at ({}, {}, {}) m", place.x, place.y, place.z));
    }
    if (amplitude == 0) {
      pattern.nulls.push_back({place, radius_m});
    } else {
      pattern.points.push_back({place, 1});
      amplitudes.push_back(amplitude);
    }
    if (pattern.points.size() > most_pattern_points || pattern.nulls.size() > most_pattern_nulls) {
      throw table.fault("", fmt::format("a pattern has at most {} points that sound and {} that are silent",
                                        most_pattern_points, most_pattern_nulls));
    }
  }
};

Vec3 read_place(TomlTable& table, std::string_view key) {
  const std::vector<double> place = table.numbers(key, 3);
  for (const double metres : place) {
    if (std::abs(metres) > farthest_m)
      throw table.fault(key, fmt::format("{} has a coordinate of {} m; the limit is {} m", key, metres, farthest_m));
  }
  return {place[0], place[1], place[2]};
}

double read_amplitude(TomlTable& table) {
  return table.number_or("amplitude", 1, 0, 1e6);
}

void read_point(TomlTable& table, Reader& reader) {
  const Vec3 place = read_place(table, "position_m");
  const double amplitude = read_amplitude(table);
  const double radius_m = table.number_or("radius_m", 0, 0, array::most_null_radius_m);
  if (radius_m > 0 && amplitude > 0)
    throw table.fault("radius_m", "radius_m goes with amplitude = 0: only silence has a size");
  table.done();
  reader.add(table, place, amplitude, radius_m);
}

void read_curve(TomlTable& table, Reader& reader) {
  const std::vector<double> numbers = table.numbers("corners_m", 0);
  if (numbers.size() < 6 || numbers.size() % 3 != 0 || numbers.size() > std::size_t{3} * 4096)
    throw table.fault("corners_m", "corners_m needs x, y, z of 2 to 4096 corners");
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    corners.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  for (const Vec3& corner : corners) {
    if (!(std::max({std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)}) <= farthest_m))
      throw table.fault("corners_m", fmt::format("corners_m has a corner farther than {} m away", farthest_m));
  }
  const std::uint64_t points = table.whole("points", 1, most_pattern_points + most_pattern_nulls);
  const bool closed = table.flag_or("closed", false);
  const double amplitude = read_amplitude(table);
  table.done();
  if (closed) corners.push_back(corners.front());
  std::vector<double> along{0};
  for (std::size_t i = 1; i < corners.size(); ++i)
    along.push_back(along.back() + glm::distance(corners[i - 1], corners[i]));
  if (!(along.back() > 0)) throw table.fault("corners_m", "corners_m has all corners at one place");
  const double steps = static_cast<double>(closed ? points : std::max<std::uint64_t>(1, points - 1));
  for (std::uint64_t n = 0; n < points; ++n) {
    const double at = along.back() * static_cast<double>(n) / steps;
    std::size_t i = 1;
    while (i + 1 < along.size() && along[i] < at)
      ++i;
    const double length = along[i] - along[i - 1];
    const double part = length > 0 ? std::clamp((at - along[i - 1]) / length, 0.0, 1.0) : 0;
    reader.add(table, corners[i - 1] + part * (corners[i] - corners[i - 1]), amplitude, 0);
  }
}

/// What a letter of a plane says; nullopt: there is no point.
std::optional<double> amplitude_of(TomlTable& table, char letter) {
  if (letter == '.') return std::nullopt;
  if (letter == '#') return 1;
  if (letter >= '0' && letter <= '9') return (letter - '0') / 10.0;
  throw table.fault("rows", fmt::format("rows has the letter '{}'; known: # for 1, 1 to 9 for tenths, 0 for silence, . "
                                        "for no point",
                                        printable(std::string_view(&letter, 1))));
}

void read_plane(TomlTable& table, Reader& reader) {
  const Vec3 centre = read_place(table, "centre_m"), right = read_place(table, "right_m"),
             up = read_place(table, "up_m");
  const std::vector<std::string> rows = table.texts("rows");
  table.done();
  if (rows.empty() || rows.front().empty()) throw table.fault("rows", "rows is empty");
  const auto height = static_cast<double>(rows.size()), width = static_cast<double>(rows.front().size());
  for (std::size_t j = 0; j < rows.size(); ++j) {
    if (rows[j].size() != rows.front().size()) throw table.fault("rows", "rows have different lengths");
    for (std::size_t i = 0; i < rows[j].size(); ++i) {
      const std::optional<double> amplitude = amplitude_of(table, rows[j][i]);
      if (!amplitude) continue;
      const Vec3 place = centre + (static_cast<double>(i) - (width - 1) / 2) * right +
                         ((height - 1) / 2 - static_cast<double>(j)) * up;
      reader.add(table, place, *amplitude, 0);
    }
  }
}

}  // namespace

Pattern parse_pattern(std::string_view text, const std::string& file) {
  TomlTable top = TomlTable::parse(text, file, "a pattern", {.bytes = most_bytes});
  Reader reader;
  reader.pattern.name = top.text_or("name", std::filesystem::path(file).stem().string());
  for (TomlTable& table : top.tables("point"))
    read_point(table, reader);
  for (TomlTable& table : top.tables("curve"))
    read_curve(table, reader);
  for (TomlTable& table : top.tables("plane"))
    read_plane(table, reader);
  top.done();
  if (reader.amplitudes.empty())
    throw bad_input(file, "no point sounds: write [[point]], [[curve]] or [[plane]] tables with an amplitude above 0");
  const double loudest = *std::ranges::max_element(reader.amplitudes);
  for (std::size_t i = 0; i < reader.amplitudes.size(); ++i) {
    Pattern::Point& point = reader.pattern.points[i];
    point.amplitude = static_cast<float>(reader.amplitudes[i] / loudest);
    if (!(reader.amplitudes[i] >= least_amplitude * loudest))
      throw bad_input(file, fmt::format("the amplitude {} is nothing beside {}", reader.amplitudes[i], loudest));
  }
  return std::move(reader.pattern);
}

std::vector<std::string> pattern_names() {
  return {"carter", "gavrilov", "hasegawa", "hoshi", "inoue"};
}

std::string known_patterns() {
  return fmt::format("{}", fmt::join(pattern_names(), ", "));
}

Pattern load_pattern(const std::string& name_or_file) {
  std::string file = name_or_file;
  std::error_code ignored;
  if (const std::vector<std::string> names = pattern_names(); std::ranges::find(names, file) != names.end()) {
    file = find_asset("patterns/" + file + ".toml");
  } else if (file.find('/') == std::string::npos && !file.ends_with(".toml") &&
             !std::filesystem::exists(file, ignored)) {
    throw bad_input(file, fmt::format("neither a file nor a known pattern; known: {}", known_patterns()));
  }
  return parse_pattern(read_text_file(file, most_bytes), file);
}

}  // namespace palpa::setup
