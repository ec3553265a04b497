#include "touch/contacts/solids_memory.hpp"

#include <algorithm>
#include <cstring>

#include "gpu/commands.hpp"

namespace palpa::touch {
namespace {

/// The sizes of all surfaces together.
SurfaceBase total(const PreparedSolids& solids) {
  SurfaceBase all;
  for (std::size_t s = 0; s < solids.records.size(); ++s) {
    const geometry::Surface& surface = solids.surfaces[s];
    if (surface.empty()) continue;
    const SurfaceBase& base = solids.surface_base[s];
    if (base.cells < all.cells) continue;  // a copy, which shares an earlier one
    all = {base.cells + static_cast<std::uint32_t>(surface.cells.size()),
           base.runs + static_cast<std::uint32_t>(surface.runs.size()),
           base.triangles + static_cast<std::uint32_t>(surface.triangles.size()),
           base.corners + static_cast<std::uint32_t>(surface.corners.size())};
  }
  return all;
}

template <typename T>
std::span<T> put(const gpu::Upload& buffer, std::uint32_t first, std::span<const T> values) {
  const std::span<T> place = buffer.as<T>().subspan(first, values.size());
  if (!values.empty()) std::memcpy(place.data(), values.data(), values.size_bytes());
  return place;
}

}  // namespace

SurfaceMemory::Table::Table(const gpu::Device& device, std::uint64_t bytes, VkFormat format, const char* name)
    : memory(device, std::max<std::uint64_t>(bytes, 16), name), view(device, memory.ref(), format, name) {}

SurfaceMemory::SurfaceMemory(const gpu::Device& device, const PreparedSolids& solids) {
  const SurfaceBase all = total(solids);
  cells_ = {device, std::uint64_t{all.cells} * sizeof(shader::SurfaceCell), VK_FORMAT_R32G32_UINT, "surface cells"};
  runs_ = {device, std::uint64_t{all.runs} * sizeof(std::uint32_t), VK_FORMAT_R32_UINT, "surface runs"};
  triangles_ = {device, std::uint64_t{all.triangles} * sizeof(shader::SurfaceTriangle), VK_FORMAT_R32G32B32A32_SFLOAT,
                "surface triangles"};
  signs_ = {device, std::uint64_t{all.triangles} * sizeof(shader::SurfaceSigns), VK_FORMAT_R32G32B32A32_UINT,
            "surface signs"};
  corners_ = {device, std::uint64_t{all.corners} * sizeof(shader::vec4), VK_FORMAT_R32G32B32A32_SFLOAT,
              "surface corners"};
  parts_ = {device, solids.parts.size() * sizeof(shader::uvec4), VK_FORMAT_R32G32B32A32_UINT, "convex parts"};
  std::uint32_t next = 0;
  for (std::size_t s = 0; s < solids.records.size(); ++s) {
    if (solids.surfaces[s].empty() || solids.surface_base[s].cells < next) continue;
    copy(solids.surfaces[s], solids.surface_base[s]);
    next = solids.surface_base[s].cells + static_cast<std::uint32_t>(solids.surfaces[s].cells.size());
  }
  put<shader::uvec4>(parts_.memory, 0, solids.parts);
}

void SurfaceMemory::copy(const geometry::Surface& surface, const SurfaceBase& base) const {
  const auto placed_cells = put(cells_.memory, base.cells, surface.cells);
  const auto placed_runs = put(runs_.memory, base.runs, surface.runs);
  const auto placed_signs = put(signs_.memory, base.triangles, surface.signs);
  put(triangles_.memory, base.triangles, surface.triangles);
  put(corners_.memory, base.corners, surface.corners);
  if (base.cells == 0) return;
  for (shader::SurfaceCell& cell : placed_cells)
    cell.first += (cell.kind & shader::surface_kinds) == shader::surface_divided ? base.cells : base.runs;
  for (std::uint32_t& run : placed_runs)
    run += base.triangles;
  for (shader::SurfaceSigns& sign : placed_signs) {
    for (shader::uint* corner : {&sign.corner0, &sign.corner1, &sign.corner2})
      *corner += base.corners;
  }
}

void SurfaceMemory::record(VkCommandBuffer commands) const {
  for (const Table* table : {&cells_, &runs_, &triangles_, &signs_, &corners_, &parts_})
    table->memory.record(commands);
}

SurfaceBindings SurfaceMemory::surface() const {
  return {cells_.view.ref(), runs_.view.ref(), triangles_.view.ref(), signs_.view.ref(), corners_.view.ref()};
}

SolidsMemory::SolidsMemory(const gpu::Device& device, const PreparedSolids& solids) {
  const gpu::Recorder recorder(device, "solids");
  gpu::Timeline timeline(device, "solids");
  const VkCommandBuffer commands = recorder.begin();
  cells_ = gpu::uploaded(device, commands, std::span(solids.cells), "plane cells");
  planes_ = gpu::uploaded(device, commands, std::span(solids.planes), "planes");
  surfaces_ = SurfaceMemory(device, solids);
  surfaces_.record(commands);
  timeline.wait(timeline.submit(recorder.end()));
}

}  // namespace palpa::touch
