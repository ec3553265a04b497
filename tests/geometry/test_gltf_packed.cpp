// Quantized and compressed models have the same triangles as the plain ones. Data that only claims to be such a model
// gives an error line and nothing else.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/gltf/draco.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/packers.hpp"
#include "support/captured.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::BadByte;
using test::box;
using test::GltfBuilder;
using test::same_triangles;
using Json = GltfBuilder::Json;

Mesh mesh_of(const GltfBuilder& builder) {
  Mesh mesh;
  EXPECT_EQ(test::stderr_of([&] { mesh = load(builder).meshes.at(0).mesh; }), "");
  return mesh;
}
// Not symmetric, so that exchanged axes or signs are noticed.
Mesh pebble() {
  return test::rounded(test::transformed(test::sphere(0.02, 9, 14), [](const Vec3& p) {
    return Vec3(p.x + 0.05, 1.5 * p.y - 0.01, 0.8 * p.z + 0.1 * p.x);
  }));
}

TEST(Quantized, IntegersComeBackWithinAStep) {
  for (const int component : {5120, 5121, 5122, 5123}) {
    for (const bool normalized : {false, true}) {
      const test::Quantized q = test::quantized_file(pebble(), component, normalized);
      const Mesh mesh = mesh_of(q.file);
      ASSERT_EQ(mesh.positions.size(), pebble().positions.size());
      EXPECT_TRUE(mesh.triangles == pebble().triangles);
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        for (int i = 0; i < 3; ++i)
          EXPECT_LE(std::abs(mesh.positions[v][i] - pebble().positions[v][i]), 0.501 * q.step) << component << " " << v;
      }
    }
  }
}

TEST(Quantized, TheLowestIntegerIsMinusOneToo) {
  // glTF 2.0 section 3.6.2.2: -128 and -127 both mean -1.
  GltfBuilder builder;
  const std::vector<std::int8_t> corners{-128, -127, 127, 0, 0, 127, 0, 0, 0, 127, 0, 0};
  builder.add_mesh(builder.add_accessor(test::bytes_of(corners), 5120, 3, "VEC3", 4));
  builder.doc["accessors"][0]["normalized"] = true;
  builder.add_node({{"mesh", 0}});
  builder.doc["extensionsUsed"] = {"KHR_mesh_quantization"};
  const Mesh mesh = mesh_of(builder);
  EXPECT_EQ(mesh.positions.at(0), Vec3(-1, -1, 1));
  EXPECT_EQ(mesh.positions.at(1), Vec3(0, 1, 0));
  EXPECT_EQ(mesh.positions.at(2), Vec3(0, 1, 0));
}

TEST(Quantized, IntegersNeedTheExtension) {
  GltfBuilder builder = test::quantized_file(pebble(), 5123, false).file;
  builder.doc.erase("extensionsRequired");
  builder.doc.erase("extensionsUsed");
  EXPECT_CONTAINS(fault_of(builder), "\"extensionsUsed\" has KHR_mesh_quantization");
  builder.doc["extensionsUsed"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(fault_of(builder), "");
  builder.doc["accessors"][0]["componentType"] = 5125;
  EXPECT_CONTAINS(fault_of(builder), "accessor 0");
}

TEST(Quantized, MorphTargetsMayBeIntegers) {
  GltfBuilder builder = test::quantized_file(box(Vec3(0), Vec3(2)), 5121, false).file;
  std::vector<std::int16_t> up;
  for (int v = 0; v < 8; ++v)
    up.insert(up.end(), {0, -510, 0, 0});
  builder.add_accessor(test::bytes_of(up), 5122, 8, "VEC3", 8);
  builder.doc["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", 2}}});
  builder.doc["meshes"][0]["weights"] = {0.5};
  // Half of -510 steps of 2 m / 255.
  EXPECT_NEAR(bounds(mesh_of(builder)).low.y, -2, 1e-9);
}

