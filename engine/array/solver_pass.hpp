// The solvers on the GPU: how the foci of many slots share the array, in one go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive.hpp"
#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "shaders/array/solve/solve.h"

namespace palpa::array {

/// What one record of the pass binds. Texels are views of 16 bytes each (gpu/texel_view.hpp).
struct SolveBindings {
  gpu::BufferRef transducers;  ///< texels of shader::DrivePoint[transducers]
  gpu::BufferRef foci;         ///< texels of shader::DriveFocus[]
  gpu::BufferRef slots;    ///< texels of shader::DriveSlot[slots]; those with `solved` == drive_unsolved are left alone
  gpu::BufferRef drives;   ///< written by greedy; by gs_pat under `uniform` and `clamp`: by how much transducers turn,
                           ///< for the drives' kernel
  gpu::BufferRef weights;  ///< written by gs_pat: vec4 per focus, plain and heard factor; scratch of greedy
  gpu::BufferRef axes;     ///< texels: vec4[transducers]
  gpu::BufferRef directivity;  ///< texels of 4 bytes: solver_directivity
};

struct SolveBatch {
  std::uint32_t transducers = 0;  ///< at least 1
  std::uint32_t slots = 0;        ///< at most 65,535
  /// Bit n: some slot that is to be solved has n + 1 foci.
  std::uint64_t sizes = 0;
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
  double nearest = 0;  ///< radius of a transducer in wavelengths
};

/// Pipelines only, those of one solver. Twins: gs_pat and greedy.
///
/// gs_pat takes three steps. The matrix of each slot: one workgroup per tile of foci. The factors from it: a thread per
/// slot, or a workgroup where foci are many. Under `uniform` and `clamp` a workgroup per slot turns the transducers, or
/// refines the factors where foci are many. The factors agree with the twin's within 1e-3. No built-in sine or
/// arctangent takes part: devices differ by the rounding of multiply-adds only. What a slot of M foci (at most
/// solve_finger_foci) and N transducers costs: N M sines and cosines, N M^2 complex multiply-adds, and at most 200
/// products of matrix and vector; under `uniform` and `clamp` once to 62 times N M sines and cosines and N M^2 / 2
/// multiply-adds more.
///
/// greedy: 16 N M square roots one after the other, a slot to a thread, so that it is fast only for many slots. Where
/// two phases are equally good to within rounding, device and twin may choose differently and go different ways from
/// there, to drives that serve the foci equally well.
///
/// The kernels know the transfer between transducers and foci as shaders/array/drive/transfer_free.glsl has it, by the
/// matrix and by the columns G of the foci, a transducer at a time: another transfer is another file of the same names.
class SolverPass {
 public:
  SolverPass(const gpu::Device& device, Solver solver);

  /// For slots of `most_foci` foci in all.
  static std::vector<gpu::ScratchBuffer> scratch(Solver solver, std::uint32_t most_foci);

  /// Nothing for `naive`. Barriers: expects the inputs to be visible to compute, and whoever used the scratch,
  /// `weights` and `drives` before to be done; the caller makes `weights` or `drives` visible afterwards.
  void record(VkCommandBuffer commands, const SolveBindings& bindings, const gpu::Scratch& scratch,
              const SolveBatch& batch) const;

 private:
  enum ScratchIndex : std::size_t { matrices, scratch_count };

  /// Kernels for slots of `fewest` to `most` foci.
  struct GsPat {
    std::uint32_t fewest = 0, most = 0, tile = 0;
    gpu::ComputePipeline diagonal, mirrored, weights, refine;
  };
  struct Greedy {
    std::uint32_t fewest = 0, most = 0;
    gpu::ComputePipeline choose;
  };
  struct Buffers;
  void record_gs_pat(VkCommandBuffer commands, const Buffers& buffers, const SolveBatch& batch) const;
  void record_greedy(VkCommandBuffer commands, const Buffers& buffers, const SolveBatch& batch) const;

  std::vector<GsPat> gs_pat_;
  std::vector<Greedy> greedy_;
};

/// The directivity as the shaders look it up: directivity_table in 16 bits, two neighbours per word.
std::vector<std::uint32_t> solver_directivity(Directivity kind, double ka);

}  // namespace palpa::array
