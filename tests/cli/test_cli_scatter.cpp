// `palpa scatter`: its tables against the sphere's series, its force, and the meshes that it rejects. Also `palpa
// drive` for foci on such a mesh, which are as loud as `scatter` then computes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "acoustics/bodies/sphere_series.hpp"
#include "cli/support/drive_here.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/told.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/boards.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<double>>;
using geometry::icosphere;
constexpr double pi = std::numbers::pi;
constexpr double radius = 5e-3;
const double wave_number = 2 * pi * 40e3 / 343;
const std::vector<std::string> upwards{"--plane-wave", "0,0,1"};

const std::filesystem::path& folder() {
  static const std::filesystem::path folder = scratch_folder("scatter");
  return folder;
}

std::string ply_of(const std::string& name, const geometry::Mesh& mesh) {
  const std::filesystem::path file = folder() / (name + ".ply");
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file;
}

/// As text, with all digits.
std::string ascii_ply_of(const std::string& name, const geometry::Mesh& mesh) {
  const std::filesystem::path file = folder() / (name + ".ply");
  geometry::write_ply(file, mesh.positions, mesh.triangles, geometry::PlyFormat::ascii);
  return file;
}

geometry::Mesh moved(const geometry::Mesh& mesh, const Vec3& by) {
  return transformed(mesh, [&](const Vec3& p) { return p + by; });
}

std::vector<std::string> scatter_line(const std::string& mesh, const std::vector<std::string>& sound) {
  return with({"scatter", "--mesh", mesh, "--sound-speed", "343"}, sound);
}

struct Scattered {
  Rows rows;
  json results;
  std::string told, err;
};

Scattered scatter(const std::string& mesh, const std::vector<std::string>& sound) {
  const std::string csv = folder() / "out.csv", file = folder() / "out.json";
  const Result result = succeeded(palpa_here(with(scatter_line(mesh, sound), {"--csv", csv, "--json", file})));
  EXPECT_TRUE(read_text(csv).starts_with("face,x,y,z,re,im\n")) << read_text(csv).substr(0, 80);
  return {read_csv(csv), json::parse(read_text(file)), result.out, result.err};
}

/// The file of an array's drive to a focus.
std::string drive_to(const std::string& layout, const std::string& focus) {
  const std::string file = folder() / (layout + ".csv");
  write_text(file, drive_here({"--layout", layout, "--amplitude", "distance", "--focus", focus}).table);
  return file;
}

/// The sound of openmpd.
const std::vector<std::string>& openmpd() {
  static const std::vector<std::string> sound{"--layout", "openmpd", "--drive", drive_to("openmpd", "0,0,100mm")};
  return sound;
}

TEST(Scatter, ASphereInAPlaneWaveIsTheSeries) {
  const Scattered got = scatter(ply_of("sphere", icosphere(radius, 5)), {"--plane-wave", "0,0,2"});
  EXPECT_EQ(got.err, "");
  ASSERT_EQ(got.rows.size(), 500u);
  const auto series = acoustics::SphereSeries::plane_wave(wave_number, radius, {0, 0, 1});
  double wrong = 0, all = 0;
  for (std::size_t face = 0; face < got.rows.size(); ++face) {
    const std::vector<double>& row = got.rows[face];
    ASSERT_EQ(row[0], static_cast<double>(face));
    const std::complex<double> exact = series.at({row[1], row[2], row[3]});
    wrong += std::norm(std::complex(row[4], row[5]) - exact);
    all += std::norm(exact);
  }
  EXPECT_LE(std::sqrt(wrong / all), 0.01);
  EXPECT_EQ(got.results["faces"], 500);
  const double density = got.results["density_kg_m3"];
  EXPECT_NEAR(density, 1.2041, 1e-4);
  const double unit = pi * radius * radius / (2 * density * 343 * 343);
  const double ka = wave_number * radius;
  for (const char* force : {"force_N", "force_far_N"}) {
    EXPECT_NEAR(got.results[force][2].get<double>() / unit, acoustics::sphere_force_function(ka), 0.01) << force;
    for (int axis = 0; axis < 2; ++axis)
      EXPECT_NEAR(got.results[force][axis].get<double>() / unit, 0, 0.002) << force;
  }
  EXPECT_EQ(got.results["torque_Nm"].size(), 3u);
}

