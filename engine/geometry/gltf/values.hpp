// The contents of a document's accessors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf/accessor.hpp"
#include "geometry/gltf/model.hpp"

namespace palpa::geometry::gltf {

/// Reads accessors by their index. `file` and `model` must outlive it. All functions throw bad_input naming the
/// accessor.
class Values {
 public:
  Values(const std::string& file, const tinygltf::Model& model) : file_(file), model_(model) {}

  /// `width` numbers per element; bad_input if a sparse index is out of range or not ascending.
  std::vector<double> numbers(std::size_t accessor, std::size_t width) const;
  /// The index list of a primitive with `vertices` vertices.
  std::vector<std::uint32_t> indices(std::size_t accessor, std::size_t vertices) const;

 private:
  [[noreturn]] void fail(const std::string& fault) const;
  [[noreturn]] void fail_sparse(std::size_t accessor, std::uint64_t index) const;
  Column column(int view, std::size_t offset, std::size_t count, std::size_t element, int component) const;
  Column column(std::size_t accessor, std::size_t width) const;
  std::optional<Sparse> sparse(std::size_t accessor, std::size_t width) const;

  const std::string& file_;
  const tinygltf::Model& model_;
};

}  // namespace palpa::geometry::gltf
