// Recordings of the finger beside logs, and what a sitting records.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "study/files/finger_file.hpp"
#include "study/files/gzip.hpp"
#include "study/files/study_folder.hpp"
#include "study/sitting/finger_recorder.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

std::string packed(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string out(text.size() + 1000, '\0'), in = text;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

class FingerRecording : public testing::Test {
 protected:
  const std::filesystem::path folder_ = test::scratch_folder("finger");
  const std::filesystem::path file_ = folder_ / "sub-1_recording-finger_physio.tsv.gz";
  const std::string sidecar_ = R"({"SamplingFrequency": 50, "StartTime": 5, "Columns": ["x", "depth"]})";

  void write(const std::string& bytes, const std::string& sidecar) const {
    test::write_text(file_, bytes);
    test::write_text(folder_ / "sub-1_recording-finger_physio.json", sidecar);
  }
  /// 20 s from 5 s on; the depth in millimetres is the time on the clock of the log.
  static std::string rows() {
    std::string text;
    for (int i = 0; i < 1000; ++i)
      text += "0.1\t" + (i % 50 == 49 ? "n/a" : std::to_string(1e-3 * (5 + i / 50.0))) + "\n";
    return text;
  }
};

TEST_F(FingerRecording, GivesTheDepthInEachTrial) {
  write(packed(rows()), sidecar_);
  const std::vector<TrialTime> trials{{6, 2}, {10, 10}, {12, 3}, {100, 10}};
  const FingerFile file = read_finger(file_, trials);
  ASSERT_EQ(file.courses.size(), 4u);
  EXPECT_FALSE(file.fault);
  const DepthCourse& first = file.courses[0];
  ASSERT_EQ(first.samples.size(), 8u) << "2 s";
  for (std::size_t bin = 0; bin < 8; ++bin) {
    ASSERT_GT(first.samples[bin], 0u);
    EXPECT_NEAR(first.sum_m[bin] / first.samples[bin], 1e-3 * (6.125 + 0.25 * bin), 1e-4) << bin;
  }
  EXPECT_EQ(file.courses[1].samples.size(), 8u) << "it ends where the next trial begins";
  EXPECT_TRUE(file.courses[3].empty()) << "the recording has ended";
}

/// Two logs of a participant, with rows that are no trial, that are broken off and that are left out.
TEST_F(FingerRecording, HasTheDepthsOfItsOwnLogsTrials) {
  const auto write_run = [&](int run, const std::string& log) {
    const std::filesystem::path events = test::events_place(folder_, 1, run);
    test::write_events(events, test::events_header + log);
    std::string text;
    for (int i = 0; i < 700; ++i)
      text += fmt::format("0.1\t{}\n", 1e-3 * run + 1e-4 * (i / 100));  // another depth in each 10 s
    const std::string stem = fmt::format("sub-1_task-shapes_run-{}_recording-finger_physio", run);
    test::write_text(events.parent_path() / (stem + ".tsv.gz"), packed(text));
    test::write_text(events.parent_path() / (stem + ".json"),
                     R"({"SamplingFrequency": 10, "StartTime": 0, "Columns": ["x", "depth"]})");
  };
  write_run(1,
            "10\t9\tpractice\ta\tcube\tcube\t1\tanswered\n"
            "20\t9\ttrial\ta\tcube\tcube\t1\tanswered\n"
            "30\t9\ttrial\ta\tsemi-sphere\tn/a\tn/a\tvoid\n"
            "40\t9\ttrial\tb\tpyramid\tcone\t1\tanswered\n"
            "50\t9\ttrial\tb\tprism\tcube\t1\tanswered\n");
  write_run(2,
            "10\t9\ttrial\ta\tpyramid\tpyramid\t1\tanswered\n"
            "20\t9\ttrial\tb\tcube\tcube\t1\tanswered\n");
  const Study study = read_study(std::vector<std::string>{folder_.string()});
  ASSERT_EQ(study.shapes, test::study_shapes);
  std::map<std::pair<std::string, std::string>, double> found;
  const std::vector<DepthCourse>& depths = study.participants.at(0).depths;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (depths[i].empty()) continue;
    EXPECT_EQ(depths[i].samples.size(), 36u) << "9 s";
    EXPECT_NEAR(depths[i].sum_m[1] / depths[i].samples[1], depths[i].sum_m[30] / depths[i].samples[30], 1e-9);
    found[{study.methods[i / 4], study.shapes[i % 4]}] =
        std::round(1e5 * depths[i].sum_m[2] / depths[i].samples[2]) / 100;
  }
  EXPECT_EQ(found, (decltype(found){
                       {{"a", "cube"}, 1.2}, {{"a", "pyramid"}, 2.1}, {{"b", "cube"}, 2.2}, {{"b", "prism"}, 1.5}}));
}

TEST_F(FingerRecording, ThatIsCutIsReadUpToThere) {
  const std::string whole = packed(rows());
  write(whole.substr(0, whole.size() / 2), sidecar_);
  const FingerFile file = read_finger(file_, std::vector<TrialTime>{{6, 2}, {20, 4}});
  ASSERT_TRUE(file.fault);
  EXPECT_CONTAINS(*file.fault, "is cut off; depths are read up to");
  EXPECT_TRUE(file.courses[1].empty());
}

