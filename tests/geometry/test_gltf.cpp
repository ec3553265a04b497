// The meaning of well-formed files: containers, hierarchies, scenes, names.
#include "geometry/gltf/gltf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "geometry/gltf_builder.hpp"
#include "geometry/memory_file.hpp"
#include "geometry/solid.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::box;
using test::GltfBuilder;
using Json = GltfBuilder::Json;

const Mesh cube = box(Vec3(0), Vec3(1));

/// A cube that no node shows.
GltfBuilder cube_file() {
  GltfBuilder builder;
  builder.add_mesh(cube);
  return builder;
}

void expect_box(const Mesh& mesh, const Vec3& low, const Vec3& high) {
  const Box found = bounds(mesh);
  const Vec3 extent = high - low;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.low[i], low[i], 1e-6) << "axis " << i;
    EXPECT_NEAR(found.high[i], high[i], 1e-6) << "axis " << i;
  }
  EXPECT_NEAR(signed_volume(mesh), extent.x * extent.y * extent.z, 1e-5);
}

TEST(Gltf, EmbeddedBesideAndBinaryGiveTheSame) {
  const auto folder = test::scratch_folder("gltf");
  const auto file = [&](const char* name) { return folder / name; };
  const Mesh ball = test::rounded(test::sphere(0.02, 40, 60));
  GltfBuilder builder;
  builder.add_mesh(ball);
  builder.add_node({{"mesh", 0}, {"name", "ball"}});
  // The end of base64 differs for each remainder of the length by three.
  for (int extra = 0; extra < 3; ++extra) {
    // Some writers escape the slashes of base64.
    std::string escaped;
    for (const char c : test::read_text(builder.write_embedded(file("a.gltf"))))
      escaped += c == '/' ? std::string("\\/") : std::string(1, c);
    test::write_text(file("d.gltf"), escaped);
    builder.write_with_bin(file("b.gltf"));
    builder.write_glb(file("c.glb"));
    // With a byte order mark, and a backslash as programs for Windows write it.
    std::filesystem::create_directories(file("parts"));
    std::filesystem::copy_file(file("b data.bin"), file("parts") / "e.bin",
                               std::filesystem::copy_options::overwrite_existing);
    test::write_text(file("e.gltf"), "\xEF\xBB\xBF" + builder.text("parts\\e.bin"));
    // A file whose own name has a backslash: as it is, and escaped for a URI.
    std::filesystem::copy_file(file("b data.bin"), file("parts\\f.bin"),
                               std::filesystem::copy_options::overwrite_existing);
    test::write_text(file("f.gltf"), builder.text("parts\\f.bin"));
    test::write_text(file("g.gltf"), builder.text("parts%5Cf.bin"));
    for (const char* name : {"a.gltf", "b.gltf", "c.glb", "d.gltf", "e.gltf", "f.gltf", "g.gltf"}) {
      const Scene scene = load_gltf(file(name));
      EXPECT_EQ(scene.file, file(name).string());
      ASSERT_EQ(scene.meshes.size(), 1U) << name;
      EXPECT_EQ(scene.meshes[0].name, "ball");
      EXPECT_TRUE(scene.meshes[0].mesh.positions == ball.positions) << name;
      EXPECT_TRUE(scene.meshes[0].mesh.triangles == ball.triangles) << name;
    }
    builder.bin.push_back(0);
  }
}

TEST(Gltf, NamesComeFromTheNodeThenTheMeshThenTheNumber) {
  GltfBuilder builder = cube_file();
  builder.add_mesh(cube);
  builder.doc["meshes"][0]["name"] = "die";
  builder.add_node({{"mesh", 0}, {"name", "first"}});
  builder.add_node({{"mesh", 0}});
  builder.add_node({{"mesh", 1}});
  const Scene scene = load(builder);
  ASSERT_EQ(scene.meshes.size(), 3U);
  EXPECT_EQ(scene.meshes[0].name, "first");
  EXPECT_EQ(scene.meshes[1].name, "die");
  EXPECT_EQ(scene.meshes[2].name, "node 2");
}

