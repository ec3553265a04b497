// The field of one drive on the GPU: its complex pressure at any number of points of the free air.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "array/directivity.hpp"
#include "array/layout.hpp"
#include "base/math.hpp"
#include "gpu/buffer.hpp"
#include "gpu/device.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/texel_view.hpp"
#include "shaders/acoustics/field.h"

namespace palpa::acoustics {

/// What one record of the pass binds. Texels are views (gpu/texel_view.hpp).
struct FieldBindings {
  gpu::BufferRef sources;      ///< in: texels of 16 bytes of shader::FieldSource[]
  gpu::BufferRef points;       ///< in: shader::FieldPoint[]
  gpu::BufferRef directivity;  ///< in: texels of 8 bytes of shader::FieldStep[field_directivity_steps]
  gpu::BufferRef pressures;    ///< out: shader::FieldPressure[], one per point
};

/// p(x) = sum over sources of s D(angle) e^{(ik - alpha) r} / max(r, nearest), lengths in wavelengths. The pipeline
/// only. Twin: Incident (incident.hpp), which it follows within 1e-4 of the field's root mean square where points are
/// within 2 m of the transducers.
class FieldPass {
 public:
  /// `directivity` omni asks no table, and without absorption there is no exponential: they are left out of the kernel.
  FieldPass(const gpu::Device& device, array::Directivity directivity, bool absorbing);

  /// Barriers: expects the inputs to be visible to compute; the caller makes `pressures` visible afterwards. At most
  /// most_points at a time.
  void record(VkCommandBuffer commands, const FieldBindings& bindings, const shader::FieldPush& push) const;
  static constexpr std::uint32_t most_points = 65535 * shader::field_group * shader::field_each;

 private:
  gpu::ComputePipeline sum_;
};

/// What the fields of one layout's drives need, so many points at a time. It is not to be touched between the submit
/// that recorded it and its completion.
class FieldMemory {
 public:
  /// Throws failure where the device cannot address so many transducers or points.
  FieldMemory(const gpu::Device& device, const array::Layout& layout, const Air& air, array::Directivity directivity,
              std::size_t most_points);

  /// Of the drive: one strength per transducer.
  void set(std::span<const std::complex<double>> strengths);
  /// Records upload, pass and readback for these points, metres; complete with the submit, no barrier needed.
  void record(VkCommandBuffer commands, const FieldPass& pass, std::span<const Vec3> points);
  /// The pressures in Pa, once the submit has completed; one per point.
  void read(std::span<std::complex<double>> pressures) const;

 private:
  const array::Layout* layout_;
  double turns_per_metre_;
  shader::FieldPush push_{};
  gpu::Upload sources_, points_, directivity_;
  gpu::TexelView source_texels_, directivity_texels_;
  gpu::Readback pressures_;
};

/// How many points field_on has in one submit: what every device addresses, and a fraction of a second on a software
/// one.
std::size_t field_batch(std::size_t transducers);

/// The twin's at() on the device, without slopes and of one drive: `pressures` has one per point. Points go in pieces
/// of a fraction of a second on a software device. False, and nothing of use, if `give_up` became true meanwhile.
bool field_on(const gpu::Device& device, const array::Layout& layout, const Air& air, array::Directivity directivity,
              std::span<const Vec3> points, std::span<const std::complex<double>> strengths,
              std::vector<std::complex<double>>& pressures, const std::atomic<bool>* give_up = nullptr);

}  // namespace palpa::acoustics
