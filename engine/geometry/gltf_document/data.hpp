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

/// Reads accessors on demand, with everything that they refer to. All functions throw bad_input.
class DataReader {
 public:
  /// Makes room in `document` for the accessors and buffers of `root`. All arguments must outlive it.
  DataReader(const Item& root, const Parsed& parsed, const Container& container, Document& document);

  /// The accessor that a member names; nullopt if absent.
  std::optional<std::uint32_t> named(const Item& item, const char* key) const;
  /// Returns the number of its elements.
  std::uint64_t read(std::uint32_t accessor, Role role);
  /// The same for an accessor whose data are in a draco stream.
  std::uint64_t read_compressed(std::uint32_t accessor, Role role);
  /// The draco stream that a primitive's extension names.
  DracoSource read_stream(const Item& extension);
  bool has_data(std::uint32_t accessor) const;

  /// Checks what read() has not seen, as far as possible without a known use.
  void check_rest();

 private:
  Item at(const char* key, const char* name, std::size_t index) const { return root_.element(key, name, index); }
  Accessor read_elements(const Item& accessor, Role role) const;
  void check_role(const Item& accessor, Role role, const std::string& type, Component component) const;
  Sparse read_sparse(const Item& sparse, const Accessor& accessor);
  const View& read_view(std::uint32_t view);
  View read_packed(const Item& extension, std::uint64_t length, std::uint64_t stride);
  std::uint64_t read_buffer(std::uint32_t buffer);
  void claim(const Item& item, std::uint64_t bytes);

  const Item& root_;
  const Parsed& parsed_;
  const Container& container_;
  Document& document_;
  bool quantized_ = false;  // whether the file uses KHR_mesh_quantization
  std::vector<Role> role_;
  std::vector<std::optional<View>> views_;
  std::vector<char> fallback_;
  std::uint64_t total_ = 0;
};

}  // namespace palpa::geometry::gltf
