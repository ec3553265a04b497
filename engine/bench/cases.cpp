// The benchmark's cases. Inputs are the paper's: its objects and finger, three D415, 3984 transducers.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "array/drive.hpp"
#include "array/drive_pass.hpp"
#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "base/system/now.hpp"
#include "bench/bench.hpp"
#include "bench/shapes.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "gpu/commands.hpp"
#include "gpu/pass_time.hpp"
#include "sensing/synthetic.hpp"
#include "session/session.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"
#include "touch/points/passes.hpp"
#include "touch/stage.hpp"

namespace palpa::bench {
namespace {

/// The times of each pass over many runs.
class StageSamples {
 public:
  void add(std::span<const gpu::PassTime> passes) {
    for (const gpu::PassTime& pass : passes)
      add(pass.name, pass.ms);
  }
  void add(const std::string& stage, double ms) {
    for (auto& [name, samples] : stages_) {
      if (name == stage) return samples.push_back(ms);
    }
    stages_.push_back({stage, {ms}});
  }
  void report(const std::string& suite, const std::string& name, std::vector<Row>& rows) const {
    for (const auto& [stage, samples] : stages_)
      rows.push_back(make_row(suite, name, stage, samples));
  }

 private:
  std::vector<std::pair<std::string, std::vector<double>>> stages_;
};

constexpr std::uint32_t warm_up = 10;

bool same_foci(const touch::Touch& a, const touch::Touch& b) {
  if (a.finger_count != b.finger_count || a.contacts.size() != b.contacts.size()) return false;
  for (std::uint32_t f = 0; f < a.finger_count; ++f) {
    for (std::size_t i = 0; i < a.fingers[f].foci.size(); ++i) {
      if (a.fingers[f].foci[i].points != b.fingers[f].foci[i].points) return false;
      if (glm::distance(a.fingers[f].foci[i].position, b.fingers[f].foci[i].position) > 1e-6f) return false;
    }
  }
  return true;
}

bool same_drives(const session::Plan& a, const session::Plan& b) {
  if (a.cycle.length != b.cycle.length || a.drives.size() != b.drives.size() || a.drives.empty()) return false;
  for (std::size_t i = 0; i < a.drives.size(); ++i) {
    const double turn = std::remainder(a.drives[i].phase - b.drives[i].phase, 2 * M_PI);
    // The foci agree only within a micrometre, that is 0.7 mrad.
    if (std::abs(a.drives[i].amplitude - b.drives[i].amplitude) > 1e-4 || std::abs(turn) > 2e-3) return false;
  }
  return true;
}

constexpr const char* on_host = ", host";

/// Times frames one after the other. `frame` computes the frame of a number from 1 on, and returns the times of its
/// steps.
template <typename Frame>
void measure_runs(const Context& context, const std::string& suite, const std::string& name, std::vector<Row>& rows,
                  Frame frame) {
  std::vector<double> total;
  StageSamples stages;
  for (std::uint32_t run = 1; run <= context.runs + warm_up; ++run) {
    const double begin = now_ms();
    const auto& steps = frame(run);
    const double ms = now_ms() - begin;
    if (run <= warm_up) continue;
    total.push_back(ms);
    stages.add(steps);
    context.progress(name, run - warm_up, context.runs);
  }
  Row row = make_row(suite, name, "total", total);
  row.value = 1e3 / row.median_ms;
  row.unit = "frames/s";
  rows.push_back(row);
  stages.report(suite, name, rows);
}

void measure_frame(const Context& context, const std::string& name, const std::vector<geometry::Solid>& solids,
                   const geometry::Mesh& skin, const Transform& T_world_skin, std::vector<Row>& rows) {
  const setup::PosedRig set_up = setup::load_posed_rig({});
  sensing::SyntheticRig rig(set_up.rig.cameras, array::board_mesh(set_up.layout), sensing::Noise::d415, 1);
  sensing::FrameSet frame;
  const sensing::Posed posed{&skin, T_world_skin};
  rig.render(std::span(&posed, 1), 0, frame);

  const session::SessionSetting setting{.scene = name,
                                        .solids = solids,
                                        .cameras = set_up.rig.cameras,
                                        .layout = set_up.layout,
                                        .events = std::nullopt,
                                        // As in a run, where the latency is measured.
                                        .predict = {session::Predict::automatic, 20e-3}};
  session::Session session(context.device, setting), expected(setting);
  session.touch(frame.frames, 0);
  expected.touch(frame.frames, 0);
  if (!same_drives(session.plan(), expected.plan())) twins_disagree(name);

  measure_runs(context, "loop", name, rows, [&](std::uint32_t run) {
    session.touch(frame.frames, run / 90.0, std::uint64_t{7} * run);
    return session.report().passes;
  });
  measure_runs(context, "loop", name + on_host, rows, [&](std::uint32_t run) {
    expected.touch(frame.frames, run / 90.0, std::uint64_t{7} * run);
    return expected.report().passes;
  });
}

geometry::Mesh load_mesh(const std::string& asset) {
  geometry::Mesh mesh;
  for (const geometry::SceneMesh& part : geometry::load_gltf(setup::find_asset(asset)).meshes)
    geometry::append(mesh, part.mesh);
  return mesh;
}

void measure_batch(const Context& context, std::uint32_t slots, std::uint32_t foci_per_slot, const std::string& name,
                   std::vector<Row>& rows) {
  const setup::PosedRig set_up = setup::load_posed_rig({});
  const array::DrivePasses passes(context.device, array::Solver::naive);
  array::DriveMemory buffers(context.device, set_up.layout, {}, slots, slots * foci_per_slot);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.03, 0.03);
  std::vector<std::vector<array::SlotFocus>> foci(slots, std::vector<array::SlotFocus>(foci_per_slot));
  for (auto& slot : foci) {
    for (auto& focus : slot)
      focus.position = Vec3(place(random), place(random), place(random));
    if (!buffers.add_slot(slot)) throw failure("bench: the batch does not fit the device's buffers");
  }
  const gpu::Recorder recorder(context.device, "bench");
  gpu::Timeline timeline(context.device);
  const auto batch = [&] {
    buffers.clear();
    for (const auto& slot : foci) {
      if (!buffers.add_slot(slot)) throw failure("bench: the batch does not fit the device's buffers");
    }
    array::compute_drives(buffers, passes, recorder, timeline);
  };
  batch();
  for (const std::uint32_t slot : {0u, slots / 2, slots - 1}) {
    const array::Drive expected = array::drive_for(set_up.layout, foci[slot]);
    const auto drive = buffers.drive(slot);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double turn = std::remainder(drive[i].phase - expected[i].phase, 2 * M_PI);
      // The phase of a sum that is almost zero is meaningless.
      if (std::abs(drive[i].amplitude - expected[i].amplitude) > 1e-3 ||
          (expected[i].amplitude > 0.05 && std::abs(turn) > 2e-2)) {
        twins_disagree(name);
      }
    }
  }
  Row row = make_row("array", name, "total", time_runs(context, name, context.runs, batch));
  row.value = slots * foci_per_slot * 1e3 / row.median_ms;
  row.unit = "foci x 3984 /s";
  rows.push_back(row);
}

