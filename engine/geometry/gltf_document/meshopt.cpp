#include "geometry/gltf_document/meshopt.hpp"

#include <fmt/format.h>
#include <meshoptimizer.h>

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

std::optional<std::vector<unsigned char>> unpack_meshopt(const MeshoptBufferView& view,
                                                         std::span<const unsigned char> packed) {
  std::vector<unsigned char> out(view.stride * view.count);
  int fault = 0;
  switch (view.mode) {
    case MeshoptMode::attributes:
      fault = meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, packed.data(), packed.size());
      break;
    case MeshoptMode::triangles:
      fault = meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, packed.data(), packed.size());
      break;
    case MeshoptMode::indices:
      fault = meshopt_decodeIndexSequence(out.data(), view.count, view.stride, packed.data(), packed.size());
      break;
  }
  if (fault != 0) return std::nullopt;
  switch (view.filter) {
    case MeshoptFilter::none:
      break;
    case MeshoptFilter::octahedral:
      meshopt_decodeFilterOct(out.data(), view.count, view.stride);
      break;
    case MeshoptFilter::quaternion:
      meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
      break;
    case MeshoptFilter::exponential:
      meshopt_decodeFilterExp(out.data(), view.count, view.stride);
      break;
  }
  return out;
}

unsigned codec_version(const MeshoptBufferView& view, std::span<const unsigned char> packed) {
  const bool is_one = view.mode == MeshoptMode::attributes && !packed.empty() && (packed[0] & 0xf0) == 0xa0;
  return is_one ? packed[0] & 0x0fu : 0;
}

}  // namespace palpa::geometry::gltf
