// Damaged files, the same ones on every run: reading them succeeds or throws palpa::Error, nothing else. Under the
// sanitizers, this is also a search for memory faults.
#include <gtest/gtest.h>

#include <random>

#include "base/log.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf_builder.hpp"
#include "geometry/hostile_models.hpp"
#include "geometry/memory_file.hpp"
#include "geometry/packers.hpp"
#include "geometry/solid.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::box;
using test::GltfBuilder;
using Json = GltfBuilder::Json;
using Random = std::mt19937;

class GeometryFuzz : public ::testing::Test {
 protected:
  GeometryFuzz() { log::set_level(log::Level::quiet); }
  ~GeometryFuzz() override { log::set_level(before_); }

  /// Reads the bytes as a file and counts whether that succeeds. Triangles that were read must have their vertices.
  void try_gltf(const std::vector<unsigned char>& bytes) {
    count(bytes, [](const std::filesystem::path& file) {
      const Scene scene = load_gltf(file);
      for (const SceneMesh& m : scene.meshes)
        expect_vertices(m.mesh.triangles, m.mesh.positions.size());
      for (const Solid& s : make_solids(scene)) {
        ASSERT_GT(signed_volume(s.mesh), 0);
        ASSERT_GE(s.mesh.triangles.size(), 4U);
      }
    });
  }
  void try_ply(const std::vector<unsigned char>& bytes) {
    count(bytes, [](const std::filesystem::path& file) {
      const Ply ply = read_ply(file);
      expect_vertices(ply.triangles, ply.positions.size());
    });
  }
  int good = 0, refused = 0;

 private:
  static void expect_vertices(const std::vector<glm::uvec3>& triangles, std::size_t vertices) {
    for (const glm::uvec3& t : triangles)
      ASSERT_LT(std::max({t[0], t[1], t[2]}), vertices);
  }
  template <typename Read>
  void count(const std::vector<unsigned char>& bytes, const Read& read) {
    static test::MemoryFile file;
    const auto path = file.write(bytes.data(), bytes.size());
    ++(test::error_of([&] { read(path); }).empty() ? good : refused);
  }
  log::Level before_ = log::level();
};

// A few bytes changed, removed, repeated, or the end cut off.
std::vector<unsigned char> damaged(std::vector<unsigned char> bytes, Random& random) {
  const std::size_t hits = 1 + random() % 4;
  for (std::size_t i = 0; i < hits && !bytes.empty(); ++i) {
    const std::size_t at = random() % bytes.size();
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto at_most = [&](std::size_t count) {
      return static_cast<std::ptrdiff_t>(std::min(count, bytes.size() - at));
    };
    switch (random() % 7) {
      case 0:
        *place = static_cast<unsigned char>(random());
        break;
      case 1:
        *place ^= static_cast<unsigned char>(1U << (random() % 8));
        break;
      case 2:
        *place = 0xff;
        break;
      case 3:
        bytes.erase(place, place + at_most(1 + random() % 8));
        break;
      case 4:
        bytes.insert(place, static_cast<unsigned char>("0123456789[]{},:\"-.eE \n"[random() % 23]));
        break;
      case 5:
        bytes.resize(at);
        break;
      default: {
        const std::vector<unsigned char> piece(place, place + at_most(random() % 40));
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size()), piece.begin(), piece.end());
      }
    }
  }
  return bytes;
}

// Some value of the document, replaced by a wrong one that is likely to find faults.
void damage(Json& value, Random& random) {
  Json* at = &value;
  while (at->is_structured() && !at->empty() && random() % 8 != 0) {
    auto child = at->begin();
    std::advance(child, static_cast<std::ptrdiff_t>(random() % at->size()));
    at = &*child;
  }
  static const Json replacements = Json::parse(R"([null, true, -1, 0, 1, 2, 3, 4, 255, 65535, 2147483647, 2147483648,
      4294967295, 18446744073709551615, 1e300, -1e300, 0.5, 1e-300, "", "x", "SCALAR", "VEC3", "MAT4", [], {}, 5120,
      5121, 5123, 5125, 5126, [0, 0], [0, 1, 2], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]])");
  const auto kind = random() % 6;
  const bool full = at->is_structured() && !at->empty();
  const auto any = [&] { return random() % at->size(); };
  if (kind == 0 && full && at->is_array()) {
    at->erase(any());
  } else if (kind == 0 && full) {
    at->erase(std::next(at->begin(), static_cast<std::ptrdiff_t>(any())).key());
  } else if (kind <= 1 && full && at->is_array()) {
    at->push_back((*at)[any()]);
  } else if (kind <= 2 && at->is_number()) {
    *at = at->get<double>() + static_cast<double>(random() % 9) - 4;
  } else {
    *at = replacements[random() % replacements.size()];
  }
}

