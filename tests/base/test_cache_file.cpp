// The cache returns only what was stored, whatever has happened to its files.
#include "base/files/cache_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <thread>

#include "support/shared_data.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

class Cache : public ::testing::Test {
 protected:
  Cache() : folder_(test::scratch_folder("cache")) {
    unsetenv("PALPA_CACHE");
    setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
    std::iota(numbers_.begin(), numbers_.end(), 7U);
  }
  ~Cache() override {
    unsetenv("XDG_CACHE_HOME");
    setenv("PALPA_CACHE", "off", 1);
  }

  void store() const {
    const std::array<std::span<const std::byte>, 3> sections{
        std::as_bytes(std::span(numbers_)), std::span<const std::byte>(), std::as_bytes(std::span(text_))};
    store_cached("test", key_, sections);
  }
  bool is_whole() const {
    const auto file = load_cached("test", key_);
    if (!file) return false;
    EXPECT_EQ(file->sections.size(), 3U);
    const auto numbers = file->section_as<std::uint32_t>(0);
    EXPECT_TRUE(std::equal(numbers.begin(), numbers.end(), numbers_.begin(), numbers_.end()));
    EXPECT_EQ(file->sections[1].size(), 0U);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(file->sections[2].data()) % 64, 0U);
    EXPECT_TRUE(file->section_as<std::uint32_t>(2).empty());
    EXPECT_EQ(std::string(file->section_as<char>(2).begin(), file->section_as<char>(2).end()), "odd length!");
    return true;
  }
  fs::path only_file() const {
    fs::path found;
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "palpa")) {
      found = entry.path();
      ++count;
    }
    EXPECT_EQ(count, 1);
    return found;
  }

  fs::path folder_;
  CacheKey key_{1, 0xfedcba9876543210};
  std::vector<std::uint32_t> numbers_ = std::vector<std::uint32_t>(1000);
  std::string text_ = "odd length!";
};

TEST_F(Cache, GivesBackWhatWasStored) {
  EXPECT_FALSE(is_whole());
  store();
  EXPECT_TRUE(is_whole());
  EXPECT_EQ(load_cached("test", {2, 0}), nullptr);
  EXPECT_EQ(load_cached("other", key_), nullptr);
  only_file();
}

TEST_F(Cache, IgnoresTruncatedAndDamagedFiles) {
  store();
  const fs::path path = only_file();
  std::ifstream in(path, std::ios::binary);
  const std::string good((std::istreambuf_iterator<char>(in)), {});
  const auto write = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  };
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{63}, std::size_t{64}, std::size_t{100}, good.size() - 1}) {
    write(good.substr(0, size));
    EXPECT_FALSE(is_whole()) << size;
  }
  write(good + "x");
  EXPECT_FALSE(is_whole());
  for (std::size_t at = 0; at < good.size(); at += at < 200 ? 1 : 97) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    write(bad);
    EXPECT_FALSE(is_whole()) << at;
  }
  store();
  EXPECT_TRUE(is_whole());
}

TEST_F(Cache, IgnoresWhatIsNoFile) {
  store();
  const fs::path path = only_file();
  fs::remove(path);
  fs::create_directory(path);
  EXPECT_FALSE(is_whole());
  store();  // fails, and reports it at the debug level only
  fs::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_FALSE(is_whole());
}

TEST_F(Cache, CanBeOffOrHaveNoPlace) {
  setenv("PALPA_CACHE", "off", 1);
  store();
  EXPECT_FALSE(is_whole());
  unsetenv("PALPA_CACHE");
  EXPECT_FALSE(is_whole());
  std::ofstream(folder_ / "file") << "not a folder";
  setenv("XDG_CACHE_HOME", (folder_ / "file").c_str(), 1);
  store();
  EXPECT_FALSE(is_whole());
}

TEST_F(Cache, IsSafeAgainstManyWriters) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k) {
        store();
        EXPECT_TRUE(is_whole());
      }
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  only_file();
}

TEST(CacheHash, TellsApart) {
  const auto key = [](std::string_view a, std::string_view b) {
    CacheHash hash;
    hash.add(a.data(), a.size());
    hash.add(b.data(), b.size());
    return hash.key();
  };
  EXPECT_EQ(key("ab", "c"), key("ab", "c"));
  EXPECT_NE(key("ab", "c"), key("a", "bc"));
  EXPECT_NE(key("ab", "c"), key("ab", "d"));
  EXPECT_NE(key("ab", "c"), key("c", "ab"));
}

}  // namespace
}  // namespace palpa
