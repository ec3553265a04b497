// The lowest layer of a glTF document: accessors, buffer views, buffers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/gltf_document/check.hpp"
#include "geometry/gltf_document/json.hpp"

namespace palpa::geometry::gltf {

/// The use of an accessor; each use allows certain types.
enum class Role : char { unused, position, displacement, indices, joints, weights, bind_matrices, place, rotation };

/// Checks accessors on demand and copies what they need into the reduced document. All functions throw bad_input.
class DataChecker {
 public:
  DataChecker(const Item& root, const Parsed& parsed, const Container& container);

  /// Fills `clean` with placeholders for everything. check() writes into `clean`, too.
  void start(Json& clean);
  /// Checks the accessor and everything it refers to; returns the number of its elements.
  std::uint64_t check(std::uint32_t accessor, Role role);
  /// Checks an accessor whose data are in a draco stream.
  std::uint64_t check_compressed(std::uint32_t accessor, Role role);
  /// Checks a buffer view that holds a draco stream, and its buffer.
  void check_stream(std::uint32_t view);
  bool has_data(std::uint32_t accessor) const;
  std::size_t accessor_count() const { return role_.size(); }
  std::size_t view_count() const { return view_checked_.size(); }
  /// The file's buffers, then those unpacked from packed views.
  const std::vector<BufferSource>& buffers() const { return buffers_; }
  /// See Document.
  const std::vector<std::uint32_t>& without_view() const { return without_view_; }

  /// Checks accessors that check() has not seen, as far as possible without a known use.
  void check_rest();

 private:
  struct BufferView {
    std::uint64_t length, stride;
  };
  // The properties of an accessor's elements.
  struct Elements {
    std::uint64_t count, component, size;  // size in bytes
    Json clean;
  };
  Item at(const char* key, const char* name, std::size_t index) const;
  Elements check_elements(const Item& accessor, Role role) const;
  void check_role(const Item& accessor, Role role, const std::string& type, std::uint64_t component) const;
  Json check_sparse(const Item& sparse, std::uint64_t accessor_count, std::uint64_t element);
  static void check_fit(const Item& item, const BufferView& view, std::uint64_t offset, std::uint64_t count,
                        std::uint64_t stride, std::uint64_t element);
  BufferView check_view(std::uint32_t view);
  void check_packed(const Item& view, std::uint32_t v, std::uint64_t length, std::uint64_t stride);
  std::uint64_t check_buffer(std::uint32_t buffer);
  void claim(const Item& item, std::uint64_t bytes);

  const Item& root_;
  const Parsed& parsed_;
  const Container& container_;
  Json* clean_ = nullptr;
  bool quantized_ = false;  // whether the file uses KHR_mesh_quantization
  std::size_t buffer_count_ = 0;
  std::vector<Role> role_;
  std::vector<char> view_checked_, fallback_;
  std::vector<BufferSource> buffers_;
  std::vector<std::uint32_t> without_view_;
  std::uint64_t total_ = 0;
};

}  // namespace palpa::geometry::gltf