class Draco : public ::testing::Test {
 protected:
  /// The stream in a file that promises so many vertices and triangles more.
  GltfBuilder file(int more_vertices = 0, int more_triangles = 0) const {
    return test::draco_file(stream, v + static_cast<std::size_t>(more_vertices),
                            t + static_cast<std::size_t>(more_triangles));
  }
  /// Whether the decoder accepts a stream where the file promises these counts.
  bool decodes(const std::vector<unsigned char>& data, std::size_t vertices, std::size_t triangles) {
    return gltf::decode_draco(data, {}, vertices, triangles, spare, fault).has_value();
  }

  const Mesh plain = pebble();
  const std::size_t v = plain.positions.size(), t = plain.triangles.size();
  const std::vector<unsigned char> stream = test::draco_stream(plain, 10, false);
  std::uint64_t spare = gltf::most_draco_bytes;
  std::string fault;
};

TEST_F(Draco, BothMethodsGiveTheTrianglesBack) {
  const Box size = bounds(plain);
  for (const bool sequential : {false, true}) {
    for (const int bits : {0, 8, 14}) {
      const auto packed = test::draco_stream(plain, bits, sequential);
      ASSERT_FALSE(packed.empty());
      const Mesh mesh = mesh_of(test::draco_file(packed, v, t));
      const double step =
          bits == 0 ? 0
                    : std::max({size.high.x - size.low.x, size.high.y - size.low.y, size.high.z - size.low.z}) /
                          ((1 << bits) - 1);
      EXPECT_TRUE(same_triangles(plain, mesh, 0.51 * step + 1e-9)) << sequential << " " << bits;
      EXPECT_TRUE(find_defects(weld(mesh)).closed_and_oriented());
    }
  }
}

TEST_F(Draco, SkinnedMeshesAreRead) {
  const Mesh cube = test::rounded(box(Vec3(0), Vec3(1)));
  GltfBuilder builder = test::draco_file(test::draco_stream(cube, 0, false, true), 8, 12);
  auto& primitive = builder.doc["meshes"][0]["primitives"][0];
  const auto add = [&](const char* name, int component, int attribute) {
    primitive["attributes"][name] = builder.doc["accessors"].size();
    builder.doc["accessors"].push_back({{"componentType", component}, {"count", 8}, {"type", "VEC4"}});
    primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"][name] = attribute;
  };
  add("JOINTS_0", 5123, 8);
  add("WEIGHTS_0", 5126, 9);
  builder.doc["nodes"][0]["skin"] = 0;
  builder.add_node({{"translation", {100, 0, 0}}});
  builder.add_node({{"translation", {0, 5, 0}}});
  builder.doc["skins"] = Json::array({{{"joints", {1, 2}}}});
  const Box found = bounds(mesh_of(builder));
  EXPECT_EQ(found.low, Vec3(0, 5, 0));
  EXPECT_EQ(found.high, Vec3(1, 6, 1));
}

TEST_F(Draco, APlainCopyIsPreferred) {
  GltfBuilder builder = file();
  const int positions = builder.add_positions(plain.positions), indices = builder.add_indices(test::corners_of(plain));
  Json& accessors = builder.doc["accessors"];
  accessors[0] = Json(accessors[static_cast<std::size_t>(positions)]);
  accessors[1] = Json(accessors[static_cast<std::size_t>(indices)]);
  EXPECT_TRUE(mesh_of(builder).positions == plain.positions);
}

TEST_F(Draco, OtherCountsThanPromisedAreAWarningMoreTrianglesAnError) {
  EXPECT_CONTAINS(warnings_of(file(1, 1)), "where the file promises");
  const std::string more = warnings_of(file(-1));
  EXPECT_CONTAINS(more, "mesh 0: the draco data in buffer view 0 hold");
  EXPECT_CONTAINS(more, "where the file promises");
  EXPECT_EQ(load(file(-1)).meshes.at(0).mesh.positions.size(), v);
  EXPECT_CONTAINS(fault_of(file(0, -1)), "triangles where the file promises");
}

