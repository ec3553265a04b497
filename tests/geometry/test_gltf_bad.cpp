// Broken files made here: each fault gives an error that names it, quickly and with little memory.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <limits>

#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf_builder.hpp"
#include "geometry/solid.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::BadByte;
using test::box;
using test::Fault;
using test::fault_of_file;
using test::GltfBuilder;
using Json = GltfBuilder::Json;

const std::filesystem::path& folder() {
  static const std::filesystem::path path = test::scratch_folder("gltf-bad");
  return path;
}

std::string fault_of_text(const std::string& text) {
  test::write_text(folder() / "model.gltf", text);
  return fault_of_file(folder() / "model.gltf");
}

std::string fault_of_bytes(const std::vector<unsigned char>& bytes) {
  test::write_bytes(folder() / "model.glb", bytes.data(), bytes.size());
  return fault_of_file(folder() / "model.glb");
}

const Mesh cube = box(Vec3(0), Vec3(1));

TEST(BadGltf, TenGigabytesOfZeros) {
  const auto file = folder() / "zeros.glb";
  test::write_text(file, "x");
  std::filesystem::resize_file(file, 10ULL << 30);
  EXPECT_CONTAINS(fault_of_file(file), "neither glTF");
  // With the beginning of a real file.
  for (const std::string& head : {std::string("{"), std::string("glTF\2\0\0\0\xff\xff\xff\xff\xf0\xff\xff\xffJSON", 20),
                                  std::string("glTF\2\0\0\0\xff\xff\xff\xff\0\0\0\1JSON", 20),
                                  std::string("glTF\2\0\0\0\xff\xff\xff\xff\0\0\0\4JSON", 20)}) {
    test::write_text(file, head);
    std::filesystem::resize_file(file, 10ULL << 30);
    EXPECT_NE(fault_of_file(file), "");
  }
  std::filesystem::remove(file);
}

// Texts, and what the message says of each.
struct BadText {
  std::string text, fault;
};

void expect_text_faults(const std::vector<BadText>& texts) {
  for (const BadText& bad : texts)
    EXPECT_CONTAINS(fault_of_text(bad.text), bad.fault) << bad.text.substr(0, 100);
}

TEST(BadGltf, InvalidJsonIsRefused) {
  std::string many = "{\"a\": [0";
  for (int i = 0; i < 2'100'000; ++i)
    many += ",0";
  std::string wide;
  for (const char c : std::string("{\"asset\": {\"version\": \"2.0\"}}"))
    wide += std::string{c, '\0'};
  expect_text_faults({{"\xff\xfe" + wide, "is text in UTF-16; save it as UTF-8"},
                      {wide, "is text in UTF-16; save it as UTF-8"},
                      {"hello", "neither glTF"},
                      {"{\n\n  \"asset\": }", "syntax error at line 3"},
                      {R"({"asset": {"version": "2.0"}} trailing)", "syntax error at character 33"},
                      {"{\"a\": \"\xff\xfe\"}", "syntax error"},
                      {"{\"a\": " + std::string(1'000'000, '['), "nested"},
                      {R"({"a": [1e999]})", "its JSON has a number that is out of range"},
                      {many + "]}", "more than 2000000 values"}});
}

TEST(BadGltf, VersionsAndExtensions) {
  expect_text_faults({{"{}", "\"asset\" is missing"},
                      {R"({"asset": {}})", "\"asset\" lacks \"version\""},
                      {R"({"asset": {"version": 2.0}})", "not a string"},
                      {R"({"asset": {"version": "2.0", "minVersion": "2.1"}})", "2.1"},
                      // A name in the file cannot break the error line.
                      {R"({"asset": {"version": "2.0"}, "extensionsRequired": ["A\nB"]})", "\"A\\nB\""},
                      {R"({"asset": {"version": "2.0"}, "extensionsRequired": [3]})", "something that is not a name"}});
  for (const char* version : {"1.0", "2", "2.", "2.0x", "20", "3.0"})
    expect_text_faults({{R"({"asset": {"version": ")" + std::string(version) + "\"}}", "palpa reads glTF 2.0"}});
}

