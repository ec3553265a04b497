// The surface suite: solids of many faces.
#include <fmt/format.h>
#include <stdlib.h>  // setenv

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "array/layouts/board_mesh.hpp"
#include "base/system/now.hpp"
#include "bench/bench.hpp"
#include "bench/shapes.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/surface/surface.hpp"
#include "gpu/commands.hpp"
#include "gpu/pass_time.hpp"
#include "sensing/synthetic.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"
#include "touch/points/passes.hpp"
#include "touch/stage.hpp"

namespace palpa::bench {
namespace {

/// Resets peak_resident_bytes(), if the system allows it.
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// Sets an environment variable temporarily.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Environment() { set(before_ ? before_->c_str() : nullptr); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  void set(const char* value) const {
    if (value != nullptr) {
      setenv(name_, value, 1);
    } else {
      unsetenv(name_);
    }
  }
  const char* name_;
  std::optional<std::string> before_;
};

struct Prepared {
  std::vector<geometry::Solid> solids;
  touch::PreparedSolids table;
};

Prepared prepare(const geometry::Scene& scene) {
  Prepared prepared{geometry::make_solids(scene), {}};
  prepared.table = touch::prepare_solids(prepared.solids);
  return prepared;
}

/// Contacts of the frame in which three cameras see the finger; gives the median.
double measure_contacts(const Context& context, const std::string& name, const std::vector<geometry::Solid>& solids,
                        const setup::PosedRig& set_up, const sensing::FrameSet& frame, double cube_ms,
                        std::vector<Row>& rows) {
  touch::Passes passes(context.device);
  touch::Stage stage(passes, solids, set_up.rig.cameras);
  touch::Touch found, expected;
  std::vector<double> samples;
  touch::Stage twin(solids, set_up.rig.cameras);
  twin.touch(frame.frames, expected);
  constexpr std::uint32_t warm_up = 10;
  for (std::uint32_t run = 0; run < context.runs + warm_up; ++run) {
    stage.touch(frame.frames, found);
    if (run == 0) {
      bool same = found.contacts.size() == expected.contacts.size();
      for (std::size_t i = 0; same && i < found.contacts.size(); ++i) {
        same = found.contacts[i].point == expected.contacts[i].point &&
               std::abs(found.contacts[i].depth_m - expected.contacts[i].depth_m) < 1e-6F;
      }
      if (!same) twins_disagree(name);
    }
    if (run < warm_up) continue;
    double ms = 0;
    for (const gpu::PassTime& time : stage.times()) {
      if (std::string_view(time.name).starts_with("contacts")) ms += time.ms;
    }
    samples.push_back(ms);
    context.progress(name + ", contacts", run - warm_up + 1, context.runs);
  }
  Row row = make_row("surface", name, "contacts", samples);
  if (cube_ms > 0) {
    row.value = 100 * row.median_ms / cube_ms;
    row.unit = "% of the cube's";
  }
  rows.push_back(row);
  return row.median_ms;
}

}  // namespace

Model load_model(const std::string& file) {
  Model model{std::filesystem::path(file).filename().string(), geometry::load_gltf(file)};
  const Environment off("PALPA_CACHE", "off");
  prepare(model.scene);
  return model;
}

void measure_preparation(const Context& context, const std::string& name, const geometry::Scene& scene,
                         std::vector<Row>& rows) {
  std::vector<double> fresh, cached;
  double megabytes = 0;
  for (std::uint32_t run = 0; run < std::min(3U, context.runs); ++run) {
    const Environment off("PALPA_CACHE", "off");
    const std::uint64_t before = resident_bytes();
    reset_peak();
    const double begin = now_ms();
    const Prepared prepared = prepare(scene);
    fresh.push_back(now_ms() - begin);
    megabytes = std::max(megabytes, static_cast<double>(peak_resident_bytes()) - static_cast<double>(before));
    context.progress(name + ", prepared", run, 3);
  }
  Row row = make_row("surface", name, "prepared", fresh);
  row.value = megabytes / 1e6;
  row.unit = "MB";
  rows.push_back(row);
  // A separate cache, so that only newly written entries are measured.
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / fmt::format("palpa-bench-{}", getpid());
  {
    const Environment on("PALPA_CACHE", "on"), here("XDG_CACHE_HOME", folder.c_str());
    prepare(scene);
    for (std::uint32_t run = 0; run < std::min(7U, context.runs); ++run) {
      const double begin = now_ms();
      const Prepared prepared = prepare(scene);
      cached.push_back(now_ms() - begin);
    }
  }
  std::error_code error;
  std::filesystem::remove_all(folder, error);
  rows.push_back(make_row("surface", name, "from cache", cached));
}

void measure_surface(const Context& context, std::vector<Row>& rows) {
  const setup::PosedRig set_up = setup::load_posed_rig({});
  const geometry::Ply finger = geometry::read_ply(setup::find_asset("finger.ply"));
  const geometry::Mesh skin{finger.positions, finger.triangles};
  sensing::SyntheticRig rig(set_up.rig.cameras, array::board_mesh(set_up.layout), sensing::Noise::d415, 1);
  const auto touched_at = [&](const Vec3& tip) {
    Transform lowered(1.0);
    lowered[3] = Vec4(tip, 1);
    sensing::FrameSet frame;
    const sensing::Posed posed{&skin, lowered};
    rig.render(std::span(&posed, 1), 0, frame);
    return frame;
  };
  const sensing::FrameSet frame = touched_at({0, -0.003, 0});
  const double cube_ms =
      measure_contacts(context, "cube", setup::load_solids(setup::find_asset("cube.glb"), {}), set_up, frame, 0, rows);
  const auto model = [&](const std::string& name, const geometry::Scene& scene, const sensing::FrameSet& touched) {
    measure_preparation(context, name, scene, rows);
    measure_contacts(context, name, geometry::make_solids(scene), set_up, touched, cube_ms, rows);
  };
  model("75,000 faces", {"bench", {{"ball", dented_ball(75'000)}}}, frame);
  model("1,000,000 faces", {"bench", {{"ball", dented_ball(1'000'000)}}}, frame);
  if (!context.model) return;
  // 3 mm into its highest vertex.
  Vec3 top(0, -1e300, 0);
  for (const geometry::SceneMesh& part : context.model->scene.meshes) {
    for (const Vec3& p : part.mesh.positions)
      top = p.y > top.y ? p : top;
  }
  model(context.model->name, context.model->scene, touched_at(top - Vec3(0, 0.003, 0)));
}

}  // namespace palpa::bench
