// Solids, point clouds and both backends, for the tests of touching.
#pragma once

#include <gtest/gtest.h>

#include <glm/vec3.hpp>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "gpu/pass_time.hpp"
#include "touch/points/passes.hpp"
#include "touch/stage.hpp"

namespace palpa::touch::test {

enum class Backend { cpu, gpu };
std::string backend_name(const ::testing::TestParamInfo<Backend>& info);

/// The same test body on both.
class OnBothBackends : public ::testing::TestWithParam<Backend> {};

/// All pipelines that any test of this program needs, on the test device, each created once.
Passes& test_passes();

/// A stage whose points are found on the test device.
class DeviceStage : public Stage {
 public:
  explicit DeviceStage(const std::vector<geometry::Solid>& solids, std::span<const sensing::Camera> cameras = {},
                       const StageSetting& setting = {})
      : Stage(test_passes(), solids, cameras, setting) {}
};

/// One touch of points whose index is their place. On the GPU, all runs in reused memory must agree.
Touch touch_on(Backend backend, const std::vector<glm::vec3>& points, const std::vector<geometry::Solid>& solids,
               const FingerOptions& parameters = {}, int gpu_runs = 2);
/// The same on the device for any indices and setting; `times` gets the passes' times of the last of `runs`.
Touch touch_on_device(std::span<const sensing::SkinPoint> points, const std::vector<geometry::Solid>& solids,
                      const StageSetting& setting, int runs = 1, std::vector<gpu::PassTime>* times = nullptr);
std::vector<sensing::SkinPoint> indexed(const std::vector<glm::vec3>& points);

/// An axis-aligned box as six planes. The mesh stays empty: touching uses only planes and bounds.
geometry::Solid box(const Vec3& low, const Vec3& high, const std::string& name = "box");
/// 40 mm cube, top at y = 0 on the y axis.
geometry::Solid cube();
/// `count` planes that touch a sphere, evenly spread: a convex polytope around it.
geometry::Solid ball(const Vec3& centre, double radius, std::uint32_t count, const std::string& name = "ball");
/// The half of a ball with its flat side down.
geometry::Solid half_ball(const Vec3& centre, double radius, std::uint32_t count);

/// Points on the skin of a finger of 8 mm radius that dips `depth` below y = 0 at (x, z), about 0.35 mm apart. Leaves
/// out points above `highest`, which long films do not need.
std::vector<glm::vec3> fingertip(std::uint32_t count, double depth, double x = 0, double z = 0, unsigned seed = 1,
                                 double highest = 1);
/// Evenly random in a box.
std::vector<glm::vec3> random_points(std::uint32_t count, const Vec3& low, const Vec3& high, unsigned seed = 1);
/// A box so large, with a delta so large, that every point near the origin is a contact.
geometry::Solid everything();
FingerOptions everything_is_contact(double gap = 5e-3, std::uint32_t min_points = 1);

/// The partition as each contact's finger, or -1.
std::vector<int> finger_of_contacts(const Touch& touch);
/// Compares bit for bit, so that NaN and -0 count.
void expect_identical(const Touch& a, const Touch& b);

/// The contacts of clusters, in the order of their smallest contacts. If there are more than max_fingers, only those
/// that become fingers.
std::vector<std::vector<std::uint32_t>> largest(std::vector<std::vector<std::uint32_t>> clusters);

}  // namespace palpa::touch::test
