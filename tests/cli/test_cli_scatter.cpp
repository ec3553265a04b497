// `palpa scatter`: its tables against the sphere's series, its force, and the meshes that it rejects. Also `palpa
// drive` for foci on such a mesh, which are as loud as `scatter` then computes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <csignal>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "acoustics/bodies/sphere_series.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<double>>;
constexpr double pi = std::numbers::pi;
constexpr double radius = 5e-3;
const double wave_number = 2 * pi * 40e3 / 343;

const std::filesystem::path& folder() {
  static const std::filesystem::path folder = scratch_folder("scatter");
  return folder;
}

std::string ply_of(const std::string& name, const geometry::Mesh& mesh) {
  const std::filesystem::path file = folder() / (name + ".ply");
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file;
}

std::string sphere_file() {
  return ply_of("sphere", geometry::icosphere(radius, 5));
}

struct Scattered {
  Rows rows;
  json results;
};

Scattered scatter(const std::vector<std::string>& arguments, const std::string& head) {
  const std::string csv = folder() / "out.csv", file = folder() / "out.json";
  const Result result = palpa_here(with({"scatter", "--csv", csv, "--json", file, "--sound-speed", "343"}, arguments));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(read_text(csv).starts_with(head)) << read_text(csv).substr(0, 80);
  return {read_csv(csv), json::parse(read_text(file))};
}

TEST(Scatter, ASphereInAPlaneWaveIsTheSeries) {
  const Scattered got = scatter({"--mesh", sphere_file(), "--plane-wave", "0,0,2"}, "face,x,y,z,re,im\n");
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

TEST(Scatter, TheForceFromAfarNeedsAirWithoutSources) {
  // A long body: its middle is near to the source, its ends are not.
  geometry::Mesh mesh = geometry::icosphere(1, 8);
  for (Vec3& p : mesh.positions)
    p *= Vec3(3e-3, 3e-3, 9e-3);
  const std::string body = ply_of("long", mesh);
  const Scattered near = scatter({"--mesh", body, "--point-source", "8mm,0,0"}, "face,x,y,z,re,im\n");
  EXPECT_TRUE(near.results["force_far_N"].is_null());
  const Scattered far = scatter({"--mesh", body, "--point-source", "14mm,0,0"}, "face,x,y,z,re,im\n");
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(far.results["force_far_N"][axis].get<double>(), far.results["force_N"][axis],
                0.02 * std::abs(far.results["force_N"][0].get<double>()));
  }
}