TEST(Scatter, AnArrayLiftsWhatIsAboveIt) {
  const std::string above = ply_of("above", moved(icosphere(radius, 5), {0, 0, 0.105}));
  const json results = scatter(above, openmpd()).results;
  const double force = results["force_N"][2];
  EXPECT_GT(force, 1e-3);
  EXPECT_LE(std::abs(results["force_N"][0].get<double>()), 0.05 * force);
  // Air that absorbs takes some of it on the way.
  const double less = scatter(above, with(openmpd(), {"--absorption"})).results["force_N"][2];
  EXPECT_LT(less, 0.99 * force);
  EXPECT_GT(less, 0.9 * force);
  // What is beside the board or close before it is not behind its wall.
  for (const geometry::Mesh& mesh :
       {moved(icosphere(1.5e-3, 4), {0, 0, 3e-3}), moved(icosphere(3e-3, 4), {0.15, 0, -10e-3})})
    EXPECT_EQ(scatter(ply_of("before", mesh), openmpd()).rows.size(), 320u);
}

TEST(Scatter, LoudDrivesAreBeyondLinearAcoustics) {
  for (const std::string& layout : {std::string("paper"), on_off_board()}) {
    const std::string told = scatter(ply_of("loud", moved(icosphere(radius, 4), {0, 0, 0.055})),
                                     {"--layout", layout, "--drive", drive_to(layout, "0,0,50mm")})
                                 .told;
    EXPECT_EQ(told.find("linear acoustics no longer holds") != std::string::npos, layout == "paper") << told;
  }
}

TEST(Scatter, WhatMakesResultsLessExactIsToldAndTurnedFacesAreMended) {
  const std::string sphere = ply_of("sphere", icosphere(radius, 5));
  geometry::Mesh inwards = icosphere(radius, 4), needles = icosphere(radius, 6), pieces = icosphere(radius, 5),
                 turned = pieces;
  geometry::flip(inwards);
  // A sphere with one of its vertices next to another.
  const glm::uvec3 t = needles.triangles[40];
  needles.positions[t.x] += 0.9 * (needles.positions[t.y] - needles.positions[t.x]);
  geometry::Mesh beside = moved(pieces, {3 * radius, 0, 0});
  geometry::append(pieces, beside);
  geometry::flip(beside);
  geometry::append(turned, beside);
  const std::string coarse = ply_of("coarse", box(Vec3(-0.01), Vec3(0.01)));
  const std::vector<std::string> close{"--point-source", "0,0,6.2mm"}, closer{"--point-source", "0,0,5.3mm", "--force"};
  const struct {
    std::string mesh;
    std::vector<std::string> sound;
    std::string told;
  } warned[]{// Half as fine as the box on which both ways to the force agree.
             {ply_of("edgy", divided(box(Vec3(-6e-3), Vec3(6e-3)), 2)),
              {"--plane-wave", "0.48,0.6,0.64", "--force"},
              "apart; a finer mesh makes both more exact"},
             {coarse, with(upwards, {"--force"}), "coarse: its faces' sides are"},
             {ply_of("inwards", inwards), upwards, "its faces point inwards"},
             {ply_of("needles", needles), upwards,
              "2 of its 720 faces are needles, more than 10 times as long as high (face 39"},
             {ply_of("turned", turned), upwards, "1 of its 2 pieces face inwards"},
             {sphere, close, "nearer than two sides, results are less exact"},
             {sphere, closer, "nearer than two sides, results are less exact"}};
  for (const auto& [mesh, sound, told] : warned)
    EXPECT_CONTAINS(scatter(mesh, sound).err, told);
  EXPECT_EQ(scatter(sphere, {"--point-source", "0,0,9mm"}).err, "");
  const auto lifts = [](const std::string& file) { return scatter(file, upwards).results["force_N"][2].get<double>(); };
  EXPECT_GT(lifts(folder() / "inwards.ply"), 0);
  EXPECT_NEAR(lifts(folder() / "turned.ply") / lifts(ply_of("pieces", pieces)), 1, 1e-3);
}

