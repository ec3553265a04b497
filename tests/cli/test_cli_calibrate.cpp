// `palpa calibrate`: the target, and the poses of cameras that see it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "array/layouts/board_mesh.hpp"
#include "array/layouts/layout.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/record_still.hpp"
#include "cli/support/told.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "sensing/target.hpp"
#include "setup/options/target_mount.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
using sensing::Camera;
using sensing::Rig;

constexpr double degree = std::numbers::pi / 180;

/// Looks at `to` from `from`, upright.
Transform looking(const Vec3& from, const Vec3& to) {
  const Vec3 ahead = glm::normalize(to - from), right = glm::normalize(glm::cross(ahead, Vec3(0, 1, 0)));
  return {Vec4(right, 0), Vec4(glm::cross(ahead, right), 0), Vec4(ahead, 0), Vec4(from, 1)};
}

/// An OpenMPD board that stands 50 mm lower than usual and two centimetres aside, and two D415 above it.
Rig rig_of_a_board() {
  Rig rig = sensing::load_rig(std::filesystem::path(where_assets_are().second) / "rigs/paper.toml");
  rig.cameras.pop_back();
  rig.cameras[0].name = "left";
  rig.cameras[0].T_world_camera = looking({-0.3, 0.12, 0.2}, {0.02, -0.18, 0});
  rig.cameras[1].name = "right";
  rig.cameras[1].T_world_camera = looking({0.2, 0.2, -0.25}, {0.02, -0.18, 0});
  rig.array = sensing::ArrayPlacement{"openmpd", array::load_layout("openmpd").default_T_world_layout, {}};
  (*rig.array->T_world_layout)[3] = Vec4(0.02, -0.2, 0, 1);
  rig.screen.reset();
  return rig;
}

/// With its first camera only.
Rig one_camera(Rig rig) {
  rig.cameras.resize(1);
  return rig;
}

/// The same cameras where nobody knows where they are.
Rig lost(Rig rig) {
  for (Camera& camera : rig.cameras)
    camera.T_world_camera = Transform(1.0);
  return rig;
}

class Calibrate : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const Rig& rig) const {
    write_text(file(name), sensing::to_toml(rig));
    return file(name);
  }

  /// What a rig's cameras see, as a recording: the boards, and the target where `T_world_target` has it.
  std::string record(const std::string& name, const Rig& rig, const Transform& T_world_target) const {
    const array::Layout own = array::load_layout(rig.array->layout);
    geometry::Mesh things =
        array::board_mesh(transformed(own, rig.array->T_world_layout.value_or(own.default_T_world_layout)));
    geometry::append(things, transformed(sensing::make_target(setup::target_mount(own).holes),
                                         [&](const Vec3& p) { return transform_point(T_world_target, p); }));
    sensing::SyntheticRig synthetic(rig.cameras, things, sensing::Noise::d415, 11);
    // Its poses must say nothing.
    return record_still(file(name), lost(rig).cameras, synthetic, {}, {0, 1 / 90.0, 2 / 90.0, 3 / 90.0},
                        sensing::Noise::d415);
  }

  std::filesystem::path folder_ = scratch_folder("calibrate");
};

Transform default_pose_of_target(const Rig& rig) {
  const array::Layout layout = array::load_layout(rig.array->layout);
  return rig.array->T_world_layout.value_or(layout.default_T_world_layout) *
         setup::target_mount(layout).T_layout_target;
}

/// What calibration promises.
void expect_poses(const Rig& found, const Rig& truth) {
  ASSERT_EQ(found.cameras.size(), truth.cameras.size());
  for (std::size_t i = 0; i < truth.cameras.size(); ++i) {
    const Transform &a = found.cameras[i].T_world_camera, &b = truth.cameras[i].T_world_camera;
    EXPECT_LT(glm::distance(Vec3(a[3]), Vec3(b[3])), 0.5e-3) << truth.cameras[i].name;
    double trace = 0;
    for (int k = 0; k < 3; ++k)
      trace += glm::dot(Vec3(a[k]), Vec3(b[k]));
    EXPECT_LT(std::acos(std::min(1.0, (trace - 1) / 2)), 0.2 * degree) << truth.cameras[i].name;
    EXPECT_EQ(found.cameras[i].fx, truth.cameras[i].fx);
  }
}

