// Logs of participants: good ones, damaged ones, and those of others.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "study/files/events_file.hpp"
#include "study/files/gzip.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

using test::events_header;
using test::events_text;

std::string with_row(const std::string& row) {
  return std::string(events_header) + "1\t10\ttrial\tm\tcube\tcube\t1.5\tanswered\n" + row + "\n";
}

TEST(EventsFile, IsReadRowByRow) {
  const EventsFile file = parse_events(events_text("single-focus", 18), "log");
  EXPECT_TRUE(file.faults.empty());
  ASSERT_EQ(file.rows.size(), 43u);
  EXPECT_EQ(file.rows[0].kind, BlockKind::familiarise);
  EXPECT_EQ(file.rows[0].answer, "");
  EXPECT_EQ(file.rows[2].kind, BlockKind::practice);
  const EventRow& trial = file.rows[3];
  EXPECT_EQ(trial.line, 5u);
  EXPECT_EQ(trial.onset_s, 100);
  EXPECT_EQ(trial.shape, "cube");
  EXPECT_EQ(trial.method, "single-focus");
  EXPECT_EQ(trial.duration_s, 10);
  EXPECT_EQ(trial.response_s, 1);
}

TEST(EventsFile, ColumnsMayBeInAnyOrderAndThereMayBeMore) {
  const std::string text =
      "\xef\xbb\xbfstatus\tanswer\tshape\tmethod\ttrial_type\tduration\tonset\tresponse_time\tnote\r\n"
      "answered\tprism\tcube\tm\ttrial\t10\t3.5\tn/a\tslept\r\n\r\n";
  const EventsFile file = parse_events(text, "log");
  ASSERT_EQ(file.rows.size(), 1u);
  EXPECT_EQ(file.rows[0].answer, "prism");
  EXPECT_EQ(file.rows[0].onset_s, 3.5);
  EXPECT_FALSE(file.rows[0].response_s);
  EXPECT_TRUE(file.faults.empty());
}

TEST(EventsFile, CellsMayBeInQuotesAndColumnsInOtherLetters) {
  const std::string text =
      "Onset \t\"Duration\"\t\"trial_type\"\tMETHOD\tshape\tanswer\t response_time\tStatus\n"
      "\"1.5\"\t10\t\"trial\"\tm\t\"6\"\" cube\"\t\"a\ttab\"\tn/a\t\"answered\"\n";
  const EventsFile file = parse_events(text, "log");
  ASSERT_EQ(file.rows.size(), 1u);
  EXPECT_EQ(file.rows[0].onset_s, 1.5);
  EXPECT_EQ(file.rows[0].shape, "6\" cube");
  EXPECT_EQ(file.rows[0].answer, "a\ttab");
  EXPECT_TRUE(file.faults.empty());
  // With both spellings, the exact one counts.
  EXPECT_EQ(parse_events("ONSET\t" + with_row("").substr(0, std::string(events_header).size()) +
                             "9\t1\t10\ttrial\tm\tcube\tcube\t1.5\tanswered\n",
                         "log")
                .rows.at(0)
                .onset_s,
            1);
  EXPECT_REFUSED(parse_events("Onset\tONSET\tduration\n", "a.tsv"), "the column onset is there twice");
  EXPECT_REFUSED(parse_events("Onset\tTime\tduration\n", "a.tsv"),
                 "the column trial_type is missing: the line has Onset, Time, duration; the columns are onset");
}

TEST(EventsFile, AQuotedStudyOfOthersIsRead) {
  PALPA_SHARED_OR_SKIP(folder, "found/7_study_quoted");
  for (const char* log :
       {"sub-1/beh/sub-1_task-shapes_run-1_events.tsv", "sub-2/beh/sub-2_task-shapes_run-1_events.tsv"}) {
    const EventsFile file = read_events(folder / log);
    EXPECT_EQ(file.rows.size(), 16u) << log;
    EXPECT_TRUE(file.faults.empty()) << log;
  }
}

