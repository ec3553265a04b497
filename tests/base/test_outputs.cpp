// No file that was read is overwritten, and only declared files are written.
#include "base/files/outputs.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/output_file.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

class RegisterTest : public testing::Test {
 protected:
  RegisterTest() {
    test::write_text(folder_ / "input", "input");
    fs::create_directory(folder_ / "deep");
    fs::create_symlink(folder_ / "input", folder_ / "soft");
    fs::create_hard_link(folder_ / "input", folder_ / "hard");
    open_ = ::open((folder_ / "input").c_str(), O_RDWR | O_CLOEXEC);
  }
  ~RegisterTest() override { ::close(open_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> names() const {
    return {path("input"),
            path("soft"),
            path("hard"),
            path("deep/../input"),
            folder_.string() + "//input",
            "/proc/self/fd/" + std::to_string(open_)};
  }
  static std::string refusal(const std::vector<Output>& outputs) {
    const Error error = test::thrown_by([&] { const Outputs declared(outputs); });
    EXPECT_EQ(error.code(), Exit::usage) << error.what();
    return error.what();
  }

  fs::path folder_ = test::scratch_folder("register");
  int open_ = -1;
};

TEST_F(RegisterTest, InputsCannotBecomeOutputs) {
  const auto kept = keep_register();
  read_file(path("input"), 100);
  for (const std::string& name : names())
    EXPECT_EQ(refusal({{"--csv", name}}), "--csv: " + name + " is read by this command, name another file");
  EXPECT_EQ(test::read_text(path("input")), "input");
}

TEST_F(RegisterTest, OutputsAreNotRead) {
  for (const std::string& name : names()) {
    const auto kept = keep_register();
    const Outputs outputs({{"--csv", name}});
    EXPECT_EQ(test::thrown_by([&] { read_file(path("input"), 100); }).code(), Exit::usage) << name;
    EXPECT_EQ(test::thrown_by([&] { refuse_output_as_input(path("input")); }).code(), Exit::usage) << name;
    EXPECT_EQ(test::thrown_by([&] { write_file(name, "x"); }).code(), Exit::usage) << "somebody wants to read it";
  }
  const auto kept = keep_register();
  EXPECT_EQ(read_file(path("input"), 100), "input");
  // The names of files that are to be created are known.
  const Outputs outputs({{"--csv", path("new")}});
  EXPECT_EQ(test::thrown_by([&] { refuse_output_as_input(path("deep/../new")); }).code(), Exit::usage);
  write_file(path("new"), "x");
  EXPECT_EQ(test::thrown_by([&] { read_file(path("deep") + "/../new", 100); }).code(), Exit::usage);
}

TEST_F(RegisterTest, OnlyDeclaredFilesAreWritten) {
  const std::string part = "palpa did not declare it";
  EXPECT_NO_THROW(write_file(path("free"), "x")) << "a program that uses the library need not declare anything";
  const auto kept = keep_register();
  for (const std::string& name : {path("new"), path("free"), path("deep/new"), std::string("/dev/null")}) {
    EXPECT_ERROR(write_file(name, "x"), Exit::failed, part) << name;
    EXPECT_ERROR(open_output(name), Exit::failed, part) << name;
  }
  EXPECT_EQ(test::read_text(path("free")), "x");
  EXPECT_FALSE(fs::exists(path("new")));
  {
    const Outputs outputs({{"--csv", path("new")},
                           {"--json", "/dev/null"},
                           {"--record", path("take"), Output::Kind::folder},
                           {"--video", path("deep/"), Output::Kind::folder}});
    write_file(path("new"), "x");
    write_file(path("deep/../new"), "y");
    write_file("/dev/null", "x");
    fs::create_directory(path("take"));
    write_file(path("take/one"), "x");
    write_file(path("deep/one"), "x");
  }
  EXPECT_ERROR(write_file(path("new"), "x"), Exit::failed, part);
  EXPECT_NO_THROW(write_file("-", ""));
}

TEST_F(RegisterTest, NothingIsReadFromAFolderThatIsReplaced) {
  fs::create_directory(path("take"));
  test::write_text(path("take/one"), "one");
  fs::create_symlink(path("take"), path("same"));
  const std::vector<Output> replaced{{"--record", path("take"), Output::Kind::replaced_recording}};
  EXPECT_NE(refusal({{"--record", path("take"), Output::Kind::folder}}).find("name a new folder"), std::string::npos);
  EXPECT_NE(refusal({{"--record", path("take"), Output::Kind::recording}}).find("give --overwrite"), std::string::npos);
  {
    const auto kept = keep_register();
    const Outputs outputs(replaced);
    for (const char* name : {"take/one", "same/one", "deep/../take/one"})
      EXPECT_EQ(test::thrown_by([&] { read_file(path(name), 100); }).code(), Exit::usage) << name;
    EXPECT_EQ(read_file(path("input"), 100), "input");
    write_file(path("take/two"), "x");
    fs::remove(path("take/two"));
  }
  {
    const auto kept = keep_register();
    read_file(path("same/one"), 100);
    EXPECT_EQ(refusal(replaced), "--record: " + path("take/one") + " is read by this command, name another folder");
  }
  // Under another name, the file is known when it is to be deleted.
  fs::create_hard_link(path("take/one"), path("elsewhere"));
  const auto kept = keep_register();
  const Outputs outputs(replaced);
  read_file(path("elsewhere"), 100);
  EXPECT_EQ(test::thrown_by([&] { writable_place(path("take/one")); }).code(), Exit::usage);
}

TEST_F(RegisterTest, AFolderThatIsContinuedIsReadAndWritten) {
  fs::create_directory(path("study"));
  test::write_text(path("study/log"), "old");
  const auto kept = keep_register();
  const Outputs outputs({{"--out", path("study"), Output::Kind::personal_folder}});
  EXPECT_EQ(read_file(path("study/log"), 100), "old");
  write_file(path("study/log"), "new");
  EXPECT_EQ(read_file(path("study/log"), 100), "new");
  const Outputs json({{"--json", path("study/result")}});
  write_file(path("study/result"), "x");
  EXPECT_EQ(test::thrown_by([&] { read_file(path("study/result"), 100); }).code(), Exit::usage);
}

TEST_F(RegisterTest, APersonalFolderIsForItsOwnerOnly) {
  const mode_t before = ::umask(0);
  fs::create_directory(path("study"));
  test::write_text(path("study/old"), "old");
  fs::permissions(path("study"), fs::perms(0700));
  {
    const Outputs outputs({{"--out", path("study"), Output::Kind::personal_folder}});
    EXPECT_TRUE(make_folder(path("study/images")));
    EXPECT_FALSE(make_folder(path("study/images")));
    write_file(path("study/images/one"), "x");
    write_file(path("study/old"), "new");
    open_output(path("study/stream"));
    open_to_append(path("study/journal"));
    EXPECT_EQ(test::open_to_others(path("study")), std::vector<fs::path>());
    EXPECT_ERROR(make_folder(path("study/old")), Exit::failed, "study/old: cannot be created: File exists");
    write_file(path("free"), "x");
    EXPECT_EQ(fs::status(path("free")).permissions(), fs::perms(0666)) << "the umask's";
  }
  write_file(path("study/later"), "x");
  EXPECT_EQ(fs::status(path("study/later")).permissions(), fs::perms(0666));
  ::umask(before);
}

TEST_F(RegisterTest, ALinkThatLeadsOutOfAFolderIsNamed) {
  fs::create_directory(path("study"));
  fs::create_directory(path("study/own"));
  fs::create_directory_symlink(path("deep"), path("study/beh"));
  fs::create_symlink(path("free"), path("study/journal"));
  fs::create_directory_symlink(path("study/own"), path("study/inside"));
  const auto kept = keep_register();
  const Outputs outputs({{"--out", path("study"), Output::Kind::personal_folder}});
  for (const auto& both : {std::pair("study/beh/log", "study/beh"), {"study/journal", "study/journal"}}) {
    EXPECT_ERROR(write_file(path(both.first), "x"), Exit::failed,
                 path(both.first) + ": is not written, because " + path(both.second) + " is a link that leads out");
  }
  EXPECT_FALSE(fs::exists(path("deep/log")));
  EXPECT_FALSE(fs::exists(path("free")));
  write_file(path("study/inside/log"), "x");
  EXPECT_EQ(test::read_text(path("study/own/log")), "x");
}

TEST_F(RegisterTest, FilesOfPalpasMayBeReadAndWrittenAgain) {
  const auto kept = keep_register();
  const Outputs outputs({{"save as", path("scene")}});
  {
    const Outputs first({{"save as", path("scene2")}});
    write_file(path("scene2"), "x");
  }
  read_file(path("scene2"), 100);
  const Outputs second({{"save as", path("scene2")}});
  write_file(path("scene2"), "y");
  add_own_file(path("settings"));
  write_file(path("settings"), "x");
  read_file(path("settings"), 100);
  write_file(path("settings"), "y");
}

TEST_F(RegisterTest, PalpasOwnFilesAreNoOutputs) {
  const auto kept = keep_register();
  add_own_file(path("input"));
  add_own_file(path("absent"));
  for (const char* name : {"input", "soft", "hard", "absent"})
    EXPECT_NE(refusal({{"--screenshot", path(name)}}).find("is a file of palpa's own"), std::string::npos) << name;
  const Outputs outputs({{"--json", path("new")}});
  EXPECT_CONTAINS(test::error_of([&] { add_own_file(path("deep/../new")); }, Exit::usage),
                  "--json: " + path("new") + " is a file of palpa's own");
}

TEST_F(RegisterTest, TwoOptionsCannotNameOneFile) {
  const Outputs first({{"--json", path("soft")}, {"--csv", path("new")}});
  EXPECT_NE(refusal({{"--events", path("hard")}}).find("--json and --events name the same file"), std::string::npos);
  EXPECT_NE(refusal({{"--events", path("deep/../new")}}).find("name the same file"), std::string::npos);
  EXPECT_NO_THROW(Outputs({{"--json", path("input")}, {"--csv", path("new")}}));
  EXPECT_NO_THROW(Outputs({{"--events", "/dev/null"}, {"--json", "/dev/null"}}));
}

TEST_F(RegisterTest, InputsAreKnownAfterTheyWereMoved) {
  const auto kept = keep_register();
  read_file(path("input"), 100);
  fs::rename(path("input"), path("moved"));
  test::write_text(path("input"), "another");
  refusal({{"--csv", path("moved")}});
  EXPECT_NO_THROW(Outputs({{"--csv", path("input")}})) << "another file, that nobody has read";
}

}  // namespace
}  // namespace palpa
