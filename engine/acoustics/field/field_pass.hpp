// The field of one drive on the GPU: its complex pressure at any number of points in free air.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "gpu/buffer.hpp"
#include "gpu/commands.hpp"
#include "gpu/device.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/texel_view.hpp"
#include "shaders/acoustics/field.h"

namespace palpa::acoustics {

/// The bindings of one recording of the pass. Texels are views (gpu/texel_view.hpp).
struct FieldBindings {
  gpu::BufferRef sources;      ///< in: texels of 16 bytes of shader::FieldSource[]
  gpu::BufferRef points;       ///< in: shader::FieldPoint[]
  gpu::BufferRef directivity;  ///< in: texels of 8 bytes of shader::FieldStep[field_directivity_steps]
  gpu::BufferRef pressures;    ///< out: shader::FieldPressure[], one per point
};

/// p(x) = sum over sources of s D(angle) e^{(ik - alpha) r} / max(r, nearest), lengths in wavelengths. Holds only the
/// pipeline. Twin: Incident (incident.hpp); the pass agrees within 1e-4 of the field's root mean square for points
/// within 2 m of the transducers.
class FieldPass {
 public:
  /// The kernel leaves out the table for the `directivity` omni, and the exponential without absorption.
  FieldPass(const gpu::Device& device, array::Directivity directivity, bool absorbing);

  /// Barriers: expects the inputs to be visible to compute; the caller makes `pressures` visible afterwards. At most
  /// most_points at a time.
  void record(VkCommandBuffer commands, const FieldBindings& bindings, const shader::FieldPush& push) const;
  static constexpr std::uint32_t most_points = 65535 * shader::field_group * shader::field_each;

 private:
  gpu::ComputePipeline sum_;
};

/// Memory for the fields of one layout's drives, for a limited number of points at a time. It must not be touched
/// between the submit that recorded it and its completion.
class FieldMemory {
 public:
  /// Throws failure if the device cannot address this many transducers or points.
  FieldMemory(const gpu::Device& device, const array::Layout& layout, const Air& air, array::Directivity directivity,
              std::size_t most_points);

  /// Sets the drive: one strength per transducer.
  void set(std::span<const std::complex<double>> strengths);
  /// Records upload, pass and readback for these points (metres). Complete with the submit, without a further barrier.
  void record(VkCommandBuffer commands, const FieldPass& pass, std::span<const Vec3> points);
  /// The pressures in Pa, one per point. Call it after the submit has completed.
  void read(std::span<std::complex<double>> pressures) const;

 private:
  const array::Layout* layout_;
  double turns_per_metre_;
  shader::FieldPush push_{};
  gpu::Upload sources_, points_, directivity_;
  gpu::TexelView source_texels_, directivity_texels_;
  gpu::Readback pressures_;
};

/// The number of points per submit of field_on: what every device can address, and a fraction of a second on a software
/// device.
std::size_t field_batch(std::size_t transducers);

/// The twin's at() on the device, without slopes, for the drives of many arrays in turn. For one thread at a time.
class FieldOn {
 public:
  FieldOn(const gpu::Device& device, array::Directivity directivity, bool absorbing);

  /// `pressures` gets one entry per point. Points are submitted in batches of a fraction of a second on a software
  /// device. Whether the air absorbs is as given to the constructor. Returns false, with a meaningless result, if
  /// `give_up` became true meanwhile.
  bool at(const array::Layout& layout, const Air& air, std::span<const Vec3> points,
          std::span<const std::complex<double>> strengths, std::vector<std::complex<double>>& pressures,
          const std::atomic<bool>* give_up = nullptr);

 private:
  const gpu::Device* device_;
  array::Directivity directivity_;
  FieldPass pass_;
  gpu::Recorder recorder_;
  gpu::Timeline timeline_;
};

/// The same for a single drive.
bool field_on(const gpu::Device& device, const array::Layout& layout, const Air& air, array::Directivity directivity,
              std::span<const Vec3> points, std::span<const std::complex<double>> strengths,
              std::vector<std::complex<double>>& pressures, const std::atomic<bool>* give_up = nullptr);

}  // namespace palpa::acoustics
