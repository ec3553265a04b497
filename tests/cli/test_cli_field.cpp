// `palpa field`: its points, its output, agreement of both backends and of both ways to a drive, and its errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<double>>;

const std::filesystem::path& folder() {
  static const std::filesystem::path folder = scratch_folder("field");
  return folder;
}

const std::vector<std::string> focus{"--layout", "openmpd", "--focus", "0,0,150mm"};
const std::vector<std::string> plane{"--plane", "xz",        "--centre", "1mm,2mm,146mm",
                                     "--size",  "12mm,30mm", "--pixels", "4,5"};

Rows field(const std::vector<std::string>& sound, const std::vector<std::string>& place, json* results = nullptr) {
  const std::string csv = folder() / "field.csv", file = folder() / "field.json";
  const Result result = palpa_here(with(with({"field", "--csv", csv, "--json", file}, sound), place));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(read_text(csv).starts_with("x,y,z,re,im\n"));
  if (results) *results = json::parse(read_text(file));
  return read_csv(csv);
}

double relative_error(const Rows& got, const Rows& expected) {
  double wrong = 0, all = 0;
  EXPECT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < std::min(got.size(), expected.size()); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(got[i][axis], expected[i][axis]);
    const std::complex<double> a(got[i][3], got[i][4]), b(expected[i][3], expected[i][4]);
    wrong += std::norm(a - b);
    all += std::norm(b);
  }
  return std::sqrt(wrong / all);
}

TEST(Field, OfAPlaneIsItsPixels) {
  json results;
  const Rows gpu = field(focus, plane, &results);
  ASSERT_EQ(gpu.size(), 20u);
  // Right, then up; rows from the top; samples at the pixels' centres.
  const double first[]{1e-3 - 4.5e-3, 2e-3, 0.146 + 12e-3}, second[]{1e-3 - 1.5e-3, 2e-3, 0.146 + 12e-3},
      below[]{1e-3 - 4.5e-3, 2e-3, 0.146 + 6e-3};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(gpu[0][axis], first[axis], 1e-15);
    EXPECT_NEAR(gpu[1][axis], second[axis], 1e-15);
    EXPECT_NEAR(gpu[4][axis], below[axis], 1e-15);
  }
  EXPECT_LT(relative_error(field(with(focus, {"--backend", "cpu"}), plane), gpu), 1e-5);

  std::vector<std::string> keys;
  for (const auto& [key, value] : results.items())
    keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"absorption_np_m", "density_kg_m3", "peak_m", "peak_pa", "points",
                                            "sound_speed_m_s", "timing_ms"}));
  const auto loudest =
      std::ranges::max_element(gpu, {}, [](const std::vector<double>& row) { return std::hypot(row[3], row[4]); });
  EXPECT_EQ(results["points"], 20);
  EXPECT_NEAR(results["peak_pa"], std::hypot((*loudest)[3], (*loudest)[4]), 1e-2);
  EXPECT_EQ(results["peak_m"], (json{(*loudest)[0], (*loudest)[1], (*loudest)[2]}));
  EXPECT_NEAR(results["density_kg_m3"], 1.204, 1e-3);
  EXPECT_NEAR(results["absorption_np_m"], 0.152, 1e-3);
  EXPECT_GT(results["timing_ms"]["total"], 0);
}

TEST(Field, OfADriveFileIsThatOfItsFocus) {
  const std::string drive = folder() / "drive.csv";
  ASSERT_EQ(palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--quiet", "--csv", drive}).exit_code,
            0);
  json results;
  const Rows of_file = field({"--layout", "openmpd", "--drive", drive, "--no-absorption"}, plane, &results);
  EXPECT_EQ(results["absorption_np_m"], 0);
  EXPECT_LT(relative_error(of_file, field(with(focus, {"--no-absorption"}), plane)), 1e-5);
}

TEST(Field, OfALineHasBothEndsAndOfAFileItsOrder) {
  const Rows line = field(focus, {"--line", "-10mm,0,0.1", "10mm,20mm,0.2", "--samples", "3"});
  ASSERT_EQ(line.size(), 3u);
  EXPECT_EQ(std::vector(line[0].begin(), line[0].begin() + 3), (std::vector{-0.01, 0.0, 0.1}));
  EXPECT_EQ(std::vector(line[2].begin(), line[2].begin() + 3), (std::vector{0.01, 0.02, 0.2}));
  const std::string ply = folder() / "points.ply";
  write_text(ply,
             "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
             "end_header\n0.01 0.02 0.2\n-0.01 0 0.1\n");
  EXPECT_EQ(field(focus, {"--points", ply}), (Rows{line[2], line[0]}));
}