// One stream for two primitives: it is reported once, so it was decoded once.
TEST_F(Draco, AStreamIsDecodedOnce) {
  GltfBuilder builder = file(1);
  Json& primitives = builder.doc["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  EXPECT_EQ(load(builder).meshes.at(0).mesh.triangles.size(), 2 * t);
  const std::string warning = warnings_of(builder);
  EXPECT_EQ(warning.find("where the file promises"), warning.rfind("where the file promises"));
  EXPECT_CONTAINS(warning, "where the file promises");
}

// A stream of 224 bytes whose texture coordinates claim two billion orientations.
TEST_F(Draco, ClaimsOfPredictionsAreBounded) {
  PALPA_SHARED_OR_SKIP(folder, "hostile");
  EXPECT_CONTAINS(test::error_of([&] { load_gltf(folder / "draco_bomb_100prims.glb"); }), "cannot be decoded");
}

TEST_F(Draco, AttributesOfAllStreamsTogetherAreBounded) {
  ASSERT_TRUE(decodes(stream, v, t));
  const std::uint64_t taken = gltf::most_draco_bytes - spare;
  EXPECT_GE(taken, v * 12);
  spare = taken - 1;
  EXPECT_FALSE(decodes(stream, v, t));
  EXPECT_CONTAINS(fault, "in all of a file");
}

TEST_F(Draco, FaultsAreNamed) {
  const GltfBuilder good = file();
  expect_faults(good,
                {{"/attributes/POSITION", "3", "have no attribute 3"},
                 {"/attributes/POSITION", "", "\"POSITION\" is missing"},
                 {"/attributes", "", "\"attributes\" is missing"},
                 {"/bufferView", "9", "names buffer view 9"},
                 {"", "\"packed\"", "is not a JSON object"}},
                "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression");
  for (const auto& [place, value, message] :
       {BadByte{0, 'd', "do not begin with draco's header"}, BadByte{5, 1, "bitstream version 1.2"},
        BadByte{7, 0, "are not a triangle mesh"}, BadByte{8, 9, "unknown method 9"}}) {
    GltfBuilder bad = good;
    bad.bin[place] = value;
    EXPECT_CONTAINS(fault_of(bad), message);
  }
  for (std::size_t length = 12; length < stream.size(); length += 11) {
    const std::vector<unsigned char> part(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_NE(fault_of(test::draco_file(part, v, t)), "") << length;
  }
}

// The places of the counts: after 11 bytes of header, depending on the method. Numbers are seven bits a byte, the
// lowest first.
TEST_F(Draco, AbsurdCountsCostNothing) {
  // The place behind the number that begins there.
  const auto behind = [](const std::vector<unsigned char>& bytes, std::size_t at) {
    while (bytes[at++] & 0x80) {
    }
    return at;
  };
  const auto with_giant = [&](std::vector<unsigned char> bytes, std::size_t at) {
    const std::vector<unsigned char> giant{0xff, 0xff, 0xff, 0xff, 0x04};  // 1.3 billion
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    bytes.erase(place, bytes.begin() + static_cast<std::ptrdiff_t>(behind(bytes, at)));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), giant.begin(), giant.end());
    return bytes;
  };
  // Traversal (one byte), vertices, faces, groups of attributes (one byte).
  const std::size_t faces = behind(stream, 12);
  EXPECT_FALSE(decodes(with_giant(stream, faces), 1000, 1000));
  EXPECT_CONTAINS(fault, "triangles where the file promises 1000");
  auto crowded = stream;
  crowded[behind(stream, faces)] = 255;
  EXPECT_FALSE(decodes(crowded, 1'000'000, 1'000'000));
  // Faces, points.
  const auto sequential = test::draco_stream(plain, 10, true);
  EXPECT_FALSE(decodes(with_giant(sequential, 11), 1000, 1000));
  EXPECT_CONTAINS(fault, "triangles where the file promises 1000");
  EXPECT_FALSE(decodes(with_giant(sequential, behind(sequential, 11)), 1000, 1000));
  EXPECT_CONTAINS(fault, "vertices where the file promises 1000");
}

