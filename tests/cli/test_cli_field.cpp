// `palpa field`: its points and its output. What it computes: tests/setup/tasks/test_field_task.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

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
  const Result result = succeeded(palpa_here(with(with({"field", "--csv", csv, "--json", file}, sound), place)));
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(read_text(csv).starts_with("x,y,z,re,im\n"));
  if (results) *results = json::parse(read_text(file));
  return read_csv(csv);
}

TEST(Field, OfAPlaneIsItsPixels) {
  json results;
  const Rows rows = field(focus, plane, &results);
  ASSERT_EQ(rows.size(), 20u);
  // Right, then up; rows from the top; samples at the pixels' centres.
  const double first[]{1e-3 - 4.5e-3, 2e-3, 0.146 + 12e-3}, second[]{1e-3 - 1.5e-3, 2e-3, 0.146 + 12e-3},
      below[]{1e-3 - 4.5e-3, 2e-3, 0.146 + 6e-3};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(rows[0][axis], first[axis], 1e-15);
    EXPECT_NEAR(rows[1][axis], second[axis], 1e-15);
    EXPECT_NEAR(rows[4][axis], below[axis], 1e-15);
  }
  std::vector<std::string> keys;
  for (const auto& [key, value] : results.items())
    keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"absorption_np_m", "amplitude", "constraint", "density_kg_m3", "peak_m",
                                            "peak_pa", "points", "solver", "sound_speed_m_s", "timing_ms"}));
  EXPECT_GT(results["timing_ms"]["total"], 0);
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
    succeeded(palpa_here(with(with({"field", "--quiet", "--vtu", arguments.back()}, focus), place)));
    all += read;
  }
  const Result result = run_program(python, arguments);
  if (result.exit_code == 77) GTEST_SKIP() << "skipped: no meshio here (Debian: python3-meshio)";
  EXPECT_EQ(result.out, all) << result.err;
}

/// The numbers of a VTU file's array: base64 of their bytes, after that of their length.
std::vector<float> vtu_array(const std::string& vtu, const std::string& name) {
  const std::size_t begin = vtu.find('\n', vtu.find("Name=\"" + name + "\"")) + 1 + 12;
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  for (std::size_t i = begin, n = 1; i < vtu.size() && digits.find(vtu[i]) != std::string::npos; ++i, ++n) {
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(vtu[i]));
    if (n % 4 != 1) bytes += static_cast<char>(bits >> (6 - 2 * ((n - 1) % 4)) & 255);
  }
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

TEST(Field, VtuHasTheNumbersOfTheCsv) {
  const std::string vtu = folder() / "spread.vtu", csv = folder() / "spread-of-vtu.csv";
  succeeded(palpa_here(with(
      with({"field", "--quiet", "--vtu", vtu, "--csv", csv, "--spread", "amplitude=20%,phase=0.2", "--draws", "40"},
           focus),
      plane)));
  const std::string text = read_text(vtu);
  const Rows rows = read_csv(csv);
  ASSERT_EQ(rows.size(), 20u);
  const auto expect = [&](const std::string& name, const auto& of_row) {
    const std::vector<float> values = vtu_array(text, name);
    ASSERT_EQ(values.size(), rows.size()) << name;
    for (std::size_t i = 0; i < rows.size(); ++i)
      EXPECT_NEAR(values[i], of_row(rows[i]), 1e-6 * std::abs(of_row(rows[i]))) << name << " at " << i;
  };
  const auto column = [](std::size_t number) { return [=](const std::vector<double>& row) { return row[number]; }; };
  expect("amplitude (Pa)", [](const std::vector<double>& row) { return std::hypot(row[3], row[4]); });
  expect("phase (rad)", [](const std::vector<double>& row) { return std::atan2(row[4], row[3]); });
  expect("real part (Pa)", column(3));
  expect("imaginary part (Pa)", column(4));
  expect("amplitude, 5 % of arrays below (Pa)", column(5));
  expect("amplitude, 95 % of arrays below (Pa)", column(7));
  for (const std::vector<double>& row : rows)
    EXPECT_LT(row[6], row[7]);
}

/// What pictures look like: tests/drawing/test_field_picture.cpp and test_line_picture.cpp.
TEST(Field, PicturesAndSpreadAreWritten) {
  const std::string png = folder() / "field.png", csv = folder() / "spread.csv";
  const auto drawn = [](const std::vector<std::string>& arguments) {
    const Result result = succeeded(palpa_here(with(with({"field", "--backend", "cpu"}, focus), arguments)));
    return result.out;
  };
  drawn(with(plane, {"--png", png}));
  EXPECT_TRUE(read_text(png).starts_with("\x89PNG"));
  EXPECT_GT(std::filesystem::file_size(png), 10000u);
  EXPECT_CONTAINS(drawn({"--line", "0,0,0.1", "0,0,0.2", "--samples", "5", "--csv", csv, "--spread",
                         "amplitude=20%,position=1mm", "--draws", "40", "--seed", "3"}),
                  "as built: the range of 90 % of 40 random arrays (seed 3)");
  EXPECT_TRUE(read_text(csv).starts_with("x,y,z,re,im,p05,p50,p95\n"));
  for (const auto& row : read_csv(csv)) {
    ASSERT_EQ(row.size(), 8u);
    EXPECT_LT(row[5], row[6]);
    EXPECT_LT(row[6], row[7]);
  }
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
    const Result result = succeeded(palpa({"field", "--layout", layout, "--focus", "0,0,0.1", "--plane", "xz", "--size",
                                           "60mm,60mm", "--pixels", pixels, "--backend", "cpu"}));
    return result.page_faults;
  };
  // How often the system had no large page to give, to any program.
  const auto refused = [] {
    std::ifstream counts("/proc/vmstat");
    long count = 0;
    for (std::string name; counts >> name >> count;) {
      if (name == "thp_fault_fallback") return count;
    }
    return 0L;
  };
  const long before = refused(), more = faults("1024,1024") - faults("16,16");
  if (more >= 5000 && refused() > before) GTEST_SKIP() << "skipped: no large page is left here";
  // A million points of 40 bytes: 10,000 small pages, or 20 large ones and what is beside them.
  EXPECT_LT(more, 5000);
}

}  // namespace
}  // namespace palpa::test
