#include "cli/output.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <system_error>

#include "base/error.hpp"

namespace palpa::cli {

Output::Output(const std::string& file) : name_(file == "-" ? "stdout" : file) {
  errno = 0;
  file_ = file == "-" ? stdout : std::fopen(file.c_str(), "wb");
  if (!file_) fail(errno);
}

Output::~Output() {
  if (file_ && file_ != stdout) std::fclose(file_);
}

void Output::write(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail(errno);
}

void Output::finish() {
  errno = 0;
  if (std::fflush(file_) != 0 || std::ferror(file_)) fail(errno);
  std::FILE* closing = file_ == stdout ? nullptr : file_;
  file_ = nullptr;
  // Some file systems tell of a full disk only here.
  if (closing && std::fclose(closing) != 0) fail(errno);
}

void Output::fail(int code) const {
  throw failure(fmt::format("{}: cannot be written: {}", name_,
                            code ? std::generic_category().message(code) : std::string("the write came up short")));
}

void refuse_two_on_stdout(const std::string& json, const std::string& csv) {
  if (json == "-" && csv == "-") throw bad_usage("--json - and --csv - would mix on stdout: give one of them a file");
}

void write_output(const std::string& file, std::string_view text) {
  Output output(file);
  output.write(text);
  output.finish();
}

}  // namespace palpa::cli
