#include "base/file_register.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "base/error.hpp"

namespace palpa {
namespace file_register {
namespace {

namespace fs = std::filesystem;

/// A file that was read.
struct Input {
  std::string name;       ///< the name under which it was read
  std::int64_t born = 0;  ///< see birth_of()
};

/// With a mutex, because inputs are opened on several threads.
struct Register {
  std::mutex mutex;
  int keepers = 0;
  std::vector<Claim> claims;
  std::map<FileIdentity, Input> inputs;
  std::map<Entry, Claim> own;  ///< of no owner and no option
  std::set<Entry> written;     ///< by this program, which may write them again
};
Register& the_register() {
  static Register instance;
  return instance;
}

FileIdentity identity_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino};
}

/// The creation time of the file in nanoseconds; 0 if the file system does not know it. A file system may give the
/// inode of a deleted file to a new one, so the same inode with a later creation time is another file.
std::int64_t birth_of(const fs::path& file) {
  struct statx status {};
  if (::statx(AT_FDCWD, file.c_str(), 0, STATX_BTIME, &status) != 0 || (status.stx_mask & STATX_BTIME) == 0) return 0;
  return std::int64_t{status.stx_btime.tv_sec} * 1'000'000'000 + status.stx_btime.tv_nsec;
}

bool is_other(std::int64_t born, std::int64_t born_too) {
  return born != 0 && born_too != 0 && born != born_too;
}

Entry entry_of(const OutputPlace& place) {
  return {identity_of(place.folder()), place.path.filename().string()};
}

bool is_known(const FileIdentity& identity) {
  return identity != FileIdentity{};
}

/// False for files that do not exist, whose identity is that of their folder, and for devices and pipes.
bool can_be_lost(const OutputPlace& place) {
  return place.kind == OutputPlace::Kind::file;
}

/// Whether that file was read and is still the same file.
bool was_read(const Register& r, const OutputPlace& place) {
  if (!can_be_lost(place)) return false;
  const auto input = r.inputs.find(place.identity);
  if (input == r.inputs.end()) return false;
  const std::int64_t born = birth_of(place.path);
  if (is_other(born, input->second.born)) return false;
  return born != 0 || identity_of(input->second.name) == place.identity;
}

bool is_same(const Claim& a, const Claim& b) {
  if (a.place.kind == OutputPlace::Kind::other || b.place.kind == OutputPlace::Kind::other) return false;
  if (can_be_lost(a.place) && can_be_lost(b.place) && a.place.identity == b.place.identity)
    return !is_other(a.born, b.born);
  return is_known(a.entry.folder) && a.entry == b.entry;
}

/// Whether the claim includes that place.
bool covers(const Claim& claim, const OutputPlace& place, const Entry& entry) {
  if (claim.entry == entry && is_known(entry.folder)) return true;
  if (place.kind != OutputPlace::Kind::absent && place.identity == claim.place.identity) return true;
  if (!claim.is_folder) return false;
  std::error_code fault;
  for (fs::path at = fs::canonical(place.folder(), fault); !fault && at != at.root_path(); at = at.parent_path()) {
    const bool was_there = claim.place.kind == OutputPlace::Kind::folder;
    if (was_there && claim.place.identity == identity_of(at)) return true;
    if (claim.entry.name == at.filename() && claim.entry.folder == identity_of(at.parent_path())) return true;
  }
  return false;
}

/// A file in a folder that was read; empty if there is none.
std::string read_inside(const Register& r, const OutputPlace& folder) {
  std::error_code fault;
  for (fs::recursive_directory_iterator file(folder.path, fault), end; !fault && file != end; file.increment(fault)) {
    if (was_read(r, output_place(file->path()))) return file->path().string();
  }
  return {};
}

Error read_by_this_command(const std::string& option, const std::string& name, const char* kind = "file") {
  return bad_usage(fmt::format("{}: {} is read by this command, name another {}", option, name, kind));
}

Error is_own(const Claim& claim) {
  return bad_usage(fmt::format("{}: {} is a file of palpa's own, name another file", claim.option, claim.place.name));
}

void identify(Claim& claim) {
  claim.entry = entry_of(claim.place);
  if (can_be_lost(claim.place)) claim.born = birth_of(claim.place.path);
}

}  // namespace

