#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/locked_bytes.hpp"
#include "base/sha256.hpp"
#include "base/version.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "sweep/hdf5_table.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

class SweepGather : public testing::Test {
 protected:
  fs::path folder_ =
      scratch_folder(std::string("gather-") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path plan_ = folder_ / "plan.toml";
  std::string out_ = folder_ / "out";
  void SetUp() override {
    const std::string layout = "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n";
    write_text(folder_ / "my,layout.toml", layout);
    write_text(plan_,
               "command = \"drive\"\n[options]\nfocus = \"0,0,100mm\"\n[vary]\n"
               "layout = [\"openmpd\", \"my,layout.toml\"]\npressure = [500, \"1kPa\"]\n");
  }
  Result sweep(const std::vector<std::string>& more) const {
    return palpa_here(with({"sweep", plan_.string(), "--out", out_}, more));
  }
};

TEST_F(SweepGather, ResultsThatAreMissingAreToldOrLeftOut) {
  expect_failure(sweep({"--gather", folder_ / "t.csv"}), 1, "has no result of this plan; compute it first");
  sweep({"--backend", "cpu", "--shard", "0/2"});
  expect_failure(sweep({"--gather", folder_ / "t.csv"}), 1,
                 "2 of 4 cases have no result yet; run the sweep again, or give --partial");
  EXPECT_FALSE(fs::exists(folder_ / "t.csv"));
  const Result partial = sweep({"--gather", folder_ / "t.csv", "--partial"});
  EXPECT_EQ(partial.out, "2 rows; 2 without a result\n");
  expect_failure(sweep({"--gather", folder_ / "t.txt"}), 2, "must end in .csv");
  expect_failure(sweep({"--gather", folder_ / "other.csv", "--partial"}), 1,
                 "ro-crate-metadata.json: describes other results than other.csv; gather into another folder");
}

TEST_F(SweepGather, TwoAtATimeAreRefused) {
  sweep({"--backend", "cpu"});
  LockedBytes lock(fs::path(out_) / "gather-lock");
  ASSERT_TRUE(lock.try_lock(0));
  expect_failure(sweep({"--gather", folder_ / "t.csv"}), 1, "another palpa sweep --gather works on it");
  lock.unlock(0);
  EXPECT_EQ(sweep({"--gather", folder_ / "t.csv"}).exit_code, 0);
}

TEST_F(SweepGather, TheProvenanceSaysWhereResultsComeFrom) {
  for (const char* shard : {"0/2", "1/2"})
    sweep({"--backend", "cpu", "--shard", shard});
  fs::create_directory(folder_ / "crate");
  EXPECT_EQ(sweep({"--gather", folder_ / "crate/t.csv"}).out, "4 rows\n");
  const std::string csv = read_text(folder_ / "crate/t.csv");
  EXPECT_NE(csv.find(",\"my,layout.toml\",500,1,"), std::string::npos) << csv;
  EXPECT_EQ(read_text(folder_ / "crate/plan.toml"), read_text(plan_));
  const std::string provenance = read_text(folder_ / "crate/provenance.csv");
  EXPECT_TRUE(provenance.starts_with("id,state,took_s,ended,run,host,device,error\n"));
  EXPECT_NE(provenance.find(",the processor,\n"), std::string::npos);

  const auto crate = nlohmann::json::parse(read_text(folder_ / "crate/ro-crate-metadata.json"));
  EXPECT_EQ(crate["@context"], "https://w3id.org/ro/crate/1.1/context");
  std::map<std::string, nlohmann::json> entities;
  int actions = 0;
  for (const auto& entity : crate["@graph"]) {
    EXPECT_TRUE(entities.emplace(entity["@id"], entity).second) << entity["@id"] << " is there twice";
    actions += entity["@type"] == "CreateAction" ? 1 : 0;
  }
  EXPECT_EQ(actions, 2);
  EXPECT_EQ(entities.at("ro-crate-metadata.json")["about"]["@id"], "./");
  EXPECT_EQ(entities.at("#palpa")["version"], version());
  for (const char* file : {"t.csv", "plan.toml", "provenance.csv"}) {
    EXPECT_EQ(entities.at(file)["sha256"], sha256(read_text(folder_ / "crate" / file))) << file;
    EXPECT_EQ(entities.at(file)["@type"], "File");
  }
  EXPECT_EQ(entities.at("#input-1")["name"], "my,layout.toml");
  EXPECT_EQ(entities.at("#input-1")["sha256"], sha256(read_text(folder_ / "my,layout.toml")));
  // Every reference leads to an entity of the crate, or away from it.
  for (const auto& [id, entity] : entities) {
    for (const auto& [key, value] : entity.items()) {
      const auto check = [&, id = id, key = key](const nlohmann::json& one) {
        if (!one.is_object() || !one.contains("@id")) return;
        const std::string to = one["@id"];
        EXPECT_TRUE(to.starts_with("https://") || entities.contains(to)) << id << " " << key << " " << to;
      };
      if (value.is_array()) {
        for (const auto& one : value)
          check(one);
      } else {
        check(value);
      }
    }
  }
  // The same once more replaces it; inputs and results of the sweep stay unharmed.
  EXPECT_EQ(sweep({"--gather", folder_ / "crate/t.csv"}).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "crate/t.csv"), csv);
  expect_failure(sweep({"--gather", plan_}), 2, "");
}

