#include "viewer/sound/field_slice.hpp"

#include <algorithm>

#include "acoustics/field/incident.hpp"

namespace palpa::viewer {
namespace {

constexpr std::uint32_t limit = 512;

}  // namespace

FieldSlice::FieldSlice(const gpu::Device& device, const array::Layout& layout, const acoustics::Air& air,
                       array::Directivity directivity, std::uint32_t most_along)
    : most_along_(std::min(most_along, limit)),
      pass_(device, directivity, air.absorption_np_m != 0),
      memory_(device, layout, air, directivity, std::size_t{most_along_} * most_along_),
      recorder_(device, "field slice"),
      timeline_(device, "field slice") {}

SliceField FieldSlice::sample(const SliceState& slice, std::span<const array::TransducerDrive> drive,
                              std::uint32_t along) {
  SliceField field{slice_grid(slice, std::min(along, most_along_)), {}};
  const std::vector<Vec3> points = slice_points(slice, field.grid);
  field.pressures.resize(points.size());
  memory_.set(acoustics::strengths_of(drive));
  memory_.record(recorder_.begin(), pass_, points);
  timeline_.wait(timeline_.submit(recorder_.end()));
  memory_.read(field.pressures);
  return field;
}

void FieldSlice::show(Picture& picture, const SliceState& slice, std::span<const array::TransducerDrive> drive) {
  const SliceField field = sample(slice, drive, most_along_);
  show_slice(picture, slice, field.grid, field.pressures);
}

}  // namespace palpa::viewer