// The file with a few damaged values; empty if what remains is no document.
std::vector<unsigned char> with_damaged_values(GltfBuilder file, std::size_t hits, Random& random) {
  file.doc["buffers"] = Json::array({{{"byteLength", file.bin.size()}}});
  for (; hits > 0; --hits)
    damage(file.doc, random);
  try {
    return file.doc.is_object() ? file.glb() : std::vector<unsigned char>{};
  } catch (const Json::exception&) {
    return {};
  }
}

// One file with many kinds of content.
GltfBuilder rich_file() {
  GltfBuilder b;
  b.add_mesh(box(Vec3(0), Vec3(1)));
  const Mesh cube = box(Vec3(2), Vec3(3));
  const int positions = b.add_positions(cube.positions);
  b.add_mesh(positions, b.add_indices(test::corners_of(cube), 5121));
  b.doc["accessors"][static_cast<std::size_t>(positions)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", b.add_view({7})}, {"componentType", 5121}}},
      {"values", {{"bufferView", b.add_view(test::bytes_of(std::vector<float>{3, 3, 3}))}}}};
  b.add_mesh(b.add_positions(test::unshared(box(Vec3(5), Vec3(6))).positions));
  b.doc["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", 0}}});
  b.doc["meshes"][0]["weights"] = {0.25};
  std::vector<std::uint16_t> weights(32, 0);
  for (std::size_t i = 0; i < 32; i += 4)
    weights[i] = 65535;
  auto& attributes = b.doc["meshes"][1]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = b.add_accessor(std::vector<unsigned char>(32, 0), 5121, 8, "VEC4");
  attributes["WEIGHTS_0"] = b.add_accessor(test::bytes_of(weights), 5123, 8, "VEC4");
  const std::vector<float> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const int matrices = b.add_accessor(test::bytes_of(identity), 5126, 1, "MAT4");
  b.doc["skins"] = Json::array({{{"joints", {0}}, {"inverseBindMatrices", matrices}}});
  b.add_node(
      {{"mesh", 0}, {"name", "a"}, {"translation", {0, 0, 9}}, {"rotation", {0, 0, 0, 1}}, {"scale", {1, -1, 1}}});
  b.add_node({{"mesh", 1}, {"skin", 0}});
  const int leaf = b.add_node({{"mesh", 2}}, false);
  b.add_node({{"children", {leaf}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1}}});
  b.doc["materials"] = Json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  b.doc["textures"] = Json::array({{{"source", 0}}});
  b.doc["images"] = Json::array({{{"uri", "a.png"}}});
  return b;
}

TEST_F(GeometryFuzz, GltfWithDamagedBytes) {
  EXPECT_EQ(make_solids(load(rich_file())).size(), 3U) << "undamaged";
  Random random(20240501);
  const auto binary = rich_file().glb();
  const std::string text = rich_file().text("data:application/octet-stream;base64,AAAA");
  const std::vector<unsigned char> plain(text.begin(), text.end());
  for (int i = 0; i < 3000; ++i)
    try_gltf(damaged(i % 3 == 0 ? plain : binary, random));
  // Truncated at many places.
  for (std::size_t length = 1; length < binary.size(); length += 7)
    try_gltf({binary.begin(), binary.begin() + static_cast<std::ptrdiff_t>(length)});
  EXPECT_GT(refused, 1000);
}

TEST_F(GeometryFuzz, GltfWithDamagedValues) {
  Random random(20240502);
  const GltfBuilder whole = rich_file();
  for (int i = 0; i < 4000; ++i) {
    const auto bytes = with_damaged_values(whole, 1 + random() % 3, random);
    if (!bytes.empty()) try_gltf(bytes);
  }
  EXPECT_GT(good, 200);
  EXPECT_GT(refused, 1000);
}

