// What outlives a call: the second time, with what palpa keeps between runs, every command and a touch of every kind of
// model are as the first time: output, warnings, errors, exit code and files.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using geometry::Mesh;

/// What a line gave, by the name of the file; without what it measured.
using Given = std::map<std::string, std::string>;

class Again : public testing::Test {
 protected:
  /// The line's results. What it makes is removed again, except what palpa keeps.
  Given given_by(const std::vector<std::string>& line) const {
    static const std::regex measured(
        R"("timing_ms": \{[^}]*\}|"seconds": [0-9.e+-]+|[0-9.]+ m?s\b|\d{4}-\d\d-\d\dT[\d:]+Z|\t[0-9a-f]{8}\b)");
    const auto before = contents_of(lines_.folder());
    const Result result = palpa_here(line);
    Given given{{"exit", std::to_string(result.exit_code)},
                {"stdout", std::regex_replace(result.out, measured, "")},
                {"stderr", result.err_without_lateness()}};
    for (const auto& [name, bytes] : contents_of(lines_.folder())) {
      if (before.contains(name) || name.starts_with("cache")) continue;
      given[name] = std::regex_replace(bytes, measured, "");
      fs::remove_all(lines_.folder() / name);
    }
    return given;
  }
  Given expect_the_same_again(const std::vector<std::string>& line) const {
    SCOPED_TRACE(testing::PrintToString(line));
    Given first = given_by(line), second = given_by(line);
    for (const auto& [name, text] : first)
      EXPECT_EQ(text, second[name]) << name;
    EXPECT_EQ(first.size(), second.size());
    return first;
  }
  /// The kinds of results that palpa keeps.
  std::set<std::string> kept() const {
    std::set<std::string> kinds;
    for (const auto& entry : fs::directory_iterator(lines_.folder() / "cache/palpa")) {
      const std::string name = entry.path().filename();
      kinds.insert(name.substr(0, name.find('-')));
    }
    return kinds;
  }

  const QuickLines lines_;
};

TEST_F(Again, EveryCommandIsAsTheFirstTime) {
  if (instrumented()) GTEST_SKIP() << "skipped: test_cli_every_option.cpp runs the same commands";
  // It runs until a signal comes; it measures; it needs a display.
  const std::set<std::string> other{"emulate", "bench", "study run"};
  for (const std::string& command : every_command()) {
    if (other.contains(command)) continue;
    const std::vector<HelpedOption> options = options_of(command);
    // What a run says on stdout, it measured.
    const bool json = command != "run" && std::ranges::any_of(options, [](auto& o) { return o.name == "--json"; });
    const std::vector<std::string> line = lines_.of(command);
    const Given first = expect_the_same_again(json ? with(line, {"--json", "-"}) : with(line, {"--quiet"}));
    EXPECT_EQ(first.at("exit"), "0") << first.at("stderr");
  }
}

/// The triangles whose middle lies on one side.
Mesh half_of(const Mesh& mesh, bool upper) {
  Mesh half{mesh.positions, {}};
  for (const glm::uvec3& t : mesh.triangles) {
    const double z = mesh.positions[t.x].z + mesh.positions[t.y].z + mesh.positions[t.z].z;
    if ((z > 0) == upper) half.triangles.push_back(t);
  }
  return half;
}

/// Its top is at y = 0. All have more triangles than are worth keeping.
geometry::Scene model_of(const std::string& kind) {
  geometry::Scene scene{"test.glb", {}};
  const auto add = [&](const Mesh& mesh, const Vec3& by = {}) {
    scene.meshes.push_back(
        {"mesh " + std::to_string(scene.meshes.size()), transformed(mesh, [&](const Vec3& p) { return p + by; })});
  };
  Mesh mesh = transformed(divided_box({0.02, 0.015, 0.01}, 5), [](const Vec3& p) { return p - Vec3(0, 0.015, 0); });
  if (kind == "whole") {
    add(mesh);
  } else if (kind == "open halves") {
    add(half_of(mesh, true));
    add(half_of(mesh, false));
  } else if (kind == "half of it") {
    add(half_of(mesh, true));
  } else if (kind == "inside out") {
    for (glm::uvec3& t : mesh.triangles)
      std::swap(t.y, t.z);
    add(mesh);
  } else if (kind == "with a hole") {
    mesh.triangles.erase(mesh.triangles.begin() + 40);
    add(mesh);
  } else if (kind == "two alike") {
    add(mesh, {-0.021, 0, 0});
    add(mesh, {0.021, 0, 0});
    scene.meshes[0].haptics.delta_m = 2e-3;
  } else {
    add(torus(0.02, 0.006, 80), {0, -0.026, 0});  // concave
  }
  return scene;
}

TEST_F(Again, EveryKindOfModelIsAsTheFirstTime) {
  std::vector<std::pair<std::string, fs::path>> models;
  for (const auto& entry : fs::directory_iterator(source_file("assets"))) {
    if (entry.path().extension() == ".glb" && !entry.path().stem().string().starts_with("hand"))
      models.emplace_back(entry.path().stem(), entry.path());
  }
  for (const char* kind : {"whole", "open halves", "half of it", "inside out", "with a hole", "two alike", "concave"}) {
    models.emplace_back(kind, lines_.folder() / (std::string(kind) + ".glb"));
    geometry::write_glb(models.back().second, model_of(kind).meshes);
  }
  std::set<std::string> untouched, warned, refused;
  for (const auto& [name, file] : models) {
    const std::vector<std::string> touch{
        "touch",     "--scene", file,     "--points", source_file("assets/finger.ply"), "--penetration", "2mm",
        "--backend", "cpu",     "--json", "-"},
        decompose{"decompose", "--scene", file,
                  "--parts",   "2",       "--resolution",
                  "10000",     "--out",   lines_.folder() / "parts.glb"};
    std::vector<std::vector<std::string>> lines{touch, decompose};
    if (name == "cube" || name == "two alike") lines.push_back(with(touch, {"--surface", "parts", "--parts", "2"}));
    for (const auto& line : lines) {
      const Given first = expect_the_same_again(line);
      if (first.at("exit") != "0") {
        refused.insert(name);
      } else if (!first.at("stderr").empty()) {
        warned.insert(name);
      }
      if (first.at("stdout").find("\"fingers\": []") != std::string::npos) untouched.insert(name);
    }
  }
  using Names = std::set<std::string>;
  EXPECT_EQ(untouched, Names{});
  EXPECT_EQ(refused, (Names{"half of it", "with a hole"}));
  EXPECT_EQ(warned, (Names{"half of it", "inside out", "with a hole"}));
  EXPECT_EQ(kept(), (Names{"parts", "solid", "surface"}));
}

}  // namespace
}  // namespace palpa::test
