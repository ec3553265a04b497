// Complete files: a reader gets the old one or the new one, whatever happens in between.
#include "base/files/output_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include <fstream>
#include <string>
#include <thread>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "support/file_size_limit.hpp"
#include "support/ordinary_user.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  fs::path folder_ = test::scratch_folder("output");
  fs::path file_ = folder_ / "out";

  std::string contents(const fs::path& file) const { return read_file(file, 1 << 20); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  mode_t mode(const fs::path& file) const {
    struct stat status {};
    EXPECT_EQ(stat(file.c_str(), &status), 0);
    return status.st_mode & 07777;
  }
};

TEST_F(OutputFileTest, IsThereWholeOrNotAtAll) {
  {
    OutputFile out(file_);
    out.write("some");
    out.write(std::string(1 << 18, 'x'));
    EXPECT_FALSE(fs::exists(file_));
  }
  EXPECT_EQ(files(), 0u);
  write_file(file_, "old");
  {
    OutputFile out(file_);
    out.write("new");
    EXPECT_EQ(contents(file_), "old");
    out.finish();
    EXPECT_EQ(contents(file_), "new");
  }
  write_file(file_, "a" + std::string(1 << 18, 'x') + "b");
  EXPECT_EQ(contents(file_), "a" + std::string(1 << 18, 'x') + "b");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, AFullDiskLeavesWhatWas) {
  write_file(file_, "old");
  const test::FileSizeLimit limit(100'000);
  for (const fs::path& file : {file_, folder_ / "new"}) {
    const Error error = test::thrown_by([&] { write_file(file, std::string(200'000, 'x')); });
    EXPECT_EQ(error.code(), Exit::failed);
    EXPECT_EQ(error.what(), file.string() + ": cannot be written: File too large");
  }
  EXPECT_EQ(contents(file_), "old");
  EXPECT_EQ(files(), 1u);
  EXPECT_STREQ(test::thrown_by([] { write_file("/dev/full", "x"); }).what(),
               "/dev/full: cannot be written: No space left on device");
}

TEST_F(OutputFileTest, AFileThatCannotGrowEndsWithItsLastWholeRecord) {
  const OpenFile out = open_output(file_);
  out.write("one\n");
  {
    const test::FileSizeLimit limit(6);
    EXPECT_STREQ(test::thrown_by([&] { out.write("three\n"); }).what(),
                 (file_.string() + ": cannot be written: File too large").c_str());
  }
  EXPECT_EQ(contents(file_), "one\n");
  out.write("four\n");
  EXPECT_EQ(contents(file_), "one\nfour\n");
}

TEST_F(OutputFileTest, KeepsTheModeOfWhatItReplaces) {
  const mode_t mask = umask(027);
  write_file(file_, "x");
  EXPECT_EQ(mode(file_), 0640u);
  chmod(file_.c_str(), 0604);
  write_file(file_, "y");
  EXPECT_EQ(mode(file_), 0604u);
  umask(mask);
}

TEST_F(OutputFileTest, AFileWithSeveralNamesKeepsThem) {
  write_file(file_, std::string(100'000, 'o'));
  fs::create_hard_link(file_, folder_ / "second");
  {
    OutputFile out(file_);
    out.write(std::string(200'000, 'x'));
    EXPECT_EQ(contents(folder_ / "second"), std::string(100'000, 'o'));
  }
  EXPECT_EQ(contents(file_), std::string(100'000, 'o'));
  write_file(file_, std::string(70'000, 'n'));
  EXPECT_EQ(contents(folder_ / "second"), std::string(70'000, 'n'));
  EXPECT_EQ(fs::hard_link_count(file_), 2u);
  EXPECT_EQ(files(), 2u);
}

TEST_F(OutputFileTest, AMountPointIsWrittenAsAnyFile) {
  write_file(file_, "old and long");
  write_file(folder_ / "below", "below");
  if (::mount(file_.c_str(), (folder_ / "below").c_str(), nullptr, MS_BIND, nullptr) != 0) {
    GTEST_SKIP() << "skipped: this needs the right to mount";
  }
  std::string told;
  try {
    write_file(folder_ / "below", "new");
  } catch (const Error& error) {
    told = error.what();
  }
  const std::string seen = contents(file_);
  ::umount((folder_ / "below").c_str());
  EXPECT_EQ(told, "");
  EXPECT_EQ(seen, "new");
  EXPECT_EQ(contents(folder_ / "below"), "below");
  EXPECT_EQ(files(), 2u);
}

TEST_F(OutputFileTest, AKilledProgramLeavesNothingBehind) {
  write_file(file_, "old");
  for (const fs::path& file : {file_, folder_ / "new"}) {
    const pid_t child = fork();
    if (child == 0) {
      OutputFile out(file);
      out.write(std::string(1 << 18, 'x'));
      ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
  }
  EXPECT_EQ(contents(file_), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, KeepsTheGroupOfWhatItReplaces) {
  write_file(file_, "x");
  constexpr gid_t another = 12345;
  if (::chown(file_.c_str(), static_cast<uid_t>(-1), another) != 0) GTEST_SKIP() << "skipped: this needs root";
  write_file(file_, "y");
  struct stat status {};
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_gid, another);
  EXPECT_EQ(contents(file_), "y");
}

TEST_F(OutputFileTest, FollowsLinks) {
  fs::create_directory(folder_ / "deep");
  fs::create_symlink("deep/file", folder_ / "first");
  fs::create_symlink(folder_ / "first", file_);
  write_file(file_, "nothing was there");
  EXPECT_EQ(contents(folder_ / "deep/file"), "nothing was there");
  write_file(file_, "something was");
  EXPECT_EQ(contents(folder_ / "deep/file"), "something was");
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_TRUE(fs::is_symlink(folder_ / "first"));
  fs::create_symlink("round", folder_ / "round");
  EXPECT_NE(std::string(test::thrown_by([&] { write_file(folder_ / "round", "x"); }).what()).find("symbolic links"),
            std::string::npos);
}

TEST_F(OutputFileTest, WritesPipesAndDevicesWhereTheyStand) {
  write_file("/dev/null", "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] {
    std::ifstream in(file_, std::ios::binary);
    read.assign(std::istreambuf_iterator<char>(in), {});
  });
  write_file(file_, std::string(300'000, 'x'));
  reader.join();
  EXPECT_EQ(read, std::string(300'000, 'x'));
  EXPECT_TRUE(fs::is_fifo(file_));
}

TEST_F(OutputFileTest, AppendsToWhatIsOpenAlready) {
  const int open_file = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(open_file, 0);
  const std::string behind = "/proc/self/fd/" + std::to_string(open_file);
  write_file(behind, "x");
  char read = 0;
  EXPECT_EQ(pread(open_file, &read, 1, 0), 1) << "another file took its place";
  EXPECT_EQ(read, 'x');
  close(open_file);
}

TEST_F(OutputFileTest, RefusesWhatCannotBeWrittenBeforeAnythingIs) {
  const auto fault = [](const fs::path& file) {
    const Error error = test::thrown_by([&] { writable_place(file); });
    EXPECT_EQ(error.code(), Exit::failed) << file;
    return std::string(error.what());
  };
  EXPECT_EQ(fault(folder_), folder_.string() + ": cannot be written: Is a directory");
  EXPECT_EQ(fault(folder_ / "absent" / "x"),
            (folder_ / "absent/x").string() + ": cannot be written: No such file or directory");
  write_file(file_, "x");
  EXPECT_NE(fault(file_ / "x").find("Not a directory"), std::string::npos);
  EXPECT_NE(fault(folder_ / "x/"), "");
  EXPECT_EQ(test::thrown_by([&] { writable_place(file_); }).code(), Exit::ok);
  EXPECT_EQ(test::thrown_by([&] { writable_place(folder_ / "new"); }).code(), Exit::ok);
  EXPECT_EQ(test::thrown_by([] { writable_place("-"); }).code(), Exit::ok);
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, AnOrdinaryUserIsToldOfRightsThatAreMissing) {
  write_file(file_, "x");
  fs::create_directory(folder_ / "closed");
  chmod(file_.c_str(), 0444);
  chmod((folder_ / "closed").c_str(), 0);
  chmod(folder_.c_str(), 0555);
  {
    const test::OrdinaryUser user;
    for (const fs::path& file : {file_, folder_ / "new", folder_ / "closed/new"}) {
      const Error refused = test::thrown_by([&] { writable_place(file); });
      EXPECT_EQ(refused.what(), file.string() + ": cannot be written: Permission denied");
      const Error failed = test::thrown_by([&] { write_file(file, "y"); });
      EXPECT_EQ(failed.what(), file.string() + ": cannot be written: Permission denied");
    }
  }
  chmod(folder_.c_str(), 0755);
  chmod((folder_ / "closed").c_str(), 0755);  // an ordinary user may have to remove it
}

TEST_F(OutputFileTest, KnowsAFileByEveryName) {
  write_file(file_, "x");
  fs::create_symlink("out", folder_ / "soft");
  fs::create_hard_link(file_, folder_ / "hard");
  const OutputPlace place = writable_place(file_);
  EXPECT_EQ(place.type, fs::file_type::regular);
  EXPECT_EQ(writable_place(folder_ / "soft").identity, place.identity);
  EXPECT_EQ(writable_place(folder_ / "hard").identity, place.identity);
  EXPECT_NE(writable_place(folder_ / "other").identity, place.identity);
}

}  // namespace
}  // namespace palpa
