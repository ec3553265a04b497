// Preloaded into a program: a disk that stops responding. As long as a file $HUNG_DISK/hangs exists, a write to a file
// below $HUNG_DISK blocks. Signals do not help, as with a network file system that is gone. The first write that blocks
// makes the file $HUNG_DISK/held.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

bool hangs(int descriptor) {
  const char* folder = std::getenv("HUNG_DISK");
  if (!folder) return false;
  std::array<char, 4096> target{};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  if (readlink(link.c_str(), target.data(), target.size() - 1) < 0) return false;
  if (std::strncmp(target.data(), folder, std::strlen(folder)) != 0) return false;
  return access((std::string(folder) + "/hangs").c_str(), F_OK) == 0;
}

}  // namespace

extern "C" ssize_t write(int descriptor, const void* bytes, size_t size) {
  using Write = ssize_t (*)(int, const void*, size_t);
  static const auto real = reinterpret_cast<Write>(dlsym(RTLD_NEXT, "write"));
  if (hangs(descriptor)) {
    const std::string held = std::string(std::getenv("HUNG_DISK")) + "/held";
    close(open(held.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  }
  while (hangs(descriptor))
    usleep(20'000);
  return real(descriptor, bytes, size);
}
