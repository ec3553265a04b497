// The sound field of drives in a plane of the picture, on the device.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/field_pass.hpp"
#include "gpu/commands.hpp"
#include "viewer/picture/field_marks.hpp"

namespace palpa::viewer {

struct SliceField {
  SliceGrid grid;
  std::vector<std::complex<double>> pressures;  ///< Pa, one per sample
};

class FieldSlice {
 public:
  /// For this layout as posed in the world. Device and layout must outlive this object. `most_along`: samples along the
  /// plane's longer side, at most 512.
  FieldSlice(const gpu::Device& device, const array::Layout& layout, const acoustics::Air& air,
             array::Directivity directivity, std::uint32_t most_along = 96);

  /// The field of one drive per transducer, in the free field: nothing is in the way. Waits for the device. The time
  /// grows with the square of `along`, which is limited to most_along, and with the number of transducers.
  SliceField sample(const SliceState& slice, std::span<const array::TransducerDrive> drive, std::uint32_t along);
  /// Puts the field, with most_along samples, into the picture (show_slice).
  void show(Picture& picture, const SliceState& slice, std::span<const array::TransducerDrive> drive);

 private:
  std::uint32_t most_along_;
  acoustics::FieldPass pass_;
  acoustics::FieldMemory memory_;
  gpu::Recorder recorder_;
  gpu::Timeline timeline_;
};

}  // namespace palpa::viewer
