#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "base/files/sha256.hpp"
#include "base/version.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

TEST(Sha256, ThePublishedExamples) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, OfAFileInPieces) {
  const std::filesystem::path file = test::scratch_folder("sha256") / "file";
  const std::string text((3U << 20) + 17, 'x');
  test::write_text(file, text);
  EXPECT_EQ(sha256_of_file(file), sha256(text));
  EXPECT_REFUSED(sha256_of_file(file.string() + "-none"), "file-none");
}

TEST(Version, SaysWhatWasBuilt) {
  EXPECT_EQ(version_and_commit().rfind(version(), 0), 0u);
  const std::string about = about_program("palpa");
  EXPECT_EQ(about.rfind("palpa " + version() + "\n", 0), 0u);
  for (const char* part :
       {"\ncommit: ", "\nbuilt with: ", "\nfeatures: ", "librealsense2", "\nlibraries: CLI11 ", ", fmt "})
    EXPECT_NE(about.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace palpa
