#include "cli/support/here.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#ifdef PALPA_ADDRESS_SANITIZER
#include <sanitizer/common_interface_defs.h>
#endif

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "base/log.hpp"
#include "cli/commands.hpp"
#include "driver/doctor.hpp"
#include "driver/emulate/command.hpp"
#include "driver/links.hpp"
#include "driver/sources.hpp"
#include "setup/options/options.hpp"

namespace palpa::test {
namespace {

/// The extensions that driver/main.cpp passes to the engine, without the rows of the bench.
cli::Extensions extensions_of_the_program() {
  return {.doctor = driver::doctor_probes(),
          .links = driver::links(),
          .sources = driver::camera_sources(),
          .commands = {driver::emulate::add_emulate},
          .cameras = driver::cameras_there};
}

/// A file without a name, or an existing file.
class Target {
 public:
  explicit Target(const std::string& name = {})
      : descriptor_(name.empty() ? memfd_create("printed", MFD_CLOEXEC) : open(name.c_str(), O_RDWR | O_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error("no file for what is printed");
  }
  ~Target() { close(descriptor_); }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  int descriptor() const { return descriptor_; }
  std::string text() const {
    std::string all(static_cast<std::size_t>(lseek(descriptor_, 0, SEEK_END)), '\0');
    if (pread(descriptor_, all.data(), all.size(), 0) != static_cast<ssize_t>(all.size()))
      throw std::runtime_error("what was printed cannot be read");
    return all;
  }

 private:
  int descriptor_;
};

/// Redirects a descriptor to another file during its lifetime.
class Redirected {
 public:
  Redirected(int descriptor, const Target& to)
      : descriptor_(descriptor), before_(fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)) {
    std::fflush(nullptr);
    dup2(to.descriptor(), descriptor_);
  }
  ~Redirected() {
    std::fflush(nullptr);
    dup2(before_, descriptor_);
    close(before_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  int descriptor_, before_;
};

/// Sends reports of a sanitizer to the real stderr: the kept output of a line would be lost when the process ends.
void let_sanitizers_report_outside() {
#ifdef PALPA_ADDRESS_SANITIZER
  static const std::intptr_t outside = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  __sanitizer_set_report_fd(reinterpret_cast<void*>(outside));
#endif
}

}  // namespace

Result palpa_here(const std::vector<std::string>& arguments, const std::string& stdout_file,
                  const std::function<void(cli::Extensions&)>& extend) {
  constexpr unsigned patience_s = 120;
  const auto [name, folder] = where_assets_are();
  setenv(name.c_str(), folder.c_str(), 1);
  std::vector<const char*> argv{"palpa"};
  for (const std::string& argument : arguments)
    argv.push_back(argument.c_str());
  // Start with a program's initial state, whatever the previous line changed.
  log::drop_warnings();
  log::set_level(log::Level::warning);
  let_sanitizers_report_outside();
  setup::keep_devices();
  cli::Extensions extensions = extensions_of_the_program();
  if (extend) extend(extensions);
  const Target nothing("/dev/null"), out(stdout_file), err;
  Result result;
  {
    const Redirected stdin_there(STDIN_FILENO, nothing), stdout_there(STDOUT_FILENO, out),
        stderr_there(STDERR_FILENO, err);
    alarm(patience_s);
    // On a separate thread: a loop's requests to the system apply to its thread and end with it.
    std::thread([&] { result.exit_code = cli::main(static_cast<int>(argv.size()), argv.data(), extensions); }).join();
    alarm(0);
  }
  if (stdout_file.empty()) result.out = out.text();
  result.err = err.text();
  expect_orderly(result, arguments);
  return result;
}

}  // namespace palpa::test
