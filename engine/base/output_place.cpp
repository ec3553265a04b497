#include "base/output_place.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace palpa {
namespace {

namespace fs = std::filesystem;

/// The maximum number of links in a row that the kernel follows.
constexpr int most_links = 40;

/// Links in /proc refer to open files, whatever their text says.
bool in_proc(const fs::path& folder) {
  struct statfs system {};
  return ::statfs(folder.c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
}

fs::path folder_of(const fs::path& file) {
  const fs::path folder = file.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

OutputPlace::Kind kind_of(mode_t mode) {
  if (S_ISREG(mode)) return OutputPlace::Kind::file;
  return S_ISDIR(mode) ? OutputPlace::Kind::folder : OutputPlace::Kind::other;
}

void follow_links(OutputPlace& place) {
  for (int i = 0; i < most_links; ++i) {
    std::error_code fault;
    const fs::path target = fs::read_symlink(place.path, fault);
    if (fault) return;
    if (in_proc(folder_of(place.path))) {
      place.open_already = true;
      return;
    }
    place.path = place.path.parent_path() / target;
  }
}

void refuse(const OutputPlace& place, bool refused, int code) {
  if (refused) throw write_failure(place.name, code);
}

/// For the result of a system call. Reads errno after the call, because arguments of one call are evaluated in any
/// order.
void refuse_failed(const OutputPlace& place, bool succeeded) {
  if (!succeeded) throw write_failure(place.name, errno);
}

/// Devices do not count: nothing in them can be overwritten, and many descriptors share one (/dev/null).
bool is_stdout(const struct stat& there) {
  struct stat out {};
  return !S_ISCHR(there.st_mode) && !S_ISBLK(there.st_mode) && ::fstat(STDOUT_FILENO, &out) == 0 &&
         there.st_dev == out.st_dev && there.st_ino == out.st_ino;
}

bool may(const fs::path& path, int what) {
  return ::faccessat(AT_FDCWD, path.c_str(), what, AT_EACCESS) == 0;
}

}  // namespace

fs::path OutputPlace::folder() const {
  return folder_of(path);
}

OutputPlace output_place(const fs::path& file) {
  OutputPlace place{.name = file.string(), .path = file};
  if (file == "-") {
    place.name = "stdout";
    place.path = "/dev/stdout";
  } else {
    follow_links(place);
  }
  struct stat status {};
  const bool there = file == "-" ? ::fstat(STDOUT_FILENO, &status) == 0 : ::stat(place.path.c_str(), &status) == 0;
  place.is_stdout = file == "-" || (there && is_stdout(status));
  place.open_already = place.open_already || place.is_stdout;
  if (there) {
    place.kind = kind_of(status.st_mode);
    place.mode = status.st_mode & 07777;
    place.owner = status.st_uid;
    place.group = status.st_gid;
    place.links = status.st_nlink;
  } else if (place.open_already || ::stat(place.folder().c_str(), &status) != 0) {
    status = {};
  }
  place.identity = {status.st_dev, status.st_ino};
  return place;
}

void refuse_unwritable(const OutputPlace& place) {
  using Kind = OutputPlace::Kind;
  if (place.open_already) return;
  refuse(place, place.kind == Kind::folder, EISDIR);
  if (place.kind != Kind::absent) {
    refuse_failed(place, may(place.path, W_OK));
    return;
  }
  const fs::path folder = place.folder();
  struct stat status {};
  refuse(place, ::lstat(place.path.c_str(), &status) == 0, ELOOP);  // still a link after that many
  refuse_failed(place, ::stat(folder.c_str(), &status) == 0);
  refuse(place, !S_ISDIR(status.st_mode), ENOTDIR);
  refuse_failed(place, may(folder, W_OK | X_OK));
  refuse(place, !place.path.has_filename(), EISDIR);
}

Error write_failure(const std::string& name, int code) {
  return failure(
      fmt::format("{}: cannot be written: {}", name,
                  code ? std::generic_category().message(code) : std::string("it was not written completely")));
}

}  // namespace palpa