// Long strings bypass the parser, because data URIs are long.
TEST(Gltf, LongNamesAreReadWhole) {
  GltfBuilder builder = cube_file();
  builder.add_node({{"mesh", 0}, {"name", "NAME"}});
  const auto file = builder.write_embedded(test::scratch_folder("gltf-names") / "long.gltf");
  const std::string text = test::read_text(file), filler(5000, 'x');
  const auto name_of = [&](const std::string& name) {
    test::write_text(file, std::string(text).replace(text.find("NAME"), 4, name));
    return load_gltf(file).meshes.at(0).name;
  };
  EXPECT_EQ(name_of(filler), filler);
  EXPECT_EQ(name_of("data:" + filler), "data:" + filler);
  EXPECT_EQ(name_of(filler + R"(\u0041\/\n\u00e4)"), filler + "A/\n\xc3\xa4");
  for (const std::string not_text : {"\xff", "\x01", "\\u12"}) {
    EXPECT_TRUE(name_of("data:" + filler + not_text).starts_with("data:long string")) << "nothing to show";
  }
}

TEST(Gltf, HierarchiesMultiplyFromTheRoot) {
  GltfBuilder builder = cube_file();
  // Scale by 2 along x, then a quarter turn about z (x to y), then a shift.
  const int leaf = builder.add_node({{"mesh", 0}, {"translation", {1, 0, 0}}}, false);
  const int middle = builder.add_node({{"children", {leaf}}, {"scale", {2, 1, 1}}}, false);
  const double h = std::sqrt(0.5);
  builder.add_node({{"children", {middle}}, {"rotation", {0, 0, h, h}}, {"translation", {10, 20, 30}}});
  const Scene scene = load(builder);
  // x in [1, 2] -> [2, 4] -> y; y in [0, 1] -> -x.
  expect_box(scene.meshes.at(0).mesh, Vec3(9, 22, 30), Vec3(10, 24, 31));
}

// Also where negative scales mirror: faces then still face outwards.
TEST(Gltf, MatrixAndTrsAgree) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int round = 0; round < 20; ++round) {
    GltfBuilder builder = cube_file();
    const Vec3 t(uniform(random), uniform(random), uniform(random));
    const auto scale = [&](int mirrored) { return (uniform(random) + 3) * (mirrored != 0 ? -1 : 1); };
    const Vec3 s(scale(round & 1), scale(round & 2), scale(round & 4));
    const glm::dquat q = glm::normalize(glm::dquat(uniform(random), uniform(random), uniform(random), uniform(random)));
    const glm::dmat3 R = glm::mat3_cast(q);
    std::vector<double> m;
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row)
        m.push_back(R[column][row] * s[column]);
      m.push_back(0);
    }
    m.insert(m.end(), {t.x, t.y, t.z, 1});
    builder.add_node({{"mesh", 0}, {"matrix", m}});
    builder.add_node({{"mesh", 0},
                      {"translation", {t.x, t.y, t.z}},
                      {"rotation", {q.x, q.y, q.z, q.w}},
                      {"scale", {s.x, s.y, s.z}}});
    const Scene scene = load(builder);
    for (std::size_t v = 0; v < 8; ++v) {
      EXPECT_LT(glm::distance(scene.meshes[0].mesh.positions[v], scene.meshes[1].mesh.positions[v]), 1e-12);
    }
    EXPECT_NEAR(signed_volume(scene.meshes[0].mesh), std::abs(s.x * s.y * s.z), 1e-9);
  }
}

TEST(Gltf, MeshesComeDepthFirst) {
  GltfBuilder builder = cube_file();
  const auto leaf = [&](const char* name) { return builder.add_node({{"mesh", 0}, {"name", name}}, false); };
  const int a = leaf("a"), b = leaf("b"), c = leaf("c");
  builder.add_node({{"mesh", 0}, {"name", "root"}, {"children", {b, a}}});
  builder.doc["scenes"][0]["nodes"].push_back(c);
  std::string order;
  for (const SceneMesh& m : load(builder).meshes)
    order += m.name + " ";
  EXPECT_EQ(order, "root b a c ");
}

