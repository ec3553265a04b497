// `palpa drive` within this process, with all that it gives.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

struct Driven {
  std::string table;  ///< --csv, as it is
  std::vector<std::vector<double>> rows;
  nlohmann::json report;  ///< --json
  std::string told;       ///< the summary
};

/// Expects success without a warning.
inline Driven drive_here(const std::vector<std::string>& arguments, const std::string& backend = "cpu") {
  static const std::filesystem::path folder = scratch_folder("drive-here");
  const std::string csv = folder / "drive.csv", report = folder / "drive.json";
  const Result result =
      succeeded(palpa_here(with({"drive", "--backend", backend, "--csv", csv, "--json", report}, arguments)));
  EXPECT_EQ(result.err, "") << testing::PrintToString(arguments);
  const std::string table = read_text(csv);
  EXPECT_TRUE(table.starts_with("index,x,y,z,nx,ny,nz,amplitude,phase\n0,")) << table.substr(0, 80);
  return {table, read_csv(csv), nlohmann::json::parse(read_text(report)), result.out};
}

}  // namespace palpa::test
