// The solvers' pass: it stays inside its buffers at every size, gives the same bytes every time, and has its header's
// layout.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <numbers>
#include <tuple>

#include "array/drive_pass.hpp"
#include "array/farthest.hpp"
#include "backends.hpp"
#include "focus_sets.hpp"
#include "gpu/barrier.hpp"
#include "gpu/texel_view.hpp"
#include "spirv/solve_diagonal.comp.hpp"
#include "spirv/solve_even_phases.comp.hpp"
#include "spirv/solve_greedy.comp.hpp"
#include "spirv/solve_mirrored.comp.hpp"
#include "spirv/solve_refine.comp.hpp"
#include "spirv/solve_weights.comp.hpp"
#include "spirv/solve_weights_few.comp.hpp"
#include "support/device.hpp"
#include "support/digest.hpp"
#include "support/instrumented.hpp"
#include "support/spirv.hpp"

namespace palpa::array {
namespace {

using test::GuardedBuffer;

Layout line(std::size_t count) {
  Layout layout;
  for (std::size_t i = 0; i < count; ++i)
    layout.transducers.push_back(
        {{0.004 * static_cast<double>(i % 40), 0.004 * static_cast<double>(i / 40), 0}, {0, 0, 1}});
  return layout;
}

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
  static const SolverPass gs_pat_pass(device, Solver::gs_pat), greedy_pass(device, Solver::greedy);
  const SolverPass& pass = solver == Solver::greedy ? greedy_pass : gs_pat_pass;
  const Medium air;
  const double turns = air.turns_per_metre();
  const FarthestTransducer farthest(layout);
  std::vector<shader::DrivePoint> points;
  std::vector<shader::vec4> axes;
  for (const Transducer& t : layout.transducers) {
    points.push_back(drive_point(t.position, turns));
    axes.push_back({0, 0, 1, 0});
  }
  std::vector<shader::DriveFocus> foci;
  std::vector<shader::DriveSlot> slots;
  SolveBatch shape;
  std::uint32_t entries = 0;
  for (const auto& slot : batch) {
    const auto count = static_cast<std::uint32_t>(slot.size());
    slots.push_back({static_cast<std::uint32_t>(foci.size()), count, 1, count > 1 ? entries : shader::drive_unsolved});
    if (count > 1) entries += count * count;
    if (count > 1) shape.sizes |= std::uint64_t{1} << (count - 1);
    for (const SlotFocus& focus : slot) {
      const shader::DrivePoint point = drive_point(focus.position, turns);
      foci.push_back({point.coarse, point.fine});
      foci.back().coarse.w = static_cast<float>(1 / (farthest.distance_from(focus.position) * turns));
      foci.back().fine.w = focus.gain;
    }
  }
  shape.transducers = static_cast<std::uint32_t>(points.size());
  shape.slots = static_cast<std::uint32_t>(slots.size());
  shape.constraint = constraint;
  shape.nearest = layout.transducer_radius_m * turns;
  auto point_buffer = GuardedBuffer::of<shader::DrivePoint>(device, points);
  auto axis_buffer = GuardedBuffer::of<shader::vec4>(device, axes);
  auto focus_buffer = GuardedBuffer::of<shader::DriveFocus>(device, foci);
  auto slot_buffer = GuardedBuffer::of<shader::DriveSlot>(device, slots);
  auto table = GuardedBuffer::of<std::uint32_t>(device, solver_directivity(Directivity::t4010a1, 3.3));
  GuardedBuffer weights(device, foci.size() * 16), drives(device, points.size() * slots.size() * 8);
  test::GuardedScratch scratch(device, SolverPass::scratch(solver, static_cast<std::uint32_t>(foci.size())));
  const auto floats = [&](const GuardedBuffer& buffer) {
    return gpu::TexelView(device, buffer.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "texels");
  };
  const gpu::TexelView point_texels = floats(point_buffer), axis_texels = floats(axis_buffer),
                       focus_texels = floats(focus_buffer),
                       slot_texels(device, slot_buffer.ref(), VK_FORMAT_R32G32B32A32_UINT, "slots"),
                       table_texels(device, table.ref(), VK_FORMAT_R32_UINT, "directivity");
  test::run_on_device([&](VkCommandBuffer commands) {
    pass.record(commands,
                {point_texels.ref(), focus_texels.ref(), slot_texels.ref(), drives.ref(), weights.ref(),
                 axis_texels.ref(), table_texels.ref()},
                scratch, shape);
    gpu::compute_to_compute(commands);
  });
  EXPECT_TRUE(point_buffer.intact() && axis_buffer.intact() && focus_buffer.intact() && slot_buffer.intact() &&
              table.intact() && scratch.intact() && weights.intact() && drives.intact());
  if (solver == Solver::greedy) return;
  for (const float factor : weights.read<float>())
    ASSERT_TRUE(std::isfinite(factor));
  // The matrix against sums that are computed here.
  const auto matrix = matrices_of(scratch, entries);
  const double k = 2 * std::numbers::pi * turns;
  for (std::size_t s = 0; s < batch.size(); ++s) {
    if (batch[s].size() < 2) continue;
    const std::size_t count = batch[s].size();
    for (const auto& [row, column] : {std::pair{count - 1, 0ul}, {0ul, count - 1}, {count / 2, count / 2}}) {
      std::complex<double> sum = 0;
      double size = 0;
      const Vec3 at = batch[s][row].position, asks = batch[s][column].position;
      for (const Transducer& t : layout.transducers) {
        const double d = glm::distance(t.position, at), other = glm::distance(t.position, asks);
        const double loud = directivity(Directivity::t4010a1, (at.z - t.position.z) / d, 3.3) / (d * turns);
        const double asked = other / farthest.distance_from(asks);
        sum += loud * asked * std::exp(std::complex<double>(0, k * (d - other)));
        size += loud * asked;
      }
      const std::complex<double> found(matrix[slots[s].solved + column * count + row]);
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
    run_guarded(line(transducers), batch, Solver::gs_pat, Constraint::normalise);
    run_guarded(line(transducers), batch, Solver::gs_pat, Constraint::uniform);
    run_guarded(line(transducers), batch, Solver::greedy, Constraint::uniform);
  }
}

// For each kernel, the smallest case: instrumented kernels take most of a minute to compile.
TEST(SolverPass, StaysInsideItsBuffers) {
  const std::vector<std::vector<SlotFocus>> batch{focus_set(3, 3, {0.05, 0, 0.1}), focus_set(5, 11, {0.05, 0, 0.1})};
  run_guarded(line(33), batch, Solver::gs_pat, Constraint::uniform);
  run_guarded(line(33), batch, Solver::greedy, Constraint::uniform);
}

TEST(SolverPass, TheSameBytesOnEveryRun) {
  const Layout layout = load_layout("openmpd");
  std::vector<std::vector<SlotFocus>> slots;
  for (unsigned seed = 0; seed < 40; ++seed)
    slots.push_back(focus_set(seed, 1 + seed % 20, {0, 0, 0.15}));
  test::Digest digest;
  for (const Solver solver : {Solver::gs_pat, Solver::greedy}) {
    for (const Constraint constraint : {Constraint::normalise, Constraint::uniform}) {
      DriveOptions options;
      options.solver = solver;
      options.constraint = constraint;
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
  const Layout layout = line(shader::solve_turns + 700);
  DriveOptions options;
  options.solver = Solver::greedy;
  const std::vector<std::vector<SlotFocus>> slots{focus_set(1, 3, {0.08, 0.4, 0.2})};
  const auto twin = backends[0].drives(layout, slots, options), device = backends[1].drives(layout, slots, options);
  std::size_t others = 0;
  for (std::size_t t = 0; t < twin[0].size(); ++t)
    others += angle_between(twin[0][t].phase, device[0][t].phase) > 1e-4;
  EXPECT_LE(others, twin[0].size() / 10);
}

TEST(SolverPass, LayoutIsWhatTheShadersHave) {
  const std::pair<const gpu::Kernel*, std::uint32_t> kernels[]{
      {&spirv::solve_diagonal_comp, shader::solve_group},
      {&spirv::solve_mirrored_comp, shader::solve_group},
      {&spirv::solve_weights_comp, shader::solve_group},
      {&spirv::solve_weights_few_comp, shader::solve_weights_few_group},
      {&spirv::solve_even_phases_comp, shader::solve_phases_group},
      {&spirv::solve_refine_comp, shader::solve_group},
      {&spirv::solve_greedy_comp, shader::solve_group}};
  for (const auto& [kernel, threads] : kernels) {
    const test::SpirvModule module = test::read_spirv(*kernel);
    const char* name = kernel->name;
    EXPECT_EQ(module.local_size[0], threads) << name;
    EXPECT_EQ(module.structs.at("SolvePush").offsets.at("nearest"), offsetof(shader::SolvePush, nearest)) << name;
    EXPECT_EQ(module.structs.at("SolvePush").offsets.at("refinings"), offsetof(shader::SolvePush, refinings)) << name;
    EXPECT_EQ(module.structs.at("SolvePush").offsets.at("most_weight"), offsetof(shader::SolvePush, most_weight));
    EXPECT_EQ(module.structs.at("SolvePush").offsets.at("next"), offsetof(shader::SolvePush, next));
  }
}

}  // namespace
}  // namespace palpa::array
