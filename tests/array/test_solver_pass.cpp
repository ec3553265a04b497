// The solvers' pass: it stays inside its buffers at every size, and gives the same bytes every time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <map>
#include <numbers>
#include <tuple>

#include "backends.hpp"
#include "focus_sets.hpp"
#include "gpu/barrier.hpp"
#include "pass_inputs.hpp"
#include "support/device.hpp"
#include "support/digest.hpp"
#include "support/instrumented.hpp"

namespace palpa::array {
namespace {

using test::GuardedBuffer;

/// R of all slots, as the pass left it.
std::vector<std::complex<float>> matrices_of(const gpu::Scratch& scratch, std::size_t entries) {
  const gpu::Readback back(test::test_device(), entries * sizeof(std::complex<float>), "matrices");
  test::run_on_device([&](VkCommandBuffer commands) {
    gpu::writes_to_transfer(commands);
    const VkBufferCopy copy{scratch[0].offset, 0, entries * sizeof(std::complex<float>)};
    vkCmdCopyBuffer(commands, scratch[0].buffer, back.ref().buffer, 1, &copy);
    back.record(commands);
  });
  const auto found = back.as<std::complex<float>>();
  return {found.begin(), found.begin() + static_cast<std::ptrdiff_t>(entries)};
}

void run_guarded(const Layout& layout, const std::vector<std::vector<SlotFocus>>& batch, Solver solver,
                 Constraint constraint) {
  gpu::Device& device = test::test_device();
  static std::map<Solver, SolverPass> passes;
  const SolverPass& pass = passes.try_emplace(solver, device, solver).first->second;
  const double turns = Medium{}.turns_per_metre();
  const PassInputs inputs(layout, batch, true);
  const std::vector<shader::vec4> axes(layout.transducers.size(), {0, 0, 1, 0});
  SolveBatch shape;
  for (const auto& slot : batch) {
    if (slot.size() > 1) shape.sizes |= std::uint64_t{1} << (slot.size() - 1);
  }
  shape.transducers = static_cast<std::uint32_t>(inputs.transducers.size());
  shape.slots = static_cast<std::uint32_t>(inputs.slots.size());
  shape.constraint = constraint;
  shape.nearest = layout.transducer_radius_m * turns;
  GuardedInputs guarded(inputs);
  auto axis_buffer = GuardedBuffer::of<shader::vec4>(device, axes);
  auto table = GuardedBuffer::of<std::uint32_t>(device, solver_directivity(Directivity::t4010a1, 3.3));
  GuardedBuffer weights(device, inputs.foci.size() * 16);
  test::GuardedScratch scratch(device, SolverPass::scratch(solver, static_cast<std::uint32_t>(inputs.foci.size())));
  const gpu::TexelView axis_texels(device, axis_buffer.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "axes"),
      table_texels(device, table.ref(), VK_FORMAT_R32_UINT, "directivity");
  test::run_on_device([&](VkCommandBuffer commands) {
    pass.record(commands,
                {guarded.transducer_texels.ref(), guarded.focus_texels.ref(), guarded.slot_texels.ref(),
                 guarded.drives.ref(), weights.ref(), axis_texels.ref(), table_texels.ref()},
                scratch, shape);
    gpu::compute_to_compute(commands);
  });
  EXPECT_TRUE(guarded.intact() && axis_buffer.intact() && table.intact() && scratch.intact() && weights.intact());
  if (solver == Solver::greedy) return;
  for (const float factor : weights.read<float>())
    ASSERT_TRUE(std::isfinite(factor));
  if (solver == Solver::eigenvalue) return;  // it overwrites the matrix
  // The matrix against sums that are computed here.
  const auto matrix = matrices_of(scratch, inputs.entries);
  const double k = 2 * std::numbers::pi * turns;
  for (std::size_t s = 0; s < batch.size(); ++s) {
    if (batch[s].size() < 2) continue;
    const std::size_t count = batch[s].size();
    for (const auto& [row, column] : {std::pair{count - 1, 0ul}, {0ul, count - 1}, {count / 2, count / 2}}) {
      std::complex<double> sum = 0;
      double size = 0;
      const Vec3 at = batch[s][row].position, asks = batch[s][column].position;
      const double farthest = farthest_of(layout, asks);
      for (const Transducer& t : layout.transducers) {
        const double d = glm::distance(t.position, at), other = glm::distance(t.position, asks);
        const double loud = directivity(Directivity::t4010a1, (at.z - t.position.z) / d, 3.3) / (d * turns);
        const double asked = other / farthest;
        sum += loud * asked * std::exp(std::complex<double>(0, k * (d - other)));
        size += loud * asked;
      }
      const std::complex<double> found(matrix[inputs.slots[s].solved + column * count + row]);
      ASSERT_LE(std::abs(found - sum), 3e-4 * size) << layout.transducers.size() << " " << count << " " << row;
    }
  }
}

TEST(SolverPass, StaysInsideItsBuffersAtEverySize) {
  const std::vector<std::vector<SlotFocus>> batch{focus_set(1, 2, {0.05, 0.02, 0.1}), focus_set(2, 1, {0.05, 0, 0.1}),
                                                  focus_set(3, 5, {0.05, 0, 0.1}),    focus_set(4, 6, {0.05, 0, 0.1}),
                                                  focus_set(5, 11, {0.05, 0, 0.1}),   focus_set(6, 17, {0.05, 0, 0.1}),
                                                  focus_set(7, 33, {0.05, 0, 0.1})};
  for (const std::size_t transducers : test::the_first<std::size_t>(2, {33, 300, 1, 31, 129})) {
    run_guarded(rows_of(transducers), batch, Solver::gs_pat, Constraint::normalise);
    run_guarded(rows_of(transducers), batch, Solver::gs_pat, Constraint::uniform);
    run_guarded(rows_of(transducers), batch, Solver::greedy, Constraint::uniform);
    run_guarded(rows_of(transducers), batch, Solver::eigenvalue, Constraint::uniform);
    run_guarded(rows_of(transducers), batch, Solver::back_propagation, Constraint::normalise);
    run_guarded(rows_of(transducers), batch, Solver::back_propagation, Constraint::clamp);
  }
}

// For each kernel, the smallest case: instrumented kernels take most of a minute to compile.
TEST(SolverPass, StaysInsideItsBuffers) {
  const std::vector<std::vector<SlotFocus>> batch{focus_set(3, 3, {0.05, 0, 0.1}), focus_set(5, 11, {0.05, 0, 0.1})};
  run_guarded(rows_of(33), batch, Solver::gs_pat, Constraint::uniform);
  run_guarded(rows_of(33), batch, Solver::greedy, Constraint::uniform);
  run_guarded(rows_of(33), batch, Solver::eigenvalue, Constraint::uniform);
}

TEST(SolverPass, TheSameBytesOnEveryRun) {
  const Layout layout = load_layout("openmpd");
  std::vector<std::vector<SlotFocus>> slots;
  for (unsigned seed = 0; seed < 40; ++seed)
    slots.push_back(focus_set(seed, 1 + seed % 20, {0, 0, 0.15}));
  test::Digest digest;
  for (const Solver solver : {Solver::gs_pat, Solver::greedy, Solver::eigenvalue, Solver::back_propagation}) {
    for (const Constraint constraint : {Constraint::normalise, Constraint::uniform}) {
      const DriveOptions options = with(solver, constraint);
      const auto first = backends[1].drives(layout, slots, options);
      const auto again = backends[1].drives(layout, slots, options);
      for (std::size_t s = 0; s < slots.size(); ++s) {
        ASSERT_EQ(std::memcmp(first[s].data(), again[s].data(), first[s].size() * sizeof(TransducerDrive)), 0);
        for (const TransducerDrive& drive : first[s]) {
          digest.add(drive.amplitude);
          digest.add(drive.phase);
        }
      }
    }
  }
  test::tell_digest("solvers", digest.value());
}

TEST(SolverPass, GreedyGoesOnFromStretchToStretch) {
  // More transducers than a single dispatch handles.
  const Layout layout = rows_of(shader::solve_turns + 700);
  const DriveOptions options = with(Solver::greedy);
  const std::vector<std::vector<SlotFocus>> slots{focus_set(1, 3, {0.08, 0.4, 0.2})};
  const auto twin = backends[0].drives(layout, slots, options), device = backends[1].drives(layout, slots, options);
  std::size_t others = 0;
  for (std::size_t t = 0; t < twin[0].size(); ++t)
    others += angle_between(twin[0][t].phase, device[0][t].phase) > 1e-4;
  EXPECT_LE(others, twin[0].size() / 10);
}

}  // namespace
}  // namespace palpa::array