TEST_F(SweepGather, IntoThePlansOwnFolder) {
  sweep({"--backend", "cpu"});
  const std::string before = read_text(plan_);
  EXPECT_EQ(sweep({"--gather", folder_ / "t.csv"}).exit_code, 0);
  EXPECT_EQ(read_text(plan_), before);
  EXPECT_TRUE(fs::exists(folder_ / "ro-crate-metadata.json"));
}

TEST_F(SweepGather, AnotherPlanIsNotReplaced) {
  const std::string text = read_text(plan_);
  sweep({"--backend", "cpu"});
  // In its own folder, a plan of another name needs no copy. The folder's plan.toml may be another sweep's.
  fs::rename(plan_, folder_ / "mine.toml");
  write_text(plan_, "another plan");
  plan_ = folder_ / "mine.toml";
  for (int times = 0; times < 2; ++times)
    EXPECT_EQ(sweep({"--gather", folder_ / "t.csv"}).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "plan.toml"), "another plan");
  const auto crate = nlohmann::json::parse(read_text(folder_ / "ro-crate-metadata.json"));
  EXPECT_TRUE(std::ranges::any_of(crate["@graph"], [&](const auto& entity) {
    return entity["@id"] == "mine.toml" && entity["sha256"] == sha256(text);
  }));
  // In a folder that is neither the plan's nor the sweep's, plan.toml and provenance.csv may be anybody's.
  for (const char* name : {"plan.toml", "provenance.csv"}) {
    const fs::path elsewhere = folder_ / (std::string("elsewhere-") + name);
    fs::create_directory(elsewhere);
    write_text(elsewhere / name, "mine");
    expect_failure(sweep({"--gather", elsewhere / "t.csv"}), 1,
                   std::string(name) + ": is not of these results, and --gather would replace it");
    EXPECT_EQ(read_text(elsewhere / name), "mine");
    EXPECT_FALSE(fs::exists(elsewhere / "t.csv"));
  }
  // What a full disk left of a crate is replaced.
  fs::create_directory(folder_ / "crate");
  EXPECT_EQ(sweep({"--gather", folder_ / "crate/t.csv"}).exit_code, 0);
  fs::remove(folder_ / "crate/plan.toml");
  EXPECT_EQ(sweep({"--gather", folder_ / "crate/t.csv"}).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "crate/plan.toml"), text);
}

TEST_F(SweepGather, ABrokenLineIsNamed) {
  sweep({"--backend", "cpu"});
  fs::path lines;
  for (const auto& entry : fs::recursive_directory_iterator(out_)) {
    if (entry.path().filename() == "cases.jsonl") lines = entry.path();
  }
  const std::string whole = read_text(lines);
  for (const char* broken : {"\"results\":[", "\"took_s\":\"\",\"x\":"}) {
    std::string text = whole;
    const std::string key = std::string(broken).substr(0, std::string(broken).find(':') + 1);
    text.replace(text.find(key), key.size(), broken);
    write_text(lines, text);
    expect_failure(sweep({"--gather", folder_ / "t.csv"}), 1,
                   lines.string() + ": the line of the case " + whole.substr(7, 20) + " is broken; remove it");
  }
  write_text(lines, whole.substr(whole.find('\n') + 1));
  EXPECT_NE(sweep({"--backend", "cpu"}).out.find("4 cases: 1 computed"), std::string::npos);
  EXPECT_EQ(sweep({"--gather", folder_ / "t.csv"}).exit_code, 0);
}

TEST_F(SweepGather, Hdf5HasTheSameBytesForTheSameResults) {
  sweep({"--backend", "cpu"});
  const std::string file = folder_ / "t.h5";
  if (!sweep::has_hdf5()) {
    expect_failure(sweep({"--gather", file}), 2, "this palpa was built without HDF5");
    return;
  }
  EXPECT_EQ(sweep({"--gather", file}).exit_code, 0);
  const std::string bytes = read_text(file);
  EXPECT_TRUE(bytes.starts_with("\x89HDF\r\n\x1a\n"));
  for (const char* column : {"id", "layout", "pressure", "pressures_pa.min", "state"})
    EXPECT_NE(bytes.find(column), std::string::npos) << column;
  out_ = folder_ / "again";
  for (const char* shard : {"0/2", "1/2"})
    sweep({"--backend", "cpu", "--shard", shard});
  EXPECT_EQ(sweep({"--gather", file}).exit_code, 0);
  EXPECT_EQ(read_text(file), bytes);
}

}  // namespace
}  // namespace palpa::test