TEST(Scatter, AnEdgyBodyThatIsTooCoarseIsWarnedOf) {
  // Half as fine as the box on which both ways to the force agree.
  const geometry::Mesh coarse = test::divided(test::box({-6e-3, -6e-3, -6e-3}, {6e-3, 6e-3, 6e-3}), 2);
  const Result result = palpa_here({"scatter", "--mesh", ply_of("coarse-box", coarse), "--plane-wave", "0.48,0.6,0.64",
                                    "--sound-speed", "343", "--force", "--json", "-"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_CONTAINS(result.err, "the force by radiation pressure");
  EXPECT_CONTAINS(result.err, "apart; a finer mesh makes both more exact");
}

TEST(Scatter, AroundTheBodyIsAirAndInsideIsNothing) {
  const Scattered got =
      scatter({"--mesh", sphere_file(), "--plane-wave", "0,0,1", "--line", "0,0,-12mm", "0,0,12mm", "--samples", "13"},
              "x,y,z,re,im\n");
  ASSERT_EQ(got.rows.size(), 13u);
  for (const std::vector<double>& row : got.rows) {
    if (std::abs(row[2]) < 4.9e-3) {
      EXPECT_TRUE(std::isnan(row[3]) && std::isnan(row[4])) << row[2];
    } else if (std::abs(row[2]) > 5.1e-3) {
      const auto exact = acoustics::sphere_in_plane_wave(wave_number, radius, {0, 0, 1}, {row[0], row[1], row[2]});
      EXPECT_LE(std::abs(std::complex(row[3], row[4]) - exact), 0.05) << row[2];
    }
  }
}

TEST(Scatter, OnTheMeshItselfIsTheSkin) {
  // Vertices lie on the body, which bulges over the faces' middles.
  const std::string mesh = ply_of("fine", geometry::icosphere(radius, 7));
  const auto series = acoustics::SphereSeries::plane_wave(wave_number, radius, {0, 0, 1});
  const geometry::Mesh at = geometry::icosphere(radius, 7);
  std::vector<Vec3> middles;
  for (const glm::uvec3& t : at.triangles)
    middles.push_back((at.positions[t.x] + at.positions[t.y]) / 2.0);
  const std::string places = folder() / "middles.ply";
  geometry::write_ply(places, middles, {});
  for (const std::string& points : {mesh, places}) {
    const Scattered got = scatter({"--mesh", mesh, "--plane-wave", "0,0,1", "--points", points}, "x,y,z,re,im\n");
    ASSERT_GT(got.rows.size(), 400u);
    for (const std::vector<double>& row : got.rows)
      EXPECT_LE(std::abs(std::complex(row[3], row[4]) - series.at({row[0], row[1], row[2]})), 0.05) << row[0];
  }
}

TEST(Scatter, AnArrayLiftsWhatIsAboveIt) {
  const std::string drive = folder() / "drive.csv";
  ASSERT_EQ(palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,100mm", "--csv", drive, "--backend", "cpu"})
                .exit_code,
            0);
  geometry::Mesh above = geometry::icosphere(radius, 5);
  for (Vec3& p : above.positions)
    p.z += 0.105;
  const std::vector<std::string> arguments{"--mesh", ply_of("above", above), "--layout", "openmpd", "--drive", drive};
  const Scattered got = scatter(arguments, "face,x,y,z,re,im\n");
  const double force = got.results["force_N"][2];
  EXPECT_GT(force, 1e-3);
  EXPECT_LE(std::abs(got.results["force_N"][0].get<double>()), 0.05 * force);
  // Air that absorbs takes some of it on the way.
  const double less = scatter(with(arguments, {"--absorption"}), "face,x,y,z,re,im\n").results["force_N"][2];
  EXPECT_LT(less, 0.99 * force);
  EXPECT_GT(less, 0.9 * force);
  expect_failure(
      palpa_here({"scatter", "--mesh", sphere_file(), "--layout", "openmpd", "--drive", drive, "--csv", "-"}), 4,
      "stands in the array");
  expect_failure(
      palpa_here({"scatter", "--mesh", arguments[1], "--layout", "sonicsurface", "--drive", drive, "--csv", "-"}), 4,
      "drive.csv");
}

TEST(Scatter, RefusesWhatIsNoBody) {
  const auto refused = [](const std::string& name, const geometry::Mesh& mesh, const std::string& why) {
    expect_failure(palpa_here({"scatter", "--mesh", ply_of(name, mesh), "--plane-wave", "0,0,1", "--csv", "-"}), 4,
                   why);
  };
  const geometry::Mesh sphere = geometry::icosphere(radius, 4);
  geometry::Mesh open = sphere, crossing = sphere, needle = sphere;
  open.triangles.pop_back();
  refused("open", open, "the mesh is open");
  geometry::Mesh other = sphere;
  for (Vec3& p : other.positions)
    p.x += radius;
  geometry::append(crossing, other);
  refused("crossing", crossing, "passes through or touches itself");
  needle.positions[0] = needle.positions[needle.triangles[0].y];
  refused("needle", needle, "needle without area");
  geometry::Mesh swapped = sphere;
  std::swap(swapped.triangles[3].x, swapped.triangles[3].y);
  refused("swapped", swapped, "opposite orientation");
  refused("points", {sphere.positions, {}}, "has no faces");
  refused("coarse", test::box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}), "too coarse");
  refused("millimetres", test::box({-10, -10, -10}, {10, 10, 10}), "see whether its vertices are in metres");
  const Result forced =
      palpa_here({"scatter", "--mesh", ply_of("coarse", box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01})), "--plane-wave",
                  "0,0,1", "--force", "--json", "-"});
  EXPECT_EQ(forced.exit_code, 0);
  EXPECT_NE(forced.err.find("coarse"), std::string::npos);
  // Turned over it is a body.
  geometry::Mesh inwards = sphere;
  geometry::flip(inwards);
  const Result turned =
      palpa_here({"scatter", "--mesh", ply_of("inwards", inwards), "--plane-wave", "0,0,1", "--json", "-"});
  EXPECT_EQ(turned.exit_code, 0);
  EXPECT_NE(turned.err.find("its faces point inwards"), std::string::npos);
  EXPECT_GT(json::parse(turned.out)["force_N"][2].get<double>(), 0);
}

