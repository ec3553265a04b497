// The meshes of CGAL's demos: good, bad and broken ones. Each is touched correctly or rejected with a reason.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/gltf/gltf.hpp"
#include "support/digest.hpp"
#include "support/exhaustive.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "touch/contacts/surface_models.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

namespace fs = std::filesystem;

/// Reads Object File Format, text: vertices, then polygons, which are cut into fans. Returns an empty mesh if the file
/// is in another format or has more than `most_faces` faces.
geometry::Mesh read_off(const fs::path& path, std::size_t most_faces) {
  std::string text = palpa::test::read_text(path);
  for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at)) {
    for (; at < text.size() && text[at] != '\n'; ++at)
      text[at] = ' ';
  }
  std::istringstream lines(text);
  std::string line;
  std::size_t vertices = 0, faces = 0, edges = 0;
  geometry::Mesh mesh;
  if (!(lines >> line) || line.find("OFF") == std::string::npos || !(lines >> vertices >> faces >> edges)) return mesh;
  if (faces > most_faces || !std::getline(lines, line) || lines.eof()) return mesh;
  std::vector<double> numbers;  // at the beginning of a line
  const auto next = [&] {
    if (!std::getline(lines, line)) return false;
    numbers.clear();
    char* after = nullptr;
    for (const char* at = line.c_str();; at = after) {
      const double value = std::strtod(at, &after);
      if (after == at) return true;
      numbers.push_back(value);
    }
  };
  // A vertex may be followed by a colour or a normal.
  while (mesh.positions.size() < vertices && next()) {
    if (numbers.size() >= 3) mesh.positions.emplace_back(numbers[0], numbers[1], numbers[2]);
  }
  for (std::size_t f = 0; f < faces && next();) {
    if (numbers.empty()) continue;
    ++f;
    const auto corners = static_cast<std::size_t>(numbers[0]);
    numbers.resize(corners + 1);  // a missing index becomes vertex 0
    const auto corner = [&](std::size_t i) {
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(numbers[i + 1]));
    };
    for (std::size_t i = 2; i < corners; ++i)
      mesh.triangles.emplace_back(corner(0), corner(i - 1), corner(i));
  }
  for (const glm::uvec3& t : mesh.triangles) {
    if (t.x >= mesh.positions.size() || t.y >= mesh.positions.size() || t.z >= mesh.positions.size()) return {};
  }
  return mesh;
}

/// 100 mm across, around the origin, in single precision.
void normalise(geometry::Mesh& mesh) {
  const Box box = geometry::bounds(mesh);
  const Vec3 extent = box.high - box.low;
  const double scale = 0.1 / std::max({extent.x, extent.y, extent.z});
  mesh = palpa::test::rounded(
      palpa::test::transformed(std::move(mesh), [&](const Vec3& p) { return (p - box.centre()) * scale; }));
}

/// Whether every edge, by position, has as many triangles along it in one direction as in the other.
bool balanced(const geometry::Mesh& mesh) {
  std::map<std::array<double, 3>, std::uint64_t> places;
  std::vector<std::uint64_t> place;
  for (const Vec3& corner : mesh.positions) {
    const Vec3 p = corner + 0.0;
    place.push_back(places.try_emplace({p.x, p.y, p.z}, places.size()).first->second);
  }
  std::vector<std::uint64_t> forth, back;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint64_t a = place[t[i]], b = place[t[(i + 1) % 3]];
      if (a == b) continue;
      forth.push_back(a << 32U | b);
      back.push_back(b << 32U | a);
    }
  }
  std::sort(forth.begin(), forth.end());
  std::sort(back.begin(), back.end());
  return forth == back;
}

/// The words of an error that say what is wrong with the mesh; empty where it says something else.
std::string reason_of(const std::string& line) {
  for (const char* reason : {"open edge", "more than two faces", "opposite orientation", "touches itself", "is flat",
                             "flat piece", "faces the same way"}) {
    if (line.find(reason) != std::string::npos) return reason;
  }
  return {};
}

/// A number that two meshes share only if they are the same. Packages bring one mesh under several names.
std::string number_of(const geometry::Mesh& mesh) {
  palpa::test::Digest digest;
  for (const Vec3& p : mesh.positions) {
    for (int i = 0; i < 3; ++i)
      digest.add(p[i]);
  }
  for (const glm::uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      digest.add(t[i]);
  }
  return fmt::format("{:016x}", digest.value());
}

