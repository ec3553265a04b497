#include "base/files/outputs.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <mutex>
#include <set>
#include <system_error>

namespace palpa {
namespace {

namespace fs = std::filesystem;
using Kind = Output::Kind;

/// A declared output, or one of palpa's own files, which nobody owns.
struct Claim {
  const Outputs* owner;
  Output output;
  OutputPlace place;
  bool is_folder() const { return output.kind != Kind::file; }
  bool is_replaced() const { return output.kind == Kind::replaced_recording; }
  bool is_personal() const { return output.kind == Kind::personal_folder; }
  bool is_continued() const { return owner == nullptr || is_personal(); }
  bool on_stdout() const { return !is_folder() && place.is_stdout; }
};

struct Files {
  std::mutex mutex;  ///< inputs are opened on several threads
  int keepers = 0;
  std::vector<Claim> claims;
  std::set<FileIdentity> inputs;                           ///< that were read
  std::set<std::pair<FileIdentity, std::string>> written;  ///< by this program, which may write them again
} the_files;

/// `descriptor` is an open file, or AT_FDCWD for a path.
FileIdentity identity_of(int descriptor, const fs::path& path, mode_t* mode = nullptr) {
  struct stat status {};
  struct statx more {};
  const int flags = descriptor == AT_FDCWD ? 0 : AT_EMPTY_PATH;
  if (::fstatat(descriptor, path.c_str(), &status, flags) != 0) return {};
  if (mode != nullptr) *mode = status.st_mode;
  const bool dated = ::statx(descriptor, path.c_str(), flags, STATX_BTIME, &more) == 0 && more.stx_mask & STATX_BTIME;
  const auto born_s = static_cast<std::uint64_t>(more.stx_btime.tv_sec);
  return {status.st_dev, status.st_ino, dated ? born_s * 1'000'000'000 + more.stx_btime.tv_nsec : 0};
}

void follow_links(OutputPlace& place) {
  constexpr int most_links = 40;  // that the kernel follows in a row
  for (int i = 0; i < most_links && !place.open_already; ++i) {
    std::error_code fault;
    const fs::path target = fs::read_symlink(place.path, fault);
    if (fault) return;
    // Links in /proc refer to open files, whatever their text says.
    struct statfs system {};
    place.open_already = ::statfs(place.folder().c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
    if (!place.open_already) place.path = place.path.parent_path() / target;
  }
}

/// "-" is stdout. Never throws, whatever exists or does not exist there.
OutputPlace output_place(const fs::path& file) {
  const bool dash = file == "-";
  OutputPlace place{.name = dash ? "stdout" : file.string(), .path = dash ? fs::path("/dev/stdout") : file};
  if (!dash) follow_links(place);
  mode_t mode = 0;
  place.identity = dash ? identity_of(STDOUT_FILENO, "", &mode) : identity_of(AT_FDCWD, place.path, &mode);
  if (mode != 0) place.type = fs::file_type::unknown;
  if (S_ISREG(mode)) place.type = fs::file_type::regular;
  if (S_ISDIR(mode)) place.type = fs::file_type::directory;
  place.entry = {identity_of(AT_FDCWD, place.folder()), place.path.filename().string()};
  // Devices do not count: nothing in them can be overwritten, and many descriptors share one (/dev/null).
  const bool is_device = mode == 0 || S_ISCHR(mode) || S_ISBLK(mode);
  place.is_stdout = dash || (!is_device && place.identity == identity_of(STDOUT_FILENO, ""));
  place.open_already = place.open_already || place.is_stdout;
  return place;
}

void refuse_unwritable(const OutputPlace& place) {
  const auto fault_of = [](const fs::path& path, int wanted) {
    return ::faccessat(AT_FDCWD, path.c_str(), wanted, AT_EACCESS) == 0 ? 0 : errno;
  };
  if (place.open_already) return;
  const bool absent = place.type == fs::file_type::not_found;
  int fault = place.type == fs::file_type::directory ? EISDIR : fault_of(place.path, absent ? F_OK : W_OK);
  if (absent && fault == ENOENT) fault = fault_of(place.folder() / "", W_OK | X_OK);
  if (fault != 0) throw write_failure(place.name, fault);
}

constexpr FileIdentity nobody{};

bool is_at(const OutputPlace& a, const OutputPlace& b) {
  return (a.identity != nobody && a.identity == b.identity) || (a.entry.first != nobody && a.entry == b.entry);
}

/// Devices and pipes are never the same output.
bool is_same(const OutputPlace& a, const OutputPlace& b) {
  return a.type != fs::file_type::unknown && b.type != fs::file_type::unknown && is_at(a, b);
}

bool is_inside(const OutputPlace& place, const Claim& folder) {
  std::error_code fault;
  if (!folder.is_folder()) return false;
  for (fs::path at = fs::canonical(place.folder(), fault); !fault; at = at.parent_path()) {
    if (is_at(output_place(at), folder.place)) return true;
    if (at == at.root_path()) break;
  }
  return false;
}

bool covers(const Claim& claim, const OutputPlace& place) {
  return is_at(claim.place, place) || is_inside(place, claim);
}

bool in_personal_folder(const OutputPlace& place) {
  return std::ranges::any_of(the_files.claims,
                             [&](const Claim& claim) { return claim.is_personal() && covers(claim, place); });
}

/// The link in a declared folder through which that file is elsewhere; empty if there is none.
fs::path link_out(const fs::path& file) {
  for (fs::path at = file; at.has_relative_path(); at = at.parent_path()) {
    std::error_code fault;
    if (!fs::is_symlink(at, fault)) continue;
    const OutputPlace folder = output_place(at.has_parent_path() ? at.parent_path() : ".");
    const auto has_it = [&](const Claim& claim) { return claim.is_folder() && covers(claim, folder); };
    if (std::ranges::any_of(the_files.claims, has_it)) return at;
  }
  return {};
}

bool was_read(const OutputPlace& place) {
  return place.type == fs::file_type::regular && the_files.inputs.contains(place.identity);
}

/// A file in a folder that was read; empty if there is none.
std::string read_inside(const OutputPlace& folder) {
  std::error_code fault;
  for (fs::recursive_directory_iterator file(folder.path, fault), end; !fault && file != end; file.increment(fault)) {
    if (was_read(output_place(file->path()))) return file->path().string();
  }
  return {};
}

constexpr const char* is_read = "is read by this command";

Error refused(const Claim& claim, const std::string& name, const char* reason, const char* kind = "file") {
  return bad_usage(fmt::format("{}: {} {}, name another {}", claim.output.option, name, reason, kind));
}

/// `own` is one of palpa's own.
void refuse_own(const Claim& claim, const Claim& own) {
  if (is_same(claim.place, own.place)) throw refused(claim, claim.place.name, "is a file of palpa's own");
}

void refuse_same(const Claim& a, const Claim& b) {
  if (!is_same(a.place, b.place)) return;
  throw bad_usage(fmt::format("{} and {} name the same file, {}: give each its own", a.output.option, b.output.option,
                              b.place.name));
}

/// For two outputs of one command.
void refuse_pair(const Claim& a, const Claim& b) {
  const std::string both = fmt::format("{} and {}", a.output.option, b.output.option);
  if (a.on_stdout() && b.on_stdout()) throw bad_usage(both + " would mix on stdout: give one of them a file");
  refuse_same(a, b);
  if (is_inside(a.place, b) || is_inside(b.place, a))
    throw bad_usage(both + ": one lies in the folder of the other: give one of them another place");
}

OutputPlace place_of(const Output& output) {
  if (output.kind == Kind::file) return output_place(output.target);
  // "take/" is the same as "take", and "-" is a folder like any other.
  OutputPlace place = output_place(fs::path(".") / (fs::path(output.target) / "").parent_path());
  place.name = output.target;
  return place;
}

void refuse_unusable(const Claim& claim) {
  const OutputPlace& place = claim.place;
  if (!claim.is_folder() || place.type == fs::file_type::not_found) return refuse_unwritable(place);
  if (place.type != fs::file_type::directory)
    throw failure(place.name + ": cannot be created: it is a file; name a new folder");
  std::error_code fault;
  if (claim.is_replaced() || claim.is_continued() || fs::is_empty(place.path, fault) || fault) return;
  throw bad_usage(
      fmt::format("{}: {} is not empty; name a new folder{}", claim.output.option, place.name,
                  claim.output.kind == Kind::recording ? ", or give --overwrite to replace the recording in it" : ""));
}

void refuse_taken(const Claim& mine) {
  if (was_read(mine.place)) throw refused(mine, mine.place.name, is_read);
  const std::string inside = mine.is_replaced() ? read_inside(mine.place) : "";
  if (!inside.empty()) throw refused(mine, inside, is_read, "folder");
  for (const Claim& other : the_files.claims) {
    if (other.owner == nullptr) refuse_own(mine, other);
    if (other.output.option != mine.output.option) refuse_same(other, mine);
  }
}

void release(const Outputs* owner) {
  std::erase_if(the_files.claims, [owner](const Claim& claim) { return claim.owner == owner; });
}

}  // namespace

Error write_failure(const std::string& name, int code) {
  return failure(fmt::format("{}: cannot be written: {}", name, std::generic_category().message(code)));
}

Outputs::Outputs(const std::vector<Output>& outputs) {
  std::vector<Claim> claims;
  for (const Output& output : outputs) {
    if (output.target.empty()) continue;
    const Claim claim{this, output, place_of(output)};
    on_stdout_ = on_stdout_ || claim.on_stdout();
    for (const Claim& other : claims)
      refuse_pair(other, claim);
    claims.push_back(claim);
  }
  std::ranges::for_each(claims, refuse_unusable);
  const std::lock_guard lock(the_files.mutex);
  std::ranges::for_each(claims, refuse_taken);
  std::ranges::move(claims, std::back_inserter(the_files.claims));
}

Outputs::~Outputs() {
  const std::lock_guard lock(the_files.mutex);
  release(this);
}

std::shared_ptr<void> keep_register() {
  const std::lock_guard lock(the_files.mutex);
  ++the_files.keepers;
  return {&the_files.keepers, [](void*) {
            const std::lock_guard ending(the_files.mutex);
            if (--the_files.keepers > 0) return;
            the_files.inputs.clear();
            the_files.written.clear();
            release(nullptr);
          }};
}

void refuse_output_as_input(const fs::path& file, int descriptor) {
  OutputPlace place = output_place(file);
  if (descriptor >= 0) {
    place.identity = identity_of(descriptor, "");
  } else if (file.empty() || (place.type != fs::file_type::regular && place.type != fs::file_type::not_found)) {
    return;
  }
  const std::lock_guard lock(the_files.mutex);
  // Files that this program wrote may be written again, even if they were read meanwhile. Refused reads are remembered,
  // too: the file must not be written, even if the caller continues without reading it.
  const auto is_ours = [&](const Claim& claim) { return claim.is_continued() && covers(claim, place); };
  const bool ours = the_files.written.contains(place.entry) || std::ranges::any_of(the_files.claims, is_ours);
  if (the_files.keepers > 0 && place.identity != nobody && !ours) the_files.inputs.insert(place.identity);
  for (const Claim& claim : the_files.claims) {
    if (claim.is_replaced() && is_inside(place, claim)) throw refused(claim, file.string(), is_read, "folder");
    const bool is_file = !claim.is_folder() && !claim.is_continued();
    if (is_file && is_same(claim.place, place)) throw refused(claim, file.string(), is_read);
  }
}

bool is_personal(const fs::path& file) {
  const std::lock_guard lock(the_files.mutex);
  return in_personal_folder(output_place(file));
}

OutputPlace writable_place(const fs::path& file) {
  OutputPlace place = output_place(file);
  refuse_unwritable(place);
  const std::lock_guard lock(the_files.mutex);
  place.is_personal = in_personal_folder(place);
  if (the_files.keepers == 0) return place;
  if (was_read(place)) throw bad_usage(place.name + " is read by this command, name another file");
  const auto is_declared = [&](const Claim& claim) { return covers(claim, place); };
  if (!place.is_stdout && std::ranges::none_of(the_files.claims, is_declared)) {
    if (const fs::path link = link_out(file); !link.empty()) {
      throw failure(
          fmt::format("{}: is not written, because {} is a link that leads out of the folder of the results: "
                      "put what it leads to in its place",
                      place.name, link.string()));
    }
    throw failure(place.name + ": is not written, since palpa did not declare it as an output: please report this");
  }
  the_files.written.insert(place.entry);
  return place;
}

void add_own_file(const fs::path& file) {
  const std::lock_guard lock(the_files.mutex);
  const Claim own{nullptr, {}, output_place(file)};
  for (const Claim& claim : the_files.claims) {
    if (claim.owner != nullptr) refuse_own(claim, own);
  }
  if (the_files.keepers > 0) the_files.claims.push_back(own);
}

}  // namespace palpa
