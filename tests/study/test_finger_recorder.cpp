// The recording of a finger during a sitting is what analyses read.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "study/files/finger_file.hpp"
#include "study/files/gzip.hpp"
#include "study/sitting/finger_recorder.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::study {
namespace {

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
  EXPECT_NE(rows.find("\t0.001\t-0.002\t0.003\n"), std::string::npos);
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3 * FingerRecorder::rate_hz);
}

TEST_F(FingerRecorderTest, PacksTheSameBytesTheSameWay) {
  const std::string text(100'000, 'x');
  EXPECT_EQ(gzip_of(text), gzip_of(text));
  EXPECT_LT(gzip_of(text).size(), 1000u);
  test::write_text(folder_.path / "packed", gzip_of(text) + gzip_of("") + gzip_of("end"));
  EXPECT_EQ(read_gzip(folder_.path / "packed", 1 << 20, 1 << 20).text, text + "end");
}

}  // namespace
}  // namespace palpa::study
