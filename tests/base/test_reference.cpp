// References between files stay inside the folder of the file that names them, whatever the path consists of.
#include "base/files/reference.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

class ReferenceTest : public testing::Test {
 protected:
  ReferenceTest() {
    fs::create_directories(folder_ / "deep/deeper");
    fs::create_directories(top_ / "scene-of-another");
    write_file(top_ / "secret", "x");
    write_file(folder_ / "beside", "x");
    write_file(folder_ / "deep/below", "x");
    fs::create_symlink("../secret", folder_ / "link-out");
    fs::create_symlink("..", folder_ / "folder-out");
    fs::create_symlink("deep/below", folder_ / "link-in");
    fs::create_symlink(folder_ / "deep", folder_ / "folder-in");
    fs::create_symlink("../link-out", folder_ / "deep/link-to-link");
    fs::create_symlink("../absent", folder_ / "dangling-out");
    fs::create_symlink("scene", top_ / "scene-link");
  }
  ~ReferenceTest() override { allow_outside_references(false); }

  Error fault(const std::string& reference) {
    return test::thrown_by([&] { ReferenceFolder("scene/model.gltf", folder_).find(reference, "buffer 3"); });
  }

  fs::path top_ = test::scratch_folder("reference"), folder_ = top_ / "scene";
};

TEST_F(ReferenceTest, ReferencesWithinTheFolderAreFollowed) {
  for (const char* inside : {"beside", "./beside", "deep/below", "deep/../beside", "deep/deeper/../../beside", "absent",
                             "no/such/file", "link-in", "folder-in/below", "folder-in/../beside", "deep//below"})
    EXPECT_EQ(ReferenceFolder("m", folder_).find(inside, "buffer 0"), folder_ / inside) << inside;
  EXPECT_EQ(ReferenceFolder("m", folder_).find("deep\\below", "x"), folder_ / "deep/below") << "written on Windows";
  // A file of exactly this name is meant, if there is one in the folder; none outside is looked for.
  write_file(folder_ / "deep\\below", "x");
  EXPECT_EQ(ReferenceFolder("m", folder_).find("deep\\below", "x"), folder_ / "deep\\below");
  EXPECT_EQ(ReferenceFolder("m", folder_).find("deep\\no", "x"), folder_ / "deep/no");
  write_file(top_ / "a\\b", "x");
  EXPECT_EQ(ReferenceFolder("m", folder_).find("..\\scene\\beside", "x"), folder_ / "../scene/beside");
  // An absolute name of a file inside, and a folder with another name.
  EXPECT_EQ(ReferenceFolder("m", folder_).find((folder_ / "beside").string(), "x"), folder_ / "beside");
  EXPECT_EQ(ReferenceFolder("m", top_ / "scene-link").find("beside", "x"), top_ / "scene-link/beside");
  EXPECT_NO_THROW(ReferenceFolder("m", top_ / "scene-link/deep/..").find("beside", "x"));
  EXPECT_NO_THROW(ReferenceFolder("m", "").find("beside", "x"));
}

TEST_F(ReferenceTest, ReferencesOutOfTheFolderAreRefused) {
  for (const std::string& outside :
       {std::string("../secret"), std::string("deep/../../secret"), std::string("link-out"),
        std::string("folder-out/secret"), std::string("deep/link-to-link"), std::string("dangling-out"),
        std::string("../scene-of-another/x"), std::string("../absent"), std::string(".."), std::string("deep/../.."),
        std::string("folder-in/../../secret"), std::string("no/../../absent"), std::string("/dev/zero"),
        std::string("/etc/hostname"), std::string("..\\secret"), std::string("../a\\b"),
        std::string("deep\\..\\..\\secret"), (top_ / "secret").string()}) {
    const Error error = fault(outside);
    EXPECT_EQ(error.code(), Exit::bad_input) << outside;
    EXPECT_EQ(std::string(error.what()).rfind("scene/model.gltf: buffer 3: \"" + outside.substr(0, 20), 0), 0u)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("--allow-outside"), std::string::npos) << error.what();
  }
  const std::string there = fault("../secret").what(), not_there = fault("../absent").what();
  EXPECT_EQ(there.substr(there.find("leads")), not_there.substr(not_there.find("leads")))
      << "whether it is there is not told";
}

TEST_F(ReferenceTest, EachReferenceIsJudged) {
  ReferenceFolder references("m", folder_);
  EXPECT_NO_THROW(references.find("beside", "x"));
  EXPECT_REFUSED(references.find("link-out", "x"), "m: x: \"link-out\" leads out");
  EXPECT_NO_THROW(references.find("deep/below", "x"));
  for (int again = 0; again < 2; ++again)
    EXPECT_REFUSED(references.find("folder-out/secret", "x"), "m: x: \"folder-out/secret\" leads out");
}

TEST_F(ReferenceTest, TheUserMayAllowReferencesOutside) {
  allow_outside_references(true);
  EXPECT_EQ(ReferenceFolder("m", folder_).find("../secret", "x"), folder_ / "../secret");
  EXPECT_EQ(ReferenceFolder("m", folder_).find("/dev/zero", "x"), "/dev/zero");
}

}  // namespace
}  // namespace palpa
