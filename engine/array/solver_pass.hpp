// The solvers on the GPU: how the foci of many slots share the array, in one go.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "array/drive.hpp"
#include "gpu/buffer.hpp"
#include "gpu/pipeline.hpp"
#include "shaders/solve.h"

namespace palpa::array {

/// What one record of the pass binds.
struct SolveRefs {
  gpu::BufferRef transducers;  ///< shader::DrivePoint[transducers]
  gpu::BufferRef axes;         ///< vec4[transducers]
  gpu::BufferRef foci;         ///< shader::DriveFocus[]
  gpu::BufferRef slots;        ///< shader::DriveSlot[slots]; those with `solved` == drive_unsolved are left alone
  gpu::BufferRef directivity;  ///< solver_directivity
  gpu::BufferRef matrices;     ///< scratch: two floats per entry; slot s has count * count from its `solved`
  gpu::BufferRef weights;      ///< written by gs_pat: vec4 per focus, plain and heard factor; scratch of greedy
  gpu::BufferRef drives;       ///< written by greedy; scratch of gs_pat under `uniform` and `clamp`
};

struct SolveBatch {
  std::uint32_t transducers = 0;  ///< at least 1
  std::uint32_t slots = 0;        ///< at most 65,535
  std::uint32_t most_foci = 0;    ///< of any slot that is to be solved, at most most_solved_foci
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
  double nearest = 0;  ///< radius of a transducer in wavelengths
};

/// Pipelines only. Twins: gs_pat and greedy.
///
/// gs_pat: the matrix of each slot by one workgroup per tile of 5 x 5 foci, the factors by one per slot. They agree
/// with the twin's within 1e-3. No built-in sine or arctangent takes part: devices differ by the rounding of
/// multiply-adds only. What a slot of M foci and N transducers costs: N M^2 complex multiply-adds, N M ceil(M / 5)
/// sines and cosines, and at most 60 products of matrix and vector; under `uniform` and `clamp` 8 times 2 N M more of
/// each.
///
/// greedy: 16 N M square roots one after the other, a slot to a thread, so that it is fast only for many slots. Where
/// two phases are equally good to within rounding, device and twin may choose differently and go different ways from
/// there, to drives that serve the foci equally well.
class SolverPass {
 public:
  explicit SolverPass(const gpu::Device& device);

  /// Nothing for `naive`. Barriers: expects the inputs to be visible to compute, and whoever used `matrices`, `weights`
  /// and `drives` before to be done; the caller makes `weights` or `drives` visible afterwards.
  void record(VkCommandBuffer commands, const SolveRefs& refs, const SolveBatch& batch, Solver solver) const;

 private:
  gpu::ComputePipeline diagonal_, mirrored_, weights_, refine_, greedy_few_, greedy_many_;
};

/// The directivity as the shaders look it up: directivity_table in 16 bits, two neighbours per word.
std::vector<std::uint32_t> solver_directivity(Directivity kind, double ka);

}  // namespace palpa::array