TEST(Scatter, NamesTheWorstNeedle) {
  // A sphere with one of its vertices next to another.
  geometry::Mesh mesh = geometry::icosphere(radius, 6);
  const glm::uvec3 t = mesh.triangles[40];
  mesh.positions[t.x] += 0.9 * (mesh.positions[t.y] - mesh.positions[t.x]);
  const Result told = palpa({"scatter", "--mesh", ply_of("needles", mesh), "--plane-wave", "0,0,1", "--json", "-"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.err.find("2 of its 720 faces are needles, more than 10 times as long as high (face 39"),
            std::string::npos)
      << told.err;
}

TEST(Scatter, PiecesFaceOutwardsAndLieBesideEachOther) {
  const auto with_sphere = [](double size, const Vec3& at, bool flipped) {
    geometry::Mesh both = geometry::icosphere(radius, 5), other = geometry::icosphere(size, 5);
    if (flipped) geometry::flip(other);
    for (Vec3& p : other.positions)
      p += at;
    geometry::append(both, other);
    return ply_of("pieces", both);
  };
  for (const bool flipped : {false, true}) {
    expect_failure(palpa_here({"scatter", "--mesh", with_sphere(radius / 2, Vec3(0), flipped), "--plane-wave", "0,0,1",
                               "--json", "-"}),
                   4, "a piece within another");
  }
  const Vec3 beside(3 * radius, 0, 0);
  const Scattered right = scatter({"--mesh", with_sphere(radius, beside, false), "--plane-wave", "0,0,1"}, "face,");
  const Result turned = palpa_here({"scatter", "--mesh", with_sphere(radius, beside, true), "--plane-wave", "0,0,1",
                                    "--sound-speed", "343", "--json", "-"});
  EXPECT_NE(turned.err.find("1 of its 2 pieces face inwards"), std::string::npos) << turned.err;
  const double force = right.results["force_N"][2];
  EXPECT_NEAR(json::parse(turned.out)["force_N"][2].get<double>() / force, 1, 1e-3);
}

TEST(Scatter, ASourceCloseToTheMeshIsToldOrRefused) {
  // Sides of 1.2 mm or so.
  const auto from = [](const std::string& z, const std::vector<std::string>& more = {}) {
    return palpa_here(with({"scatter", "--mesh", sphere_file(), "--point-source", "0,0," + z, "--json", "-"}, more));
  };
  EXPECT_EQ(from("9mm").err, "");
  const Result near = from("6.2mm");
  EXPECT_EQ(near.exit_code, 0);
  EXPECT_NE(near.err.find("nearer than two sides, results are less exact"), std::string::npos) << near.err;
  expect_failure(from("5.3mm"), 2, "from the mesh");
  EXPECT_EQ(from("5.3mm", {"--force"}).exit_code, 0);
}

TEST(Scatter, AnArraysTransducersAreAWall) {
  const std::string drive = folder() / "drive.csv";
  ASSERT_EQ(palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,100mm", "--csv", drive, "--backend", "cpu"})
                .exit_code,
            0);
  const auto at = [&](const std::string& name, double size, const Vec3& place) {
    geometry::Mesh mesh = geometry::icosphere(size, 4);
    for (Vec3& p : mesh.positions)
      p += place;
    return palpa_here(
        {"scatter", "--mesh", ply_of(name, mesh), "--layout", "openmpd", "--drive", drive, "--json", "-"});
  };
  // A board's middle lies between four transducers: a thin body there is nearer to none than its radius.
  expect_failure(at("through", 1.5e-3, {0, 0, 0}), 4, "behind its wall");
  expect_failure(at("behind", 3e-3, {2e-3, 1e-3, -30e-3}), 4, "behind its wall");
  EXPECT_EQ(at("before", 1.5e-3, {0, 0, 3e-3}).exit_code, 0);
  EXPECT_EQ(at("beside", 3e-3, {0.15, 0, -10e-3}).exit_code, 0);
}

TEST(Scatter, LoudDrivesAreBeyondLinearAcoustics) {
  const std::string drive = folder() / "loud.csv";
  const auto told = [&](const std::string& layout) {
    EXPECT_EQ(
        palpa_here({"drive", "--layout", layout, "--focus", "0,0,50mm", "--csv", drive, "--backend", "cpu"}).exit_code,
        0);
    geometry::Mesh mesh = geometry::icosphere(radius, 4);
    for (Vec3& p : mesh.positions)
      p.z += 0.055;
    const Result result = palpa_here({"scatter", "--mesh", ply_of("loud", mesh), "--layout", layout, "--drive", drive});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out.find("linear acoustics no longer holds") != std::string::npos;
  };
  EXPECT_TRUE(told("paper"));
  EXPECT_FALSE(told("sonicsurface"));
}

TEST(Scatter, LongWorkSaysWhatItDoesAndStopsOnCtrlC) {
  PALPA_TERMINAL_OR_SKIP();
  const std::filesystem::path csv = folder() / "hand.csv";
  std::filesystem::remove(csv);
  const std::string mesh = ply_of("large", geometry::icosphere(15e-3, 22));
  Terminal terminal({"scatter", "--mesh", mesh, "--plane-wave", "0,0,1", "--csv", csv.string()});
  EXPECT_TRUE(terminal.shows("filling the matrix of the surface")) << terminal.text();
  const auto begin = std::chrono::steady_clock::now();
  terminal.type("\x03");
  EXPECT_EQ(terminal.ended_by_signal(), SIGINT) << terminal.text();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_FALSE(std::filesystem::exists(csv));
}

/// A fingertip above a board, and a point a little below the middle of one of its faces.
struct Above {
  std::string file;
  Vec3 centre;
  std::string focus;
};
Above fingertip(std::size_t face) {
  geometry::Mesh mesh = geometry::icosphere(radius, 6);
  for (Vec3& p : mesh.positions)
    p.z += 0.1;
  const glm::uvec3& t = mesh.triangles[face];
  const Vec3 centre = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
  const Vec3 below = centre + 0.3 * (Vec3(0, 0, 0.1) - centre);
  return {ply_of("above", mesh), centre, fmt::format("{},{},{}", below.x, below.y, below.z)};
}

TEST(DriveOnAFinger, IsAsLoudAsWhatScattersSays) {
  const std::vector<std::string> drive{"drive", "--layout",     "openmpd", "--sound-speed",
                                       "343",   "--constraint", "uniform"};
  for (const std::size_t face : {5u, 200u}) {
    const Above above = fingertip(face);
    const std::string csv = folder() / "drive.csv", other = folder() / "other.csv", file = folder() / "drive.json";
    const std::vector<std::string> here = with(drive, {"--focus", above.focus, "--mesh", above.file});
    const Result made = palpa(with(here, {"--transfer", "finger", "--csv", csv, "--json", file}));
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_NE(made.out.find("on the nearest skin"), std::string::npos) << made.out;
    const json results = json::parse(read_text(file));
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(results["aimed_m"][0][static_cast<std::size_t>(axis)].get<double>(), above.centre[axis], 1e-4);
    EXPECT_GE(results["over_free_field"][0], 1);
    const Scattered got = scatter({"--mesh", above.file, "--layout", "openmpd", "--drive", csv}, "face,x,y,z,re,im\n");
    const double loud = std::hypot(got.rows[face][4], got.rows[face][5]);
    EXPECT_NEAR(results["pressures_pa"][0].get<double>() / loud, 1, 5e-3);
    ASSERT_EQ(palpa_here(with(here, {"--solver", "adjoint", "--csv", other})).exit_code, 0);
    EXPECT_EQ(read_text(other), read_text(csv));
    // A pressure that is asked for is there.
    const std::vector<std::string> asked{"drive",   "--layout",  "openmpd", "--sound-speed", "343",
                                         "--focus", above.focus, "--mesh",  above.file,      "--pressure",
                                         "500Pa",   "--solver",  "adjoint", "--csv",         csv};
    ASSERT_EQ(palpa_here(asked).exit_code, 0);
    const Scattered even = scatter({"--mesh", above.file, "--layout", "openmpd", "--drive", csv}, "face,x,y,z,re,im\n");
    EXPECT_NEAR(std::hypot(even.rows[face][4], even.rows[face][5]), 500, 3);
  }
}

TEST(DriveOnAFinger, RefusesWhatHasNoFinger) {
  const Above above = fingertip(5);
  const auto refused = [](const std::vector<std::string>& arguments, int code, const std::string& why) {
    expect_failure(palpa_here(arguments), code, why);
  };
  const std::vector<std::string> drive{"drive", "--layout", "openmpd", "--focus", above.focus, "--csv", "-"};
  refused(with(drive, {"--transfer", "finger"}), 2, "--mesh is missing");
  refused(with(drive, {"--solver", "adjoint"}), 2, "--mesh is missing");
  refused(with(drive, {"--mesh", above.file}), 2, "--mesh goes with --transfer finger");
  refused(with(drive, {"--mesh", above.file, "--solver", "adjoint", "--transfer", "free"}), 2, "leave --transfer free");
  refused(with(drive, {"--mesh", "nothing.ply", "--transfer", "finger"}), 4, "nothing.ply");
  const std::string there = ply_of("there", geometry::icosphere(radius, 6));
  refused(with(drive, {"--mesh", there, "--transfer", "finger"}), 4, "stands in the array");
  const std::string unknown = "this command has no finger's mesh", none = "has no option '--transfer'";
  refused({"field", "--layout", "openmpd", "--focus", "0,0,0.1", "--plane", "xz", "--size", "1cm,1cm", "--csv", "-",
           "--transfer", "finger"},
          2, none);
  const std::string scene = source_file("assets/cube.glb");
  const std::string drives = scratch_folder("no-finger") / "drives.bin";
  refused({"export", "--scene", scene, "--frames", "1", "--drives", drives, "--solver", "adjoint"}, 2, unknown);
  refused({"touch", "--scene", scene, "--points", source_file("assets/finger.ply"), "--layout", "paper", "--transfer",
           "finger"},
          2, none);
}

TEST(Scatter, RefusesWavesThatAreNone) {
  const std::string mesh = sphere_file();
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& why) {
    expect_failure(palpa_here(with({"scatter", "--mesh", mesh, "--csv", "-"}, arguments)), 2, why);
  };
  refused({}, "nothing sounds");
  refused({"--plane-wave", "0,0,1", "--point-source", "0,0,1"}, "exclude each other");
  refused({"--plane-wave", "0,0,0"}, "is not a direction");
  refused({"--point-source", "0,0,1mm"}, "inside the mesh");
  refused({"--plane-wave", "0,0,1", "--layout", "paper"}, "go together");
  refused({"--plane-wave", "0,0,1", "--absorption"}, "lossless");
}

