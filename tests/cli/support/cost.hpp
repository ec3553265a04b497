// Measures the cost of models: the command's processor time and memory, compared with the size of the file.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "geometry/gltf/write.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {

class Cost : public testing::Test {
 protected:
  std::filesystem::path folder_ = scratch_folder("cost");
  /// Processor time in limits of docs/limits.md, which are of elapsed time on a quick machine: work that two cores
  /// share may take twice as much.
  double limits_ = 2 * slowest;

  Result touch(const std::filesystem::path& scene) const {
    return within_limit({"touch", "--scene", scene.string(), "--points", source_file("assets/finger.ply").string(),
                         "--penetration", "3mm", "--backend", "cpu"},
                        scene);
  }
  /// One frame of the mesh, as the paper's cameras see it.
  Result rendered(const geometry::Mesh& mesh) const {
    const geometry::SceneMesh scene{"it", mesh};
    geometry::write_glb(folder_ / "model.glb", std::span(&scene, 1));
    return within_limit(
        {"run", "--scene", source_file("assets/cube.glb"), "--source", "synthetic:" + (folder_ / "model.glb").string(),
         "--frames", "1", "--every-frame", "--backend", "cpu"},
        folder_ / "model.glb");
  }
  Result within_limit(const std::vector<std::string>& line, const std::filesystem::path& file) const {
    RunOptions options;
    options.environment = {{"PALPA_CACHE", "off"}};
    const Result result = palpa(line, options);
    const double megabytes = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
    // Elapsed time depends on other programs. Sanitizers need more time and memory.
    EXPECT_LT(result.processor_s, (instrumented() ? 45 : limits_) * (1 + megabytes)) << result.err;
    if (!instrumented()) {
      EXPECT_LT(result.peak_mib, 1e9 / (1 << 20)) << result.err;
    }
    return result;
  }
  Result touch(const geometry::Mesh& mesh) const {
    const geometry::SceneMesh scene{"it", mesh};
    geometry::write_glb(folder_ / "model.glb", std::span(&scene, 1));
    return touch(folder_ / "model.glb");
  }
  void expect_refused(const Result& result, const std::string& part) const {
    expect_failure(result, 4, "model.glb: mesh \"it\": ");
    expect_failure(result, 4, part);
  }
};

}  // namespace palpa::test
