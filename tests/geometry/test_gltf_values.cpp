// Numbers from accessors: modes, widths, strides, sparse values, skins, morph targets.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf_builder.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"

namespace palpa::geometry {
namespace {

using test::box;
using test::bytes_of;
using test::GltfBuilder;
using Json = GltfBuilder::Json;

// Triangles as corner positions: what a mesh shows, independent of its indices.
std::vector<std::array<Vec3, 3>> shown(const Mesh& mesh) {
  std::vector<std::array<Vec3, 3>> corners;
  for (const glm::uvec3& t : mesh.triangles) {
    corners.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  }
  return corners;
}

const std::vector<Vec3> zigzag{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}, {0, 3, 0}};

TEST(GltfModes, ListsStripsAndFansAsTheSpecificationDrawsThem) {
  for (const int component : {0, 5121, 5123, 5125}) {
    // Indices run backwards, so that a reader that ignores them is noticed.
    std::vector<Vec3> stored = zigzag;
    std::vector<std::uint32_t> indices;
    if (component != 0) {
      std::reverse(stored.begin(), stored.end());
      for (std::uint32_t i = 0; i < 7; ++i)
        indices.push_back(6 - i);
    }
    const auto& p = zigzag;
    const std::vector<std::pair<int, std::vector<std::array<Vec3, 3>>>> cases{
        {4, {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}}},
        {5, {{p[0], p[1], p[2]}, {p[1], p[3], p[2]}, {p[2], p[3], p[4]}, {p[3], p[5], p[4]}, {p[4], p[5], p[6]}}},
        {6, {{p[1], p[2], p[0]}, {p[2], p[3], p[0]}, {p[3], p[4], p[0]}, {p[4], p[5], p[0]}, {p[5], p[6], p[0]}}}};
    for (const auto& [mode, expected] : cases) {
      GltfBuilder builder;
      const int positions = builder.add_positions(stored);
      builder.add_mesh(positions, component == 0 ? -1 : builder.add_indices(indices, component), mode);
      builder.add_node({{"mesh", 0}});
      EXPECT_EQ(shown(load(builder).meshes.at(0).mesh), expected) << "mode " << mode << ", component " << component;
      // Seven corners are not a whole number of separate triangles.
      EXPECT_EQ(warnings_of(builder).empty(), mode != 4);
      GltfBuilder two;
      two.add_mesh(two.add_positions({{0, 0, 0}, {1, 0, 0}}), -1, mode);
      two.add_node({{"mesh", 0}});
      EXPECT_TRUE(load(two).meshes.empty()) << "fewer than three corners";
    }
  }
}

TEST(GltfAccessors, InterleavedWithOffsets) {
  const Mesh cube = box(Vec3(0), Vec3(1, 2, 3));
  // Per vertex: 8 bytes of something else, the position, 4 bytes of something else.
  std::vector<unsigned char> bytes(192, 0x7f);
  for (std::size_t v = 0; v < 8; ++v) {
    for (int i = 0; i < 3; ++i) {
      const auto value = static_cast<float>(cube.positions[v][i]);
      std::memcpy(bytes.data() + 24 * v + 8 + 4 * static_cast<std::size_t>(i), &value, 4);
    }
  }
  GltfBuilder builder;
  builder.add_view({1, 2, 3, 4, 5});
  builder.add_accessor(bytes, 5126, 8, "VEC3", 24);
  builder.doc["accessors"][0]["byteOffset"] = 8;
  builder.add_mesh(0, builder.add_indices(test::corners_of(cube), 5123));
  builder.add_node({{"mesh", 0}});
  const Mesh mesh = load(builder).meshes.at(0).mesh;
  EXPECT_EQ(mesh.positions, cube.positions);
  EXPECT_EQ(mesh.triangles, cube.triangles);
}

/// Makes an accessor sparse: `values` (a buffer view) replace the elements at `places`, with indices of `component`.
void replace(GltfBuilder& builder, std::size_t accessor, const std::vector<std::uint32_t>& places, int values,
             int component = 5121) {
  const int indices = builder.add_indices(places, component);
  builder.doc["accessors"][accessor]["sparse"] = {
      {"count", places.size()},
      {"indices",
       {{"bufferView", builder.doc["accessors"][static_cast<std::size_t>(indices)]["bufferView"]},
        {"componentType", component}}},
      {"values", {{"bufferView", values}}}};
  builder.doc["accessors"].erase(static_cast<std::size_t>(indices));
}

