// The sound field of drives in a plane of the picture, on the device.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field_pass.hpp"
#include "gpu/commands.hpp"
#include "viewer/field_marks.hpp"

namespace palpa::viewer {

class FieldSlice {
 public:
  /// Of this layout as posed in the world. Device and layout outlive it. `along`: samples along the plane's longer
  /// side, at most 512; the time grows with its square, and with the number of transducers.
  FieldSlice(const gpu::Device& device, const array::Layout& layout, const acoustics::Air& air,
             array::Directivity directivity, std::uint32_t along = 96);

  /// Puts the field of one drive per transducer into the picture (show_slice). Free field: nothing is in the way. Waits
  /// for the device.
  void show(Picture& picture, const SliceState& slice, std::span<const array::TransducerDrive> drive);

 private:
  std::uint32_t along_;
  acoustics::FieldPass pass_;
  acoustics::FieldMemory memory_;
  gpu::Recorder recorder_;
  gpu::Timeline timeline_;
  std::vector<std::complex<double>> pressures_;
};

}  // namespace palpa::viewer