TEST(BadGltf, BinaryContainers) {
  const auto good = GltfBuilder(cube).glb();
  for (std::size_t length : {0U, 3U, 11U, 12U, 19U, 20U, 30U})
    EXPECT_NE(fault_of_bytes({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)}), "") << length;
  EXPECT_CONTAINS(fault_of_bytes({good.begin(), good.end() - 1}), "cut off");
  for (const auto& [place, value, fault] : {BadByte{4, 1, "version 1"}, BadByte{16, 'B', "first chunk is not JSON"},
                                            BadByte{15, 0xff, "chunk 0 is cut off"}}) {
    auto bytes = good;
    bytes[place] = value;
    EXPECT_CONTAINS(fault_of_bytes(bytes), fault);
  }
}

TEST(BadGltf, LongStringsCostLittle) {
  const std::string filler(8 << 20, 'A'), head = R"({"asset": {"version": "2.0"}, )";
  std::string slashes;
  while (slashes.size() < filler.size())
    slashes += "\\/";
  expect_text_faults({{head + R"("extras": ")" + filler + "\"}", "no triangle mesh"},
                      {head + R"("extras": ")" + filler, "syntax error"},
                      {R"({"asset": {"version": ")" + filler + "\"}}", "palpa reads glTF 2.0"},
                      {head + R"("buffers": [{"byteLength": 9, "uri": ")" + slashes + "\"}]}", "not a relative path"}});
  GltfBuilder builder(cube);
  // The second one looks like the placeholder of a long string.
  for (const auto& [uri, fault] : {std::pair("data:;base64," + filler + "!", "not base64"),
                                   std::pair(std::string("data:long string 7"), "its data URI is not")}) {
    builder.doc["buffers"] = Json::array({{{"byteLength", 240}, {"uri", uri}}});
    EXPECT_CONTAINS(fault_of_text(builder.text("")), fault);
  }
}

