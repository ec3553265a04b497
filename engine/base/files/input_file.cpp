#include "base/files/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/files/outputs.hpp"

namespace palpa {
namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path, std::uint64_t most_bytes) : name_(path.string()) {
  // O_NONBLOCK: opening a FIFO without a writer would block.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) {
    throw bad_input(name_, errno == ENOENT ? "no such file" : "cannot be opened: " + reason(errno));
  }
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  size_ = known ? static_cast<std::uint64_t>(status.st_size) : 0;
  if (known && S_ISREG(status.st_mode)) {
    try {
      refuse_output_as_input(path, descriptor_);
    } catch (const Error&) {
      ::close(descriptor_);
      throw;
    }
  }
  std::string fault;
  if (!known) {
    fault = "cannot be examined: " + reason(errno);
  } else if (S_ISDIR(status.st_mode)) {
    fault = "is a folder, a file is needed";
  } else if (!S_ISREG(status.st_mode)) {
    fault = "is not a regular file";
  } else if (size_ == 0) {
    fault = "is empty";
  } else if (size_ > most_bytes) {
    fault = fmt::format("has {} bytes, at most {} are expected", size_, most_bytes);
  }
  if (fault.empty()) return;
  ::close(descriptor_);
  throw bad_input(name_, fault);
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
    if (got == 0) throw bad_input(name_, fmt::format("ends after {} bytes, in the middle of its data", offset + done));
    done += static_cast<std::size_t>(got);
  }
}

std::string InputFile::head(std::size_t count) const {
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(count, size_)), '\0');
  read_at(0, std::span(reinterpret_cast<unsigned char*>(text.data()), text.size()));
  return text;
}

std::string read_file(const std::filesystem::path& path, std::uint64_t most_bytes) {
  const InputFile file(path, most_bytes);
  return file.head(static_cast<std::size_t>(file.size()));
}

std::size_t mark_of(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? mark.size() : 0;
}

std::string_view text_in(std::string_view bytes, const std::string& name) {
  const auto is_letter = [](char c) { return c >= '\t' && c <= '~'; };
  // Without a mark, the zero bytes beside Western letters tell.
  const auto has_zeros = [&](std::size_t zero) {
    return bytes.size() >= 4 && bytes[zero] == '\0' && bytes[2 + zero] == '\0' && is_letter(bytes[1 - zero]) &&
           is_letter(bytes[3 - zero]);
  };
  if (has_zeros(0) || has_zeros(1) || bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    throw bad_input(name, "is text in UTF-16; save it as UTF-8");
  return bytes.substr(mark_of(bytes));
}

std::string read_text_file(const std::filesystem::path& path, std::uint64_t most_bytes) {
  std::string text = read_file(path, most_bytes);
  text.erase(0, text.size() - text_in(text, path.string()).size());
  return text;
}

}  // namespace palpa