/// Skin is points or, for cameras, images.
template <typename Skin>
void measure_stage(const Context& context, const std::string& name, const std::vector<geometry::Solid>& solids,
                   std::span<const sensing::Camera> cameras, const touch::StageSetting& setting, const Skin& skin,
                   std::vector<Row>& rows) {
  touch::Touch found, expected;
  touch::Passes passes(context.device);
  touch::Stage stage(passes, solids, cameras, setting), host(solids, cameras, setting);
  host.touch(skin, expected);
  stage.touch(skin, found);
  if (!same_foci(found, expected)) twins_disagree(name);
  measure_runs(context, "touch", name, rows, [&](std::uint32_t run) {
    stage.touch(skin, found, run / 90.0);
    return stage.times();
  });
  measure_runs(context, "touch", name + on_host, rows, [&](std::uint32_t run) {
    host.touch(skin, expected, run / 90.0);
    return host.times();
  });
}

void measure_points(const Context& context, const std::string& name, const std::vector<geometry::Solid>& solids,
                    const std::vector<glm::vec3>& points, std::vector<Row>& rows) {
  measure_stage(context, name, solids, {}, {}, sensing::numbered(points), rows);
}

/// As many clusters as there may be fingers, each wider than a finger: flat patches that face the cameras below.
void measure_wide_patches(const Context& context, std::vector<Row>& rows) {
  constexpr double side = 20e-3, apart = 26e-3, below_top = 0.7e-3;
  geometry::Mesh patches;
  for (int i = 0; i < 64; ++i) {
    const int column = i % 8 - 4, row = i / 8 - 4;
    const Vec3 corner(column * apart, -below_top, row * apart);
    const auto first = static_cast<std::uint32_t>(patches.positions.size());
    for (const Vec3& way : {Vec3(0), Vec3(side, 0, 0), Vec3(side, 0, side), Vec3(0, 0, side)})
      patches.positions.push_back(corner + way);
    patches.triangles.push_back({first, first + 1, first + 2});
    patches.triangles.push_back({first, first + 2, first + 3});
  }
  const setup::PosedRig set_up = setup::load_posed_rig({});
  sensing::SyntheticRig rig(set_up.rig.cameras, {}, sensing::Noise::d415, 1);
  sensing::FrameSet frame;
  const sensing::Posed posed{&patches, Transform(1.0)};
  rig.render(std::span(&posed, 1), 0, frame);
  measure_stage(context, "64 wide patches", box_solid(Vec3(-0.2, -0.05, -0.2), Vec3(0.2, 0, 0.2)), set_up.rig.cameras,
                {.follow = true, .hysteresis = touch::Hysteresis::on}, frame.frames, rows);
}

}  // namespace