/// By somebody else's reader.
TEST(Field, VtuIsWhatOthersRead) {
  const std::filesystem::path python = "/usr/bin/python3";
  if (!std::filesystem::exists(python)) GTEST_SKIP() << "skipped: no Python here";
  const std::string script = folder() / "read.py";
  write_text(script,
             "import sys\n"
             "try:\n"
             "  import meshio\n"
             "except ImportError:\n"
             "  sys.exit(77)\n"
             "for file in sys.argv[1:]:\n"
             "  m = meshio.read(file)\n"
             "  a, re, im = (m.point_data[n] for n in ('amplitude (Pa)', 'real part (Pa)', 'imaginary part (Pa)'))\n"
             "  assert abs(a * a - re * re - im * im).max() <= 1e-5 * (a * a).max()\n"
             "  print(len(m.points), [(c.type, len(c.data)) for c in m.cells], repr(m.points[1][2]))\n");
  const std::string ply = folder() / "triangle.ply";
  write_text(ply,
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
             "element face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0.1\n0.01 0 0.125\n0 0.01 0.1\n3 0 1 2\n");
  const struct {
    std::vector<std::string> place;
    std::string read;
  } places[]{{plane, "20 [('quad', 12)] 0.158\n"},
             {{"--line", "0,0,0", "0,0,1", "--samples", "5"}, "5 [('line', 4)] 0.25\n"},
             {{"--points", ply}, "3 [('triangle', 1)] 0.125\n"}};
  std::vector<std::string> arguments{script};
  std::string all;
  for (const auto& [place, read] : places) {
    arguments.push_back(folder() / ("field" + std::to_string(arguments.size()) + ".vtu"));
    const Result written = palpa_here(with(with({"field", "--quiet", "--vtu", arguments.back()}, focus), place));
    ASSERT_EQ(written.exit_code, 0) << written.err;
    all += read;
  }
  const Result result = run_program(python, arguments);
  if (result.exit_code == 77) GTEST_SKIP() << "skipped: no meshio here (Debian: python3-meshio)";
  EXPECT_EQ(result.out, all) << result.err;
}

/// What it looks like: tests/drawing/test_field_picture.cpp.
TEST(Field, PngIsAPictureOfAPlane) {
  const std::string png = folder() / "field.png";
  const Result result = palpa(with(with({"field", "--png", png, "--json", "-"}, focus), plane));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(read_text(png).starts_with("\x89PNG"));
  EXPECT_GT(std::filesystem::file_size(png), 10000u);
  expect_failure(palpa_here(with(with({"field", "--png", png}, focus), {"--points", "points.ply"})), 2,
                 "--png draws a plane or a line");
}

/// What it looks like: tests/drawing/test_line_picture.cpp.
TEST(Field, PngIsAPictureOfALine) {
  const std::string png = folder() / "line.png", banded = folder() / "banded.png";
  const auto line = with(focus, {"--line", "0,0,0.1", "0,0,0.2", "--backend", "cpu"});
  ASSERT_EQ(palpa_here(with({"field", "--png", png}, line)).exit_code, 0);
  ASSERT_EQ(palpa_here(with({"field", "--png", banded, "--spread", "phase=0.5", "--draws", "20"}, line)).exit_code, 0);
  EXPECT_TRUE(read_text(png).starts_with("\x89PNG"));
  EXPECT_NE(read_text(png), read_text(banded));
}

