// Collections of real good and broken files, where they are installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "geometry/gltf.hpp"
#include "geometry/shapes.hpp"
#include "geometry/solid.hpp"
#include "support/shared_data.hpp"

namespace palpa::geometry {
namespace {

std::vector<std::filesystem::path> models_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".gltf" || extension == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct Outcome {
  std::size_t triangles = 0, solids = 0;
  std::string error;  // of reading or of making solids
  bool read = false;
};

Outcome try_model(const std::filesystem::path& file) {
  Outcome outcome;
  [[maybe_unused]] const std::clock_t start = std::clock();  // processor time: other tests may keep this one waiting
  outcome.error = test::error_of([&] {
    const Scene scene = load_gltf(file);
    outcome.read = true;
    for (const SceneMesh& m : scene.meshes)
      outcome.triangles += m.mesh.triangles.size();
    outcome.solids = make_solids(scene).size();
  });
#ifdef NDEBUG
  EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC) << file;
#endif
  EXPECT_TRUE(outcome.error.empty() || outcome.error.starts_with(file.string() + ": ")) << outcome.error;
  return outcome;
}

TEST(GltfCorpora, MalformedFilesAreErrorsUnlessTheFaultIsNotInTheGeometry) {
  PALPA_SHARED_OR_SKIP(folder, "gltf-malformed");
  // A wrong material, a wrong texture index, an animation's accessor: each is a unit cube.
  const std::set<std::string> cubes{"badObject.gltf", "badUint.gltf", "box_sparse.glb"};
  const auto files = models_below(folder);
  EXPECT_EQ(files.size(), 45U);
  for (const auto& file : files) {
    Outcome outcome;
    const std::string warnings = test::stderr_of([&] { outcome = try_model(file); });
    if (cubes.contains(file.filename().string())) {
      EXPECT_EQ(outcome.error, "");
      EXPECT_EQ(outcome.triangles, 12U) << file;
      EXPECT_EQ(outcome.solids, 1U) << file;
      EXPECT_NE(warnings, "") << file;
    } else {
      EXPECT_NE(outcome.error, "") << file;
    }
  }
}

TEST(GltfCorpora, ValidFilesHaveTheTrianglesThatTheValidatorCounts) {
  PALPA_SHARED_OR_SKIP(folder, "gltf-valid");
  // By folder number, where the scene differs from the sum over the file's meshes: no node shows the mesh; an instance;
  // one of two scenes.
  const std::map<std::string, std::size_t> shown{{"29", 0}, {"31", 0}, {"47", 3542}, {"57", 2}};
  const std::map<std::string, std::string> refused{
      {"11", "KHR_mesh_quantization"}, {"15", "KHR_mesh_quantization"},      {"33", "KHR_mesh_quantization"},
      {"43", "KHR_mesh_quantization"}, {"45", "KHR_draco_mesh_compression"}, {"49", "KHR_draco_mesh_compression"}};
  const std::map<std::string, std::size_t> solids{{"01", 1}, {"03", 1}, {"05", 1}, {"07", 1},
                                                  {"09", 1}, {"17", 4}, {"21", 2}, {"53", 1}};
  std::ifstream manifest(folder / "manifest.csv");
  std::string line;
  std::getline(manifest, line);
  int rows = 0;
  while (std::getline(manifest, line)) {
    std::vector<std::string> field;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      field.push_back(cell);
    const std::string number = field.at(0).substr(0, 2);
    const auto file = folder / field.at(0) / field.at(1);
    Outcome outcome;
    test::stderr_of([&] { outcome = try_model(file); });
    ++rows;
    if (refused.contains(number)) {
      EXPECT_CONTAINS(outcome.error, "requires the extension \"" + refused.at(number) + "\"");
      continue;
    }
    const auto known = shown.find(number);
    EXPECT_EQ(outcome.triangles, known != shown.end() ? known->second : std::stoul(field.at(5)))
        << file << " " << outcome.error;
    EXPECT_EQ(outcome.solids, solids.contains(number) ? solids.at(number) : 0) << file << " " << outcome.error;
  }
  EXPECT_EQ(rows, 29);
}

TEST(GltfCorpora, AssimpModels) {
  const std::filesystem::path folder = "/usr/share/assimp/models/glTF2";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: Debian's assimp-testmodels is not installed";
  const std::map<std::string, std::string> faults{{"RecursiveNodes.gltf", "loop"},
                                                  {"IndexOutOfRange.gltf", "names vertex 255"},
                                                  {"AllIndicesOutOfRange.gltf", "65535"},
                                                  {"BoxWithInfinites.glb", "vertex 0 is not finite"},
                                                  {"badArray.gltf", "\"primitives\" is not an array"},
                                                  {"sceneWrongType.gltf", "\"scene\" is not an index"},
                                                  {"NoScene.gltf", "scene 0"},
                                                  {"SceneWithoutNodes.gltf", "no triangle mesh"}};
  std::size_t found = 0;
  for (const auto& file : models_below(folder)) {
    Outcome outcome;
    test::stderr_of([&] { outcome = try_model(file); });
    const auto known = faults.find(file.filename().string());
    if (known == faults.end()) continue;
    ++found;
    EXPECT_CONTAINS(outcome.error, known->second);
  }
  EXPECT_EQ(found, faults.size());
  EXPECT_CONTAINS(try_model(folder / "MissingBin/BoxTextured.gltf").error, "BoxTextured0.bin: no such file");
  EXPECT_EQ(try_model(folder / "BoxTextured-glTF-Binary/BoxTextured.glb").solids, 1U);
}

}  // namespace
}  // namespace palpa::geometry
