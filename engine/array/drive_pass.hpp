// Drives on the GPU: many slots in one submit.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/field/farthest.hpp"
#include "array/field/free_field.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/slot_drives.hpp"
#include "array/solver_pass.hpp"
#include "array/transducer_drive.hpp"
#include "gpu/buffer.hpp"
#include "gpu/commands.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/texel_view.hpp"
#include "shaders/array/drive/drive.h"

namespace palpa::array {

/// The bindings of one recording of the pass. Texels are views of 16 bytes each (gpu/texel_view.hpp).
struct DriveBindings {
  gpu::BufferRef transducers;  ///< in: texels of shader::DrivePoint[transducers]
  gpu::BufferRef foci;         ///< in: texels of shader::DriveFocus[]
  gpu::BufferRef slots;   ///< in: texels of shader::DriveSlot[slots]; first + count within `foci`, see most_pass_foci()
  gpu::BufferRef drives;  ///< out: shader::DriveOut[slots * transducers], slot after slot; at most 2^32 - 1
  gpu::BufferRef weights;  ///< in: texels, vec4 per focus, plain and heard factor; only bound if batch.weighted
};

struct DriveBatch {
  std::uint32_t transducers = 0;  ///< at most max_transducers
  std::uint32_t slots = 0;        ///< of this batch
  bool single = true;             ///< some slot has one focus or none
  bool several = true;            ///< some slot has several foci and is not solved (drive_unsolved)
  bool weighted = false;          ///< some slot has several foci and factors for them
  std::uint32_t turned_foci = 0;  ///< slots of at most so many foci with factors turn phases (shader::DrivePush)
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
};

/// The maximum number of foci in a slot for the pass on a device that ends long loops (gpu::DeviceDescription): with
/// more foci, the result would be wrong. (2026 in `paper`, 122 with 65,000 transducers.)
std::size_t most_pass_foci(std::uint32_t transducers);

/// Holds only pipelines. Twin: drive_for. The pass agrees within 2e-6 rad and 1e-6 of amplitude for single foci up to 2
/// m away (farther away, floats are coarser: 2e-4 rad at 10 m). Sums of several foci depend on the device's atan(y, x),
/// for which Vulkan only guarantees 4096 ULP (2.4e-4 of the phase): their drives may differ by that much between
/// devices.
class DrivePass {
 public:
  explicit DrivePass(const gpu::Device& device);

  /// Barriers: expects the inputs to be visible to compute; the caller makes `drives` visible afterwards.
  void record(VkCommandBuffer commands, const DriveBindings& bindings, const DriveBatch& batch) const;

 private:
  gpu::ComputePipeline focus_;
  gpu::ComputePipeline sum_;
  gpu::ComputePipeline weighted_;
};

/// The passes for drives and for the solver that runs before them.
struct DrivePasses {
  DrivePasses(const gpu::Device& device, Solver which) : solver(device, which), drives(device) {}
  SolverPass solver;
  DrivePass drives;
};

/// All memory of one batch in flight; allocated once on construction. Must not be touched between the submit that
/// recorded it and its completion; after that, `drive` may be called.
class DriveMemory {
 public:
  DriveMemory() = default;
  /// `layout` is posed in the frame of the foci; all batches have the same options. Throws bad_usage if the options
  /// have a transfer, or if `most_slots` slots exceed the device's largest storage buffer (128 MiB on small devices:
  /// 4210 slots of 3984 transducers); see fitting_slots.
  DriveMemory(const gpu::Device& device, const Layout& layout, const DriveOptions& options, std::uint32_t most_slots,
              std::uint32_t most_foci);

  /// The maximum number of slots in one batch of this layout.
  static std::uint32_t fitting_slots(const gpu::Device& device, std::size_t transducers);

  /// Starts a new batch.
  void clear();
  /// Adds the next slot, which may have no foci. Returns false and adds nothing if slots or foci would not fit. On a
  /// device that ends long loops, drives of more than most_pass_foci() foci are the host's. On every device, so are
  /// those whose phases are sought (loud_effort in loud_phases.hpp), and those with nulls.
  [[nodiscard]] bool add_slot(std::span<const SlotFocus> foci);
  /// The same with the factors of the foci, as in drive_by_factors. All slots of a batch must be added with the same
  /// overload.
  [[nodiscard]] bool add_slot(std::span<const SlotFocus> foci, std::span<const std::complex<double>> factors);
  std::uint32_t slots() const { return batch_.slots; }
  std::uint32_t transducers() const { return batch_.transducers; }
  /// The slots among these that solve_on_host() computes.
  std::size_t host_slots() const { return host_slots_.size(); }

  /// Records upload, passes and readback of the slots added since `clear`. Complete with the submit, without a further
  /// barrier.
  void record(VkCommandBuffer commands, const DrivePasses& passes);
  /// Computes the drives that are the host's, on worker threads. Call it once per batch, after the last add_slot(). The
  /// device may work meanwhile.
  void solve_on_host();

  /// Drive of the batch's slot `slot`. Call it after the submit has completed, and after solve_on_host().
  std::span<const TransducerDrive> drive(std::uint32_t slot) const;

 private:
  Layout layout_;
  DriveOptions options_;
  FarthestTransducer farthest_{Layout{}};
  std::uint32_t most_slots_ = 0, most_foci_ = 0;
  gpu::Upload transducers_, foci_, slots_, factors_;
  gpu::TexelView transducer_texels_, focus_texels_, slot_texels_, factor_texels_;
  // For the solvers; empty under `naive`.
  gpu::Upload axes_, directivity_;
  gpu::Buffer weights_;
  gpu::Scratch solver_scratch_;
  gpu::TexelView axis_texels_, directivity_texels_, weight_texels_;
  gpu::Readback drives_;
  DriveBatch batch_;
  SolveBatch solve_;
  std::uint32_t used_foci_ = 0, used_entries_ = 0;
  bool by_factors_ = false;
  bool layout_sent_ = false;
  std::size_t pass_foci_ = 0;  ///< slots with more foci are computed on the host
  // Slots that are silent on the device, and computed on the host.
  SlotDrives host_slots_;
  std::size_t most_host_slots_ = 0;
  std::vector<std::uint32_t> host_numbers_;  ///< which slots of the batch they are
  Drive host_drives_;                        ///< one after the other
  bool solved_ = false;
  // Transducers that judge whether foci are near each other.
  Layout ears_;
  FreeField ears_field_;
  std::vector<FocusSource> ears_sources_;
  Columns ears_columns_;
  FocusMatrix ears_matrix_;

  bool fits(std::size_t foci) const { return batch_.slots < most_slots_ && foci <= most_foci_ - used_foci_; }
  void reserve_host_drives(bool ends_long_loops);
  /// Whether the solver searches for phases if foci are near each other.
  bool may_seek() const;
  bool seeks(std::span<const SlotFocus> foci, std::size_t count);
  bool add_host_slot(std::span<const SlotFocus> foci, std::span<const std::complex<double>> factors);
  void add_focus(const SlotFocus& focus, float gain);
};

/// Computes the slots that were added to `memory`, and waits for their drives.
void compute_drives(DriveMemory& memory, const DrivePasses& passes, const gpu::Recorder& recorder,
                    gpu::Timeline& timeline);

/// A place in the form that the shaders need. `w` components are left 0.
shader::DrivePoint drive_point(const Vec3& metres, double turns_per_metre);

}  // namespace palpa::array
