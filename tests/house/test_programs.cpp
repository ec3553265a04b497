// The programs as files: where they search for libraries, and their protection against memory faults. Normally, these
// are the build's programs; if PALPA_PROGRAMS is set, those in its folders, separated by colons (tests/package).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "house/small_body.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

/// All programs and libraries in the folders: what readelf says about their segments, libraries and symbols.
const std::map<fs::path, std::string>& files() {
  static const std::map<fs::path, std::string> all = [] {
    std::map<fs::path, std::string> found;
    const char* const given = std::getenv("PALPA_PROGRAMS");
    std::istringstream folders(given ? given : PALPA_BUILT_PROGRAMS);
    for (std::string folder; std::getline(folders, folder, ':');) {
      for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string read = "LC_ALL=C exec readelf --wide -h -l -d --dyn-syms \"$0\"";
        const Result result = run_program("/bin/sh", {"-c", read, entry.path()});
        if (result.out.find("(NEEDED)") != std::string::npos) found.emplace(entry.path(), result.out);
      }
    }
    return found;
  }();
  return all;
}

bool says(const std::string& elf, const std::string& pattern) {
  return std::regex_search(elf, std::regex(pattern));
}

/// Tests are built with less protection: nobody gives them untrusted data.
bool of_users(const fs::path& file) {
  static const std::set<std::string> names{"palpa",      "palpa-guard", "palpa-viewer", "join_pictures",
                                           "make_bunny", "make_dense",  "make_depth",   "make_finger",
                                           "make_hand",  "make_objects"};
  return names.contains(file.filename());
}

bool installed(const fs::path& file) {
  return file.filename().string().starts_with("palpa");
}

TEST(Programs, AreThere) {
  for (const char* name : {"palpa", "palpa-guard"})
    EXPECT_TRUE(std::ranges::any_of(files(), [&](const auto& f) { return f.first.filename() == name; })) << name;
}

// The system's loader knows where libraries are. An empty entry, which CMake leaves behind, means the current folder.
TEST(Programs, HaveNoSearchPathOfLibraries) {
  for (const auto& [file, elf] : files())
    EXPECT_FALSE(says(elf, "\\((RPATH|RUNPATH)\\)")) << file;
}

// With this, a memory fault ends a program instead of helping an attacker.
TEST(Programs, AreLinkedAgainstMemoryFaults) {
  for (const auto& [file, elf] : files()) {
    EXPECT_TRUE(says(elf, "Type: +DYN")) << file << " is not position independent";
    EXPECT_TRUE(says(elf, "GNU_RELRO ")) << file << " is writable after relocation";
    EXPECT_TRUE(says(elf, "GNU_STACK [ 0-9a-fx]+ RW ")) << file << " has an executable stack";
    if (of_users(file)) {
      EXPECT_TRUE(says(elf, "BIND_NOW|Flags: NOW")) << file << " resolves functions while it runs";
    }
  }
}

TEST(Programs, CheckTheirStackTheirBuffersAndTheirIndices) {
  for (const auto& [file, elf] : files()) {
    if (!of_users(file)) continue;
    EXPECT_TRUE(says(elf, "UND __stack_chk_fail")) << file << " has no stack protector";
    EXPECT_TRUE(says(elf, "UND \\w*glibcxx_assert_fail")) << file << " is built without _GLIBCXX_ASSERTIONS";
    if (!installed(file)) continue;
    EXPECT_TRUE(says(elf, "UND __\\w+_chk\\b")) << file << " is not fortified";
#ifdef __x86_64__
    // sub $4096,%rsp, then GCC's orq $0,(%rsp) or clang's movq $0,(%rsp): a function's large frame is touched page by
    // page.
    const std::string code = read_text(file), frame{"\x48\x81\xec\x00\x10\x00\x00", 7};
    EXPECT_TRUE(code.find(frame + std::string("\x48\x83\x0c\x24\x00", 5)) != std::string::npos ||
                code.find(frame + std::string("\x48\xc7\x04\x24\x00", 5)) != std::string::npos)
        << file << " does not probe its stack";
#endif
  }
}

/// The command line, and its exit code with the program's own libraries.
struct Start {
  Arguments arguments;
  int exit_code = 0;
};

/// `folder`: for a body, and for pictures.
std::vector<Start> starts(const std::string& name, const fs::path& folder) {
  const std::string cube = source_file("assets/cube.glb");
  if (name == "palpa") {
    return {{{"--version"}},
            {{"doctor", "--quiet"}},
            {{"scatter", "--mesh", write_small_body(folder), "--plane-wave", "0,0,1", "--csv", "-"}}};
  }
  if (name == "palpa-viewer") {
    return {{{"--version"}},
            {with({"--headless", "--scene", cube, "--source", "synthetic", "--noise-free", "--layout", "autd3",
                   "--size", "64x48", "--frames", "1", "--quiet"},
                  {"--screenshot", folder / "run.png"})},
            {{"--scene", cube}, 3}};  // looks for a display
  }
  if (name == "palpa-guard") return {{{}, 1}};
  return {{{}, 2}};  // one line of usage
}

/// Runs it in a folder, to which a shell changes first.
Result run_in(const fs::path& folder, const fs::path& program, const Arguments& arguments) {
  return run_program(
      "/bin/sh", with({"-c", "cd \"$0\" && exec \"$@\"", folder, program}, arguments),
      {.environment = {where_assets_are(), {"PALPA_CACHE", "off"}, {"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
}

// A user who unpacks an archive and starts palpa there must not run the archive's contents.
TEST(Programs, LoadNothingFromTheCurrentFolder) {
  // The libraries that a running program opens by name, and all that the others need.
  std::set<std::string> names{"libvulkan.so.1",   "libopenblas.so.0", "libvulkan_lvp.so", "libudev.so.1",
                              "libgfortran.so.5", "libGLX.so.0",      "libX11.so.6",      "libwayland-client.so.0"};
  static const std::regex needed("\\(NEEDED\\) +Shared library: \\[(.+?)\\]");
  for (const auto& [file, elf] : files()) {
    for (std::sregex_iterator at(elf.begin(), elf.end(), needed), end; at != end; ++at)
      names.insert((*at)[1]);
  }
  std::size_t started = 0;
  const fs::path folder = scratch_folder("decoys");
  const fs::path mark = folder / "a-decoy-was-loaded";
  for (const std::string& name : names)
    fs::copy_file(PALPA_DECOY, folder / name);
  // The test itself works: a program that searches the current folder loads a decoy, and cannot start with it.
  const Result trapped =
      run_program("/bin/sh", {"-c", "cd \"$0\" && LD_LIBRARY_PATH=. exec \"$1\" --version", folder, palpa_binary()});
  ASSERT_TRUE(fs::remove(mark) || trapped.exit_code != 0);

  for (const auto& [file, elf] : files()) {
    if (!of_users(file)) continue;
    for (const Start& start : starts(file.filename(), folder)) {
      const Result result = run_in(folder, file, start.arguments);
      const std::string what = file.string() + (start.arguments.empty() ? "" : " " + start.arguments.front());
      EXPECT_EQ(result.exit_code, start.exit_code) << what << ": " << result.err.substr(0, result.err.find('\n'));
      EXPECT_FALSE(fs::remove(mark)) << what << " loads a library from the current folder";
      ++started;
    }
  }
  EXPECT_GE(started, 4u);
}

}  // namespace
}  // namespace palpa::test