/// Number and outcome of each mesh of known_meshes.txt.
std::map<std::string, std::string> known_meshes() {
  std::ifstream file(palpa::test::source_file("tests/touch/contacts/known_meshes.txt"));
  std::map<std::string, std::string> known;
  std::string number, name, outcome;
  while (file >> number >> name && std::getline(file >> std::ws, outcome))
    known[number] = outcome;
  return known;
}

/// Points around a solid are contacts exactly where every triangle, looked at in double precision, says so.
void expect_true_contacts(const std::vector<geometry::Solid>& solids, std::uint32_t count) {
  const auto points = points_near(solids[0].mesh, count, 11);
  Touch touch;
  Stage(solids).touch(indexed(points), touch);
  std::vector<char> contact(points.size(), 0);
  for (const Contact& c : touch.contacts)
    contact[c.point] = 1;
  const Truth truth(solids[0].mesh);
  int wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double depth = truth.depth(Vec3(points[i]), i % 100 == 0);
    if (std::abs(depth) < 1e-6 || std::abs(depth - 1.5e-3) < 1e-6) continue;
    if ((contact[i] != 0) != (depth > 0 && depth < 1.5e-3) && ++wrong < 3) {
      ADD_FAILURE() << "point " << points[i].x << " " << points[i].y << " " << points[i].z << " depth " << depth;
    }
  }
  EXPECT_EQ(wrong, 0);
}

// PALPA_EXHAUSTIVE adds meshes of more than 10,000 faces, and more points per mesh. The package's meshes depend on its
// version, so each mesh is identified by its contents, and its outcome is compared with known_meshes.txt. For each mesh
// that is missing there, the test prints a line for that file.
TEST(Corpus, IsTouchedRightOrRefusedWithAReason) {
  const fs::path archive = "/usr/share/doc/libcgal-demo/data.tar.gz";
  if (!fs::exists(archive)) GTEST_SKIP() << "skipped: libcgal-demo is not installed";
  const fs::path folder = palpa::test::scratch_folder("cgal");
  const std::string line = "tar xzf " + archive.string() + " -C " + folder.string() + " --wildcards '*.off'";
  ASSERT_EQ(std::system(line.c_str()), 0);
  log::set_level(log::Level::quiet);
  const bool thorough = palpa::test::exhaustive();
  const std::size_t most_faces = thorough                      ? std::numeric_limits<std::size_t>::max()
                                 : palpa::test::instrumented() ? 2'000
                                                               : 10'000;
  const std::map<std::string, std::string> known = known_meshes();
  std::set<std::string> recognised;
  int meshes = 0, touched = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".off") continue;
    geometry::Mesh mesh = read_off(entry.path(), most_faces);
    if (mesh.triangles.empty()) continue;
    ++meshes;
    const std::string number = number_of(mesh);
    normalise(mesh);
    const bool is_closed = balanced(mesh);
    const std::string name = entry.path().stem().string();
    SCOPED_TRACE(name);
    std::string outcome = is_closed ? "closed, touched" : "open, touched";
    try {
      const std::vector<geometry::Solid> solids = geometry::make_solids({name, {{name, mesh}}});
      EXPECT_TRUE(is_closed) << "an open mesh was accepted";
      ++touched;
      expect_true_contacts(solids, palpa::test::samples(1'500, 20'000));
    } catch (const Error& error) {
      const std::string told = error.what(), reason = reason_of(told);
      EXPECT_EQ(error.code(), Exit::bad_input);
      EXPECT_EQ(told.find('\n'), std::string::npos);
      EXPECT_FALSE(reason.empty()) << told;
      outcome = (is_closed ? "closed, " : "open, ") + reason;
      if (is_closed || thorough) std::printf("  %s: %s\n", is_closed ? "closed" : "open", told.c_str());
    }
    if (const auto at = known.find(number); at != known.end()) {
      EXPECT_EQ(outcome, at->second);
      recognised.insert(number);
    } else {
      std::printf("  not known: %s %s %s\n", number.c_str(), name.c_str(), outcome.c_str());
    }
  }
  std::printf("%d meshes, %zu of them known and different, %d touched\n", meshes, recognised.size(), touched);
  // Fewer were recognised only if they were read wrongly: the packages' versions have most of their meshes in common.
  EXPECT_GE(recognised.size(), palpa::test::instrumented() ? 50u : 100u);
  EXPECT_GE(touched, thorough ? 70 : palpa::test::instrumented() ? 40 : 60);
  log::set_level(log::Level::warning);
}

}  // namespace
}  // namespace palpa::touch::test