TEST_F(Calibrate, FindsThePapersCameras) {
  const Rig truth = sensing::load_rig(std::filesystem::path(where_assets_are().second) / "rigs/paper.toml");
  const std::string source = record("seen", truth, default_pose_of_target(truth));
  const Result result =
      succeeded(palpa_here({"calibrate", "--rig", write("lost.toml", lost(truth)), "--source", source, "--out",
                            file("found.toml"), "--json", file("found.json"), "--frames", "3"}));
  EXPECT_EQ(result.err, "");
  const Rig found = sensing::load_rig(file("found.toml"));
  expect_poses(found, truth);
  EXPECT_EQ(found.array->layout, "paper");
  EXPECT_TRUE(found.screen.has_value());
  const json said = json::parse(read_text(file("found.json")));
  EXPECT_EQ(said["frames"], 3);
  ASSERT_EQ(said["cameras"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const json& camera = said["cameras"][i];
    EXPECT_EQ(camera["name"], truth.cameras[i].name);
    EXPECT_GT(camera["points"], 5000);
    // Noise at 0.5 m: 0.57 mm in a frame, along the ray.
    EXPECT_LT(camera["rms_m"], 0.5e-3);
    EXPECT_GT(camera["p95_m"], camera["rms_m"]);
    EXPECT_GT(camera["hold"], 0.1);
    EXPECT_LT(camera["deviation_m"], 0.2e-3);
    EXPECT_GT(camera["deviation_m"], 1e-6);
    EXPECT_LT(camera["deviation_rad"], 2e-3);
    EXPECT_GT(camera["deviation_rad"], 1e-5);
    EXPECT_EQ(camera["T_world_camera"][0][3], found.cameras[i].T_world_camera[3][0]);
  }
  EXPECT_NE(result.out.find("front left: "), std::string::npos);
  EXPECT_NE(result.out.find(" mm rms, "), std::string::npos);
}

TEST_F(Calibrate, ATargetElsewhereIsToldWhere) {
  const Rig truth = one_camera(rig_of_a_board());
  const setup::TargetMount mount = setup::target_mount(array::load_layout("openmpd"));
  const Transform T_world_layout = *truth.array->T_world_layout;
  const Transform elsewhere = T_world_layout * setup::moved_mount(mount, {0.01, 0.005, 0.02}, 90 * degree);
  const std::string source = record("seen", truth, elsewhere);
  const Result told =
      succeeded(palpa_here({"calibrate", "--rig", write("lost.toml", lost(truth)), "--source", source, "--out",
                            file("found.toml"), "--at", "10mm,5mm,20mm", "--turn", "90", "--quiet"}));
  EXPECT_EQ(told.out + told.err, "");
  expect_poses(sensing::load_rig(file("found.toml")), truth);
}

TEST_F(Calibrate, WarnsOfATargetOrACameraOfAnotherScale) {
  const Rig truth = one_camera(rig_of_a_board());
  const std::string large = record("large", truth, glm::scale(default_pose_of_target(truth), Vec3(1.03)));
  const Result result = succeeded(palpa_here({"calibrate", "--rig", write("lost.toml", lost(truth)), "--source", large,
                                              "--json", file("large.json"), "--out", file("found.toml")}));
  const json camera = json::parse(read_text(file("large.json")))["cameras"][0];
  EXPECT_NEAR(camera["scale"], 1.03, 0.008) << camera;
  EXPECT_LT(camera["scale_deviation"], 0.005);
  EXPECT_EQ(result.err_lines().size(), 1u) << result.err;
  EXPECT_CONTAINS(result.err, "camera \"left\": it sees the target");
  EXPECT_CONTAINS(result.err, "% larger than it is");
  EXPECT_CONTAINS(result.err, "either the print or the camera's scale is off");
}

TEST_F(Calibrate, RefusesWhatCannotBeSeen) {
  Rig truth = rig_of_a_board();
  truth.cameras[1].T_world_camera = looking({0.2, 0.2, -0.25}, {0.5, -0.2, -0.8});
  const std::string rig = write("rig.toml", truth), source = record("seen", truth, default_pose_of_target(truth));
  expect_refused({"calibrate", "--source", source, "--out", file("found.toml"), "--rig"},
                 {{{rig}, "camera \"right\": only 0 of its ", 4},
                  {{write("one.toml", one_camera(truth))}, "has 1 [[camera]], and the source has 2", 4}});
  EXPECT_FALSE(std::filesystem::exists(file("found.toml")));
}

TEST_F(Calibrate, TheTargetsHolesStandOverGapsBetweenTransducers) {
  for (const std::string& layout : array::layout_names()) {
    const array::Layout own = array::load_layout(layout);
    const setup::TargetMount mount = setup::target_mount(own);
    for (const double x : {-mount.holes.x_m, mount.holes.x_m}) {
      for (const double y : {-mount.holes.y_m, mount.holes.y_m}) {
        const Vec3 hole = transform_point(mount.T_layout_target, {x, y, 0});
        std::vector<double> far;
        for (const array::Transducer& transducer : own.transducers)
          far.push_back(glm::distance(transducer.position, hole));
        std::sort(far.begin(), far.end());
        // Transducers are 10 mm wide, screws 4 mm.
        EXPECT_GT(far[0], 7e-3) << layout;
        EXPECT_LT(far[3], 7.5e-3) << layout;
      }
    }
    const array::Transducer& any = own.transducers.front();
    if (layout == "paper") continue;
    EXPECT_NEAR(glm::dot(transform_direction(mount.T_layout_target, {0, 0, 1}), any.axis), 1, 1e-12);
  }
}

TEST_F(Calibrate, WritesTheTargetForAPrinter) {
  const Result printed = palpa_here({"calibrate", "--target", file("t.stl"), "--layout", "openmpd"});
  ASSERT_EQ(printed.exit_code, 0);
  EXPECT_TRUE(printed.out.starts_with(file("t.stl") + ": the target for openmpd, in millimetres")) << printed.out;
  EXPECT_NE(printed.out.find("next: print it"), std::string::npos) << printed.out;
  EXPECT_NE(printed.out.find("palpa calibrate --rig RIG --layout openmpd --source SOURCE"), std::string::npos);
  const Result viewed = palpa_here({"calibrate", "--target", file("t.glb"), "--layout", "openmpd"});
  ASSERT_EQ(viewed.exit_code, 0);
  EXPECT_NE(viewed.out.find("palpa-viewer --scene " + file("t.glb")), std::string::npos) << viewed.out;
  const std::string stl = read_text(file("t.stl"));
  const geometry::Scene scene = geometry::load_gltf(file("t.glb"));
  ASSERT_EQ(scene.meshes.size(), 1U);
  const geometry::Mesh& mesh = scene.meshes[0].mesh;
  EXPECT_NEAR(geometry::bounds(mesh).high.y, -0.15 + 0.054, 1e-8);  // on a board that lies 150 mm below the origin
  ASSERT_EQ(stl.size(), 84 + 50 * mesh.triangles.size());
  float highest = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      float z = 0;
      std::memcpy(&z, stl.data() + 84 + 50 * t + 12 * (corner + 1) + 8, sizeof(z));
      highest = std::max(highest, z);
    }
  }
  EXPECT_EQ(highest, 54.0F);  // millimetres
}

}  // namespace
}  // namespace palpa::test