/// Small members of the families whose cost could grow faster than their size: nested bodies, bodies side by side along
/// a diagonal, a fan of needles, nodes and instances that share a mesh, overlapping parts.
std::vector<GltfBuilder> families() {
  std::vector<GltfBuilder> all(6);
  const Mesh cube = box(Vec3(-1), Vec3(1));
  const Mesh meshes[]{test::hostile::nested(5, true),
                      test::hostile::rods(5),
                      test::hostile::needles(12),
                      test::ell(),
                      test::ell(),
                      cube};
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].add_mesh(meshes[i]);
  for (std::size_t i = 0; i < 3; ++i)
    all[i].add_node({{"mesh", 0}});
  for (int i = 0; i < 20; ++i)
    all[3].add_node({{"mesh", 0}, {"translation", {0.1 * i, 0, 0}}});
  const int places = all[4].add_positions(cube.positions);
  all[4].add_node(
      {{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  all[4].doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  for (int i = 0; i < 6; ++i)
    all[5].add_node({{"mesh", 0}, {"translation", {0.3 * i, 0, 0}}, {"extras", {{"palpa_part_of", "body"}}}});
  return all;
}

TEST_F(GeometryFuzz, DamagedFamilies) {
  for (const GltfBuilder& seed : families())
    try_gltf(seed.glb());
  EXPECT_EQ(good, 5);
  EXPECT_EQ(refused, 1) << "the needles";
  Random random(20240506);
  for (const GltfBuilder& seed : families()) {
    const auto whole = seed.glb();
    for (int i = 0; i < 300; ++i) {
      try_gltf(damaged(whole, random));
      const auto bytes = with_damaged_values(seed, 1, random);
      if (!bytes.empty()) try_gltf(bytes);
    }
  }
  EXPECT_GT(good, 105);
  EXPECT_GT(refused, 501);
}

// Only the compressed bytes: other tests damage the rest.
TEST_F(GeometryFuzz, DamagedStreams) {
  Random random(20240505);
  const Mesh ball = test::rounded(test::sphere(0.02, 6, 8));
  std::vector<GltfBuilder> seeds{test::meshopt_file(ball), test::meshopt_file(ball, {.sequence = true}),
                                 test::meshopt_file(ball, {.exponential = true, .index_size = 2})};
  for (const bool sequential : {false, true}) {
    for (const int bits : {0, 11}) {
      seeds.push_back(test::draco_file(test::draco_stream(ball, bits, sequential, bits == 0), ball.positions.size(),
                                       ball.triangles.size()));
      // Limits so high that they have no effect.
      seeds.push_back(test::draco_file(test::draco_stream(ball, bits, sequential, bits == 0), 500'000, 500'000));
    }
  }
  for (const GltfBuilder& seed : seeds) {
    EXPECT_EQ(load_gltf(seed.in_memory()).meshes.at(0).mesh.triangles.size(), ball.triangles.size());
    for (int i = 0; i < 400; ++i) {
      GltfBuilder bad = seed;
      for (std::size_t hits = 1 + random() % 4; hits > 0; --hits) {
        unsigned char& byte = bad.bin[random() % bad.bin.size()];
        byte = random() % 2 == 0 ? static_cast<unsigned char>(byte ^ 1U << random() % 8)
                                 : static_cast<unsigned char>(random());
      }
      try_gltf(bad.glb());
    }
    for (std::size_t length = 1; length < seed.bin.size(); length += 13) {
      GltfBuilder bad = seed;
      bad.bin.resize(length);
      bad.bin.resize(seed.bin.size());
      try_gltf(bad.glb());
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST_F(GeometryFuzz, DamagedRealFiles) {
  PALPA_SHARED_OR_SKIP(folder, "gltf-valid");
  Random random(20240503);
  for (const char* name : {"03_Box/Box.glb", "07_cubeStrip/cubeStrip.glb", "39_quad_skin/quad_skin.glb",
                           "53_BoxVertexColors/BoxVertexColors.gltf", "11_Duck-vp-3-vt-3-vn-3/Duck-vp-3-vt-3-vn-3.glb",
                           "43_BoxMeshopt/BoxMeshopt.glb", "49_Box_Draco/Box_Draco.glb"}) {
    const auto bytes = test::read_bytes(folder / name);
    ASSERT_FALSE(bytes.empty());
    for (int i = 0; i < 500; ++i)
      try_gltf(damaged(bytes, random));
  }
  EXPECT_GT(refused, 500);
}

TEST_F(GeometryFuzz, Ply) {
  Random random(20240504);
  const auto folder = test::scratch_folder("fuzz");
  const Mesh ball = test::sphere(0.02, 4, 5);
  std::vector<std::vector<unsigned char>> seeds;
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::binary}) {
    write_ply(folder / "seed.ply", ball.positions, ball.triangles, format);
    seeds.push_back(test::read_bytes(folder / "seed.ply"));
  }
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement extra 2\nproperty list int double a\nelement vertex 2\nproperty "
      "double x\n"
      "property list uchar short b\nproperty short y\nproperty uint z\nelement face 1\nproperty list uchar uchar "
      "vertex_index\nend_header\n";
  big += std::string(2 * 4 + 2 * 15, '\0') + std::string("\3\0\1\0", 4);
  seeds.emplace_back(big.begin(), big.end());
  for (const auto& seed : seeds)
    try_ply(seed);
  EXPECT_EQ(good, 3) << "undamaged";
  for (const auto& seed : seeds) {
    for (int i = 0; i < 2000; ++i)
      try_ply(damaged(seed, random));
  }
  EXPECT_GT(good, 103);
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace palpa::geometry