TEST(Gltf, ScenesAreChosenByIndexElseByDefaultElseTheFirst) {
  GltfBuilder builder = cube_file();
  for (int i = 0; i < 3; ++i)
    builder.add_node({{"mesh", 0}, {"name", std::string(1, static_cast<char>('a' + i))}}, false);
  builder.doc["scenes"] = Json::array({{{"nodes", {0}}}, {{"nodes", {1}}}, {{"nodes", {2, 0}}}});
  builder.doc["scene"] = 1;
  EXPECT_EQ(load(builder).meshes.at(0).name, "b");
  EXPECT_EQ(load(builder, 0).meshes.at(0).name, "a");
  EXPECT_EQ(load(builder, 2).meshes.size(), 2U);
  for (const int absent : {3, -1}) {
    EXPECT_CONTAINS(test::error_of([&] { load(builder, absent); }),
                    "has no scene " + std::to_string(absent) + "; it has 3");
  }
  builder.doc.erase("scene");
  EXPECT_EQ(load(builder).meshes.at(0).name, "a");
  builder.doc.erase("scenes");
  EXPECT_EQ(load(builder).meshes.size(), 3U);
}

TEST(Gltf, SeveralPrimitivesAreOneMeshAndPointsAndLinesNone) {
  GltfBuilder builder;
  const int positions = builder.add_positions(cube.positions);
  const std::vector<std::uint32_t> corners = test::corners_of(cube);
  Json primitives = Json::array();
  for (const auto& half : {std::vector(corners.begin(), corners.begin() + 18), {corners.begin() + 18, corners.end()}})
    primitives.push_back({{"attributes", {{"POSITION", positions}}}, {"indices", builder.add_indices(half, 5121)}});
  for (int mode = 0; mode < 4; ++mode)
    primitives.push_back({{"attributes", {{"POSITION", positions}}}, {"mode", mode}});
  builder.doc["meshes"] = Json::array({{{"primitives", primitives}}, {{"primitives", {primitives[2]}}}});
  builder.add_node({{"mesh", 0}});
  builder.add_node({{"mesh", 1}});
  const auto solids = make_solids(load(builder));
  ASSERT_EQ(solids.size(), 1U);
  EXPECT_NEAR(signed_volume(solids[0].mesh), 1, 1e-12);
}