TEST(GltfAccessors, SparseValuesReplace) {
  const auto file = [](const std::vector<std::uint32_t>& places, int component, bool based) {
    GltfBuilder builder;
    builder.add_mesh(builder.add_positions({{9, 9, 9}, {1, 0, 0}, {9, 9, 9}}));
    builder.add_node({{"mesh", 0}});
    replace(builder, 0, places, builder.add_view(bytes_of(std::vector<float>{0, 0, 5, 0, 1, 0})), component);
    if (!based) builder.doc["accessors"][0].erase("bufferView");
    return builder;
  };
  for (const int component : {5121, 5123, 5125}) {
    for (const bool based : {true, false}) {
      const std::vector<Vec3> expected{{0, 0, 5}, {based ? 1 : 0, 0, 0}, {0, 1, 0}};
      EXPECT_EQ(load(file({0, 2}, component, based)).meshes.at(0).mesh.positions, expected);
      // Descending, repeated and too large indices are faults.
      for (const std::vector<std::uint32_t>& wrong : {std::vector<std::uint32_t>{2, 0}, {1, 1}, {0, 3}})
        EXPECT_CONTAINS(fault_of(file(wrong, component, based)), "accessor 0: the sparse index");
    }
  }
}

/// Turns the accessor into one without a buffer view, whose elements are zeros, except those at `places`.
void keep_only(GltfBuilder& builder, std::size_t accessor, const std::vector<std::uint32_t>& places, int values) {
  builder.doc["accessors"][accessor].erase("bufferView");
  replace(builder, accessor, places, values);
}

TEST(GltfAccessors, SparseWithoutABufferViewBeginsWithZeros) {
  const Mesh mesh = box(Vec3(0), Vec3(1));
  GltfBuilder builder;
  builder.add_mesh(mesh);
  std::vector<std::uint32_t> places, values, corners = test::corners_of(mesh);
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (corners[i] == 0) continue;
    places.push_back(i);
    values.push_back(corners[i]);
  }
  keep_only(builder, 1, places, builder.add_view(bytes_of(values)));
  builder.doc["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  keep_only(builder, 2, {2}, builder.add_view(bytes_of(std::vector<float>{5, 0, 0})));
  builder.add_node(
      {{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 2}}}}}}}});
  builder.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = load(builder);
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[0].mesh.triangles, mesh.triangles);
  EXPECT_EQ(bounds(scene.meshes[1].mesh).low, Vec3(0));
  EXPECT_EQ(bounds(scene.meshes[2].mesh).low, Vec3(5, 0, 0));
  // glTF-Transform leaves out both if all elements are zeros.
  builder.doc["accessors"][2].erase("sparse");
  EXPECT_EQ(bounds(load(builder).meshes.at(2).mesh).low, Vec3(0));
  builder.doc["accessors"][2]["count"] = 4'000'000'000U;
  EXPECT_CONTAINS(fault_of(builder), "accessor 2: brings the buffers to more than");
  builder.doc["accessors"][1].erase("sparse");
  EXPECT_CONTAINS(fault_of(builder), "accessor 1: has no data");
}

TEST(GltfMorph, DefaultWeightsOfMeshAndNode) {
  GltfBuilder builder(box(Vec3(0), Vec3(1)));
  const int up = builder.add_positions(std::vector<Vec3>(8, Vec3(0, 1, 0)));
  const int right = builder.add_positions(std::vector<Vec3>(8, Vec3(1, 0, 0)));
  builder.doc["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", up}}, {{"POSITION", right}}});
  builder.doc["meshes"][0]["weights"] = {0.5, 0};
  builder.add_node({{"mesh", 0}, {"weights", {0, 2}}});
  const Scene scene = load(builder);
  EXPECT_EQ(bounds(scene.meshes.at(0).mesh).low, Vec3(0, 0.5, 0));
  EXPECT_EQ(bounds(scene.meshes.at(1).mesh).low, Vec3(2, 0, 0));
  expect_faults(builder, {{"/nodes/1/weights", "[1]", "\"weights\" has 1 values; it needs 2"},
                          {"/meshes/0/primitives/-", R"({"attributes": {"POSITION": 0}})",
                           "has no morph targets, but the mesh's first primitive has 2"},
                          {"/meshes/0/primitives/-", R"({"attributes": {"POSITION": 0}, "targets": [{}]})",
                           "has 1 morph targets, but the mesh's first primitive has 2"}});
}

// A bar of two bones: the lower half belongs to one, the upper to the other, which is turned and shifted.
class GltfSkin : public ::testing::Test {
 protected:
  GltfSkin() {
    builder.add_mesh(bound);
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    for (const Vec3& p : bound.positions) {
      joints.insert(joints.end(), {0, 1, 0, 0});
      weights.insert(weights.end(), {p.y < 1 ? 3.0F : 0.0F, p.y < 1 ? 0.0F : 3.0F, 0, 0});
    }
    builder.add_accessor(joints, 5121, 8, "VEC4");
    builder.add_accessor(bytes_of(weights), 5126, 8, "VEC4");
    // The second bone sits at y = 1 when bound.
    std::vector<float> inverse(32);
    for (std::size_t i = 0; i < 32; ++i)
      inverse[i] = i % 16 % 5 == 0 ? 1.0F : 0.0F;
    inverse[16 + 13] = -1;
    builder.add_accessor(bytes_of(inverse), 5126, 2, "MAT4");
    auto& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = 2;
    attributes["WEIGHTS_0"] = 3;
    builder.doc["skins"] = Json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", 4}}});
    // The node's own transform does not count for a skinned mesh.
    builder.add_node({{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}});
    builder.add_node({{"children", {2}}, {"translation", {0, 5, 0}}});
    builder.add_node({{"translation", {0, 1, 0}}, {"scale", {2, 2, 2}}}, false);
  }
  const Mesh bound = box(Vec3(0), Vec3(1, 2, 1));
  GltfBuilder builder;
};