TEST(Scatter, WhatIsNoBodyOrNoSoundIsRefused) {
  const geometry::Mesh sphere = icosphere(radius, 4);
  geometry::Mesh open = sphere, crossing = sphere, needle = sphere, swapped = sphere;
  open.triangles.pop_back();
  geometry::append(crossing, moved(sphere, {radius, 0, 0}));
  needle.positions[0] = needle.positions[needle.triangles[0].y];
  std::swap(swapped.triangles[3].x, swapped.triangles[3].y);
  geometry::Mesh within = icosphere(radius, 5), hollow = within, inner = icosphere(radius / 2, 5);
  geometry::append(within, inner);
  geometry::flip(inner);
  geometry::append(hollow, inner);
  const std::string good = ply_of("sphere", icosphere(radius, 5)),
                    above = ply_of("above", moved(sphere, {0, 0, 0.105}));
  const std::vector<std::string> other{"--layout", on_off_board(), "--drive", openmpd().back()};
  const auto shone = [&](const char* name, const geometry::Mesh& mesh) { return with({ply_of(name, mesh)}, upwards); };
  expect_refused(
      {"scatter", "--sound-speed", "343", "--csv", "-", "--mesh"},
      {{shone("open", open), "the mesh is open", 4},
       {shone("crossing", crossing), "passes through or touches itself", 4},
       {shone("needle", needle), "needle without area", 4},
       {shone("swapped", swapped), "opposite orientation", 4},
       {shone("points", {sphere.positions, {}}), "has no faces", 4},
       {shone("coarse", box(Vec3(-0.01), Vec3(0.01))), "too coarse", 4},
       {shone("millimetres", box(Vec3(-10), Vec3(10))), "see whether its vertices are in metres", 4},
       {shone("within", within), "a piece within another", 4},
       {shone("hollow", hollow), "a piece within another", 4},
       {{good}, "nothing sounds"},
       {with({good, "--point-source", "0,0,1"}, upwards), "exclude each other"},
       {{good, "--plane-wave", "0,0,0"}, "is not a direction"},
       {{good, "--point-source", "0,0,1mm"}, "inside the mesh"},
       {{good, "--point-source", "0,0,5.3mm"}, "from the mesh"},
       {with({good, "--absorption"}, upwards), "lossless"},
       {with({good}, openmpd()), "stands in the array", 4},
       // A board's middle lies between four transducers: a thin body there is nearer to none than its radius.
       {with({ply_of("through", icosphere(1.5e-3, 4))}, openmpd()), "behind its wall", 4},
       {with({ply_of("behind", moved(icosphere(3e-3, 4), {2e-3, 1e-3, -30e-3}))}, openmpd()), "behind its wall", 4},
       {with({above}, other), "openmpd.csv", 4}});
}

TEST(Scatter, WhatIsSmallerThanAMicrometreIsBadInputWhereverAMeshIsABodyASolidOrSkin) {
  const geometry::Mesh octahedron = icosphere(2e-3, 1);
  geometry::Mesh two = octahedron;
  geometry::append(two, transformed(octahedron, [](const Vec3& p) { return p * 5e-16 + Vec3(3e-3, 0, 0); }));
  const std::string finger = source_file("assets/finger.ply"), cube = source_file("assets/cube.glb"),
                    scene = folder() / "dust.glb", pieces = ascii_ply_of("two", two);
  const geometry::Ply ply = geometry::read_ply(finger);
  const std::string file =
      ascii_ply_of("dust", transformed({ply.positions, ply.triangles}, [](const Vec3& p) { return p * 1e-40; }));
  const geometry::SceneMesh solid{"dust", box(Vec3(0), Vec3(1e-9))};
  geometry::write_glb(scene, std::span(&solid, 1));
  const std::string body = "a body measures at least a micrometre", skin = "skin measures at least a micrometre";
  const std::pair<std::vector<std::string>, std::string> wrong[]{
      {scatter_line(pieces, upwards), "two.ply: has a piece that is only "},
      {scatter_line(pieces, upwards), body},
      {scatter_line(file, upwards), file + ": is only "},
      {scatter_line(file, upwards), body},
      {{"simulate", "--scene", cube, "--finger", file}, file + ": is only "},
      {{"drive", "--layout", "openmpd", "--focus", "0,0,0.1", "--transfer", "finger", "--mesh", file},
       file + ": is only "},
      {{"run", "--scene", cube, "--source", "synthetic:" + file}, file + ": is only "},
      {{"export", "--scene", cube, "--source", "synthetic:" + file, "--frames", "1", "--foci", "-"}, skin},
      {{"calibrate", "--source", "synthetic:" + file}, skin},
      {{"touch", "--scene", scene, "--points", finger}, scene + ": mesh \"dust\" is only 1e-09 m across"}};
  for (const auto& [line, part] : wrong)
    expect_failure(palpa_here(with(line, {"--backend", "cpu"})), 4, part);
}

