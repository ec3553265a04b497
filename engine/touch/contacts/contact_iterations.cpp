#include "touch/contacts/contact_iterations.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "shaders/touch/contacts/parts_depth.h"
#include "shaders/touch/contacts/surface.h"

namespace palpa::touch {
namespace {

/// Iterations for a solid whose box does not contain the point: a software device also runs the head of a loop that is
/// not taken.
constexpr std::uint64_t for_any_planes = 2, for_any_surface = 4, for_any_parts = 7;
constexpr std::size_t boxes_that_meet = 16;

/// Covers only the cells that are looked up: plane_cell_depth() of contacts_math.h skips those that are too deep.
std::uint64_t longest_of_planes(const PreparedSolids& solids, const shader::SolidRecord& record, float delta,
                                bool deep) {
  const std::size_t cells = std::size_t{record.cells_per_axis} * record.cells_per_axis * record.cells_per_axis;
  std::uint64_t longest = 0;
  for (const shader::PlaneCell& cell : std::span(solids.cells).subspan(record.first_cell, cells)) {
    if (deep || cell.shallowest < delta) longest = std::max<std::uint64_t>(longest, cell.count);
  }
  return longest;
}

std::uint64_t longest_of_parts(const PreparedSolids& solids, const shader::SolidRecord& record) {
  const std::size_t cells = std::size_t{record.cells_per_axis} * record.cells_per_axis * record.cells_per_axis;
  std::uint64_t entries = 0, planes = 0, triangles = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    const shader::uvec4& lists =
        solids.parts[record.first_cell + shader::parts_header_words + c * shader::parts_cell_words];
    entries = std::max<std::uint64_t>(entries, lists.y);
    triangles = std::max<std::uint64_t>(triangles, lists.w);
    for (const shader::uvec4& entry : std::span(solids.parts).subspan(lists.x, lists.y))
      planes = std::max<std::uint64_t>(planes, entry.y);
  }
  return entries * (planes + 2) + triangles;
}

}  // namespace

std::uint32_t contact_iterations(const PreparedSolids& solids, const FingerOptions& parameters) {
  std::uint64_t for_any = for_any_planes;
  std::vector<std::uint64_t> longest;
  longest.reserve(solids.records.size());
  for (std::size_t s = 0; s < solids.records.size(); ++s) {
    const shader::SolidRecord& record = solids.records[s];
    if (record.asked_by == shader::asked_by_parts) {
      for_any = std::max(for_any, for_any_parts);
      longest.push_back(longest_of_parts(solids, record));
    } else if (record.asked_by == shader::asked_by_surface) {
      for_any = std::max(for_any, for_any_surface);
      longest.push_back(std::uint64_t{solids.surfaces[s].longest} + shader::surface_most_levels);
    } else {
      longest.push_back(longest_of_planes(solids, record,
                                          static_cast<float>(solids.delta_m(static_cast<std::uint32_t>(s), parameters)),
                                          parameters.wants_deep()));
    }
  }
  const std::size_t some = std::min(longest.size(), boxes_that_meet);
  std::partial_sort(longest.begin(), longest.begin() + static_cast<std::ptrdiff_t>(some), longest.end(),
                    std::greater<>());
  const std::uint64_t iterations = std::accumulate(longest.begin(), longest.begin() + static_cast<std::ptrdiff_t>(some),
                                                   for_any * solids.records.size() + 1);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(iterations, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace palpa::touch