TEST(Gltf, ExtensionsThatDoNotMoveTrianglesMayBeRequired) {
  GltfBuilder builder(cube);
  builder.doc["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
  EXPECT_EQ(load(builder).meshes.size(), 1U);
  // The whole name counts: the effect of a longer name is unknown.
  for (const char* name : {"ACME_new", "", "KHR_mesh_quantization_2", "KHR_materials_", "KHR_materials_displacement",
                           "KHR_xmp_x", "KHR_xmp KHR_xmp_json_ld"}) {
    builder.doc["extensionsRequired"] = {name};
    EXPECT_CONTAINS(fault_of(builder), "requires the extension \"" + std::string(name) + "\"");
  }
}

// 3 boxes: in place; moved; turned about z by a right angle, twice as large and moved.
GltfBuilder instanced_file() {
  GltfBuilder builder = cube_file();
  const auto accessor = [&](const std::vector<float>& values, const char* type) {
    return builder.add_accessor(test::bytes_of(values), 5126, 3, type);
  };
  const auto t = accessor({0, 0, 0, 5, 0, 0, 0, 5, 0}, "VEC3");
  const float half = std::sqrt(0.5F);
  const auto r = accessor({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, half, half}, "VEC4");
  const auto s = accessor({1, 1, 1, 1, 1, 1, 2, 2, 2}, "VEC3");
  builder.add_node(
      {{"mesh", 0},
       {"name", "crate"},
       {"translation", {0, 0, 7}},
       {"extras", {{"palpa_delta_m", 0.002}}},
       {"extensions",
        {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", t}, {"ROTATION", r}, {"SCALE", s}}}}}}}});
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  return builder;
}

TEST(Gltf, GpuInstancesAreMeshesOfTheirOwn) {
  const Scene scene = load(instanced_file());
  ASSERT_EQ(scene.meshes.size(), 3U);
  EXPECT_EQ(scene.meshes[0].name, "crate[0]");
  EXPECT_EQ(scene.meshes[2].name, "crate[2]");
  expect_box(scene.meshes[0].mesh, {0, 0, 7}, {1, 1, 8});
  expect_box(scene.meshes[1].mesh, {5, 0, 7}, {6, 1, 8});
  expect_box(scene.meshes[2].mesh, {-2, 5, 7}, {0, 7, 9});
  for (const Solid& solid : make_solids(scene))
    EXPECT_EQ(solid.haptics.delta_m, 0.002);
}

TEST(Gltf, FaultsOfInstancesAreNamed) {
  GltfBuilder good = instanced_file();
  const std::string tilted = std::to_string(good.add_view(test::bytes_of(std::vector<float>(12, 0.1F))));
  const std::string flat = std::to_string(good.add_view(test::bytes_of(std::vector<float>{1, 0, 1, 1, 1, 1, 1, 1, 1})));
  const std::string attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
  expect_faults(good, {{attributes + "/SCALE", "99", "names accessor 99"},
                       {"/accessors/3/count", "2", "has 3 instances, but 2 of ROTATION"},
                       {attributes + "/ROTATION", "2", "rotations of instances that are not VEC4"},
                       {attributes + "/TRANSLATION", "3", "not VEC3"},
                       {"/accessors/2/count", "1000000000", "does not fit its buffer view"},
                       {attributes, "{}", "has neither TRANSLATION nor ROTATION nor SCALE"},
                       {"/accessors/3/bufferView", tilted, "instance 0: its rotation is not a unit quaternion"},
                       {"/accessors/4/bufferView", flat, "node 0, instance 0: its scale is zero"}});
}

TEST(Gltf, HiddenNodesStayTouchableWithAWarning) {
  GltfBuilder builder = cube_file();
  const Json hidden{{"KHR_node_visibility", {{"visible", false}}}}, shown{{"KHR_node_visibility", {{"visible", true}}}};
  const int child = builder.add_node({{"mesh", 0}, {"extensions", shown}}, false);
  builder.add_node({{"mesh", 0}, {"children", {child}}, {"extensions", hidden}});
  builder.doc["extensionsRequired"] = {"KHR_node_visibility"};
  EXPECT_CONTAINS(warnings_of(builder, 2), "node 1 and 1 other are hidden (KHR_node_visibility), but still touchable");
  builder.doc["nodes"][1]["extensions"] = shown;
  EXPECT_EQ(warnings_of(builder, 2), "");
  builder.doc["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  EXPECT_CONTAINS(fault_of(builder), "\"visible\" is neither true nor false");
}

TEST(Gltf, AScaleOfZeroAlongAllAxesHidesAMesh) {
  GltfBuilder builder = cube_file();
  const int child = builder.add_node({{"mesh", 0}, {"translation", {1, 2, 3}}}, false);
  builder.add_node({{"mesh", 0}, {"scale", {0, 0, 0.0}}, {"name", "hidden"}, {"children", {child}}});
  builder.add_node({{"mesh", 0}, {"name", "shown"}});
  EXPECT_EQ(load(builder).meshes.at(0).name, "shown");
  EXPECT_CONTAINS(warnings_of(builder), "node 1 and 1 other are hidden by a scale of zero along all axes and left out");
  // As a matrix.
  builder.doc["nodes"][1].erase("children");
  builder.doc["nodes"][1].erase("scale");
  builder.doc["nodes"][1]["matrix"] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 6, 7, 1};
  EXPECT_CONTAINS(warnings_of(builder), "node 1 is hidden by a scale");
  // One of three instances.
  GltfBuilder crates = instanced_file();
  const int scales = crates.add_view(test::bytes_of(std::vector<float>{1, 1, 1, 0, 0, 0, 2, 2, 2}));
  crates.doc["accessors"][4]["bufferView"] = scales;
  EXPECT_CONTAINS(warnings_of(crates, 2), "node 0, instance 1 is hidden");
  EXPECT_EQ(load(crates).meshes.at(1).name, "crate[2]");
  // Two axes are no way to hide anything.
  GltfBuilder flat = cube_file();
  flat.add_node({{"mesh", 0}, {"scale", {0, 1, 0}}});
  EXPECT_CONTAINS(fault_of(flat), "node 0: its scale is zero along some direction");
  // If nothing else is left, that is the fault.
  flat.doc["nodes"][0]["scale"] = {0, 0, 0};
  EXPECT_CONTAINS(fault_of(flat), "no mesh is left: node 0 is hidden by a scale of zero along all axes; give one that");
  flat.add_node({{"mesh", 0}, {"scale", {0, 0, 0}}});
  EXPECT_CONTAINS(fault_of(flat), "no mesh is left: node 0 and 1 other are hidden by a scale of zero");
  flat.add_node({{"mesh", 0}, {"extras", {{"palpa_touchable", false}}}});
  EXPECT_CONTAINS(fault_of(flat),
                  "touchable (node 0 and 1 other are hidden by a scale of zero along all axes); a scene");
}

TEST(Gltf, InstancesOfAnotherProgramAreRead) {
  PALPA_SHARED_OR_SKIP(folder, "hostile");
  EXPECT_EQ(make_solids(load_gltf(folder / "simple-instancing.glb")).size(), 125U);
}

TEST(Gltf, PicturesAndMaterialsDoNotMatter) {
  GltfBuilder builder(cube);
  builder.doc["images"] = Json::array({{{"uri", "absent.png"}},
                                       {{"uri", "data:image/png;base64,AAAA"}},
                                       {{"bufferView", 0}, {"mimeType", "image/png"}}});
  builder.doc["textures"] = Json::array({{{"source", 0}}});
  builder.doc["extras"] = {{"anything", {1, 2, 3}}};
  EXPECT_EQ(warnings_of(builder), "");
  builder.doc["materials"] = Json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 7}}}}}}});
  EXPECT_CONTAINS(warnings_of(builder), "texture 7");
}

