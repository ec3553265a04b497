// Drives as files: what is written is read back, and each fault is named with its line.
#include "setup/files/drive_file.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::setup {
namespace {

class DriveFile : public testing::Test {
 protected:
  const array::Layout layout_ = array::load_layout("autd3");
  const std::filesystem::path file_ = test::scratch_folder("drive-file") / "d.csv";
  const array::Drive drive_ = [this] {
    array::Drive drive;
    for (std::size_t i = 0; i < layout_.transducers.size(); ++i)
      drive.push_back({static_cast<float>(i % 4) / 3, static_cast<float>(i) - 100});
    return drive;
  }();

  array::Drive read(const std::string& text) const {
    test::write_text(file_, text);
    return load_drive(file_, layout_);
  }
  /// The file with another cell in the row of a transducer.
  std::string with(std::size_t transducer, std::size_t column, const std::string& cell) const {
    std::string text = drive_csv(layout_, drive_);
    std::size_t at = text.find("\n" + std::to_string(transducer) + ",") + 1;
    for (; column > 0; --column)
      at = text.find(',', at) + 1;
    return text.replace(at, text.find_first_of(",\n", at) - at, cell);
  }
};

TEST_F(DriveFile, IsReadBack) {
  const array::Drive back = read(drive_csv(layout_, drive_));
  ASSERT_EQ(back.size(), drive_.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].amplitude, drive_[i].amplitude) << i;
    EXPECT_EQ(back[i].phase, drive_[i].phase) << i;
  }
  EXPECT_EQ(read(with(7, 7, "0"))[7].amplitude, 0);
  EXPECT_EQ(read(with(7, 7, "1"))[7].amplitude, 1);
  // What numpy's abs often is for a unit phasor, in double and in single precision.
  for (const char* const one : {"1.0000000000000002", "1.00000024", "1.000001"})
    EXPECT_EQ(read(with(7, 7, one))[7].amplitude, 1) << one;
}

TEST_F(DriveFile, FaultsAreNamedWithTheirLine) {
  std::string short_by_one = drive_csv(layout_, drive_);
  short_by_one.resize(short_by_one.rfind("\n248,") + 1);
  const std::vector<std::pair<std::string, std::string>> faults{
      {with(9, 7, "-0.25"), "d.csv: line 11: amplitude -0.25 is not within 0..1"},
      {with(9, 7, "1.5"), "line 11: amplitude 1.5 is not within 0..1"},
      {with(9, 7, "1.00001"), "line 11: amplitude 1.00001 is not within 0..1"},
      {with(9, 7, "nan"), "line 11: "},
      {with(9, 8, "7e6"), "line 11: phase 7000000 is more than a million turns"},
      {with(9, 8, "1,2"), "line 11: "},
      {with(0, 3, "x"), "line 2: "},
      {with(3, 0, "4"), "line 5: expected transducer 3, found 4"},
      {with(3, 1, "0.5"), "line 5: the drive belongs to another layout than autd3: transducer 3 is at (0.5, "},
      {with(3, 6, "-1"), "line 5: the drive belongs to another layout than autd3: transducer 3 points along "},
      {short_by_one, "it has 248 transducers, but autd3 has 249"},
      {"index,x\n", "is not a drive: its first line is not index,x,y,z"},
      {"", "d.csv: is empty"}};
  for (const auto& each : faults)
    EXPECT_REFUSED(read(each.first), each.second);
}

}  // namespace
}  // namespace palpa::setup
