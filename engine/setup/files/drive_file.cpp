#include "setup/files/drive_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <numbers>
#include <string_view>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/lines.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace palpa::setup {
namespace {

constexpr std::string_view first_line = "index,x,y,z,nx,ny,nz,amplitude,phase";
constexpr std::size_t columns = 9;
constexpr std::uint64_t most_bytes = std::uint64_t{array::max_transducers} * 512;

using Row = std::array<double, columns>;

/// Returns false unless the line is exactly this many finite numbers.
bool parse(std::string_view line, Row& row) {
  const std::vector<std::string_view> cells = cells_of(line, ',');
  if (cells.size() != columns) return false;
  for (std::size_t i = 0; i < columns; ++i) {
    const std::optional<double> number = parse_number(cells[i]);
    if (!number) return false;
    row[i] = *number;
  }
  return true;
}

std::string place(const Vec3& p) {
  return fmt::format("({}, {}, {})", p.x, p.y, p.z);
}

/// The reason why that row does not belong to this transducer; empty if it does.
std::string foreign(const Row& row, const array::Transducer& own) {
  const Vec3 position(row[1], row[2], row[3]), axis(row[4], row[5], row[6]);
  if (glm::distance(position, own.position) > drive_tolerance)
    return fmt::format("is at {} in the drive and at {} in the layout", place(position), place(own.position));
  if (glm::distance(axis, own.axis) > drive_tolerance)
    return fmt::format("points along {} in the drive and along {} in the layout", place(axis), place(own.axis));
  return {};
}

}  // namespace

std::string drive_csv(const array::Layout& layout, std::span<const array::TransducerDrive> drive) {
  std::string csv = fmt::format("{}\n", first_line);
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const auto& [p, n] = layout.transducers[i];
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{}\n", i, p.x, p.y, p.z, n.x, n.y, n.z,
                   drive[i].amplitude, drive[i].phase);
  }
  return csv;
}

array::Drive load_drive(const std::filesystem::path& file, const array::Layout& layout) {
  const std::string text = read_text_file(file, most_bytes), name = file.string();
  Lines lines(text);
  if (lines.next() != first_line) {
    throw bad_input(name,
                    fmt::format("is not a drive: its first line is not {}; palpa drive --csv writes one", first_line));
  }
  array::Drive drive;
  const std::size_t transducers = layout.transducers.size();
  std::size_t rows = 0;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) continue;
    const std::size_t number = lines.number();
    Row row{};
    if (!parse(*line, row)) {
      throw bad_input(
          name, fmt::format("line {}: '{}' is not {} numbers ({})", number, printable(*line, 60), columns, first_line));
    }
    if (row[0] != static_cast<double>(rows)) {
      throw bad_input(
          name, fmt::format("line {}: expected transducer {}, found {}: rows must be in layout order, from 0", number,
                            rows, row[0]));
    }
    if (rows < transducers) {
      if (const std::string fault = foreign(row, layout.transducers[rows]); !fault.empty()) {
        throw bad_input(name, fmt::format("line {}: the drive belongs to another layout than {}: transducer {} {}",
                                          number, layout.name, rows, fault));
      }
    }
    const std::optional<float> amplitude = as_given_amplitude(row[7]);
    if (!amplitude) throw bad_input(name, fmt::format("line {}: amplitude {} is not within 0..1", number, row[7]));
    if (std::abs(row[8]) > most_phase_rad) {
      throw bad_input(name,
                      fmt::format("line {}: phase {} is more than a million turns; phases are in radians, such as "
                                  "-1.57",
                                  number, row[8]));
    }
    drive.push_back({*amplitude, static_cast<float>(row[8])});
    ++rows;
  }
  if (rows != transducers) {
    throw bad_input(name, fmt::format("belongs to another layout: it has {} transducers, but {} has {}", rows,
                                      layout.name, transducers));
  }
  return drive;
}

}  // namespace palpa::setup