TEST(EventsFile, AFaultyRowIsLeftOutWithItsLine) {
  const std::vector<std::pair<std::string, std::string>> faults{
      {"2\t10\ttrial\tm\tcube\tcube\t1.5", "7 cells where the first line has 8"},
      {"x\t10\ttrial\tm\tcube\tcube\t1.5\tanswered", "onset 'x' is not a time in seconds"},
      {"nan\t10\ttrial\tm\tcube\tcube\t1.5\tanswered", "onset 'nan' is not a time"},
      {"-1\t10\ttrial\tm\tcube\tcube\t1.5\tanswered", "onset '-1' is not a time"},
      {"2\t-1\ttrial\tm\tcube\tcube\t1.5\tanswered", "duration '-1' is not a time"},
      {"2\t10\ttrial\tm\tcube\tcube\tinf\tanswered", "response_time 'inf' is not a time"},
      {"2\t10\ttrial\tm\tcube\tcube\t1,5\tanswered", "response_time '1,5' is not a time"},
      {"2\t10\ttrail\tm\tcube\tcube\t1\tanswered",
       "trial_type 'trail' is not familiarise, free, practice, trial or rest"},
      {"2\t10\ttrial\tm\tcube\tcube\t1\tok", "status 'ok' is not answered, done or void"},
      {"2\t10\ttrial\tm\tcube\tn/a\t1\tanswered", "an answered trial has no answer"},
      {"2\t10\ttrial\t\tcube\tcube\t1\tanswered", "an answered trial has no method"},
      {"2\t10\ttrial\tm\tcube\tcube\t1\tdone", "only answered or void fit"},
      {"2\t10\ttrial\tm\t" + std::string(65, 'x') + "\tcube\t1\tanswered", "is longer than 64 letters"},
      {"1\t10\ttrial\tm\tcube\tcube\t1\tanswered", "the same onset as line 2"},
      {"0.5\t10\ttrial\tm\tcube\tcube\t1\tanswered", "its onset 0.5 lies before that of line 2"}};
  for (const auto& [row, told] : faults) {
    const EventsFile file = parse_events(with_row(row), "a.tsv");
    EXPECT_EQ(file.rows.size(), 1u) << row;
    ASSERT_EQ(file.faults.size(), 1u) << row;
    EXPECT_TRUE(file.faults[0].starts_with("a.tsv: line 3: ")) << file.faults[0];
    EXPECT_CONTAINS(file.faults[0], told);
    EXPECT_CONTAINS(file.faults[0], "the row is left out");
  }
  EXPECT_TRUE(parse_events(with_row("2\t10\ttrial\tm\tcube\tn/a\tn/a\tvoid"), "a").faults.empty());
}

TEST(EventsFile, ALineThatIsCutIsLeftOut) {
  std::string text = with_row("2\t10\ttrial\tm\tcube\tcube\t1.5\tanswered");
  text.pop_back();
  const EventsFile file = parse_events(text, "a.tsv");
  EXPECT_EQ(file.rows.size(), 1u) << "1.5 might have been 1.52";
  ASSERT_EQ(file.faults.size(), 1u);
  EXPECT_CONTAINS(file.faults[0], "a.tsv: line 3: the line has no end: the file is cut off here");
}

