#include "geometry/files/ply.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "geometry/files/load_triangles.hpp"
#include "geometry/gltf_builder.hpp"
#include "geometry/memory_file.hpp"
#include "support/captured.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"

namespace palpa::geometry {
namespace {

const std::filesystem::path& folder() {
  static const std::filesystem::path path = test::scratch_folder("ply");
  return path;
}

std::filesystem::path written(const std::string& bytes) {
  static test::MemoryFile file;
  return file.write(bytes.data(), bytes.size());
}

Ply read(const std::string& bytes) {
  return read_ply(written(bytes));
}

std::string fault_of_file(const std::filesystem::path& file) {
  return test::fault_of_reading(file, [&] { read_ply(file); });
}

std::string fault_of(const std::string& bytes) {
  return fault_of_file(written(bytes));
}

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n";
}

/// What the messages about files must say.
void expect_faults_of(const std::vector<std::pair<std::string, std::string>>& files) {
  for (const auto& [bytes, message] : files)
    EXPECT_CONTAINS(fault_of(bytes), message) << bytes.substr(0, 300);
}

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string triangle_header =
    "element vertex 3\n" + xyz + "element face 1\nproperty list uchar int vertex_indices\n";

TEST(Ply, RoundTripsExactlyInAscii) {
  std::mt19937_64 random(1);
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      do
        p[k] = std::bit_cast<double>(random());
      while (!std::isfinite(p[k]));
    }
    points.push_back(p);
  }
  points.emplace_back(0.1, -0.0, std::numeric_limits<double>::denorm_min());
  write_ply(folder() / "a.ply", points, {}, PlyFormat::ascii);
  const Ply back = read_ply(folder() / "a.ply");
  EXPECT_TRUE(back.positions == points);
  EXPECT_TRUE(back.triangles.empty());
}

TEST(Ply, RoundTripsInBinaryToSinglePrecision) {
  const Mesh ball = test::sphere(0.02, 30, 40);
  write_ply(folder() / "b.ply", ball.positions, ball.triangles);
  const Ply back = read_ply(folder() / "b.ply");
  EXPECT_TRUE(back.positions == test::rounded(ball).positions);
  EXPECT_TRUE(back.triangles == ball.triangles);
  // 12 bytes a vertex, 13 a triangle, and the header.
  const auto size = std::filesystem::file_size(folder() / "b.ply");
  EXPECT_LT(size - 12 * ball.positions.size() - 13 * ball.triangles.size(), 300U);
  write_ply(folder() / "c.ply", ball.positions, ball.triangles, PlyFormat::ascii);
  EXPECT_TRUE(read_ply(folder() / "c.ply").triangles == ball.triangles);
  write_ply(folder() / "none.ply", {});
  EXPECT_TRUE(read_ply(folder() / "none.ply").positions.empty());
}

TEST(Ply, ReadsAsciiAsPeopleWriteIt) {
  const Ply ply = read(
      "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info x\r\nelement vertex 4\r\n"
      "property float32 x\r\nproperty uchar red\r\nproperty double y\r\nproperty float z\r\n"
      "element face 2\r\nproperty uchar flag\r\nproperty list uchar uint vertex_index\r\n"
      "element edge 1\r\nproperty int a\r\nend_header\r\n"
      "0 255 0 0\r\n+1 0 0 0\r\n 1.5e0\t7 1 0 \r\n\r\n0 7 1 -.25\r\n0 4 0 1 2 3\r\n1 3 0 2 3\r\n");
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {1.5, 1, 0}, {0, 1, -0.25}};
  EXPECT_TRUE(ply.positions == positions);
  // The quadrilateral becomes a fan.
  const std::vector<glm::uvec3> triangles{{0, 1, 2}, {0, 2, 3}, {0, 2, 3}};
  EXPECT_TRUE(ply.triangles == triangles);
}

template <typename T>
void put(std::string& out, T value, bool big) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

template <typename T>
void check_type(const std::string& name) {
  for (const bool big : {false, true}) {
    std::string elements = "element vertex 2\nproperty list ";
    elements.append(std::is_integral_v<T> ? name : "uint8").append(" short extra\n");
    for (const char axis : {'x', 'y', 'z'})
      elements.append("property ").append(name).append({' ', axis, '\n'});
    std::string file = header(big ? "binary_big_endian" : "binary_little_endian", elements + "property double more\n");
    for (int v = 0; v < 2; ++v) {
      if constexpr (std::is_integral_v<T>) {
        put<T>(file, 2, big);
      } else {
        put<std::uint8_t>(file, 2, big);
      }
      put<std::int16_t>(file, -1, big);
      put<std::int16_t>(file, 12345, big);
      put<T>(file, static_cast<T>(100 + v), big);
      put<T>(file, std::numeric_limits<T>::max(), big);
      put<T>(file, std::numeric_limits<T>::lowest(), big);
      put<double>(file, 0.5, big);
    }
    const Ply ply = read(file);
    ASSERT_EQ(ply.positions.size(), 2U);
    for (int v = 0; v < 2; ++v) {
      EXPECT_EQ(ply.positions[static_cast<std::size_t>(v)],
                Vec3(100 + v, static_cast<double>(std::numeric_limits<T>::max()),
                     static_cast<double>(std::numeric_limits<T>::lowest())))
          << name << (big ? " big" : " little");
    }
  }
}

