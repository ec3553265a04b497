// The contents of a model's accessors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf/model.hpp"

namespace palpa::geometry::gltf {

/// Reads accessors by their index. All functions throw bad_input, naming the accessor.
class Values {
 public:
  /// Both arguments must outlive it. The model has been checked.
  Values(const std::string& file, const tinygltf::Model& model) : file_(file), model_(model) {}

  /// The accessor's numbers of each element, one element after the other, of at most `most` elements, normalized.
  std::vector<double> numbers(int accessor, std::size_t most = any_count) const;
  /// Such numbers as they are stored: if the accessor is normalized, integers become 0 to 1, signed ones -1 to 1 (glTF
  /// 2.0 section 3.6.2.2).
  std::vector<double> normalized(int accessor, std::vector<double> stored) const;
  /// The index list of a primitive with `vertices` vertices.
  std::vector<std::uint32_t> indices(int accessor, std::size_t vertices) const;
  std::span<const unsigned char> bytes(int view) const;
  /// Warns if the accessor's min and max are not those of its positions.
  void check_bounds(int accessor, const Box& box) const;

 private:
  static constexpr std::size_t any_count = std::numeric_limits<std::size_t>::max();
  [[noreturn]] void fail(int accessor, const std::string& fault) const;
  template <typename T>
  std::vector<T> read(int accessor, std::size_t most) const;

  const std::string& file_;
  const tinygltf::Model& model_;
};

/// Triangles of `vertices` (0, 1, 2, ... or an index list) as list (mode 4), strip (5) or fan (6). Remaining vertices
/// of an incomplete triangle are dropped. glTF 2.0 section 3.7.2.1.
std::vector<glm::uvec3> triangles_of(int mode, std::span<const std::uint32_t> vertices);

/// The number of those triangles.
std::size_t triangle_count(int mode, std::size_t vertices);

}  // namespace palpa::geometry::gltf