TEST(EventsFile, OtherTablesAreRefused) {
  EXPECT_REFUSED(parse_events("", "a.tsv"), "a.tsv: is empty");
  EXPECT_REFUSED(parse_events("onset,duration,trial_type\n", "a.tsv"),
                 "line 1: the column onset is missing: the line has onset,duration,trial_type; the columns are onset, "
                 "duration");
  std::string text = events_header;
  EXPECT_REFUSED(parse_events(text.replace(text.find("answer"), 6, "reply"), "a.tsv"), "the column answer is missing");
  EXPECT_REFUSED(parse_events("shape\t" + std::string(events_header), "a.tsv"), "the column shape is there twice");
  EXPECT_REFUSED(parse_events(std::string(events_header) + std::string(200'000, '\n') + "x\n", "a.tsv"),
                 "has more than 100000 lines");
}

TEST(EventsFile, AForeignFileDoesNotFloodItsReader) {
  std::string text = events_header;
  for (int i = 0; i < 500; ++i)
    text += "nothing\n";
  const EventsFile file = parse_events(text, "a.tsv");
  EXPECT_EQ(file.faults.size(), 11u);
  EXPECT_EQ(file.faults.back(), "a.tsv: 490 further rows are left out");
}

TEST(EventsFile, ItsSidecarNamesVersionShapesAndChecksum) {
  const auto log = test::events_place(test::scratch_folder("sidecar"), 1);
  const std::string text = events_text("m", 20);
  const auto with = [&](const std::string& sidecar) {
    test::write_events(log, text, sidecar);
    return read_events(log);
  };
  EXPECT_EQ(with(test::events_sidecar).shapes, test::study_shapes);
  EXPECT_TRUE(with(R"({"PalpaStudyVersion": 1})").faults.empty());
  EXPECT_REFUSED(with(R"({"PalpaStudyVersion": 2})"), "the log has version 2, this palpa reads version 1");
  EXPECT_REFUSED(with("{}"), "\"PalpaStudyVersion\" is missing");
  EXPECT_REFUSED(with("{"), "is not a JSON object");
  EXPECT_REFUSED(with("[1]"), "is not a JSON object");
  EXPECT_REFUSED(with(R"({"PalpaStudyVersion": 1, "shape": {"Levels": 3}})"), "is not an object");
  EXPECT_REFUSED(with(R"({"PalpaStudyVersion": 1, "EventsCrc32": "12"})"), "is not eight digits");
  char sum[9];
  std::snprintf(sum, sizeof sum, "%08x", crc32_of(text));
  EXPECT_TRUE(with(R"({"PalpaStudyVersion": 1, "EventsCrc32": ")" + std::string(sum) + "\"}").faults.empty());
  const EventsFile edited = with(R"({"PalpaStudyVersion": 1, "EventsCrc32": "00000000"})");
  EXPECT_EQ(edited.rows.size(), 43u);
  ASSERT_EQ(edited.faults.size(), 1u);
  EXPECT_CONTAINS(edited.faults[0], "was changed after its session ended");
  test::write_text(log, text);
  std::filesystem::path beside = log;
  std::filesystem::remove(beside.replace_extension(".json"));
  const EventsFile alone = read_events(log);
  ASSERT_EQ(alone.faults.size(), 1u);
  EXPECT_CONTAINS(alone.faults[0], "it is read as version 1");
}

/// Whatever the bytes, a log is read or refused in one line, and no row is invented.
TEST(EventsFile, AnyMutationIsReadOrRefused) {
  const std::string good = events_text("cross-section", 26);
  std::uint32_t state = 7;
  const auto random = [&](std::size_t below) {
    state = state * 1664525 + 1013904223;
    return static_cast<std::size_t>(state >> 8) % below;
  };
  std::vector<std::string> pieces{std::string(1, '\0'), std::string(3000, '9'), ""};
  for (const char* piece :
       {"\t", "\n", "\r\n", "n/a", "nan", "-1", "1e999", "answered", "void", "trial", "\xff", "\xe2\x80\xae"})
    pieces.emplace_back(piece);
  int read = 0, refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string text = good;
    for (std::size_t k = random(4) + 1; k > 0; --k) {
      const std::size_t at = random(text.size());
      switch (random(4)) {
        case 0:
          text[at] = static_cast<char>(random(256));
          break;
        case 1:
          text.resize(at + 1);
          break;
        case 2:
          text.insert(at, pieces[random(pieces.size())]);
          break;
        default:
          text.erase(at, random(60));
      }
    }
    const std::string error = test::error_of([&] {
      const EventsFile file = parse_events(text, "log");
      ++read;
      EXPECT_LE(file.rows.size(), 50u);
      EXPECT_LE(file.faults.size(), 11u);
      for (const EventRow& row : file.rows)
        EXPECT_TRUE(std::isfinite(row.onset_s) && row.method.size() <= 64);
    });
    refused += error.empty() ? 0 : 1;
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace palpa::study