TEST(Scatter, WhatIsSmallerThanAMicrometreIsBadInput) {
  const geometry::Mesh octahedron = geometry::icosphere(2e-3, 1);
  geometry::Mesh two = octahedron;
  geometry::append(two, transformed(octahedron, [](const Vec3& p) { return p * 5e-16 + Vec3(3e-3, 0, 0); }));
  const geometry::Ply finger = geometry::read_ply(source_file("assets/finger.ply"));
  const geometry::Mesh dust =
      transformed({finger.positions, finger.triangles}, [](const Vec3& p) { return p * 1e-40; });
  const std::vector<std::pair<std::string, geometry::Mesh>> bodies{{"two", two}, {"dust", dust}};
  for (const auto& [name, mesh] : bodies) {
    const std::filesystem::path file = folder() / (name + ".ply");
    geometry::write_ply(file, mesh.positions, mesh.triangles, geometry::PlyFormat::ascii);
    const Result result = palpa_here({"scatter", "--mesh", file, "--plane-wave", "0,0,1"});
    expect_failure(result, 4, name + ".ply: ");
    expect_failure(result, 4, "a body measures at least a micrometre");
  }
  // The same holds wherever a mesh is a body, a solid or skin.
  const std::string file = folder() / "dust.ply", cube = source_file("assets/cube.glb");
  const std::string scene = folder() / "dust.glb";
  const geometry::SceneMesh solid{"dust", box(Vec3(0), Vec3(1e-9))};
  geometry::write_glb(scene, std::span(&solid, 1));
  const auto refused = [](const std::vector<std::string>& line, const std::string& told) {
    expect_failure(palpa_here(with(line, {"--backend", "cpu"})), 4, told);
  };
  refused({"simulate", "--scene", cube, "--finger", file}, file + ": is only ");
  refused({"drive", "--layout", "openmpd", "--focus", "0,0,0.1", "--transfer", "finger", "--mesh", file},
          file + ": is only ");
  refused({"run", "--scene", cube, "--source", "synthetic:" + file}, file + ": is only ");
  refused({"export", "--scene", cube, "--source", "synthetic:" + file, "--frames", "1", "--foci", "-"},
          "skin measures at least a micrometre");
  refused({"calibrate", "--source", "synthetic:" + file}, "skin measures at least a micrometre");
  refused({"touch", "--scene", scene, "--points", source_file("assets/finger.ply")},
          scene + ": mesh \"dust\" is only 1e-09 m across");
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
  const auto ascii = [](const std::string& name, const geometry::Mesh& mesh) {
    const std::filesystem::path file = folder() / (name + ".ply");
    geometry::write_ply(file, mesh.positions, mesh.triangles, geometry::PlyFormat::ascii);
    return file.string();
  };
  const std::string fine = ascii("fine", graded_corner(4e-3, 20)), tiny = ascii("tiny", graded_corner(4e-3, 30));
  const Result result = palpa_here({"scatter", "--mesh", fine, "--plane-wave", "0,0,1", "--json", "-"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out)["faces"], 124);
  for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
           {"scatter", "--mesh", tiny, "--plane-wave", "0,0,1"},
           {"simulate", "--scene", source_file("assets/cube.glb"), "--finger", tiny},
           {"drive", "--layout", "openmpd", "--focus", "0,0,0.1", "--transfer", "finger", "--mesh", tiny}}) {
    expect_failure(palpa_here(line), 4, tiny + ": face ");
    expect_failure(palpa_here(line), 4, "at least 1e-09 m long and a nanometre high");
  }
  // Pieces beside each other that are far from the middle of a large body.
  geometry::Mesh large = graded_corner(90, 0);
  for (const double x : {-90 - 3.5e-6, -90 + 1.5e-6}) {
    geometry::append(large, transformed(graded_corner(1.5e-6, 0), [&](const Vec3& p) { return p + Vec3(x, 0, 0); }));
  }
  expect_failure(palpa_here({"scatter", "--force", "--mesh", ascii("large", large), "--frequency", "1kHz",
                             "--plane-wave", "0,0,1"}),
                 4, "at least 1.8e-05 m long");
}

}  // namespace
}  // namespace palpa::test
