// The solvers on the GPU: how the foci of many slots share the array, in one submit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "gpu/scratch.hpp"
#include "shaders/array/solve/solve.h"

namespace palpa::array {

/// The bindings of one recording of the pass. Texels are views of 16 bytes each (gpu/texel_view.hpp).
struct SolveBindings {
  gpu::BufferRef transducers;  ///< in: texels of shader::DrivePoint[transducers]
  gpu::BufferRef foci;         ///< in: texels of shader::DriveFocus[]
  gpu::BufferRef slots;   ///< in: texels of shader::DriveSlot[slots]; those with `solved` == drive_unsolved are skipped
  gpu::BufferRef drives;  ///< out: of greedy; of gs_pat under `uniform` and `clamp`: the phase changes of the
                          ///< transducers, for the drives' kernel; else scratch
  gpu::BufferRef weights;      ///< out: vec4 per focus, plain and heard factor; scratch of greedy
  gpu::BufferRef axes;         ///< in: texels, vec4[transducers]
  gpu::BufferRef directivity;  ///< in: texels of 4 bytes, solver_directivity
};

struct SolveBatch {
  std::uint32_t transducers = 0;  ///< at least 1
  std::uint32_t slots = 0;        ///< at most 65,535
  /// Bit n: some slot to solve has n + 1 foci.
  std::uint64_t sizes = 0;
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
  double nearest = 0;  ///< radius of a transducer in wavelengths
};

/// Holds only the pipelines of one solver. Twins: gs_pat, greedy, eigenvalue_factors and propagated_factors.
///
/// gs_pat takes three steps. First, the matrix of each slot, with one workgroup per tile of foci. Second, the factors
/// from it, with a thread per slot, or a workgroup for many foci. Third, under `uniform` and `clamp`, a workgroup per
/// slot changes the phases of the transducers, or refines the factors if there are many foci. The factors agree with
/// the twin's within 1e-3. No built-in sine or arctangent is used, so devices only differ by the rounding of
/// multiply-adds. The cost of a slot of M foci (at most solve_finger_foci) and N transducers is N M sines and cosines,
/// N M^2 complex multiply-adds, and at most 200 products of matrix and vector; under `uniform` and `clamp` additionally
/// 1 to 62 times N M sines and cosines and N M^2 / 2 multiply-adds.
///
/// greedy: 16 N M square roots one after the other, with one thread per slot, so it is only fast for many slots. If two
/// phases are equally good within rounding, device and twin may choose differently and diverge from there, to drives
/// that serve the foci equally well.
///
/// `loudest` is gs_pat here: slots whose phases it seeks are solved by the twin and left out of the batch.
///
/// eigenvalue and back_propagation use gs_pat's kernels of many foci for the matrix, and a workgroup per slot for the
/// factors. Under `uniform` and `clamp`, back_propagation goes on over the whole array, one dispatch per step: up to
/// 100 times 2 N M sines and cosines.
///
/// The kernels use the transfer between transducers and foci from shaders/array/drive/transfer_free.glsl, for the
/// matrix and for the columns G of the foci, one transducer at a time. Another transfer is another file with the same
/// names.
class SolverPass {
 public:
  SolverPass(const gpu::Device& device, Solver solver);

  /// For slots with at most `most_foci` foci in total.
  static std::vector<gpu::ScratchBuffer> scratch(Solver solver, std::uint32_t most_foci);

  /// Records nothing for `naive`. Barriers: expects the inputs to be visible to compute, and earlier users of the
  /// scratch, `weights` and `drives` to be done; the caller makes `weights` or `drives` visible afterwards.
  void record(VkCommandBuffer commands, const SolveBindings& bindings, const gpu::Scratch& scratch,
              const SolveBatch& batch) const;

 private:
  enum ScratchIndex : std::size_t { matrices, scratch_count };

  /// Kernels for slots of `fewest` to `most` foci: the matrix, the factors from it, and those that refine them.
  struct ByMatrix {
    std::uint32_t fewest = 0, most = 0, tile = 0;
    gpu::ComputePipeline diagonal, mirrored, weights, refine;
  };
  struct Greedy {
    std::uint32_t fewest = 0, most = 0;
    gpu::ComputePipeline choose;
  };
  struct Buffers;
  void record_by_matrix(VkCommandBuffer commands, const Buffers& buffers, const SolveBatch& batch) const;
  void record_greedy(VkCommandBuffer commands, const Buffers& buffers, const SolveBatch& batch) const;

  Solver solver_;
  std::vector<ByMatrix> by_matrix_;
  std::vector<Greedy> greedy_;
};

/// The directivity table for the shaders: directivity_table in 16 bits, two neighbours per word.
std::vector<std::uint32_t> solver_directivity(Directivity kind, double ka);

}  // namespace palpa::array
