// A small plan, and sittings that keep their journal in memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/plan/plan_file.hpp"
#include "study/sitting/rehearsal.hpp"
#include "support/study_files.hpp"

namespace palpa::test {

/// Two methods, two shapes, all kinds of blocks; touches of 50 ms.
inline constexpr const char* small_plan_head = R"(title = "Small"
[[shape]]
name = "cube"
model = "cube.glb"
[[shape]]
name = "ball"
model = "ball.glb"
[[method]]
name = "single-focus"
[[method]]
name = "cross-section"
[study]
participants = 2
trials_per_shape = 2
touch_s = 0.05
)";

inline study::StudyPlan small_plan() {
  return study::parse_plan(small_plan_head + all_blocks(), "plan.toml");
}

/// A journal in memory.
struct MemoryJournal {
  std::string text, digits;

  explicit MemoryJournal(std::uint32_t participant, const std::string& plan_sha256) {
    text = study::head_line({participant, plan_sha256});
    digits = study::digits_of(text);
  }
  /// Continues a text, without the line that is cut off.
  explicit MemoryJournal(std::string_view before) {
    const study::Journal journal = study::read_journal(before, "journal");
    text = before.substr(0, journal.whole);
    digits = journal.last_digits;
  }
  void add(const study::Entry& entry) {
    const std::string line = study::entry_line(entry, digits);
    text += line;
    digits = study::digits_of(line);
  }
  std::vector<study::Entry> entries() const { return study::read_journal(text, "journal").entries; }
};

}  // namespace palpa::test