void claim(std::vector<Claim> claims) {
  Register& r = the_register();
  std::ranges::for_each(claims, identify);
  const std::lock_guard lock(r.mutex);
  for (const Claim& mine : claims) {
    if (was_read(r, mine.place)) throw read_by_this_command(mine.option, mine.place.name);
    for (const auto& [entry, own] : r.own) {
      if (is_same(own, mine)) throw is_own(mine);
    }
    if (const std::string inside = mine.is_replaced ? read_inside(r, mine.place) : std::string(); !inside.empty())
      throw read_by_this_command(mine.option, inside, "folder");
    for (const Claim& other : r.claims) {
      if (other.owner == mine.owner || other.option == mine.option || !is_same(other, mine)) continue;
      throw bad_usage(fmt::format("{} and {} name the same file, {}: give each its own", other.option, mine.option,
                                  mine.place.name));
    }
  }
  std::ranges::move(claims, std::back_inserter(r.claims));
}

void release(const void* owner) {
  Register& r = the_register();
  const std::lock_guard lock(r.mutex);
  std::erase_if(r.claims, [owner](const Claim& claim) { return claim.owner == owner; });
}

bool is_in_use() {
  Register& r = the_register();
  const std::lock_guard lock(r.mutex);
  return r.keepers > 0 || !r.claims.empty();
}

void reads(const fs::path& file, const FileIdentity& identity) {
  Register& r = the_register();
  const OutputPlace place = output_place(file);
  const Entry entry = entry_of(place);
  const std::int64_t born = is_known(identity) ? birth_of(file) : 0;
  const std::lock_guard lock(r.mutex);
  // Files that this program wrote may be written again, even if they were read meanwhile. Refused reads are remembered,
  // too: the file must not be written, even if the caller continues without reading it.
  if (r.keepers > 0 && is_known(identity) && !r.own.contains(entry) && !r.written.contains(entry))
    r.inputs[identity] = {file.string(), born};
  for (const Claim& claim : r.claims) {
    if (claim.is_replaced && covers(claim, place, entry))
      throw read_by_this_command(claim.option, file.string(), "folder");
    if (claim.is_folder || claim.place.kind == OutputPlace::Kind::other) continue;
    const bool same = can_be_lost(claim.place) && claim.place.identity == identity && !is_other(claim.born, born);
    if (same || claim.entry == entry) throw read_by_this_command(claim.option, file.string());
  }
}

void writes(const OutputPlace& place) {
  Register& r = the_register();
  const Entry entry = entry_of(place);
  const std::lock_guard lock(r.mutex);
  if (r.keepers == 0 || r.own.contains(entry)) return;
  if (was_read(r, place)) throw bad_usage(fmt::format("{} is read by this command, name another file", place.name));
  const bool declared =
      place.is_stdout || std::ranges::any_of(r.claims, [&](const Claim& one) { return covers(one, place, entry); });
  if (!declared) {
    throw failure(
        fmt::format("{}: is not written, since palpa did not declare it as an output: please report this", place.name));
  }
  r.written.insert(entry);
}

void add_own(const fs::path& file) {
  Claim own{.owner = nullptr, .option = {}, .place = output_place(file)};
  identify(own);
  Register& r = the_register();
  const std::lock_guard lock(r.mutex);
  for (const Claim& other : r.claims) {
    if (is_same(own, other)) throw is_own(other);
  }
  const Entry entry = own.entry;
  r.own.insert_or_assign(entry, std::move(own));
}

}  // namespace file_register

KeptRegister::KeptRegister() {
  file_register::Register& r = file_register::the_register();
  const std::lock_guard lock(r.mutex);
  ++r.keepers;
}

KeptRegister::~KeptRegister() {
  file_register::Register& r = file_register::the_register();
  const std::lock_guard lock(r.mutex);
  if (--r.keepers > 0) return;
  r.inputs.clear();
  r.own.clear();
  r.written.clear();
}

}  // namespace palpa