TEST_F(FingerRecording, OfAnotherKindIsRefused) {
  const std::vector<TrialTime> trials{{6, 2}};
  const auto refused = [&](const std::string& bytes, const std::string& sidecar, const std::string& told) {
    write(bytes, sidecar);
    EXPECT_REFUSED(read_finger(file_, trials), told);
  };
  refused("not packed", sidecar_, "is not a gzip file");
  std::string damaged = packed(rows());
  for (std::size_t i = 30; i < damaged.size(); i += 7)
    damaged[i] = static_cast<char>(damaged[i] + 1);
  refused(damaged, sidecar_, "damaged");
  refused(packed(rows()), R"({"SamplingFrequency": 50, "StartTime": 5, "Columns": ["x", "y"]})", "has no \"depth\"");
  refused(packed(rows()), R"({"SamplingFrequency": 0, "StartTime": 5, "Columns": ["depth"]})", "SamplingFrequency");
  refused(packed(rows()), R"({"StartTime": 5, "Columns": ["x", "depth"]})", "\"SamplingFrequency\" is missing");
  refused(packed(rows()), R"({"SamplingFrequency": 50, "StartTime": 5, "Columns": ["depth"]})",
          "2 cells where 1 column is named");
  std::string odd;
  for (int i = 0; i < 200; ++i)
    odd += "0\t12\n";
  refused(packed(odd), sidecar_, "'12' is not a depth in metres");
}

TEST(Gzip, RefusesMoreThanIsAllowed) {
  const auto file = test::scratch_folder("gzip") / "zeros.gz";
  test::write_text(file, packed(std::string(3'000'000, '0')));
  EXPECT_REFUSED(read_gzip(file, 1 << 20, 1 << 20), "has more than 1048576 bytes unpacked");
  EXPECT_EQ(read_gzip(file, 1 << 20, 3'000'000).text.size(), 3'000'000u);
  EXPECT_REFUSED(read_gzip(file, 100, 1 << 20), "at most 100 are expected");
  EXPECT_EQ(crc32_of("123456789"), 0xcbf43926u);
}

class FingerRecorderTest : public testing::Test {
 protected:
  FingerRecorderTest() { make_folders(folder_); }
  std::filesystem::path file() const { return folder_.file(1, "_recording-finger_physio.tsv.gz"); }

  const ParticipantFolder folder_ = participant_folder(test::scratch_folder("finger-recorder"), 1);
};

TEST_F(FingerRecorderTest, IsReadBack) {
  {
    FingerRecorder recorder(folder_, 1);
    // The finger sinks by 1 mm in 0.1 s, from 1 s on. It is written in two pieces.
    for (int i = 0; i <= 100; ++i) {
      const double time_s = 1 + 0.01 * i;
      recorder.add(time_s, FingerSample{0.01 * (time_s - 1), {0.001, -0.002, 0.003}});
      if (i == 50) recorder.flush(time_s);
    }
    recorder.flush(3);
  }
  const std::vector<TrialTime> trials{{0, 1}, {1, 1}, {2.5, 0.5}};
  const FingerFile read = read_finger(file(), trials);
  ASSERT_EQ(read.courses.size(), 3u);
  EXPECT_FALSE(read.fault);
  EXPECT_TRUE(read.courses[0].empty()) << "before the first sample";
  EXPECT_TRUE(read.courses[2].empty()) << "a sample is not repeated for long";
  const DepthCourse& course = read.courses[1];
  ASSERT_EQ(course.samples.size(), 4u);
  for (std::size_t bin = 0; bin < 4; ++bin) {
    ASSERT_GT(course.samples[bin], 0u);
    const double middle_s = (static_cast<double>(bin) + 0.5) * DepthCourse::bin_s;
    EXPECT_NEAR(course.sum_m[bin] / course.samples[bin], 0.01 * middle_s, 1.5e-3) << bin;
  }
  const std::string rows = read_gzip(file(), 1 << 20, 1 << 20).text;
  EXPECT_CONTAINS(rows, "\t0.001\t-0.002\t0.003\n");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3 * FingerRecorder::rate_hz);
}

TEST_F(FingerRecorderTest, PacksTheSameBytesTheSameWay) {
  const std::string text(100'000, 'x');
  EXPECT_EQ(gzip_of(text), gzip_of(text));
  EXPECT_LT(gzip_of(text).size(), 1000u);
  test::write_text(folder_.path / "filled", gzip_of(text) + std::string(512, '\0'));
  EXPECT_EQ(read_gzip(folder_.path / "filled", 1 << 20, 1 << 20).text, text) << "zeros after its end";
  test::write_text(folder_.path / "packed", gzip_of(text) + gzip_of("") + gzip_of("end"));
  EXPECT_EQ(read_gzip(folder_.path / "packed", 1 << 20, 1 << 20).text, text + "end");
}

}  // namespace
}  // namespace palpa::study
