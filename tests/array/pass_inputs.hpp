// The inputs of the passes for drives, written from shaders/array/drive/drive.h's description alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "array/drive_pass.hpp"
#include "focus_sets.hpp"
#include "gpu/texel_view.hpp"
#include "support/device.hpp"

namespace palpa::array {

/// Rows of 40 transducers.
inline Layout rows_of(std::size_t count) {
  Layout layout;
  for (std::size_t i = 0; i < count; ++i)
    layout.transducers.push_back(
        {{0.004 * static_cast<double>(i % 40), 0.004 * static_cast<double>(i / 40), 0}, {0, 0, 1}});
  return layout;
}

struct PassInputs {
  std::vector<shader::DrivePoint> transducers;
  std::vector<shader::DriveFocus> foci;
  std::vector<shader::DriveSlot> slots;
  std::uint32_t entries = 0;  ///< of the matrices of all slots of several foci
  bool several = false;

  /// `solved`: slots of several foci have a matrix.
  PassInputs(const Layout& layout, const std::vector<std::vector<SlotFocus>>& batch, bool solved = false) {
    const double turns = Medium{}.turns_per_metre();
    for (const Transducer& t : layout.transducers)
      transducers.push_back(drive_point(t.position, turns));
    for (const auto& slot : batch) {
      const auto count = static_cast<std::uint32_t>(slot.size());
      float gain = 0;
      for (const SlotFocus& focus : slot)
        gain = std::max(gain, focus.gain);
      slots.push_back({static_cast<std::uint32_t>(foci.size()), count, gain,
                       solved && count > 1 ? entries : shader::drive_unsolved});
      if (count > 1) entries += count * count;
      several = several || count > 1;
      for (const SlotFocus& focus : slot) {
        const shader::DrivePoint point = drive_point(focus.position, turns);
        foci.push_back({point.coarse, point.fine});
        foci.back().coarse.w = static_cast<float>(1 / (farthest_of(layout, focus.position) * turns));
        foci.back().fine.w = gain > 0 ? focus.gain / gain : 1;
      }
    }
    foci.resize(std::max<std::size_t>(1, foci.size()));
  }
};

/// Those inputs in buffers between guard words, and room for the drives.
struct GuardedInputs {
  explicit GuardedInputs(const PassInputs& inputs)
      : transducers(test::GuardedBuffer::of<shader::DrivePoint>(device, inputs.transducers)),
        foci(test::GuardedBuffer::of<shader::DriveFocus>(device, inputs.foci)),
        slots(test::GuardedBuffer::of<shader::DriveSlot>(device, inputs.slots)),
        drives(device, inputs.slots.size() * inputs.transducers.size() * sizeof(shader::DriveOut)) {}

  gpu::Device& device = test::test_device();
  test::GuardedBuffer transducers, foci, slots, drives;
  gpu::TexelView transducer_texels{device, transducers.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "transducers"},
      focus_texels{device, foci.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "foci"},
      slot_texels{device, slots.ref(), VK_FORMAT_R32G32B32A32_UINT, "slots"};

  DriveBindings bindings() const {
    return {transducer_texels.ref(), focus_texels.ref(), slot_texels.ref(), drives.ref(), {}};
  }
  bool intact() { return transducers.intact() && foci.intact() && slots.intact() && drives.intact(); }
};

}  // namespace palpa::array