TEST(BadGltf, FaultsOfADocumentAreNamed) {
  const std::vector<Fault> faults{
      {"/scene", "1", "\"scene\" names scene 1"},
      {"/scene", "-1", "\"scene\" is not an index"},
      {"/scene", "0.5", "\"scene\" is not an index"},
      {"/scenes/0/nodes", "[]", "no triangle mesh"},
      {"/scenes/0/nodes", "[0, 0]", "names node 0 twice"},
      {"/scenes/0/nodes", "[4]", "names node 4"},
      {"/nodes", "{}", "\"nodes\" is not an array"},
      {"/nodes/0", "3", "node 0: is not a JSON object"},
      {"/nodes", R"([{"children": [1]}, {"children": [0], "mesh": 0}])", "loop"},
      {"/nodes/0/children", "[0]", "its own child"},
      {"/nodes", R"([{"children": [2]}, {"children": [2]}, {"mesh": 0}])", "both node 0 and node 1"},
      {"/nodes", R"([{"mesh": 0}, {"children": [0]}])", "a child of node 1"},
      {"/nodes/0/mesh", "1", "names mesh 1"},
      {"/nodes/0/name", "7", "\"name\" is not a string"},
      {"/nodes/0/skin", "0", "names skin 0"},
      {"/nodes/0/matrix", "[1, 0]", "2 values; it needs 16"},
      {"/nodes/0/matrix", "[1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]", "not affine"},
      {"/nodes/0/matrix", "[1, 2, 3, 0, 1, 2, 3, 0, 0, 0, 1, 0, 0, 0, 0, 1]", "scale is zero"},
      {"/nodes/0", R"({"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "scale": [1, 1, 1]})",
       "both \"matrix\""},
      {"/nodes/0/scale", "[1, 0, 1]", "scale is zero"},
      {"/nodes/0/scale", "[1e300, 1e300, 1e300]", "its scale is zero"},
      {"/nodes/0/scale", "[1e-200, 1e-200, 1e-200]", "its scale is zero"},
      // So far away that both of its ends round to one place.
      {"/nodes/0/translation", "[1e308, 0, 0]", "kilometre"},
      {"/nodes/0/translation", "[1e6, 0, 0]", "kilometre"},
      {"/nodes/0/rotation", "[0, 0, 0, 0]", "unit quaternion"},
      {"/nodes/0/rotation", "[0, \"0\", 0, 1]", "not a number"},
      {"/meshes/0/primitives/0/mode", "7", "\"mode\" is 7"},
      {"/meshes/0/primitives", "[]", "no primitives"},
      {"/meshes/0/primitives/0/attributes", "", "\"attributes\" is missing"},
      {"/meshes/0/primitives/0/attributes/POSITION", "\"0\"", "not an index"},
      {"/accessors/0/type", "\"VEC2\"", "they must be VEC3"},
      {"/accessors/0", R"({"bufferView": 0, "componentType": 5122, "normalized": true, "count": 8, "type": "VEC3"})",
       "KHR_mesh_quantization"},
      {"/accessors/1/componentType", "5126", "not scalar unsigned integers"},
      {"/accessors/1/componentType", "5124", "accessor 1"},
      {"/accessors/0/count", "0", "\"count\" is 0"},
      {"/accessors/0/count", "9", "does not fit its buffer view"},
      {"/accessors/0/count", "4000000000", "does not fit its buffer view"},
      {"/accessors/0/count", "1e30", "\"count\" is not a whole number"},
      {"/accessors/0/byteOffset", "4", "does not fit its buffer view"},
      {"/accessors/0/bufferView", "", "has no data"},
      {"/accessors/0/sparse", R"({"count": 9, "indices": {}, "values": {}})", "\"count\" is 9"},
      {"/accessors/0/sparse", R"({"count": 1})", "\"indices\" is missing"},
      {"/bufferViews/1/byteLength", "4000000", "does not fit its buffer"},
      {"/bufferViews/0/byteOffset", "4000000000", "does not fit its buffer"},
      {"/bufferViews/0/byteStride", "8", "byteStride of 8"},
      {"/bufferViews/0/byteStride", "13", "multiple of 4"},
      {"/bufferViews/0/byteStride", "256", "within 4 and 252"},
      {"/bufferViews/1/byteStride", "4", "byteStride"},
      {"/buffers", R"([{"byteLength": 4000}])", "but the BIN chunk has"},
      {"/buffers", R"([{"byteLength": 4000000000, "uri": "data:;base64,AAAA"}])", "reads at most"},
      {"/buffers", R"([{"byteLength": 240, "uri": "absent.bin"}])", "absent.bin"},
      {"/buffers", R"([{"byteLength": 240, "uri": "/dev/zero"}])", "not a relative path"},
      {"/buffers", R"([{"byteLength": 240, "uri": "../../../../../../../../dev/zero"}])", "buffer 0"},
      {"/buffers", R"([{"byteLength": 240, "uri": "a%zz"}])", "not a relative path"},
      {"/buffers", R"([{"byteLength": 240, "uri": "."}])", "is a folder"},
      {"/buffers", R"([{"byteLength": 240, "uri": "data:;base64,AAAA"}])", "byteLength"},
      {"/buffers", R"([{"byteLength": 240, "uri": "data:;base64,)" + std::string(320, '!') + "\"}]", "not base64"}};
  expect_faults(GltfBuilder(cube), faults);
}

TEST(BadGltf, PositionsThatAreNotFinite) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
    Mesh spoilt = cube;
    spoilt.positions[5].y = wrong;
    EXPECT_CONTAINS(fault_of(GltfBuilder(spoilt)), "vertex 5 is not finite");
  }
}

