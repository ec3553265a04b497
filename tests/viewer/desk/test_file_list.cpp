// The files from which one is chosen.
#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/desk/file_list.hpp"

namespace palpa::viewer {
namespace {

std::vector<std::string> names(const FilePicker& picker) {
  std::vector<std::string> out;
  for (const FilePicker::Entry& entry : picker.entries)
    out.push_back(entry.name + (entry.folder ? "/" : ""));
  return out;
}

TEST(FileList, HasFoldersFirstAndOnlyWhatIsWanted) {
  const auto folder = test::scratch_folder("viewer-file-list");
  std::filesystem::create_directories(folder / "zoo");
  for (const char* name : {"b.glb", "a.gltf", "c.txt", ".hidden.glb"})
    test::write_text(folder / name, "");
  FilePicker picker{.title = "a model", .endings = {".glb", ".gltf"}, .folder = folder.string()};
  list_files(picker);
  EXPECT_EQ(names(picker), (std::vector<std::string>{"zoo/", "a.gltf", "b.glb"}));
  picker.listed.clear();
  picker.folders = true;
  list_files(picker);
  EXPECT_EQ(names(picker), (std::vector<std::string>{"zoo/"}));
  picker.name = "zoo";
  EXPECT_EQ(chosen_file(picker), (folder / "zoo").string());
  EXPECT_EQ(folder_above((folder / "zoo").string()), folder.string());
  picker.folder = (folder / "absent").string();
  list_files(picker);
  EXPECT_FALSE(picker.fault.empty());
}

TEST(FileList, NamesWhatIsBelowTheCurrentFolderBriefly) {
  FilePicker picker{.folder = std::filesystem::current_path().string(), .name = "model.glb"};
  EXPECT_EQ(chosen_file(picker), "model.glb");
}

}  // namespace
}  // namespace palpa::viewer