TEST(Meshopt, AllModesGiveTheMeshBack) {
  const Mesh plain = pebble();
  for (const bool sequence : {false, true}) {
    for (const int index_size : {2, 4}) {
      for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        const Mesh mesh = mesh_of(test::meshopt_file(plain, {sequence, false, index_size, extension, !sequence}));
        EXPECT_TRUE(mesh.positions == plain.positions);
        EXPECT_TRUE(same_triangles(plain, mesh, 0));
        EXPECT_EQ(mesh.triangles == plain.triangles, sequence);
      }
    }
  }
}

TEST(Meshopt, TheExponentialFilter) {
  const Mesh mesh = mesh_of(test::meshopt_file(pebble(), {.exponential = true}));
  EXPECT_TRUE(same_triangles(pebble(), mesh, 0.5 / (1 << 20)));
  EXPECT_FALSE(mesh.positions == pebble().positions);
}

TEST(Meshopt, SparseDataOnTop) {
  const Mesh plain = pebble();
  GltfBuilder builder = test::meshopt_file(plain);
  builder.doc["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", builder.add_view({0})}, {"componentType", 5121}}},
      {"values", {{"bufferView", builder.add_view(test::bytes_of(std::vector<float>{9, 9, 9}))}}}};
  builder.doc["buffers"][0]["byteLength"] = builder.bin.size();
  EXPECT_EQ(mesh_of(builder).positions.at(0), Vec3(9));
}

TEST(Meshopt, FaultsAreNamed) {
  const GltfBuilder good = test::meshopt_file(pebble());
  const auto extension = [](int view, const std::string& key) {
    return "/bufferViews/" + std::to_string(view) + "/extensions/EXT_meshopt_compression/" + key;
  };
  expect_faults(good, {{extension(0, "buffer"), "2", "names buffer 2"},
                       {extension(0, "byteLength"), "1000000", "does not fit its buffer"},
                       {extension(0, "byteOffset"), "1000000", "does not fit its buffer"},
                       {extension(0, "mode"), "\"POINTS\"", "palpa knows ATTRIBUTES, TRIANGLES, INDICES"},
                       {extension(0, "mode"), "", "\"mode\" is \"\""},
                       {extension(0, "filter"), "\"COLOR\"", "palpa knows NONE"},
                       {extension(0, "filter"), "\"QUATERNION\"", "needs 8"},
                       {extension(1, "filter"), "\"EXPONENTIAL\"", "only attributes"},
                       {extension(0, "byteStride"), "10", "multiple of 4"},
                       {extension(1, "byteStride"), "8", "must be 2 or 4"},
                       {extension(0, "count"), "4000000000", "the buffer view has"},
                       {extension(1, "count"), "7", "three indices each"},
                       {extension(0, "byteLength"), "5", "unpacks to"},
                       {"/bufferViews/0/byteStride", "16", "has a byteStride of 12, but the buffer view has one of 16"},
                       // Indices to missing vertices are found after unpacking, as in a plain file.
                       {"/accessors/0/count", "100", "but there are only 100"}});
  GltfBuilder bad = good;
  const Json& first = bad.doc["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  bad.bin.at(first.value("byteOffset", std::size_t{0})) = 0xa7;
  EXPECT_CONTAINS(fault_of(bad), "packed with version 7 of meshoptimizer's vertex codec");
  // What unpacks to too much.
  Json& view = (bad = good).doc["bufferViews"][0];
  Json& packed = view["extensions"]["EXT_meshopt_compression"];
  view["byteStride"] = packed["byteStride"] = 252;
  packed["count"] = 2'000'000;
  view["byteLength"] = std::uint64_t{252} * 2'000'000;
  EXPECT_CONTAINS(fault_of(bad), "packed and unpacked; palpa reads no more");
}

}  // namespace
}  // namespace palpa::geometry