TEST(Gltf, FaultsBesideTheSceneAreWarnings) {
  GltfBuilder builder(cube);
  builder.doc["accessors"].push_back({{"bufferView", 9}, {"componentType", 5126}, {"count", 1}, {"type", "VEC3"}});
  builder.doc["meshes"].push_back(Json::object());
  EXPECT_CONTAINS(warnings_of(builder), "mesh 1: has no primitives (the scene does not need it)");
  builder.doc["scenes"][0]["nodes"] = Json::array();
  EXPECT_CONTAINS(fault_of(builder), "mesh 1: has no primitives");
}

TEST(Gltf, WrongBoundsAreAWarning) {
  GltfBuilder builder(cube);
  builder.doc["accessors"][0]["min"] = {0, 0, 0};
  builder.doc["accessors"][0]["max"] = {1, 1, 1};
  EXPECT_EQ(warnings_of(builder), "");
  builder.doc["accessors"][0]["max"] = {1, 2, 1};
  EXPECT_CONTAINS(warnings_of(builder), "accessor 0: its min and max");
}

TEST(Gltf, BytesAfterTheEndOfAGlbAreAWarning) {
  GltfBuilder builder(cube);
  auto bytes = builder.glb();
  bytes.resize(bytes.size() + 5, 0xff);
  test::MemoryFile file;
  const auto path = file.write(bytes.data(), bytes.size());
  EXPECT_CONTAINS(test::stderr_of([&] { EXPECT_EQ(load_gltf(path).meshes.size(), 1U); }), "5 bytes after");
}

TEST(Gltf, DeepChainsAreNotDangerous) {
  GltfBuilder builder = cube_file();
  constexpr int depth = 20'000;
  for (int i = 0; i < depth; ++i)
    builder.add_node({{"translation", {0.001, 0, 0}}, {"children", {i + 1}}}, i == 0);
  builder.add_node({{"mesh", 0}}, false);
  EXPECT_NEAR(bounds(load(builder).meshes.at(0).mesh).low.x, 20, 1e-6);
}

}  // namespace
}  // namespace palpa::geometry
