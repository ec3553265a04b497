#include "base/files/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <system_error>

#include "base/log.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

mode_t mode_of(const OutputPlace& place) {
  return place.is_personal ? 0600 : 0666;
}

/// A file of a participant may be there with another mode. A file system without modes, and a file of somebody else,
/// keep theirs.
void restrict_mode(const OutputPlace& place, int descriptor) {
  if (place.is_personal) static_cast<void>(!::fchmod(descriptor, mode_of(place)));
}

/// Does not wait for a pipe's reader: without one, errno is ENXIO.
int try_to_open(const OutputPlace& place) {
  return ::open(place.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, mode_of(place));
}

int wait_for_reader(const OutputPlace& place, const Patience& patience) {
  constexpr timespec slice{0, 10'000'000};
  constexpr double told_after_s = 0.5;  // a reader that is started together with palpa arrives sooner
  const auto begin = std::chrono::steady_clock::now();
  for (bool told = false;;) {
    // A signal that does not end the program ends the wait, just as it ends a call that opens such a pipe.
    const bool signalled = ::nanosleep(&slice, nullptr) != 0 && errno == EINTR;
    const int descriptor = try_to_open(place);
    if (descriptor >= 0 || errno != ENXIO) return descriptor;
    const double waited_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (patience.seconds && waited_s > *patience.seconds)
      throw failure(place.name + ": nobody reads this pipe: start its reader first");
    if (signalled || (patience.stop != nullptr && *patience.stop))
      throw WaitEnded(Exit::failed, place.name + ": palpa was ended before anybody read this pipe");
    if (!patience.seconds && waited_s > told_after_s && !std::exchange(told, true))
      log::at_once(place.name + ": palpa waits for somebody to read this pipe");
  }
}

/// Locks a whole file. Throws bad_usage if another writer has done so, in this process or in another one. False, with
/// errno: the file system has no locks.
bool lock(const OpenFile& file) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(file.descriptor(), F_OFD_SETLK, &whole) == 0) return true;
  if (errno != EAGAIN && errno != EACCES) return false;
  throw bad_usage(file.name() + ": another palpa is writing this file; wait until it has ended");
}

/// A name that no other writer in this process uses; between two processes, EEXIST prevents collisions.
fs::path new_name(const OutputPlace& place) {
  static std::atomic<std::uint64_t> count{0};
  return place.folder() / fmt::format("{}{}-{}", temporary_prefix, ::getpid(), count++);
}

/// The path for linking a descriptor without a name.
std::string link_of(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

/// Copies all of a file into another of the same name for messages.
void copy(const OpenFile& file) {
  OpenFile into = open_output(file.name());
  constexpr std::size_t piece = 1 << 30;
  ssize_t copied = 1;
  for (off_t at = 0; copied != 0;) {
    copied = ::sendfile(into.descriptor(), file.descriptor(), &at, piece);
    if (copied < 0 && errno != EINTR) throw write_failure(file.name(), errno);
  }
  into.close();
}

}  // namespace

int write_all(int descriptor, std::string_view bytes, std::size_t& written) {
  for (written = 0; written < bytes.size();) {
    const ssize_t more = ::write(descriptor, bytes.data() + written, bytes.size() - written);
    if (more > 0) {
      written += static_cast<std::size_t>(more);
    } else if (more == 0 || (errno != EAGAIN && errno != EINTR)) {
      return more == 0 ? EIO : errno;
    } else if (errno == EAGAIN) {
      // Another process made this pipe or terminal non-blocking; there is nothing else to do here but wait.
      pollfd room{descriptor, POLLOUT, 0};
      ::poll(&room, 1, -1);
    }
  }
  return 0;
}

OpenFile::OpenFile(std::string name, int descriptor) : name_(std::move(name)), descriptor_(descriptor) {
  if (descriptor < 0) throw write_failure(name_, errno);
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

bool OpenFile::on_disk() const {
  struct stat status {};
  return ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
}

bool OpenFile::is_at(const fs::path& file) const {
  struct stat own {
  }, there{};
  return ::fstat(descriptor_, &own) == 0 && ::stat(file.c_str(), &there) == 0 && own.st_dev == there.st_dev &&
         own.st_ino == there.st_ino;
}

void OpenFile::write(std::string_view bytes, bool kept) const {
  std::size_t written = 0;
  int fault = write_all(descriptor_, bytes, written);
  if (fault == 0 && kept && ::fdatasync(descriptor_) != 0) fault = errno;
  if (fault == 0) return;
  // Half a record would be read as a cut one, but a later record must not follow it.
  const off_t end = ::lseek(descriptor_, 0, SEEK_CUR) - static_cast<off_t>(written);
  if (written > 0 && end >= 0 && ::ftruncate(descriptor_, end) == 0) ::lseek(descriptor_, end, SEEK_SET);
  throw write_failure(name_, fault);
}

void OpenFile::cut(std::uint64_t bytes) const {
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0 || ::fdatasync(descriptor_) != 0)
    throw write_failure(name_, errno);
}

void OpenFile::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) throw write_failure(name_, errno);
}

