// The files from which one is chosen.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer/panel_data/file_list.hpp"

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

TEST(FileList, ARecordingIsNoFolderToEnter) {
  const auto folder = test::scratch_folder("viewer-file-list-recording");
  std::filesystem::create_directories(folder / "take");
  std::filesystem::create_directories(folder / "empty");
  test::write_text(folder / "take" / "recording.toml", "");
  FilePicker picker = picker_to_open({});
  picker.folder = folder.string();
  list_files(picker);
  ASSERT_EQ(picker.entries.size(), 2u);
  EXPECT_FALSE(picker.entries[0].recording);
  EXPECT_TRUE(picker.entries[1].recording) << picker.entries[1].name;
  for (const char* name : {"take", "empty", "absent", ""}) {
    picker.name = name;
    EXPECT_EQ(is_folder_to_enter(picker), picker.name == "empty") << name;
  }
  picker.name = "take";
  picker.is_new = true;
  EXPECT_TRUE(is_folder_to_enter(picker)) << "a new file in it";
  picker.folders = true;
  EXPECT_FALSE(is_folder_to_enter(picker));
}

TEST(FileList, UsualFoldersExistAndAreDifferentAndTheCurrentOneIsNamedBriefly) {
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(chosen_file({.folder = here, .name = "model.glb"}), "model.glb");
  const std::vector<NamedFolder> folders = starting_folders(here);
  ASSERT_FALSE(folders.empty());
  EXPECT_EQ(folders.front().folder, here);
  for (const NamedFolder& place : folders) {
    EXPECT_TRUE(std::filesystem::is_directory(place.folder)) << place.folder;
    EXPECT_EQ(std::ranges::count(folders, place.folder, &NamedFolder::folder), 1) << place.name;
  }
}

}  // namespace
}  // namespace palpa::viewer
