// Collections of real good and broken files, if they are installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <sstream>

#include "geometry/gltf/gltf.hpp"
#include "geometry/packers.hpp"
#include "geometry/solid.hpp"
#include "support/captured.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

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
  std::string error;  // of reading, or of making solids
  bool read = false;
};

Outcome try_model(const std::filesystem::path& file) {
  Outcome outcome;
  outcome.error = test::fault_of_reading(file, [&] {
    const Scene scene = load_gltf(file);
    outcome.read = true;
    for (const SceneMesh& m : scene.meshes)
      outcome.triangles += m.mesh.triangles.size();
    outcome.solids = make_solids(scene).size();
  });
  return outcome;
}

TEST(GltfCorpora, MalformedFilesAreErrorsUnlessTheFaultIsNotInTheGeometry) {
  PALPA_SHARED_OR_SKIP(folder, "gltf-malformed");
  // A wrong material, a wrong texture index, a wrong accessor of an animation: each file is still a unit cube.
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
  // By folder number, if the scene differs from the sum over the file's meshes: no node shows the mesh; an instance;
  // one of two scenes.
  const std::map<std::string, std::size_t> shown{{"29", 0}, {"31", 0}, {"33", 0}, {"47", 3542}, {"57", 2}};
  const std::map<std::string, std::size_t> solids{{"01", 1}, {"03", 1}, {"05", 1}, {"07", 1}, {"09", 1},
                                                  {"15", 2}, {"17", 4}, {"21", 2}, {"23", 1}, {"43", 1},
                                                  {"47", 7}, {"49", 1}, {"53", 1}, {"55", 1}};
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
    // A file without nodes can only be rejected, for this or another fault.
    EXPECT_TRUE(outcome.read || field.at(7) == "0") << outcome.error;
    const auto known = shown.find(number);
    EXPECT_EQ(outcome.triangles, known != shown.end() ? known->second : std::stoul(field.at(5)))
        << file << " " << outcome.error;
    EXPECT_EQ(outcome.solids, solids.contains(number) ? solids.at(number) : 0) << file << " " << outcome.error;
  }
  EXPECT_EQ(rows, 29);
}

// The same model, plain and compressed by another program.
TEST(GltfCorpora, CompressedModelsAreTheirPlainTwins) {
  const auto mesh_of = [](const std::filesystem::path& file) {
    Mesh all;
    for (const SceneMesh& m : load_gltf(file).meshes)
      append(all, m.mesh);
    return all;
  };
  const std::filesystem::path engine = "/usr/share/assimp/models/glTF2";
  bool any = false;
  if (std::filesystem::exists(engine / "draco/2CylinderEngine.gltf")) {
    any = true;
    const Mesh plain = mesh_of(engine / "2CylinderEngine-glTF-Binary/2CylinderEngine.glb");
    const Mesh packed = mesh_of(engine / "draco/2CylinderEngine.gltf");
    // draco's encoder left out triangles with two corners at one place.
    std::size_t whole = 0;
    for (const SceneMesh& m : load_gltf(engine / "2CylinderEngine-glTF-Binary/2CylinderEngine.glb").meshes)
      whole += weld(m.mesh).triangles.size();
    EXPECT_EQ(whole, packed.triangles.size());
    const Box a = bounds(plain), b = bounds(packed);
    const double size = glm::length(a.high - a.low);
    EXPECT_LT(glm::length(a.low - b.low) + glm::length(a.high - b.high), 1e-3 * size);
    EXPECT_NEAR(area(plain), area(packed), 1e-3 * area(plain));
  }
  if (const auto folder = test::shared_data("gltf-valid"); !folder.empty()) {
    any = true;
    const Mesh plain = mesh_of(folder / "03_Box/Box.glb");
    EXPECT_TRUE(test::same_triangles(plain, mesh_of(folder / "49_Box_Draco/Box_Draco.glb"), 1e-6));
    EXPECT_TRUE(test::same_triangles(plain, mesh_of(folder / "43_BoxMeshopt/BoxMeshopt.glb"), 1e-4));
  }
  if (!any) GTEST_SKIP() << "skipped: neither assimp-testmodels nor ../shared/data is here";
}

// Each is read or refused at once. test_gltf_bad.cpp has the messages.
TEST(GltfCorpora, AssimpModels) {
  const std::filesystem::path folder = "/usr/share/assimp/models/glTF2";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: Debian's assimp-testmodels is not installed";
  for (const auto& file : models_below(folder))
    test::stderr_of([&] { try_model(file); });
  EXPECT_CONTAINS(try_model(folder / "MissingBin/BoxTextured.gltf").error, "BoxTextured0.bin: no such file");
  EXPECT_EQ(try_model(folder / "BoxTextured-glTF-Binary/BoxTextured.glb").solids, 1U);
}

}  // namespace
}  // namespace palpa::geometry