TEST(Field, SpreadAddsColumnsAndWords) {
  const std::string csv = folder() / "spread.csv";
  const Result result = palpa_here(
      with(with({"field"}, focus), {"--line", "0,0,0.1", "0,0,0.2", "--samples", "5", "--backend", "cpu", "--spread",
                                    "amplitude=20%,position=1mm", "--draws", "40", "--seed", "3", "--csv", csv}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("as built: the range of 90 % of 40 random arrays (seed 3)"), std::string::npos)
      << result.out;
  EXPECT_TRUE(read_text(csv).starts_with("x,y,z,re,im,p05,p50,p95\n"));
  for (const auto& row : read_csv(csv)) {
    ASSERT_EQ(row.size(), 8u);
    EXPECT_LT(row[5], row[6]);
    EXPECT_LT(row[6], row[7]);
  }
}

TEST(Field, SaysWhatIsWrong) {
  const std::string other = folder() / "other.csv", bad = folder() / "bad.csv";
  ASSERT_EQ(palpa_here({"drive", "--layout", "autd3", "--focus", "0,0,150mm", "--quiet", "--csv", other}).exit_code, 0);
  std::string text = read_text(other);
  text.replace(text.rfind(','), 1, ",x");
  write_text(bad, text);
  const struct {
    std::vector<std::string> arguments;
    int code;
    std::string part;
  } wrong[]{
      {with({"--focus", "0,0,0.15"}, plane), 2, "--layout is missing"},
      {with({"--layout", "autd3"}, plane), 2, "nothing sounds: give --drive FILE.csv, or --focus"},
      {with(with(focus, {"--drive", other}), plane), 2, "exclude each other"},
      {with({"--layout", "autd3", "--drive", other, "--solver", "greedy"}, plane), 2, "exclude each other"},
      {with({"--layout", "autd3", "--drive", other, "--null", "0,2cm,0.15"}, plane), 2, "exclude each other"},
      {focus, 2, "no place to look at: give --plane"},
      {with(focus, {"--plane", "xy"}), 2, "--plane has no extent: give --size"},
      {with(focus, {"--plane", "xy", "--size", "0,10mm"}), 2, "--size: '0,10mm' is not W,H"},
      {with(focus, {"--plane", "xy", "--size", "10mm,10mm", "--pixels", "0,5"}), 2, "--pixels: '0,5'"},
      {with(focus, {"--plane", "xy", "--size", "10mm,10mm", "--samples", "5"}), 2, "--samples goes with --line"},
      {with(focus, {"--line", "0,0,0.1", "0,0,0.1"}), 2, "both ends are the same point"},
      {with(focus, {"--line", "0,0,0.1"}), 2, "--line"},
      {with(focus, {"--line", "0,0,0.1", "0,0,200"}), 2, "farther than 100 m"},
      {with(focus, {"--plane", "xy", "--size", "1,1", "--pixels", "65536,65536"}), 1,
       "a field of 4294967296 points needs 687.2 GB of memory"},
      {with(with(focus, plane), {"--humidity", "130"}), 2, "--humidity: '130' is out of range"},
      {with({"--layout", "openmpd", "--drive", other}, plane), 4, "the drive belongs to another layout than openmpd"},
      {with({"--layout", "openmpd-pair", "--drive", other}, plane), 4, "transducer 0 is at"},
      {with({"--layout", "autd3", "--drive", bad}, plane), 4, "line 250"},
      {with({"--layout", "autd3", "--drive", "no.csv"}, plane), 4, "no.csv"},
  };
  for (const auto& [arguments, code, part] : wrong)
    expect_failure(palpa_here(with({"field"}, arguments)), code, part);
}

// The system takes back small pages so slowly that a field of gigabytes ended seconds after Ctrl-C.
TEST(Field, ALargeOneIsInLargePages) {
  if (instrumented()) GTEST_SKIP() << "skipped: a sanitizer changes the use of memory";
  std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
  const std::string enabled{std::istreambuf_iterator<char>(file), {}};
  if (enabled.empty() || enabled.find("[never]") != std::string::npos) GTEST_SKIP() << "skipped: no large pages here";
  // With one transducer, only the points take memory.
  const std::string layout = folder() / "one.toml";
  write_text(layout, "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n");
  const auto faults = [&](const std::string& pixels) {
    const Result result = palpa({"field", "--layout", layout, "--focus", "0,0,0.1", "--plane", "xz", "--size",
                                 "60mm,60mm", "--pixels", pixels, "--backend", "cpu"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.page_faults;
  };
  // A million points of 40 bytes: 10,000 small pages, or 20 large ones and what is beside them.
  EXPECT_LT(faults("1024,1024") - faults("16,16"), 5000);
}

TEST(Field, LongWorkSaysWhatItDoesAndStopsOnCtrlC) {
  PALPA_TERMINAL_OR_SKIP();
  const std::filesystem::path out = folder() / "out-of-ctrl-c";
  for (const char* const backend : {"gpu", "cpu"}) {
    std::filesystem::remove_all(out);
    std::filesystem::create_directories(out);
    Terminal terminal({"field",       "--layout", "paper",       "--focus",  "0,0,0",       "--plane",
                       "xy",          "--size",   "60mm,60mm",   "--pixels", "1500,1500",   "--backend",
                       backend,       "--csv",    out / "a.csv", "--vtu",    out / "a.vtu", "--png",
                       out / "a.png", "--json",   out / "a.json"});
    EXPECT_TRUE(terminal.shows("summing the sound of transducers")) << terminal.text();
    terminal.type("\x03");
    EXPECT_EQ(terminal.ended_by_signal(), SIGINT) << terminal.text();
    EXPECT_LT(terminal.processor_s_to_end(), slowest) << backend;
    EXPECT_TRUE(std::filesystem::is_empty(out)) << backend;
  }
}

}  // namespace
}  // namespace palpa::test