TEST_F(GltfSkin, FollowsTheBones) {
  const Mesh mesh = load(builder).meshes.at(0).mesh;
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3& p = bound.positions[v];
    const Vec3 expected = p.y < 1 ? p + Vec3(0, 5, 0) : Vec3(0, 6, 0) + 2.0 * (p - Vec3(0, 1, 0));
    EXPECT_LT(glm::distance(mesh.positions[v], expected), 1e-6) << v;
  }
  builder.doc["nodes"][0]["scale"] = {0, 0, 0};
  EXPECT_EQ(warnings_of(builder), "");
}

TEST_F(GltfSkin, SparseWeightsAndBindMatricesBeginWithZeros) {
  const Mesh whole = load(builder).meshes.at(0).mesh;
  for (const std::size_t a : {3u, 4u}) {
    const int view = builder.doc["accessors"][a]["bufferView"];
    std::vector<std::uint32_t> all(builder.doc["accessors"][a]["count"].get<std::size_t>());
    std::iota(all.begin(), all.end(), 0U);
    keep_only(builder, a, all, view);
  }
  EXPECT_EQ(load(builder).meshes.at(0).mesh.positions, whole.positions);
}

TEST_F(GltfSkin, ManySkinsWithSharedDataCostLittle) {
  const auto seconds_with = [](GltfBuilder file, int skins) {
    const Json skin = file.doc["skins"][0];
    for (int i = 1; i < skins; ++i) {
      file.doc["skins"].push_back(skin);
      file.add_node({{"mesh", 0}, {"skin", i}});
    }
    const auto path = file.in_memory();
    const double start = test::processor_s();
    EXPECT_EQ(load_gltf(path).meshes.size(), static_cast<std::size_t>(skins));
    return test::processor_s() - start;
  };
  // Matrices without a joint.
  GltfBuilder matrices = builder;
  keep_only(matrices, 4, {0, 1}, matrices.doc["accessors"][4]["bufferView"]);
  matrices.doc["accessors"][4]["count"] = 4'000'000;
  [[maybe_unused]] const double seconds = seconds_with(matrices, 100);
#ifdef NDEBUG
  EXPECT_LT(seconds, test::slowest);
  // Morph targets of the weight 0, or without positions.
  GltfBuilder targets = builder;
  targets.doc["meshes"][0]["primitives"][0]["targets"] = Json::array_t(300'000, Json::object());
  targets.doc["meshes"][0]["weights"] = Json::array_t(300'000, 0);
  targets.doc["meshes"][0]["weights"].back() = 1;
  EXPECT_LT(seconds_with(targets, 30'000), test::slowest);
#endif
}

TEST_F(GltfSkin, WithoutBindMatricesJointsAreTheWorld) {
  builder.doc["skins"][0].erase("inverseBindMatrices");
  const Mesh mesh = load(builder).meshes.at(0).mesh;
  // The corner (1, 2, 1) follows the second bone: scaled by 2, six metres up.
  EXPECT_LT(glm::distance(mesh.positions[7], Vec3(2, 10, 2)), 1e-6);
}

TEST_F(GltfSkin, ASkinThatNoNodeUsesDoesNotMatter) {
  builder.doc["nodes"][0].erase("skin");
  EXPECT_EQ(bounds(load(builder).meshes.at(0).mesh).low, Vec3(100, 0, 0));
  builder.doc["skins"][0] = Json::object();
  EXPECT_CONTAINS(warnings_of(builder), "skin 0: has no joints (the scene does not need it)");
}

TEST_F(GltfSkin, FaultsAreNamed) {
  expect_faults(builder, {{"/skins/0/joints", "[1]", "names a joint that its skin does not have"},
                          {"/skins/0/joints", "[1, 7]", "skin 0: \"joints\" names node 7"},
                          {"/accessors/4/count", "1", "2 joints but only 1 inverse bind matrices"},
                          {"/meshes/0/primitives/0/attributes/WEIGHTS_0", "", "one is missing"},
                          {"/accessors/2/count", "7", "8 positions but 7 of JOINTS_0"}});
}

}  // namespace
}  // namespace palpa::geometry
