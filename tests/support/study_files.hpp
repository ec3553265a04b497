// The folder of a study, as an experiment would write it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

inline const std::vector<std::string> study_shapes{"cube", "semi-sphere", "pyramid", "prism"};
inline constexpr const char* events_header =
    "onset\tduration\ttrial_type\tmethod\tshape\tanswer\tresponse_time\tstatus\n";

/// A log of 40 trials, of which `correct` are correct, spread over the session. All wrong answers are the next shape.
/// `begin_s` is added to all onsets: no two people begin at the same moment.
inline std::string events_text(const std::string& method, std::uint32_t correct, std::uint32_t trials = 40,
                               double begin_s = 0) {
  std::string text = events_header;
  const auto row = [&](double onset, const std::string& type, const std::string& rest) {
    text += std::to_string(begin_s + onset) + "\t10\t" + type + "\t" + method + "\t" + rest + "\n";
  };
  row(0, "familiarise", "cube\tn/a\tn/a\tdone");
  row(20, "free", "n/a\tn/a\tn/a\tdone");
  row(60, "practice", "semi-sphere\tcube\t2.5\tanswered");
  for (std::uint32_t k = 0; k < trials; ++k) {
    const std::uint32_t shape = k % 4, answer = k * 7 % trials < correct ? shape : (shape + 1) % 4;
    row(100 + 15.0 * k, "trial",
        study_shapes[shape] + "\t" + study_shapes[answer] + "\t" + std::to_string(1 + 0.01 * (k % 9)) + "\tanswered");
  }
  return text;
}

inline constexpr const char* events_sidecar =
    R"({"PalpaStudyVersion": 1, "shape": {"Levels": {"cube": "", "semi-sphere": "", "pyramid": "", "prism": ""}}})";

/// The path of a participant's log, whose folder is made.
inline std::filesystem::path events_place(const std::filesystem::path& study, std::uint32_t number, int run = 1) {
  const std::string name = "sub-" + std::to_string(number);
  std::filesystem::create_directories(study / name / "beh");
  return study / name / "beh" / (name + "_task-shapes_run-" + std::to_string(run) + "_events.tsv");
}

/// Writes a log and its sidecar.
inline void write_events(const std::filesystem::path& log, const std::string& text,
                         const std::string& sidecar = events_sidecar) {
  write_text(log, text);
  std::filesystem::path beside = log;
  write_text(beside.replace_extension(".json"), sidecar);
}

/// One participant's correct answers of 40 with each method, in the order in which the methods were used.
using CorrectAnswers = std::vector<std::pair<std::string, std::uint32_t>>;

inline void write_participant(const std::filesystem::path& study, std::uint32_t number,
                              const CorrectAnswers& sessions) {
  int run = 0;
  for (const auto& [method, correct] : sessions)
    write_events(events_place(study, number, ++run), events_text(method, correct, 40, 1e-3 * number));
}

/// Ten participants with accuracies whose statistics are known: sf .45 .30 .55 .25 .40 .35 .50 .275 .375 .45, cs .70
/// .65 .80 .45 .75 .55 .85 .525 .60 .65. The first five began with single-focus, the others with cross-section.
inline constexpr std::uint32_t ten_single[]{18, 12, 22, 10, 16, 14, 20, 11, 15, 18};
inline constexpr std::uint32_t ten_cross[]{28, 26, 32, 18, 30, 22, 34, 21, 24, 26};
inline void write_ten(const std::filesystem::path& study) {
  for (std::uint32_t i = 0; i < 10; ++i) {
    const std::pair<std::string, std::uint32_t> single{"single-focus", ten_single[i]},
        cross{"cross-section", ten_cross[i]};
    write_participant(study, i + 1, i < 5 ? CorrectAnswers{single, cross} : CorrectAnswers{cross, single});
  }
}

/// The blocks of a plan that has a shape "cube": each kind, touches of its touch_s or 0.1 s.
inline std::string all_blocks() {
  return read_text(source_file("tests/support/study_blocks.toml"));
}

/// A plan whose simulation takes a fraction of a second with a small finger. The models are files.
inline void write_small_plan(const std::filesystem::path& file, const std::string& one, const std::string& other) {
  write_text(file, "[[shape]]\nname = \"one\"\nmodel = \"" + one + "\"\n[[shape]]\nname = \"other\"\nmodel = \"" +
                       other +
                       "\"\n[[method]]\nname = \"single-focus\"\nlayout = \"openmpd\"\n"
                       "[[method]]\nname = \"cross-section\"\nlayout = \"openmpd\"\nfoci = 4\n"
                       "[[candidate]]\nname = \"slow\"\nmethod = \"cross-section\"\nlayout = \"openmpd\"\nfoci = 4\n"
                       "dwell_ms = 2\n"
                       "[study]\nparticipants = 3\ntrials_per_shape = 5\ntouch_s = 2\n"
                       "[observer]\ndepths_mm = [0.8]\nplacements = 3\nlateral_mm = 0.05\nyaw_deg = 0.5\n"
                       "[fit]\nmethod = \"single-focus\"\naccuracy = 0.6\ntrials = 30\n");
}

/// A rig with a screen and one small camera, which sees the fingertip.
inline std::filesystem::path write_study_rig(const std::filesystem::path& folder) {
  const std::string camera = read_text(source_file("tests/cli/support/small_rig.toml"));
  const std::string paper = read_text(source_file("assets/rigs/paper.toml"));
  const std::filesystem::path file = folder / "rig.toml";
  const std::size_t screen = paper.find("[screen]");
  write_text(file, camera.substr(0, camera.find("[array]")) +
                       paper.substr(screen, paper.find("\n\n", screen) - screen) + "\n");
  return file;
}

}  // namespace palpa::test
