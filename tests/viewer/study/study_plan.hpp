// A small plan of a study, and the answers that a study's folder has.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "study/files/study_folder.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

struct PlanParts {
  double touch_s = 0.05;
  std::array<double, 2> dwell_ms{1.5, 1.5};  ///< of the methods
  std::string layout = "autd3", run = "predict = false\n", level = "ceiling = 0.5\nlimit_db = 140\n";
};

/// Two shapes and two methods on one board. `blocks`: the plan's [[block]] tables.
inline std::filesystem::path write_study_plan(const std::filesystem::path& folder, const std::string& blocks,
                                              const PlanParts& parts = {}) {
  std::string text = "title = \"Cubes and balls\"\n";
  for (const std::string shape : {"cube", "semi-sphere"}) {
    const std::string model = source_file("assets/" + shape + ".glb").string();
    text += "[[shape]]\nname = \"" + shape + "\"\nmodel = \"" + model + "\"\n";
  }
  for (const std::size_t m : {0, 1}) {
    text += std::string("[[method]]\nname = \"") + (m == 0 ? "single-focus" : "cross-section") + "\"\nlayout = \"" +
            parts.layout + "\"\ndwell_ms = " + std::to_string(parts.dwell_ms[m]) + "\n";
  }
  const std::filesystem::path file = folder / "plan.toml";
  text += "[study]\nparticipants = 2\ntrials_per_shape = 2\ntouch_s = " + std::to_string(parts.touch_s) + "\n";
  write_text(file, text + "[run]\nmasking = \"off\"\n" + parts.run + "[level]\n" + parts.level + blocks);
  return file;
}

/// Method, shape and answer of the first participant's trials, sorted.
inline std::vector<std::array<std::uint32_t, 3>> answers_in(const std::filesystem::path& folder) {
  const study::Study study = study::read_study(std::vector<std::string>{folder.string()});
  std::vector<std::array<std::uint32_t, 3>> rows;
  if (study.participants.empty()) return rows;
  for (const study::Trial& trial : study.participants[0].trials)
    rows.push_back({trial.method, trial.shape, trial.answer});
  std::ranges::sort(rows);
  return rows;
}

}  // namespace palpa::test
