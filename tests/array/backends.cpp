#include "backends.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "array/drive.hpp"
#include "array/drive_pass.hpp"
#include "support/device.hpp"

namespace palpa::array {
namespace {

std::vector<Drive> on_host(const Layout& layout, const std::vector<std::vector<SlotFocus>>& slots,
                           const DriveOptions& options) {
  std::vector<Drive> drives;
  for (const auto& foci : slots)
    drives.push_back(drive_for(layout, foci, options));
  return drives;
}

std::vector<Drive> on_device(const Layout& layout, const std::vector<std::vector<SlotFocus>>& slots,
                             const DriveOptions& options) {
  gpu::Device& device = test::test_device();
  static const DrivePasses passes[]{{device, Solver::naive},      {device, Solver::gs_pat},
                                    {device, Solver::greedy},     {device, Solver::loudest},
                                    {device, Solver::eigenvalue}, {device, Solver::back_propagation}};
  std::size_t foci = 0;
  for (const auto& slot : slots)
    foci += slot.size();
  DriveMemory buffers(device, layout, options, static_cast<std::uint32_t>(slots.size()),
                      static_cast<std::uint32_t>(foci));
  for (const auto& slot : slots)
    EXPECT_TRUE(buffers.add_slot(slot));
  test::run_on_device(
      [&](VkCommandBuffer commands) { buffers.record(commands, passes[static_cast<std::size_t>(options.solver)]); });
  buffers.solve_on_host();
  std::vector<Drive> drives;
  for (std::uint32_t s = 0; s < buffers.slots(); ++s) {
    const auto drive = buffers.drive(s);
    drives.emplace_back(drive.begin(), drive.end());
  }
  return drives;
}

}  // namespace

// One focus: the phase's own rounding to float, twice. Sums: lavapipe's atan is exact to 3.5e-6.
const Backend backends[2] = {{"twin", on_host, 2.5e-7, 1e-7}, {"gpu", on_device, 1e-6, 1e-5}};

double angle_between(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * std::numbers::pi));
}

std::size_t faults(const Drive& drive) {
  return static_cast<std::size_t>(std::ranges::count_if(drive, [](const TransducerDrive& t) {
    const double phase = t.phase;
    return !(t.amplitude >= 0 && t.amplitude <= 1 && phase > -std::numbers::pi && phase <= std::numbers::pi);
  }));
}

bool same(std::span<const TransducerDrive> a, std::span<const TransducerDrive> b) {
  return std::ranges::equal(a, b, [](const TransducerDrive& x, const TransducerDrive& y) {
    return x.amplitude == y.amplitude && x.phase == y.phase;
  });
}

std::vector<std::vector<SlotFocus>> random_slots(std::size_t slots, std::size_t most_foci, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.08, 0.08);
  std::uniform_real_distribution<float> gain(0, 1);
  std::vector<std::vector<SlotFocus>> all(slots);
  for (auto& foci : all) {
    foci.resize(random() % (most_foci + 1));
    for (SlotFocus& focus : foci)
      focus = {{place(random), place(random), place(random)}, gain(random)};
  }
  return all;
}

}  // namespace palpa::array
