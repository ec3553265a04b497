#include "array/solver_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "array/greedy.hpp"
#include "gpu/barrier.hpp"
#include "spirv/solve_diagonal.comp.hpp"
#include "spirv/solve_greedy.comp.hpp"
#include "spirv/solve_mirrored.comp.hpp"
#include "spirv/solve_refine.comp.hpp"
#include "spirv/solve_weights.comp.hpp"

namespace palpa::array {

static_assert(shader::solve_most_foci == most_solved_foci);
static_assert(shader::solve_directivity_steps == directivity_steps);
static_assert(shader::solve_phases == greedy_phases);
static_assert(shader::solve_few == gs_pat_few);
static_assert(gs_pat_most_help == 4);  // in solve_step.glsl

namespace {

// Fewest and most foci of a slot.
constexpr std::array<std::uint32_t, 2> few{2, shader::solve_few_foci};
constexpr std::array<std::uint32_t, 2> many{shader::solve_few_foci + 1, shader::solve_most_foci};

gpu::PipelineLayout layout(std::span<const std::uint32_t> constants = {}) {
  return {shader::solve_buffers, sizeof(shader::SolvePush), constants};
}

}  // namespace

SolverPass::SolverPass(const gpu::Device& device)
    : diagonal_(device, "solve_diagonal", spirv::solve_diagonal_comp, layout()),
      mirrored_(device, "solve_mirrored", spirv::solve_mirrored_comp, layout()),
      weights_(device, "solve_weights", spirv::solve_weights_comp, layout()),
      refine_(device, "solve_refine", spirv::solve_refine_comp, layout()),
      greedy_few_(device, "solve_greedy", spirv::solve_greedy_comp, layout(few)),
      greedy_many_(device, "solve_greedy_many", spirv::solve_greedy_comp, layout(many)) {}

void SolverPass::record(VkCommandBuffer commands, const SolveRefs& refs, const SolveBatch& batch, Solver solver) const {
  if (solver == Solver::naive || batch.transducers == 0 || batch.slots == 0 || batch.most_foci < 2) return;
  shader::SolvePush push{};
  push.transducers = batch.transducers;
  push.slots = batch.slots;
  push.weighting = static_cast<std::uint32_t>(batch.weighting);
  push.constraint = static_cast<std::uint32_t>(batch.constraint);
  push.nearest = static_cast<float>(batch.nearest);
  push.stride = greedy_stride(batch.transducers);
  push.steps = gs_pat_steps;
  push.most_weight = static_cast<float>(gs_pat_most_weight);
  push.still = static_cast<float>(gs_pat_still);
  const auto run = [&](const gpu::ComputePipeline& pipeline, std::uint32_t x, std::uint32_t y = 1) {
    pipeline.dispatch(commands,
                      {refs.transducers, refs.axes, refs.foci, refs.slots, refs.directivity, refs.matrices,
                       refs.weights, refs.drives},
                      push, x, y);
  };
  if (solver == Solver::greedy) {
    std::uint32_t next = 0;
    for (push.begin = 0; push.begin < batch.transducers; push.begin = push.end) {
      if (push.begin > 0) gpu::compute_to_compute(commands);
      push.end = std::min(push.begin + shader::solve_turns, batch.transducers);
      push.next = next;
      run(greedy_few_, gpu::groups_for(batch.slots, shader::solve_group));
      if (batch.most_foci > shader::solve_few_foci) {
        // Other slots, but the same buffers, which nothing else tells apart.
        gpu::compute_to_compute(commands);
        run(greedy_many_, gpu::groups_for(batch.slots, shader::solve_group));
      }
      next = static_cast<std::uint32_t>(std::uint64_t{push.end} * push.stride % batch.transducers);
    }
    return;
  }
  const std::uint32_t tiles = gpu::groups_for(batch.most_foci, shader::solve_tile);
  run(diagonal_, batch.slots, tiles);
  if (tiles > 1) {
    gpu::compute_to_compute(commands);
    run(mirrored_, batch.slots, tiles * (tiles - 1) / 2);
  }
  gpu::compute_to_compute(commands);
  run(weights_, batch.slots);
  if (batch.constraint == Constraint::normalise) return;
  for (std::uint32_t i = 0; i < gs_pat_refinings; ++i) {
    gpu::compute_to_compute(commands);
    run(refine_, batch.slots);
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