TEST(BadGltf, IndicesOutOfRangeAndPrimitiveRestarts) {
  for (const auto& [component, restart] :
       {std::pair(5121, 255U), std::pair(5123, 65535U), std::pair(5125, 4294967295U)}) {
    for (const std::uint32_t index : {8U, restart}) {
      GltfBuilder builder;
      const int positions = builder.add_positions(cube.positions);
      builder.add_mesh(positions, builder.add_indices({0, 1, 2, 3, index, 5}, component));
      builder.add_node({{"mesh", 0}});
      EXPECT_CONTAINS(fault_of(builder),
                      index == 8 ? "index 4 names vertex 8, but there are only 8" : "primitive restart");
    }
  }
}

// Small files that would need a lot of memory or time.
TEST(BadGltf, BombsAreRefusedBeforeTheyGoOff) {
  const GltfBuilder ball(test::sphere(1, 100, 200));  // of 40 000 triangles
  GltfBuilder nodes = ball;
  for (int i = 1; i < 10'000; ++i)
    nodes.add_node({{"mesh", 0}});
  EXPECT_CONTAINS(fault_of(nodes), "more than 2000000 triangles");

  GltfBuilder primitives = ball;
  const Json one = primitives.doc["meshes"][0]["primitives"][0];
  primitives.doc["meshes"][0]["primitives"] = Json::array_t(10'000, one);
  EXPECT_CONTAINS(fault_of(primitives), "more than 2000000 triangles");
  primitives.doc["meshes"][0]["primitives"] = Json::array_t(60'000, one);
  EXPECT_CONTAINS(fault_of(primitives), "more than 50000 primitives");

  GltfBuilder morph = ball;
  morph.doc["meshes"][0]["primitives"][0]["targets"] = Json::array_t(5'000, {{"POSITION", 0}});
  morph.doc["meshes"][0]["weights"] = Json::array_t(5'000, 1);
  EXPECT_CONTAINS(fault_of(morph), "morph targets move more than");

  GltfBuilder many;
  many.doc["nodes"] = Json::array_t(200'000, Json::object());
  EXPECT_CONTAINS(fault_of(many), "has 200000 nodes");

  GltfBuilder base(cube);
  base.doc["accessors"][0].erase("bufferView");
  base.doc["accessors"][0]["count"] = 4'000'000'000U;
  base.doc["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}};
  EXPECT_CONTAINS(fault_of(base), "more than 2000000 triangles or 6000000 vertices");
}

// The numbers of triangles and of vertices, times that of the instances, are multiples of 2^64.
TEST(BadGltf, CountsThatWrapAroundAreRefused) {
  GltfBuilder builder;
  const Json sparse{{"count", 1},
                    {"indices", {{"bufferView", builder.add_view({0})}, {"componentType", 5121}}},
                    {"values", {{"bufferView", builder.add_view(std::vector<unsigned char>(12, 0))}}}};
  const auto zeros = [](std::uint64_t count) {
    return Json{{"componentType", 5126}, {"count", count}, {"type", "VEC3"}};
  };
  builder.doc["accessors"] = {zeros((1U << 25) + 2), zeros((std::uint64_t{1} << 32) - 256), zeros(1U << 24)};
  builder.doc["accessors"][0]["sparse"] = builder.doc["accessors"][1]["sparse"] = sparse;
  const Json strip{{"attributes", {{"POSITION", 0}}}, {"mode", 5}};
  const Json corner{{"attributes", {{"POSITION", 1}}}, {"indices", builder.add_indices({0})}};
  Json::array_t primitives(1 << 15, strip);
  primitives.insert(primitives.end(), 256, corner);
  builder.doc["meshes"] = {{{"primitives", primitives}}};
  builder.add_node(
      {{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 2}}}}}}}});
  EXPECT_CONTAINS(fault_of(builder), "more than 2000000 triangles or 6000000 vertices");
}

TEST(BadGltf, PeakMemoryStaysBelowAGigabyte) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef NDEBUG
  EXPECT_LT(usage.ru_maxrss, 1'000'000) << "kB";
#endif
}

}  // namespace
}  // namespace palpa::geometry
