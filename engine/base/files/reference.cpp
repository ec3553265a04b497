#include "base/files/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> outside_allowed{false};

/// The maximum number of links in a row that the kernel follows.
constexpr int most_links = 40;

/// The path without symbolic links and ".."; parts that do not exist are kept as written. Empty if it cannot be
/// determined.
fs::path resolved(fs::path path) {
  std::error_code fault;
  // A dangling link must also be followed, because its target may be created later.
  for (int i = 0; i < most_links && fs::is_symlink(fs::symlink_status(path, fault)); ++i)
    path = path.parent_path() / fs::read_symlink(path, fault);
  fs::path whole = fs::weakly_canonical(fs::absolute(path, fault), fault);
  return fault ? fs::path() : whole;
}

bool is_within(const fs::path& path, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

}  // namespace

void allow_outside_references(bool allowed) {
  outside_allowed = allowed;
}

std::array<fs::path, 2> readings_of(const std::string& reference, const fs::path& folder) {
  std::string with_slashes = reference;
  std::ranges::replace(with_slashes, '\\', '/');
  return {folder / reference, folder / with_slashes};
}

ReferenceFolder::ReferenceFolder(std::string naming, const fs::path& folder)
    : naming_(std::move(naming)), folder_(folder), root_(resolved(folder.empty() ? fs::path(".") : folder)) {}

/// Caches folders: of many references in one folder, only symbolic links are resolved individually.
bool ReferenceFolder::holds(const fs::path& path) {
  if (root_.empty()) return false;
  std::error_code fault;
  const bool plain = path.filename() != ".." && path.filename() != "." && path.has_filename() &&
                     !fs::is_symlink(fs::symlink_status(path, fault));
  if (!plain) return is_within(resolved(path), root_);
  const auto [known, is_new] = below_.try_emplace(path.parent_path(), false);
  if (is_new) known->second = is_within(resolved(path.parent_path().empty() ? "." : path.parent_path()), root_);
  return known->second;
}

fs::path ReferenceFolder::find(const std::string& reference, const std::string& what) {
  const auto [as_written, with_slashes] = readings_of(reference, folder_);
  const auto is_allowed = [&](const fs::path& path) { return outside_allowed || holds(path); };
  std::error_code fault;
  // Whether a file outside exists is asked only if that is allowed.
  const auto is_meant = [&] { return as_written == with_slashes || fs::exists(fs::symlink_status(as_written, fault)); };
  if (is_allowed(as_written) && is_meant()) return as_written;
  if (is_allowed(with_slashes)) return with_slashes;
  throw bad_input(naming_, fmt::format("{}: \"{}\" leads out of the folder of this file; --allow-outside permits that",
                                       what, printable(reference, 60)));
}

}  // namespace palpa