TEST(Ply, MayBeginWithAByteOrderMark) {
  const std::string mark = "\xef\xbb\xbf", ascii = header("ascii", "element vertex 1\n" + xyz);
  EXPECT_EQ(read(mark + ascii + "1 2 3\n").positions, (std::vector<Vec3>{{1, 2, 3}}));
  EXPECT_CONTAINS(test::error_of([&] { read(mark + ascii + "1 x 3\n"); }), "line 8: \"x\"");
  const std::string binary = header("binary_little_endian", "element vertex 1\n" + xyz);
  EXPECT_EQ(read(mark + binary + std::string(12, '\0')).positions, (std::vector<Vec3>{{0, 0, 0}}));
  std::string wide = "\xff\xfe";
  for (const char c : ascii)
    wide += std::string{c, '\0'};
  EXPECT_CONTAINS(fault_of(wide), "is text in UTF-16; save it as UTF-8");
}

TEST(Ply, LinesMayEndWithACarriageReturn) {
  const std::string ascii =
      "ply\rformat ascii 1.0\relement vertex 2\rproperty float x\rproperty float y\rproperty float z\rend_header\r";
  EXPECT_EQ(read(ascii + "1 2 3\r4 5 6\r").positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_CONTAINS(test::error_of([&] { read(ascii + "1 2 3\r4 x 6\r"); }), "line 9: \"x\"");
  // A binary body may begin with the byte that would complete a line end.
  std::string binary = ascii;
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  binary.replace(binary.find("vertex 2"), 8, "vertex 1");
  const std::string body{'\n', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(read(binary + body).positions.at(0).x, std::bit_cast<float>(10));
  PALPA_SHARED_OR_SKIP(folder, "hostile");
  const Ply rhino = read_ply(folder / "rhino_cr_only.ply");
  EXPECT_EQ(rhino.positions.size(), 24U);
}

template <typename T>
void check_types(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    check_type<T>(name);
}

TEST(Ply, ReadsEveryTypeInEitherByteOrder) {
  check_types<std::int8_t>({"char", "int8"});
  check_types<std::uint8_t>({"uchar", "uint8"});
  check_types<std::int16_t>({"short", "int16"});
  check_types<std::uint16_t>({"ushort", "uint16"});
  check_types<std::int32_t>({"int", "int32"});
  check_types<std::uint32_t>({"uint", "uint32"});
  check_types<float>({"float", "float32"});
  check_types<double>({"double", "float64"});
}

TEST(Ply, ElementsInAnyOrder) {
  std::string file = header("binary_little_endian",
                            "element junk 1000\nproperty double a\nproperty uchar b\n"
                            "element face 1\nproperty list int ushort vertex_indices\nproperty float q\n"
                            "element lists 2\nproperty list uchar float l\nelement vertex 3\n" +
                                xyz + "element tail 9\nproperty char c\n");
  file += std::string(9000, '\x55');
  put<std::int32_t>(file, 3, false);
  for (const std::uint16_t i : {2, 1, 0})
    put(file, i, false);
  put<float>(file, 1, false);
  put<std::uint8_t>(file, 0, false);
  put<std::uint8_t>(file, 2, false);
  put<double>(file, 1, false);
  for (int i = 0; i < 9; ++i)
    put(file, static_cast<float>(i), false);
  file += std::string(9, 'c');
  const Ply ply = read(file);
  ASSERT_EQ(ply.positions.size(), 3U);
  EXPECT_EQ(ply.positions[2], Vec3(6, 7, 8));
  EXPECT_EQ(ply.triangles.at(0), glm::uvec3(2, 1, 0));
}

TEST(PlyFaults, TenGigabytes) {
  const auto file = folder() / "zeros.ply";
  const std::string lists = "element a 2000000000\nproperty list uchar int l\n";
  for (const std::string& head :
       {std::string("x"), std::string("ply\n"), header("ascii", "element vertex 9\n" + xyz),
        header("ascii", "element vertex 9\n" + xyz) + " \n",
        header("binary_little_endian", "element vertex 800000000\n" + xyz),
        header("ascii", "element vertex 1000000000\n" + xyz), header("binary_big_endian", lists + triangle_header),
        header("binary_big_endian", "element a 2000000000\nproperty int l\nelement vertex 3\nproperty int x\n")}) {
    std::ofstream(file, std::ios::binary) << head;
    std::filesystem::resize_file(file, 10ULL << 30);
    EXPECT_NE(fault_of_file(file), "") << head;
  }
  std::filesystem::remove(file);
}

TEST(PlyFaults, Headers) {
  const std::string one = "element vertex 1\n", vertex = one + xyz;
  expect_faults_of({
      {"plyformat", "first line"},
      {"solid x", "first line"},
      {"ply\nformat ascii 1.0\n", "end_header"},
      {"ply\n" + std::string(100'000, 'c') + "\n", "header"},
      {"ply\n" + vertex + "end_header\n0 0 0\n", "\"format\""},
      {header("ascii2", ""), "line 2"},
      {"ply\nformat ascii 2.0\nend_header\n", "line 2"},
      {header("ascii", ""), "no element \"vertex\""},
      {header("ascii", "elephant\n"), "unknown keyword"},
      {header("ascii", "property float x\n"), "line 3"},
      {header("ascii", "element vertex -1\n"), "whole number"},
      {header("ascii", "element vertex 99999999999999999999\n"), "whole number"},
      {header("ascii", one + "property half x\n"), "unknown type"},
      {header("ascii", one + "property list float int x\n"), "integer"},
      {header("ascii", one + "property float x\nproperty float y\n") + "0 0\n", "x, y, z"},
      {header("ascii", vertex + "property int x\n") + "0 0 0 0\n", "twice"},
      {header("ascii", vertex + vertex) + "0 0 0 0 0 0\n", "twice"},
  });
}

TEST(PlyFaults, CountsThatTheFileCannotHold) {
  const std::string faces = "element face 3000000000\nproperty list uchar int vertex_indices\n";
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    expect_faults_of({
        {header(format, "element vertex 4000000000\n" + xyz) + "0 0 0\n", "promises 4000000000"},
        {header(format, "element vertex 18446744073709551615\n" + xyz) + "0 0 0\n", "promises"},
        {header(format, "element vertex 1\n" + xyz + faces) + "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0", "promises 3000000000"},
    });
  }
}

TEST(PlyFaults, Truncation) {
  const Mesh ball = test::sphere(0.02, 5, 6);
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::binary}) {
    write_ply(folder() / "whole.ply", ball.positions, ball.triangles, format);
    std::ifstream in(folder() / "whole.ply", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    // The last newline of an ascii file may be missing, and its last number may lose digits unnoticed.
    const std::size_t spare = format == PlyFormat::ascii ? 3 : 0;
    for (std::size_t length = 1; length + spare < whole.size(); ++length)
      EXPECT_NE(fault_of(whole.substr(0, length)), "") << length;
  }
}

TEST(PlyFaults, Values) {
  const std::string start = header("ascii", triangle_header), good = start + "0 0 0\n1 0 0\n0 1 0\n";
  std::string binary = header("binary_little_endian", "element vertex 2\n" + xyz);
  for (int i = 0; i < 5; ++i)
    put(binary, 1.0F, false);
  put(binary, std::numeric_limits<float>::quiet_NaN(), false);
  expect_faults_of({
      {start + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1 is not finite"},
      {start + "0 0 0\n1 0 0\n0 1 -inf\n3 0 1 2\n", "vertex 2 is not finite"},
      {start + "0 0 0\n1 0 1e999\n0 1 0\n3 0 1 2\n", "vertex 1 is not finite"},
      {start + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "line 11: \"zero\" is not a number"},
      {good + "3 0 1 3\n", "vertex 3, but there are only 3"},
      {good + "3 0 1 -2\n", "uses vertex -2"},
      {good + "3 0 1 1.5\n", "does not fit its type"},
      {good + "2 0 1 0\n", "has 2 corners"},
      {good + "300 0 1 2\n", "does not fit its type"},
      {good + std::string(5000, ' ') + "3 0 1 2\n", "a number is missing"},
      {start + std::string(500, '1') + " 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "400 characters"},
      {binary, "vertex 1 is not finite"},
  });
}

TEST(PlyFaults, ARowIsALineWithTheNumbersOfItsElement) {
  const std::string points = header("ascii", "element vertex 2\n" + xyz);
  const std::string faces = header("ascii", triangle_header) + "0 0 0\r\n1 0 0\t \r\n\r\n0 1 0\r\n";
  expect_faults_of({
      {points + "0 0 0 1\n1 2 3 1\n", "line 8: 4 numbers, the header promises 3"},
      {points + "0 0 0\n1 2 3 x y\n", "line 9: 5 numbers, the header promises 3"},
      {points + "0 0\n1 2 3\n4 5 6\n", "line 8: 2 numbers, the header promises 3"},
      {points + "0 0 0 1 2 3\n", "line 8: 6 numbers, the header promises 3"},
      {faces + "3 0 1 2 9\n", "line 14: 5 numbers, the header and the lists in this line promise 4"},
      {faces + "3 0 1\r\n2\r\n", "line 14: 3 numbers, the header and the lists in this line promise 4"},
      {header("ascii", "element tag 1\nproperty int a\nelement vertex 1\n" + xyz) + "1 2\n3 4 5\n",
       "line 10: 2 numbers, the header promises 1"},
      {points + "0 0 0" + std::string(5000, ' ') + "\n1 2 3\n", "do not end its line"},
  });
  EXPECT_EQ(read(faces + "3 0 1 2").triangles.size(), 1U);
}

TEST(PlyFaults, DataBehindTheElementsIsLeftOutWithAWarning) {
  const std::string vertex = "element vertex 1\n" + xyz, points = header("ascii", vertex),
                    binary = header("binary_little_endian", vertex),
                    more = vertex + "element tag 2\nproperty uchar a\nproperty int b\n";
  const auto warning_of = [](const std::string& file) {
    return test::stderr_of([&] { EXPECT_EQ(read(file).positions.size(), 1U); });
  };
  const std::vector<std::pair<std::string, std::string>> longer{
      {points + "0 0 0\n\n1 2 3\n4 5 6", "line 10: 2 lines more than its header promises are left out"},
      {binary + std::string(24, '\0'), "12 bytes more than its header promises"},
      {header("ascii", more) + "0 0 0\n1 2\n3 4\n5 6\n", "line 14: 1 line more"},
      {header("binary_big_endian", more) + std::string(12 + 2 * 5 + 3, '\0'), "3 bytes more"},
  };
  for (const auto& [file, message] : longer)
    EXPECT_CONTAINS(warning_of(file), message);
  for (const std::string& whole :
       {points + "0 0 0", points + "0 0 0\r\n \r\n\x1a", binary + std::string(12, '\0') + "\r\n",
        header("ascii", more) + "0 0 0\nthese are\nnot read\n",
        header("binary_big_endian", more) + std::string(12 + 2 * 5, '\0')})
    EXPECT_EQ(warning_of(whole), "");
}

TEST(PlyFaults, ADiskThatIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "skipped: no /dev/full";
  const Mesh ball = test::sphere(0.02, 100, 200);
  const std::vector<Vec3> one{{0, 0, 0}};
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::binary}) {
    EXPECT_ERROR(write_ply("/dev/full", ball.positions, ball.triangles, format), Exit::failed,
                 "/dev/full: cannot be written: No space left");
    EXPECT_ERROR(write_ply("/dev/full", one, {}, format), Exit::failed, "No space left");
  }
  EXPECT_ERROR(write_ply(folder() / "absent" / "a.ply", one), Exit::failed, "No such file");
}

TEST(Ply, AMillionPointsTakeASecondOrTwo) {
  const Mesh ball = test::sphere(0.02, 500, 2000);
  for (const PlyFormat format : {PlyFormat::ascii, PlyFormat::binary}) {
    write_ply(folder() / "large.ply", ball.positions, {}, format);
    [[maybe_unused]] const double start = test::processor_s();
    EXPECT_EQ(read_ply(folder() / "large.ply").positions.size(), ball.positions.size());
#ifdef NDEBUG
    EXPECT_LT(test::processor_s() - start, 3 * test::slowest);
#endif
  }
}

TEST(LoadTriangles, TheEndingSaysWhichFormatAFileHas) {
  const Mesh finger = load_triangles(test::source_file("assets/finger.ply").string());
  EXPECT_EQ(finger.triangles, read_ply(test::source_file("assets/finger.ply")).triangles);
  const auto cube = test::source_file("assets/cube.glb"), loud = folder() / "CUBE.GLB";
  std::filesystem::copy_file(cube, loud);
  EXPECT_EQ(load_triangles(loud.string()).triangles.size(), 12u);
  EXPECT_EQ(load_triangles(loud.string()).positions, load_triangles(cube.string()).positions);
  EXPECT_REFUSED(load_triangles((folder() / "none.obj").string()), "none.obj");
}

}  // namespace
}  // namespace palpa::geometry
