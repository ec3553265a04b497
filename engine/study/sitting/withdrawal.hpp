// A participant takes back their consent: all of their files are erased. A tombstone, a small file, stays, so that
// nobody gets their number, and analyses can say how many people withdrew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpa::study {

/// A file that was erased, but has other names (hard links) elsewhere, under which its content remains.
struct OtherNames {
  std::filesystem::path file{};
  std::uint64_t names = 0;  ///< how many
  std::uint64_t inode = 0;  ///< by which they can be found
};

struct Withdrawal {
  std::size_t files = 0;  ///< that were erased
  bool before = false;    ///< the participant had withdrawn before, and nothing was left
  /// Files and folders elsewhere, to which links in the folder led. They still exist.
  std::vector<std::filesystem::path> remaining{};
  std::vector<OtherNames> other_names{};
};

/// Erases the participant's files from the study's folder. The tombstone is written first and is on the disk before
/// anything is erased, so that an interrupted withdrawal can be repeated. Links are erased, not followed. Throws
/// bad_input if the study has no such participant, bad_usage while a sitting of theirs is under way, failure() if a
/// file cannot be erased.
Withdrawal withdraw(const std::filesystem::path& study, std::uint32_t participant);

}  // namespace palpa::study
