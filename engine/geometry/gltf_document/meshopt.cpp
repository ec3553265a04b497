#include "geometry/gltf_document/meshopt.hpp"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <array>

#include "base/error.hpp"

namespace palpa::geometry::gltf {

std::optional<std::string> meshopt_fault(const MeshoptBufferView& view) {
  const bool attributes = view.mode == MeshoptMode::attributes;
  // The decoders assume these conditions.
  if (attributes && (view.stride == 0 || view.stride % 4 != 0 || view.stride > 256))
    return fmt::format("\"byteStride\" is {}; for attributes it must be a multiple of 4, at most 256", view.stride);
  if (!attributes && view.stride != 2 && view.stride != 4)
    return fmt::format("\"byteStride\" is {}; for indices it must be 2 or 4", view.stride);
  if (view.mode == MeshoptMode::triangles && view.count % 3 != 0)
    return fmt::format("\"count\" is {}; triangles have three indices each", view.count);
  if (!attributes && view.filter != MeshoptFilter::none) return "has a filter, which only attributes may have";
  if (view.filter == MeshoptFilter::octahedral && view.stride != 4 && view.stride != 8)
    return fmt::format("\"byteStride\" is {}; the filter OCTAHEDRAL needs 4 or 8", view.stride);
  if (view.filter == MeshoptFilter::quaternion && view.stride != 8)
    return fmt::format("\"byteStride\" is {}; the filter QUATERNION needs 8", view.stride);
  return std::nullopt;
}

std::vector<unsigned char> unpack_meshopt(const std::string& file, const MeshoptBufferView& view,
                                          std::span<const unsigned char> packed) {
  using Decode = int (*)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
  static constexpr std::array<Decode, 3> decoders{meshopt_decodeVertexBuffer, meshopt_decodeIndexBuffer,
                                                  meshopt_decodeIndexSequence};
  using Filter = void (*)(void*, std::size_t, std::size_t);
  static constexpr std::array<Filter, 4> filters{nullptr, meshopt_decodeFilterOct, meshopt_decodeFilterQuat,
                                                 meshopt_decodeFilterExp};
  std::vector<unsigned char> out(view.stride * view.count);
  const Decode decode = decoders.at(static_cast<std::size_t>(view.mode));
  if (decode(out.data(), view.count, view.stride, packed.data(), packed.size()) != 0) {
    const std::string where =
        fmt::format("buffer {}: bytes {} to {} are", view.buffer, view.offset, view.offset + view.length);
    // Version 1 belongs to KHR_meshopt_compression, and older libraries cannot unpack it.
    if (const int codec = packed.empty() ? 0 : packed[0];
        view.mode == MeshoptMode::attributes && codec > 0xa0 && codec <= 0xaf) {
      throw bad_input(file,
                      fmt::format("{} packed with version {} of meshoptimizer's vertex codec, but palpa was built "
                                  "with a meshoptimizer that reads version 0 only: pack the model with "
                                  "EXT_meshopt_compression, or not at all",
                                  where, codec & 0xf));
    }
    throw bad_input(file, fmt::format("{} not what the meshopt compression unpacks to {} elements of {} bytes", where,
                                      view.count, view.stride));
  }
  const Filter filter = filters.at(static_cast<std::size_t>(view.filter));
  if (filter != nullptr) filter(out.data(), view.count, view.stride);
  return out;
}

}  // namespace palpa::geometry::gltf