/// The corner of a cube of this size. Its sides are halved towards the corner, this many times.
geometry::Mesh graded_corner(double size, int halvings) {
  geometry::Mesh mesh;
  for (int i = 0; i <= halvings; ++i) {
    const double side = std::ldexp(size, -i);
    for (const Vec3& p : {Vec3(side, 0, 0), Vec3(0, side, 0), Vec3(0, 0, side)})
      mesh.positions.push_back(p);
  }
  mesh.positions.emplace_back(0, 0, 0);
  const auto tip = static_cast<unsigned>(mesh.positions.size() - 1), last = tip - 3;
  mesh.triangles = {{0, 1, 2}, {tip, last + 1, last}, {tip, last, last + 2}, {tip, last + 2, last + 1}};
  for (unsigned at = 0; at < last; at += 3) {
    for (const auto& [p, q] : {std::pair(1u, 0u), std::pair(0u, 2u), std::pair(2u, 1u)}) {
      mesh.triangles.emplace_back(at + p, at + q, at + p + 3);
      mesh.triangles.emplace_back(at + q, at + q + 3, at + p + 3);
    }
  }
  return mesh;
}

TEST(Scatter, FacesTooSmallForSinglePrecisionAreBadInput) {
  EXPECT_EQ(scatter(ascii_ply_of("graded", graded_corner(4e-3, 20)), upwards).results["faces"], 124);
  const std::string tiny = ascii_ply_of("tiny", graded_corner(4e-3, 30));
  for (const std::string& part : {tiny + ": face ", std::string("at least 1e-09 m long and a nanometre high")})
    expect_failure(palpa_here(scatter_line(tiny, upwards)), 4, part);
  // Pieces beside each other that are far from the middle of a large body.
  geometry::Mesh large = graded_corner(90, 0);
  for (const double x : {-90 - 3.5e-6, -90 + 1.5e-6})
    geometry::append(large, moved(graded_corner(1.5e-6, 0), {x, 0, 0}));
  expect_failure(palpa_here({"scatter", "--force", "--mesh", ascii_ply_of("large", large), "--frequency", "1kHz",
                             "--plane-wave", "0,0,1"}),
                 4, "at least 1.8e-05 m long");
}

TEST(DriveOnAFinger, IsAsLoudAsWhatScattersSays) {
  const geometry::Mesh mesh = moved(icosphere(radius, 6), {0, 0, 0.1});
  const std::string file = ply_of("fingertip", mesh), csv = folder() / "on-finger.csv";
  for (const std::size_t face : {5u, 200u}) {
    // The focus lies a little below the middle of the face.
    const glm::uvec3& t = mesh.triangles[face];
    const Vec3 centre = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
    const Vec3 below = centre + 0.3 * (Vec3(0, 0, 0.1) - centre);
    const std::vector<std::string> drive{"--layout",      "openmpd",
                                         "--sound-speed", "343",
                                         "--constraint",  "uniform",
                                         "--mesh",        file,
                                         "--focus",       fmt::format("{},{},{}", below.x, below.y, below.z)};
    const Driven driven = drive_here(with(drive, {"--transfer", "finger"}));
    EXPECT_CONTAINS(driven.told, "on the nearest skin");
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(driven.report["aimed_m"][0][static_cast<std::size_t>(axis)].get<double>(), centre[axis], 1e-4);
    EXPECT_GE(driven.report["over_free_field"][0], 1);
    EXPECT_EQ(drive_here(with(drive, {"--solver", "adjoint"})).table, driven.table);
    write_text(csv, driven.table);
    const std::vector<double> row = scatter(file, {"--layout", "openmpd", "--drive", csv}).rows.at(face);
    EXPECT_NEAR(driven.report["pressures_pa"][0].get<double>() / std::hypot(row[4], row[5]), 1, 5e-3);
  }
}

}  // namespace
}  // namespace palpa::test
