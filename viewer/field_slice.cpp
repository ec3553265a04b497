#include "viewer/field_slice.hpp"

#include <algorithm>

#include "acoustics/incident.hpp"

namespace palpa::viewer {
namespace {

constexpr std::uint32_t most_along = 512;

}  // namespace

FieldSlice::FieldSlice(const gpu::Device& device, const array::Layout& layout, const acoustics::Air& air,
                       array::Directivity directivity, std::uint32_t along)
    : along_(std::min(along, most_along)),
      pass_(device, directivity, air.absorption_np_m != 0),
      memory_(device, layout, air, directivity, std::size_t{along_} * along_),
      recorder_(device, "field slice"),
      timeline_(device, "field slice") {}

void FieldSlice::show(Picture& picture, const SliceState& slice, std::span<const array::TransducerDrive> drive) {
  const SliceGrid grid = slice_grid(slice, along_);
  const std::vector<Vec3> points = slice_points(slice, grid);
  pressures_.resize(points.size());
  memory_.set(acoustics::strengths_of(drive));
  memory_.record(recorder_.begin(), pass_, points);
  timeline_.wait(timeline_.submit(recorder_.end()));
  memory_.read(pressures_);
  show_slice(picture, slice, grid, pressures_);
}

}  // namespace palpa::viewer
