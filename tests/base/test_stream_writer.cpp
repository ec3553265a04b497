#include "base/files/stream_writer.hpp"

#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "support/begins.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

/// On the pipe of a test, which closes its own descriptor.
StreamWriter writer_on(int pipe, std::size_t room) {
  return {OpenFile("a pipe", ::dup(pipe)), room};
}

StreamWriter writer_of(const std::string& file) {
  return {open_output(file), 1 << 16};
}

/// What comes out of a pipe until its other end is closed.
std::string read_all(int pipe) {
  std::string text;
  std::array<char, 1000> block;
  for (ssize_t got; (got = read(pipe, block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<std::size_t>(got));
  return text;
}

/// Lines of many lengths, each of one letter.
std::string lines_of(char letter, int count) {
  std::string text;
  for (int n = 0; n < count; ++n)
    text += std::string(static_cast<std::size_t>(1 + n * 37 % 900), letter) + '\n';
  return text;
}

TEST(StreamWriter, AForkedProcessDoesNotWaitForAThreadThatItDoesNotHave) {
  const std::filesystem::path file = test::scratch_folder("stream_writer_fork") / "file";
  {
    StreamWriter writer = writer_of(file);
    EXPECT_TRUE(writer.add("a\n"));
    EXPECT_TRUE(writer.flush());
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::alarm(5);  // it would wait for the disk for ten seconds
      const bool idle = !writer.add("lost\n", {.seconds = 20}) && !writer.flush() && writer.waiting() == 0;
      writer.close();
      ::_exit(idle ? 7 : 8);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 7);
    EXPECT_TRUE(writer.add("b\n"));
    EXPECT_TRUE(writer.flush());
  }
  EXPECT_EQ(test::read_text(file), "a\nb\n");
}

TEST(StreamWriter, LinesOfTwoOnOnePipeStayWhole) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  constexpr int count = 2000;
  std::string read_back;
  std::thread reader([&] { read_back = read_all(ends[0]); });
  {
    StreamWriter a = writer_on(ends[1], 1 << 21), b = writer_on(ends[1], 1 << 21);
    // All waiting lines are taken at once: many lines together, and more than a pipe holds.
    for (auto* const writer : {&a, &b}) {
      std::istringstream lines(lines_of(writer == &a ? 'a' : 'b', count));
      for (std::string line; std::getline(lines, line);)
        ASSERT_TRUE(writer->add(line + '\n'));
    }
    EXPECT_TRUE(a.flush({.seconds = 10}));
    EXPECT_TRUE(b.flush({.seconds = 10}));
  }
  close(ends[1]);
  reader.join();
  close(ends[0]);
  std::string of_a, of_b;
  std::istringstream lines(read_back);
  for (std::string line; std::getline(lines, line);) {
    ASSERT_EQ(std::set<char>(line.begin(), line.end()).size(), 1u) << "torn or glued: " << line;
    (line[0] == 'a' ? of_a : of_b) += line + '\n';
  }
  EXPECT_TRUE(of_a == lines_of('a', count));
  EXPECT_TRUE(of_b == lines_of('b', count));
}

TEST(StreamWriter, LinesThatNobodyReadsStayWhole) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  std::string line(1000, 'x');
  line.back() = '\n';
  {
    StreamWriter writer = writer_on(ends[1], 1 << 20);
    for (int n = 0; n < 200; ++n)
      ASSERT_TRUE(writer.add(line));
    const auto held = [&] {
      int bytes = 0;
      ioctl(ends[0], FIONREAD, &bytes);
      return bytes;
    };
    EXPECT_TRUE(test::begins([&] { return held() > 50'000; }));
    EXPECT_FALSE(writer.flush({.seconds = 0.1}));
  }
  close(ends[1]);
  const std::size_t size = read_all(ends[0]).size();
  close(ends[0]);
  EXPECT_GT(size, 50'000u);
  EXPECT_EQ(size % line.size(), 0u);
}

// A recording of drives that cannot grow must leave the array silent.
TEST(StreamWriter, AFileThatCannotGrowEndsWithAWholeRecordInZeros) {
  const std::string file = test::scratch_folder("zeros") / "stream";
  const test::FileSizeLimit limit(25);
  StreamWriter writer = writer_of(file);
  writer.end_in_zeros(4);
  for (const char letter : {'a', 'b'}) {
    ASSERT_TRUE(writer.add(std::string(10, letter)));
    ASSERT_TRUE(writer.flush({.seconds = 10}));
  }
  ASSERT_TRUE(writer.add(std::string(10, 'c')));
  EXPECT_ERROR(writer.flush({.seconds = 10}), Exit::failed, "cannot be written");
  EXPECT_EQ(test::read_text(file), std::string(10, 'a') + std::string(6, 'b') + std::string(4, '\0'));
}

/// The message for a second writer of the file; empty if it may write.
std::string second_writer(const std::string& file) {
  return test::error_of([&] { writer_of(file); }, Exit::usage);
}

TEST(StreamWriter, AFileHasOneWriterAtATime) {
  const std::string file = test::scratch_folder("one-writer") / "stream.txt";
  {
    StreamWriter first = writer_of(file);
    ASSERT_TRUE(first.add("kept\n"));
    ASSERT_TRUE(first.flush({.seconds = 10}));
    EXPECT_EQ(second_writer(file), file + ": another palpa is writing this file; wait until it has ended");
    // The same file under another name, and in another process.
    std::filesystem::create_hard_link(file, file + ".link");
    EXPECT_NE(second_writer(file + ".link"), "");
    const pid_t child = fork();
    if (child == 0) _exit(second_writer(file).empty() ? 1 : 0);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_ERROR(open_to_append(file), Exit::usage, "another palpa is writing this file");
    EXPECT_EQ(test::read_text(file), "kept\n") << "a refused writer has emptied it";
  }
  EXPECT_NO_THROW(open_to_append(file));
  EXPECT_EQ(second_writer(file), "");
  EXPECT_EQ(test::read_text(file), "");
}

}  // namespace
}  // namespace palpa
