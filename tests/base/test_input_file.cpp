#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "support/ordinary_user.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

std::filesystem::path file_with(const std::string& name, const std::string& text) {
  static const std::filesystem::path folder = test::scratch_folder("input_file");
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

/// The error of the file, without its name.
std::string fault_of(const std::filesystem::path& path, std::uint64_t most_bytes = InputFile::any_size) {
  const std::string line = test::error_of([&] { const InputFile file(path, most_bytes); });
  if (line.empty()) return "accepted";
  EXPECT_TRUE(line.starts_with(path.string() + ": ")) << line;
  return line.substr(path.string().size() + 2);
}

TEST(InputFile, RefusesWhatIsNoFile) {
  const std::filesystem::path folder = file_with("any", "x").parent_path();
  EXPECT_EQ(fault_of(folder / "absent"), "no such file");
  EXPECT_EQ(fault_of(folder / "any" / "below"), "cannot be opened: Not a directory");
  EXPECT_EQ(fault_of(folder), "is a folder, a file is needed");
  EXPECT_EQ(fault_of("/dev/zero"), "is not a regular file");
  EXPECT_EQ(fault_of(file_with("empty", "")), "is empty");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(fault_of(folder / "pipe"), "is not a regular file");  // and it does not wait for a writer
  std::filesystem::create_symlink(folder / "loop", folder / "loop");
  EXPECT_EQ(fault_of(folder / "loop"), "cannot be opened: Too many levels of symbolic links");
  const auto secret = file_with("secret", "x");
  std::filesystem::permissions(secret, std::filesystem::perms::none);
  const test::OrdinaryUser user;
  EXPECT_EQ(fault_of(secret), "cannot be opened: Permission denied");
}

TEST(InputFile, ATextMayBeginWithAByteOrderMark) {
  EXPECT_EQ(read_text_file(file_with("marked",
                                     "\xef\xbb\xbf"
                                     "a,b\n"),
                           100),
            "a,b\n");
  EXPECT_EQ(read_text_file(file_with("plain", "a,b\n"), 100), "a,b\n");
  const auto wide = file_with("wide", std::string("\xff\xfe"
                                                  "a\0",
                                                  4));
  EXPECT_EQ(test::error_of([&] { read_text_file(wide, 100); }),
            wide.string() + ": is text in UTF-16; save it as UTF-8");
}

TEST(InputFile, TextInUtf16IsKnownWithoutAMark) {
  using namespace std::string_view_literals;
  for (const std::string_view bytes : {"{\0\"\0a\0"sv, "\0{\0\"\0a"sv, "\xff\xfe{\0"sv, "\xfe\xff\0{"sv})
    EXPECT_REFUSED(text_in(bytes, "a.json"), "a.json: is text in UTF-16; save it as UTF-8");
  for (const std::string_view bytes : {""sv, "{"sv, "{}"sv, "ab\0\0"sv, "\0\0\0\1"sv, "\x80\0\x80\0"sv, "\xc3\xa4"sv})
    EXPECT_EQ(text_in(bytes, "a"), bytes);
}

TEST(InputFile, RefusesWhatIsTooLarge) {
  const auto file = file_with("five", "12345");
  EXPECT_EQ(fault_of(file, 5), "accepted");
  EXPECT_EQ(fault_of(file, 4), "has 5 bytes, at most 4 are expected");
  EXPECT_EQ(read_file(file, 5), "12345");
  EXPECT_REFUSED(read_file(file, 4), "has 5 bytes, at most 4");
}

TEST(InputFile, ReadsAnyPart) {
  const std::string text("a\0b\ncdef", 8);
  const InputFile file(file_with("text", text));
  EXPECT_EQ(file.size(), 8u);
  EXPECT_EQ(file.head(3), text.substr(0, 3));
  EXPECT_EQ(file.head(100), text);
  std::array<unsigned char, 3> part{};
  file.read_at(5, part);
  EXPECT_EQ(part, (std::array<unsigned char, 3>{'d', 'e', 'f'}));
  EXPECT_REFUSED(file.read_at(6, part), "ends after 8 bytes");
}

TEST(InputFile, NoticesThatItsFileShrank) {
  const auto path = file_with("shrinking", std::string(100, 'x'));
  const InputFile file(path);
  std::filesystem::resize_file(path, 40);
  EXPECT_EQ(test::error_of([&] { file.head(100); }),
            path.string() + ": ends after 40 bytes, in the middle of its data");
}

TEST(InputFile, MovesItsDescriptorAlong) {
  InputFile first(file_with("moved", "xyz"));
  const InputFile second(std::move(first));
  EXPECT_EQ(second.head(3), "xyz");
  EXPECT_TRUE(second.name().ends_with("moved"));
}

}  // namespace
}  // namespace palpa
