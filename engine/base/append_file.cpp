#include "base/append_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/core.h>

#include <cerrno>
#include <system_error>

#include "base/error.hpp"
#include "base/file_register.hpp"
#include "base/open_output.hpp"
#include "base/output_place.hpp"

namespace palpa {
namespace {

void lock(int descriptor, const std::string& name) {
  if (lock_output(descriptor, name)) return;
  throw failure(name + ": cannot be locked: " + std::system_category().message(errno) +
                "; use a folder on a file system with locks");
}

}  // namespace

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

void keep_file(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw write_failure(file.string(), errno);
  const int code = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (code != 0) throw write_failure(file.string(), code);
  sync_folder(file.parent_path());
}

AppendFile::AppendFile(const std::filesystem::path& file) : name_(file.string()) {
  const OutputPlace place = output_place(file);
  if (place.kind == OutputPlace::Kind::folder || place.kind == OutputPlace::Kind::other)
    throw failure(name_ + ": is not a regular file");
  file_register::writes(place);
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_APPEND | O_NONBLOCK, 0666);
  if (descriptor_ < 0) throw write_failure(name_, errno);
  try {
    lock(descriptor_, name_);
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) throw write_failure(name_, errno);
    size_ = static_cast<std::uint64_t>(status.st_size);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
  // The name of a new file is only safe when its folder is.
  if (place.kind == OutputPlace::Kind::absent) sync_folder(place.folder());
}

AppendFile::~AppendFile() {
  ::close(descriptor_);
}

std::string AppendFile::content(std::uint64_t most_bytes) const {
  if (size_ > most_bytes) throw bad_input(name_, fmt::format("has more than {} bytes", most_bytes));
  std::string text(size_, '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t got = ::pread(descriptor_, text.data() + done, text.size() - done, static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw bad_input(name_, "cannot be read to its end");
    done += static_cast<std::size_t>(got);
  }
  return text;
}

void AppendFile::add(std::string_view record) {
  std::size_t done = 0;
  int code = 0;
  while (code == 0 && done < record.size()) {
    const ssize_t wrote = ::write(descriptor_, record.data() + done, record.size() - done);
    if (wrote >= 0) {
      done += static_cast<std::size_t>(wrote);
    } else if (errno != EINTR) {
      code = errno;
    }
  }
  if (code == 0 && ::fdatasync(descriptor_) != 0) code = errno;
  if (code != 0) {
    // Half a record would be read as a cut one, but a later record must not follow it.
    if (::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0) ::fdatasync(descriptor_);
    throw write_failure(name_, code);
  }
  size_ += record.size();
}

void AppendFile::cut(std::uint64_t bytes) {
  if (bytes >= size_) return;
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0 || ::fdatasync(descriptor_) != 0)
    throw write_failure(name_, errno);
  size_ = bytes;
}

}  // namespace palpa
