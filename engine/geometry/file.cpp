#include "geometry/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/error.hpp"

namespace palpa::geometry {
namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()) {
  // O_NONBLOCK: opening a FIFO without a writer would wait for one.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw bad_input(name_, "cannot be opened: " + reason(errno));
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  const char* fault = !known                     ? "cannot be examined"
                      : S_ISDIR(status.st_mode)  ? "is a directory; a file is wanted"
                      : !S_ISREG(status.st_mode) ? "is not a regular file"
                      : status.st_size == 0      ? "is empty"
                                                 : nullptr;
  if (fault != nullptr) {
    ::close(descriptor_);
    throw bad_input(name_, fault);
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : name_(std::move(other.name_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

void InputFile::read_at(std::uint64_t offset, std::span<unsigned char> out) const {
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t got = ::pread(descriptor_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw bad_input(name_, "cannot be read: " + reason(errno));
    if (got == 0)
      throw bad_input(name_, "ends after " + std::to_string(offset + done) + " bytes, in the middle of its data");
    done += static_cast<std::size_t>(got);
  }
}

std::string InputFile::head(std::size_t count) const {
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(count, size_)), '\0');
  read_at(0, std::span(reinterpret_cast<unsigned char*>(text.data()), text.size()));
  return text;
}

}  // namespace palpa::geometry
