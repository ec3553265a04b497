// The field on the device, against its twin and the definition in doubles. The pass stays inside its buffers.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "acoustics/field/field_pass.hpp"
#include "acoustics/field/incident.hpp"
#include "acoustics/field/pressure.hpp"
#include "acoustics/rigs.hpp"
#include "array/drive_pass.hpp"
#include "gpu/barrier.hpp"
#include "gpu/texel_view.hpp"
#include "support/barriers.hpp"
#include "support/device.hpp"
#include "support/digest.hpp"
#include "support/thrown.hpp"

namespace palpa::acoustics {
namespace {

using namespace array;
using Complex = std::complex<double>;

std::vector<Vec3> random_points(std::size_t count, double half_size, const Vec3& centre = Vec3(0)) {
  std::mt19937 random(11);
  const auto uniform = [&] { return half_size * (2 * static_cast<double>(random()) / 4294967296.0 - 1); };
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(centre + Vec3(uniform(), uniform(), uniform()));
  return points;
}

Drive focus_drive(const Layout& layout, const Vec3& focus) {
  const SlotFocus foci[]{{focus, 1}};
  return drive_for(layout, foci);
}

TEST(FieldPass, IsTheDefinitionsSum) {
  const Layout layout = load_layout("paper");
  const Drive drive = focus_drive(layout, {0.01, 0, 0.02});
  const std::vector<Vec3> points = random_points(300, 0.15);
  for (const Directivity kind : {Directivity::omni, Directivity::piston, Directivity::t4010a1}) {
    for (const Air& air : {air_of({}), without_absorption(air_of({}))}) {
      std::vector<Complex> pressures, expected;
      ASSERT_TRUE(field_on(test::test_device(), layout, air, kind, points, strengths_of(drive), pressures));
      for (const Vec3& point : points)
        expected.push_back(pressure_at(layout, drive, point, air.medium, kind, air.absorption_np_m));
      EXPECT_LT(relative_error(pressures, expected), 2e-5);
    }
  }
}

TEST(MissingBarriers, AreSeenBetweenTheFieldAndTheHost) {
  const Layout layout = load_layout("paper");
  const auto strengths = strengths_of(focus_drive(layout, {0, 0, 0.15}));
  std::vector<Complex> pressures;
  const test::NoBarrierAfter none("field");
  const auto compute = [&] {
    (void)field_on(test::test_device(), layout, air_of({}), Directivity::piston, random_points(10, 0.1), strengths,
                   pressures);
  };
  EXPECT_CONTAINS(test::error_of(compute, Exit::failed), "which field wrote");
}

TEST(FieldPass, IsTheTwinsFarAwayAndOnATransducer) {
  Layout layout = load_layout("openmpd");
  const Drive drive = focus_drive(layout, {0, 0, 0.15});
  std::vector<Vec3> points = random_points(500, 1, {0, 0, 2});
  points.push_back(layout.transducers[100].position);
  points.push_back(layout.transducers[7].position + Vec3(0, 0, 1e-3));
  points.emplace_back(0, 0, -0.3);
  for (const double radius : {layout.transducer_radius_m, 0.0}) {
    layout.transducer_radius_m = radius;
    if (radius == 0) points.erase(points.end() - 3);  // the sound is unbounded there
    std::vector<Complex> pressures;
    Waves twin;
    const Air air = air_of({});
    ASSERT_TRUE(
        field_on(test::test_device(), layout, air, Directivity::t4010a1, points, strengths_of(drive), pressures));
    ASSERT_TRUE(Incident(layout, air, Directivity::t4010a1).at(points, {}, strengths_of(drive), twin));
    EXPECT_LT(relative_error(std::span(pressures).first(500), std::span(twin.pressures).first(500)), 1e-4);
    for (std::size_t i = 500; i < points.size(); ++i)
      EXPECT_LT(std::abs(pressures[i] - twin.pressures[i]), 1e-4 * std::abs(twin.pressures[i])) << i;
  }
}

TEST(FieldPass, StaysInsideItsBuffersAtEverySize) {
  gpu::Device& device = test::test_device();
  const FieldPass pass(device, Directivity::omni, false);
  const std::vector<shader::FieldStep> table(shader::field_directivity_steps, {1, 0});
  for (const std::size_t sources : {0u, 1u, 3u}) {
    for (const std::size_t count : {0u, 1u, 31u, 33u, 127u, 128u, 129u, 300u}) {
      std::vector<shader::FieldSource> from(std::max<std::size_t>(1, sources));
      for (std::size_t n = 0; n < sources; ++n)
        from[n] = {{0, 0, static_cast<float>(n), 1}, {}, {0, 0, 1, 0}};
      std::vector<shader::FieldPoint> to;
      for (std::size_t i = 0; i < count; ++i)
        to.push_back({{10, 0, static_cast<float>(i) / 16, 0}, {}});
      auto source_buffer = test::GuardedBuffer::of<shader::FieldSource>(device, from);
      auto point_buffer = test::GuardedBuffer::of<shader::FieldPoint>(device, to);
      auto table_buffer = test::GuardedBuffer::of<shader::FieldStep>(device, table);
      test::GuardedBuffer pressures(device, count * sizeof(shader::FieldPressure));
      const gpu::TexelView source_texels(device, source_buffer.ref(), VK_FORMAT_R32G32B32A32_SFLOAT, "sources"),
          table_texels(device, table_buffer.ref(), VK_FORMAT_R32G32_UINT, "directivity");
      const shader::FieldPush push{static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(sources), 0.5F, 0};
      test::run_on_device([&](VkCommandBuffer commands) {
        pass.record(commands, {source_texels.ref(), point_buffer.ref(), table_texels.ref(), pressures.ref()}, push);
        gpu::compute_to_compute(commands);
      });
      ASSERT_TRUE(source_buffer.intact() && point_buffer.intact() && table_buffer.intact() && pressures.intact());
      const auto out = pressures.read<shader::FieldPressure>();
      for (std::size_t i = 0; i < count; ++i) {
        Complex expected = 0;
        for (std::size_t n = 0; n < sources; ++n) {
          const double d = std::hypot(10.0, static_cast<double>(i) / 16 - static_cast<double>(n));
          expected += std::polar(1 / d, 2 * 3.14159265358979 * d);
        }
        ASSERT_NEAR(out[i].re, expected.real(), 3e-6) << sources << " " << count << " " << i;
        ASSERT_NEAR(out[i].im, expected.imag(), 3e-6);
      }
    }
  }
}

TEST(FieldPass, TheSameBytesOnEveryRun) {
  const Layout layout = load_layout("autd3");
  const Strengths strengths = strengths_of(focus_drive(layout, {0, 0, 0.2}));
  const std::vector<Vec3> points = random_points(1000, 0.05, {0, 0, 0.2});
  test::Digest digest;
  std::vector<Complex> first, again;
  for (const Directivity kind : {Directivity::omni, Directivity::t4010a1}) {
    const auto run = [&](std::vector<Complex>& out) {
      field_on(test::test_device(), layout, air_of({}), kind, points, strengths, out);
    };
    run(first);
    run(again);
    ASSERT_EQ(std::memcmp(first.data(), again.data(), first.size() * sizeof(Complex)), 0);
    for (const Complex& p : first) {
      digest.add(p.real());
      digest.add(p.imag());
    }
  }
  test::tell_digest("field", digest.value());
}

TEST(FieldPass, APieceIsNeverMoreThanOneDispatchHolds) {
  for (const std::size_t transducers : {0, 1, 2, 15, 16, 17, 249, 3984, 1'000'000, 1'000'000'000}) {
    const std::size_t piece = field_batch(transducers);
    EXPECT_GT(piece, 0u);
    EXPECT_LE(piece, FieldPass::most_points);
    EXPECT_LE(piece * sizeof(shader::FieldPoint), std::size_t{128} << 20);
  }
}

TEST(FieldPass, GivesUpWhenTold) {
  const Layout layout = load_layout("autd3");
  const Strengths strengths(layout.transducers.size(), 1.0);
  const std::atomic<bool> give_up = true;
  std::vector<Complex> pressures;
  EXPECT_FALSE(field_on(test::test_device(), layout, air_of({}), Directivity::omni, random_points(3, 0.1), strengths,
                        pressures, &give_up));
  EXPECT_TRUE(field_on(test::test_device(), layout, air_of({}), Directivity::omni, {}, strengths, pressures));
  EXPECT_TRUE(pressures.empty());
}

}  // namespace
}  // namespace palpa::acoustics
