// The header of a PLY file: its elements, and where they begin.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/files/input_file.hpp"

namespace palpa::geometry::ply {

enum class Format { ascii, little, big };
enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

inline constexpr std::array<std::size_t, 8> type_size{1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
  std::string name;
  Type type = Type::f32;
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::uint64_t bytes = 0;  // up to and including the line end after end_header
  std::uint64_t lines = 0;
  char line_end = '\n';  // the last byte of every line
};

/// Throws bad_input.
Header parse_header(const InputFile& file);

}  // namespace palpa::geometry::ply