OpenFile open_output(const fs::path& path, const Patience& patience) {
  const OutputPlace place = writable_place(path);
  if (place.is_stdout) return {place.name, ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)};
  std::error_code ignored;
  int descriptor = try_to_open(place);
  if (descriptor < 0 && errno == ENXIO && fs::is_fifo(place.path, ignored))
    descriptor = wait_for_reader(place, patience);
  OpenFile file(place.name, descriptor);
  if (file.on_disk()) {
    restrict_mode(place, descriptor);
    lock(file);  // without locks, it must be believed that nobody else writes
    if (::ftruncate(descriptor, 0) != 0) throw write_failure(place.name, errno);
  }
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags >= 0) ::fcntl(descriptor, F_SETFL, flags & ~O_NONBLOCK);
  return file;
}

OpenFile open_to_append(const fs::path& path) {
  const OutputPlace place = writable_place(path);
  const bool absent = place.type == fs::file_type::not_found;
  if (!absent && place.type != fs::file_type::regular) throw failure(place.name + ": is not a regular file");
  OpenFile file(place.name, ::open(place.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_APPEND, mode_of(place)));
  restrict_mode(place, file.descriptor());
  if (!lock(file)) {
    throw failure(place.name + ": cannot be locked: " + std::system_category().message(errno) +
                  "; use a folder on a file system with locks");
  }
  if (absent) keep_file(place.path);
  return file;
}

OutputFile::OutputFile(const fs::path& file) : place_(writable_place(file)) {
  is_beside_ = !place_.open_already && place_.type != fs::file_type::unknown && open_beside();
  if (!is_beside_) file_ = open_output(file);
}

/// Opens the file without a name if the file system supports that. False if this cannot replace the file that is there.
bool OutputFile::open_beside() {
  const bool replaces = place_.type == fs::file_type::regular;
  int descriptor = ::open(place_.folder().c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode_of(place_));
  if (descriptor >= 0 && ::access(link_of(descriptor).c_str(), F_OK) != 0) ::close(std::exchange(descriptor, -1));
  for (errno = EEXIST; descriptor < 0 && errno == EEXIST;) {
    beside_ = new_name(place_);
    descriptor = ::open(beside_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode_of(place_));
  }
  if (descriptor < 0) beside_.clear();
  if (descriptor < 0 && replaces && (errno == EACCES || errno == EPERM || errno == EROFS)) return false;
  file_ = OpenFile(place_.name, descriptor);
  struct stat old {};
  if (!replaces || (::stat(place_.path.c_str(), &old) == 0 && ::fchown(descriptor, old.st_uid, old.st_gid) == 0 &&
                    ::fchmod(descriptor, place_.is_personal ? mode_of(place_) : old.st_mode & 07777) == 0))
    return true;
  if (!beside_.empty()) ::unlink(std::exchange(beside_, {}).c_str());
  return false;
}

OutputFile::~OutputFile() {
  if (!beside_.empty()) ::unlink(beside_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  constexpr std::size_t block = 1 << 16;
  if (buffer_.size() + bytes.size() > block) {
    file_.write(buffer_);
    buffer_.clear();
  }
  if (bytes.size() > block) return file_.write(bytes);
  buffer_ += bytes;
}

void OutputFile::finish() {
  file_.write(buffer_);
  if (is_beside_) put_in_place();
  file_.close();
}

void OutputFile::put_in_place() {
  struct stat there {};
  if (::stat(place_.path.c_str(), &there) == 0 && there.st_nlink > 1) return copy(file_);
  if (beside_.empty()) {
    // It gets the name of its place, or if that is taken, one under which it takes that place.
    const std::string link = link_of(file_.descriptor());
    fs::path name = place_.path;
    while (::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) {
      if (errno != EEXIST) throw write_failure(place_.name, errno);
      name = new_name(place_);
    }
    if (name == place_.path) return;
    beside_ = name;
  }
  if (::rename(beside_.c_str(), place_.path.c_str()) == 0) return beside_.clear();
  if (errno != EBUSY) throw write_failure(place_.name, errno);
  copy(file_);
}

void write_file(const fs::path& file, std::string_view bytes) {
  OutputFile output(file);
  output.write(bytes);
  output.finish();
}

bool make_folder(const fs::path& folder) {
  if (::mkdir(folder.c_str(), is_personal(folder) ? 0700 : 0777) == 0) return true;
  const int fault = errno;
  std::error_code ignored;
  if (fault == EEXIST && fs::is_directory(folder, ignored)) return false;
  throw failure(fmt::format("{}: cannot be created: {}", folder.string(), std::generic_category().message(fault)));
}

void keep_to_owner(const fs::path& file) {
  std::error_code kept;
  const fs::file_type type = fs::symlink_status(file, kept).type();
  if (type == fs::file_type::directory) fs::permissions(file, fs::perms(0700), kept);
  if (type == fs::file_type::regular) fs::permissions(file, fs::perms(0600), kept);
}

void keep_file(const fs::path& file) {
  for (const fs::path& path : {file, file.has_parent_path() ? file.parent_path() : fs::path(".")}) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    const int fault = descriptor >= 0 && ::fsync(descriptor) == 0 ? 0 : errno;
    if (descriptor >= 0) ::close(descriptor);
    std::error_code ignored;
    if (fault != 0 && !fs::is_directory(path, ignored)) throw write_failure(path.string(), fault);
  }
}

}  // namespace palpa
