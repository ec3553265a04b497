#include "array/solver_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "array/solvers/back_propagation.hpp"
#include "array/solvers/eigenvalue.hpp"
#include "array/solvers/greedy.hpp"
#include "array/solvers/gs_pat.hpp"
#include "gpu/barrier.hpp"
#include "spirv/solve_diagonal.comp.hpp"
#include "spirv/solve_eigenvalue.comp.hpp"
#include "spirv/solve_even_phases.comp.hpp"
#include "spirv/solve_greedy.comp.hpp"
#include "spirv/solve_mirrored.comp.hpp"
#include "spirv/solve_refine.comp.hpp"
#include "spirv/solve_weights.comp.hpp"
#include "spirv/solve_weights_few.comp.hpp"

namespace palpa::array {

static_assert(shader::solve_most_foci == most_solved_foci);
static_assert(shader::solve_directivity_steps == directivity_steps);
static_assert(shader::solve_phases == greedy_phases);
static_assert(shader::solve_finger_foci == gs_pat_few);
// Each focus has its own thread while the transducers' phases change.
static_assert(shader::solve_phases_group >= shader::solve_finger_foci);
static_assert(shader::solve_starts == gs_pat_starts && shader::solve_sounds == gs_pat_sounds &&
              shader::solve_climb == gs_pat_climb && shader::solve_look == gs_pat_look &&
              shader::solve_tries == gs_pat_tries && shader::solve_bounded_tries == gs_pat_bounded_tries &&
              shader::solve_raises == phases_raises);
static_assert(shader::solve_most_help == static_cast<float>(gs_pat_most_help) &&
              shader::solve_hears == static_cast<float>(gs_pat_hears) &&
              shader::solve_same == static_cast<float>(gs_pat_same) &&
              shader::solve_better == static_cast<float>(gs_pat_better) &&
              shader::solve_miss == static_cast<float>(gs_pat_miss) &&
              shader::solve_fill == static_cast<float>(gs_pat_fill) &&
              shader::solve_uneven == static_cast<float>(phases_uneven) &&
              shader::solve_push == static_cast<float>(phases_push) &&
              shader::solve_keep == static_cast<float>(phases_keep));
static_assert(shader::solve_damping == static_cast<float>(even_damping) &&
              shader::solve_least_damping == static_cast<float>(even_least_damping) &&
              shader::solve_most_damping == static_cast<float>(even_most_damping) &&
              shader::solve_less == static_cast<float>(even_less) &&
              shader::solve_more == static_cast<float>(even_more) &&
              shader::solve_ridge == static_cast<float>(eigenvalue_ridge));

namespace {

gpu::ComputePipeline pipeline(const gpu::Device& device, const char* name, const gpu::Kernel& kernel,
                              std::initializer_list<std::uint32_t> constants) {
  return {device, name, kernel, sizeof(shader::SolvePush), {constants.begin(), constants.size()}};
}

shader::SolvePush push_of(Solver solver, const SolveBatch& batch) {
  shader::SolvePush push{};
  push.transducers = batch.transducers;
  push.slots = batch.slots;
  push.weighting = static_cast<std::uint32_t>(batch.weighting);
  push.constraint = static_cast<std::uint32_t>(batch.constraint);
  push.nearest = static_cast<float>(batch.nearest);
  push.stride = greedy_stride(batch.transducers);
  push.steps = gs_pat_steps;
  push.refinings = gs_pat_refinings;
  push.most_weight = static_cast<float>(gs_pat_most_weight);
  push.still = static_cast<float>(gs_pat_still);
  push.tries = gs_pat_most_tries(batch.transducers);
  if (solver == Solver::eigenvalue) {
    push.steps = eigenvalue_steps;
    push.still = static_cast<float>(eigenvalue_still);
  } else if (solver == Solver::back_propagation) {
    push.steps = batch.constraint == Constraint::normalise ? propagation_steps : 0;  // otherwise over the whole array
    push.still = static_cast<float>(propagation_still);
  }
  return push;
}

/// The largest number of foci of a slot in the batch, within fewest .. most; 0: no slot has such a size.
std::uint32_t most_foci(const SolveBatch& batch, std::uint32_t fewest, std::uint32_t most) {
  while (most >= fewest && !(batch.sizes >> (most - 1) & 1))
    --most;
  return most >= fewest ? most : 0;
}

}  // namespace

/// The kernels' buffers by name: those of the caller, and the scratch.
struct SolverPass::Buffers : SolveBindings {
  gpu::BufferRef matrices = {};
};

SolverPass::SolverPass(const gpu::Device& device, Solver solver) : solver_(solver) {
  std::uint32_t fewest = 2;
  if (is_gs_pat(solver)) {
    for (const std::uint32_t most : {shader::solve_hand_foci, shader::solve_finger_foci}) {
      by_matrix_.push_back({fewest,
                            most,
                            most,
                            pipeline(device, "solve_diagonal", spirv::solve_diagonal_comp, {fewest, most, most}),
                            {},
                            pipeline(device, "solve_weights_few", spirv::solve_weights_few_comp, {fewest, most}),
                            pipeline(device, "solve_even_phases", spirv::solve_even_phases_comp, {fewest, most})});
      fewest = most + 1;
    }
  }
  if (is_gs_pat(solver) || solver == Solver::eigenvalue || solver == Solver::back_propagation) {
    ByMatrix& many = by_matrix_.emplace_back();
    many.fewest = fewest;
    many.most = shader::solve_most_foci;
    many.tile = shader::solve_tile;
    many.diagonal = pipeline(device, "solve_diagonal", spirv::solve_diagonal_comp, {fewest, many.most, many.tile});
    many.mirrored = pipeline(device, "solve_mirrored", spirv::solve_mirrored_comp, {fewest, many.most, many.tile});
    if (solver == Solver::eigenvalue) {
      many.weights = pipeline(device, "solve_eigenvalue", spirv::solve_eigenvalue_comp, {fewest, many.most});
    } else {
      const std::uint32_t weighs = is_gs_pat(solver) ? 1 : 0;
      many.weights = pipeline(device, "solve_weights", spirv::solve_weights_comp, {fewest, many.most, weighs});
      many.refine = pipeline(device, "solve_refine", spirv::solve_refine_comp, {fewest, many.most, weighs});
    }
  }
  if (solver == Solver::greedy) {
    for (const std::uint32_t most : {shader::solve_greedy_few, shader::solve_most_foci}) {
      greedy_.push_back({fewest, most, pipeline(device, "solve_greedy", spirv::solve_greedy_comp, {fewest, most})});
      fewest = most + 1;
    }
  }
}

std::vector<gpu::ScratchBuffer> SolverPass::scratch(Solver solver, std::uint32_t most_foci) {
  // A slot of n foci has n * n entries of two floats, where n is at most most_solved_foci.
  const bool has_matrix = solver != Solver::naive && solver != Solver::greedy;
  const VkDeviceSize entries = has_matrix ? VkDeviceSize{most_foci} * most_solved_foci : 0;
  return {{"focus matrices", entries * 2 * sizeof(float)}};
}

void SolverPass::record(VkCommandBuffer commands, const SolveBindings& bindings, const gpu::Scratch& scratch,
                        const SolveBatch& batch) const {
  if (batch.transducers == 0 || batch.slots == 0 || batch.sizes == 0) return;
  Buffers buffers{bindings};
  buffers.matrices = scratch[matrices];
  if (!by_matrix_.empty()) record_by_matrix(commands, buffers, batch);
  if (!greedy_.empty()) record_greedy(commands, buffers, batch);
}

void SolverPass::record_by_matrix(VkCommandBuffer commands, const Buffers& buffers, const SolveBatch& batch) const {
  const shader::SolvePush push = push_of(solver_, batch);
  bool first = true;
  const auto run = [&](const gpu::ComputePipeline& kernel, const gpu::KernelBuffers& bound, std::uint32_t x,
                       std::uint32_t y = 1) {
    // If it is not the previous step, it is other slots in the same buffers, so a barrier is needed.
    if (!std::exchange(first, false)) gpu::compute_to_compute(commands);
    kernel.dispatch(commands, bound, push, x, y);
  };
  for (const ByMatrix& kernels : by_matrix_) {
    const std::uint32_t foci = most_foci(batch, kernels.fewest, kernels.most);
    if (foci == 0) continue;
    const bool few = kernels.most <= shader::solve_finger_foci;
    const std::uint32_t tiles = gpu::groups_for(foci, kernels.tile);
    run(kernels.diagonal, spirv::solve_diagonal_buffers(buffers), batch.slots, tiles);
    if (tiles > 1) {
      run(kernels.mirrored, spirv::solve_mirrored_buffers(buffers), batch.slots, tiles * (tiles - 1) / 2);
    }
    if (few) {
      run(kernels.weights, spirv::solve_weights_few_buffers(buffers),
          gpu::groups_for(batch.slots, shader::solve_weights_few_group));
    } else if (solver_ == Solver::eigenvalue) {
      run(kernels.weights, spirv::solve_eigenvalue_buffers(buffers), batch.slots);
    } else {
      run(kernels.weights, spirv::solve_weights_buffers(buffers), batch.slots);
    }
    if (batch.constraint == Constraint::normalise || !kernels.refine) continue;
    if (few) {
      run(kernels.refine, spirv::solve_even_phases_buffers(buffers), batch.slots);
    } else {
      const std::uint32_t refinings = is_gs_pat(solver_) ? gs_pat_refinings : propagation_steps;
      for (std::uint32_t i = 0; i < refinings; ++i)
        run(kernels.refine, spirv::solve_refine_buffers(buffers), batch.slots);
    }
  }
}

void SolverPass::record_greedy(VkCommandBuffer commands, const Buffers& buffers, const SolveBatch& batch) const {
  shader::SolvePush push = push_of(solver_, batch);
  bool first = true;
  while (push.begin < batch.transducers) {
    push.end = std::min(push.begin + shader::solve_turns, batch.transducers);
    for (const Greedy& kernels : greedy_) {
      if (most_foci(batch, kernels.fewest, kernels.most) == 0) continue;
      if (!std::exchange(first, false)) gpu::compute_to_compute(commands);
      kernels.choose.dispatch(commands, spirv::solve_greedy_buffers(buffers), push,
                              gpu::groups_for(batch.slots, shader::solve_group));
    }
    push.next = static_cast<std::uint32_t>(std::uint64_t{push.end} * push.stride % batch.transducers);
    push.begin = push.end;
  }
}

std::vector<std::uint32_t> solver_directivity(Directivity kind, double ka) {
  const std::vector<double> table = directivity_table(kind, ka);
  const auto sample = [&](std::size_t i) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(table[i], 0.0, 1.0) * 65535));
  };
  std::vector<std::uint32_t> words(directivity_steps);
  for (std::size_t i = 0; i < words.size(); ++i)
    words[i] = sample(i) | sample(i + 1) << 16;
  return words;
}

}  // namespace palpa::array
