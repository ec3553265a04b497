// The lowest layer of a glTF document: accessors, buffer views, buffers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf_document/document.hpp"
#include "geometry/gltf_document/json.hpp"

namespace palpa::geometry::gltf {

/// The use of an accessor; each use allows certain types.
enum class Role : char { unused, position, displacement, indices, joints, weights, bind_matrices, place, rotation };

/// Checks accessors on demand, with everything that they refer to. All functions throw bad_input.
class DataChecker {
 public:
  /// Adds the buffers of `root` to `document`, and their lengths as far as the checks need them. All arguments must
  /// outlive it.
  DataChecker(const Item& root, const Parsed& parsed, const Container& container, Document& document);

  /// The accessor that a member names; nullopt if absent.
  std::optional<std::uint32_t> named(const Item& item, const char* key) const;
  /// Returns the number of its elements.
  std::uint64_t check(std::uint32_t accessor, Role role);
  /// The same for an accessor whose data are in a draco stream.
  std::uint64_t check_compressed(std::uint32_t accessor, Role role) const;
  /// The draco stream that a primitive's extension names. Returns its attributes.
  Item check_stream(const Item& extension);
  bool has_data(std::uint32_t accessor) const;

  /// Checks what check() has not seen, as far as possible without a known use.
  void check_rest();

 private:
  // An accessor's elements; sizes in bytes.
  struct Elements {
    std::uint64_t count, component_size, size;
  };
  struct View {
    std::uint64_t length, stride;  // stride 0: not given
  };
  Item at(const char* key, const char* name, std::size_t index) const { return root_.element(key, name, index); }
  Elements check_elements(const Item& accessor, Role role) const;
  void check_role(const Item& accessor, Role role, const std::string& type, std::uint64_t component) const;
  void check_sparse(const Item& sparse, const Elements& elements);
  View check_view(std::uint32_t view);
  void check_packed(const Item& view, const Item& extension, const View& unpacked);
  std::uint64_t check_buffer(std::uint32_t buffer);
  void claim(const Item& item, std::uint64_t bytes);

  const Item& root_;
  const Parsed& parsed_;
  const Container& container_;
  std::vector<BufferSource>& buffers_;
  bool quantized_ = false;  // whether the file uses KHR_mesh_quantization
  std::vector<Role> role_;
  std::vector<std::uint64_t> count_;  // of accessors with a role
  std::vector<std::optional<View>> views_;
  std::vector<char> fallback_;
  std::uint64_t total_ = 0;
};

}  // namespace palpa::geometry::gltf