void measure_loop(const Context& context, std::vector<Row>& rows) {
  const geometry::Ply finger = geometry::read_ply(setup::find_asset("finger.ply"));
  const geometry::Mesh skin{finger.positions, finger.triangles};
  Transform lowered(1.0);
  lowered[3] = Vec4(0, -0.003, 0, 1);
  measure_frame(context, "finger in cube", setup::load_solids(setup::find_asset("cube.glb"), {}), skin, lowered, rows);
  measure_frame(context, "finger in semi-sphere", setup::load_solids(setup::find_asset("semi-sphere.glb"), {}), skin,
                lowered, rows);
  // This box contains everything that the cameras see except the boards; the touch uses a tenth of it.
  measure_frame(context, "hand in large box", box_solid(Vec3(-0.18, -0.18, -0.15), Vec3(0.18, 0.18, 0.15)),
                load_mesh("hand-point.glb"), Transform(1.0), rows);
}

void measure_array(const Context& context, std::vector<Row>& rows) {
  measure_batch(context, 10, 1, "ten foci of one frame", rows);
  measure_batch(context, 10, 2, "ten slots of 2 foci", rows);
  measure_batch(context, 1000, 1, "batch of 1000 foci", rows);
  measure_batch(context, 200, 5, "200 slots of 5 foci", rows);
}

void measure_touch(const Context& context, std::vector<Row>& rows) {
  const geometry::Ply finger = geometry::read_ply(setup::find_asset("finger.ply"));
  std::vector<glm::vec3> points;
  for (const Vec3& p : finger.positions)
    points.emplace_back(p.x, p.y - 0.003, p.z);
  for (const char* object : {"cube", "semi-sphere", "pyramid", "prism"}) {
    measure_points(context, fmt::format("finger in {}", object),
                   setup::load_solids(setup::find_asset(fmt::format("{}.glb", object)), {}), points, rows);
  }
  // A large plate of skin: many contacts, one finger. Also a scattered plate, where most contacts have four or five
  // others within the gap: clusters of any size that wind through each other.
  for (const auto& [kind, apart_m] : {std::pair{"", 5e-4}, std::pair{", scattered", 4.2e-3}}) {
    for (const std::uint32_t contacts : {20'000u, 100'000u}) {
      std::mt19937 random(contacts);
      const double side = std::sqrt(contacts) * apart_m;
      std::uniform_real_distribution<double> along(0, side), deep(1e-5, 1.4e-3);
      std::vector<glm::vec3> plate;
      for (std::uint32_t i = 0; i < contacts; ++i)
        plate.emplace_back(along(random), -deep(random), along(random));
      measure_points(context, fmt::format("{} contacts{}", contacts, kind),
                     box_solid(Vec3(-0.05, -0.1, -0.05), Vec3(side + 0.1, 0, side + 0.1)), plate, rows);
    }
  }
  // The maximum number of fingers, side by side.
  std::mt19937 random(64);
  std::uniform_real_distribution<double> across(-5e-3, 5e-3), deep(1e-5, 1.4e-3);
  std::vector<glm::vec3> patches;
  patches.reserve(20'000);
  for (int i = 0; i < 20'000; ++i)
    patches.emplace_back(0.02 * (i % 8) + across(random), -deep(random), 0.02 * (i / 8 % 8) + across(random));
  measure_points(context, "64 fingers, 20000 contacts", box_solid(Vec3(-0.05, -0.1, -0.05), Vec3(0.25, 0, 0.25)),
                 patches, rows);
  measure_wide_patches(context, rows);
}

}  // namespace palpa::bench
