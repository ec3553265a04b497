#include "sensing/recording.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <string>
#include <thread>

#include "base/files/reference.hpp"
#include "random_rig.hpp"
#include "sensing/grey_png.hpp"
#include "support/bits.hpp"
#include "support/captured.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

namespace fs = std::filesystem;

fs::path fresh(const std::string& name) {
  fs::path folder = test::scratch_folder("recording-" + name);
  fs::remove_all(folder);
  return folder;
}

struct Take {
  std::vector<Camera> cameras;
  std::vector<FrameSet> sets;
};

Take random_take(std::uint64_t seed, int frames) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Take take;
  for (int i = 0; i < 2; ++i)
    take.cameras.push_back(test::random_file_camera(random));
  for (int i = 0; i < frames; ++i) {
    FrameSet set;
    set.sequence = 5 + 3 * static_cast<std::uint64_t>(i);
    for (const Camera& camera : take.cameras) {
      set.frames.push_back(test::random_frame(random, camera));
      set.frames.back().time_s = 1e5 + i / 90.0 + 0.001 * unit(random);
    }
    set.time_s = std::min(set.frames[0].time_s, set.frames[1].time_s);
    take.sets.push_back(std::move(set));
  }
  return take;
}

void write(const fs::path& folder, const Take& take) {
  RecordingWriter writer(folder, take.cameras);
  for (const FrameSet& set : take.sets)
    writer.write(set);
  EXPECT_EQ(writer.frames(), take.sets.size());
}

void expect_same(const FrameSet& a, const FrameSet& b) {
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_TRUE(test::same_bits(a.time_s, b.time_s));
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].depth, b.frames[i].depth);
    EXPECT_TRUE(test::same_bits(a.frames[i].time_s, b.frames[i].time_s));
  }
}

TEST(Recording, ReadsBackBitForBit) {
  const fs::path folder = fresh("round");
  const Take take = random_take(1, 12);
  write(folder, take);
  const auto source = make_replay(load_recording(folder), {.paced = false});
  ASSERT_EQ(source->cameras().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const Camera &a = take.cameras[i], &b = source->cameras()[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.width, b.width);
    EXPECT_TRUE(test::same_bits(a.T_world_camera, b.T_world_camera));
    EXPECT_TRUE(test::same_bits(a.distortion, b.distortion));
    EXPECT_EQ(a.depth_unit_m, b.depth_unit_m);
  }
  FrameSet set;
  for (const FrameSet& wanted : take.sets) {
    ASSERT_TRUE(source->next(set, 1));
    expect_same(wanted, set);
  }
  EXPECT_FALSE(source->next(set, 1));
  EXPECT_FALSE(source->next(set, 1));
}

TEST(Recording, KeepsWhatItsCamerasIgnore) {
  const fs::path folder = fresh("mask");
  Take take = random_take(4, 2);
  Camera &left = take.cameras[0], &right = take.cameras[1];
  left.roi = {1, 0, left.width, left.height};
  std::vector<std::uint8_t> pixels(pixel_count(right), 255);
  pixels.back() = 0;
  right.mask = std::make_shared<Mask>(Mask{"/somewhere/else.png", pixels});
  left.background = std::make_shared<Background>(
      Background{"/somewhere/empty.png", std::vector<std::uint16_t>(pixel_count(left), 4321), 0.0035});
  write(folder, take);
  const Recording back = load_recording(folder);
  ASSERT_TRUE(back.cameras[0].roi && back.cameras[1].mask && back.cameras[0].background);
  EXPECT_EQ(back.cameras[0].background->depth, left.background->depth);
  EXPECT_EQ(back.cameras[0].background->margin_m, 0.0035);
  EXPECT_EQ(back.cameras[0].background->file, fs::absolute(folder / "background-0.png").string());
  EXPECT_EQ(back.cameras[0].roi->x0, 1u);
  EXPECT_EQ(back.cameras[0].roi->x1, left.width);
  EXPECT_FALSE(back.cameras[0].mask || back.cameras[1].roi);
  EXPECT_EQ(back.cameras[1].mask->pixels, pixels);
  EXPECT_EQ(back.cameras[1].mask->file, fs::absolute(folder / "mask-1.png").string());
  // The images contain everything that was seen.
  FrameSet set;
  read_entry(back, 1, set);
  expect_same(take.sets[1], set);
  // Nothing remains of a recording without frames.
  const fs::path none = fresh("mask-none");
  RecordingWriter(none, take.cameras).discard();
  EXPECT_FALSE(fs::exists(none));
}

TEST(Recording, ItsTimesMayBeginWithAByteOrderMark) {
  const fs::path folder = fresh("marked");
  write(folder, random_take(1, 2));
  test::write_text(folder / "times.csv", "\xef\xbb\xbf" + test::read_text(folder / "times.csv"));
  EXPECT_EQ(load_recording(folder).entries.size(), 2u);
}

TEST(Recording, ABlankLineOfItsTimesIsAWarning) {
  const fs::path folder = fresh("blank");
  write(folder, random_take(1, 2));
  test::write_text(folder / "times.csv", test::read_text(folder / "times.csv") + "\r\n \n");
  std::size_t frames = 0;
  const std::string said = test::stderr_of([&] { frames = load_recording(folder).entries.size(); });
  EXPECT_EQ(frames, 2U);
  EXPECT_EQ(said, "palpa: warning: " + (folder / "times.csv").string() + ": line 4 is blank; it counts as no frame\n");
}

TEST(Recording, WhatIsOnDiskStaysReadableAfterACrash) {
  const fs::path folder = fresh("crash");
  const Take take = random_take(2, 4);
  RecordingWriter writer(folder, take.cameras);
  writer.write(take.sets[0]);
  writer.write(take.sets[1]);
  // Still open, with an incomplete frame: an image, half a line.
  write_png16(folder / "000002-0.png", take.cameras[0].width, take.cameras[0].height, take.sets[2].frames[0].depth);
  const std::string times = test::read_text(folder / "times.csv");
  test::write_text(folder / "times.csv", times + "11,100000.0");
  Recording recording;
  EXPECT_EQ(test::stderr_of([&] { recording = load_recording(folder); }),
            "palpa: warning: " + (folder / "times.csv").string() +
                ": line 4 has no end, and is no whole frame; it is left out: expected a sequence number and 2 times in "
                "seconds, none beyond 1e12\n");
  ASSERT_EQ(recording.entries.size(), 2u);
  FrameSet set;
  read_entry(recording, 1, set);
  expect_same(set, take.sets[1]);
}

TEST(Recording, WriterRefusesWhatItCannotKeep) {
  const fs::path folder = fresh("refuse");
  const Take take = random_take(3, 2);
  RecordingWriter writer(fresh("refuse2"), take.cameras);
  writer.write(take.sets[1]);
  FrameSet half = take.sets[1];
  half.frames.pop_back();
  EXPECT_ERROR(writer.write(half), Exit::usage, "1 depth frame for 2 cameras");
  EXPECT_ERROR(RecordingWriter(fresh("refuse3") / "no" / "parent", take.cameras), Exit::failed, "cannot be created");
  EXPECT_ERROR(RecordingWriter(fresh("refuse4"), {}), Exit::usage, "a recording needs a camera");
  // It takes a new or an empty folder, and leaves what is somebody's.
  fs::create_directory(folder);
  EXPECT_NO_THROW(RecordingWriter(folder, take.cameras));
  fs::remove(folder / "recording.toml");
  fs::remove(folder / "times.csv");
  test::write_text(folder / "000000-0.png", "somebody's");
  EXPECT_ERROR(RecordingWriter(folder, take.cameras), Exit::usage, "is not empty; name a new folder");
  EXPECT_EQ(test::read_text(folder / "000000-0.png"), "somebody's");
  EXPECT_FALSE(fs::exists(folder / "recording.toml"));
}

TEST(Recording, ARecordingThatGrowsIsNotReplaced) {
  const fs::path folder = fresh("growing");
  const Take take = random_take(7, 2);
  {
    RecordingWriter writer(folder, take.cameras);
    ASSERT_TRUE(writer.write(take.sets[0]));
    EXPECT_ERROR(RecordingWriter(folder, take.cameras, Existing::replaced), Exit::usage,
                 "another palpa is writing this file");
    ASSERT_TRUE(writer.write(take.sets[1]));
  }
  EXPECT_EQ(load_recording(folder).entries.size(), 2u);
  RecordingWriter second(folder, take.cameras, Existing::replaced);
  EXPECT_TRUE(second.write(take.sets[0]));
}

TEST(Recording, WriterReplacesARecordingButNothingElse) {
  const Take first = random_take(5, 4), second = random_take(6, 2);
  const fs::path folder = fresh("replace");
  write(folder, first);
  const auto names = [&] {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder))
      all.insert(entry.path().filename().string());
    return all;
  };
  const std::set<std::string> before = names();
  {
    RecordingWriter writer(folder, second.cameras, Existing::replaced);
    EXPECT_EQ(names(), before) << "it stays until the first frame comes";
    writer.discard();
    EXPECT_EQ(names(), before);
  }
  EXPECT_EQ(load_recording(folder).entries.size(), 4u);
  {
    RecordingWriter writer(folder, second.cameras, Existing::replaced);
    for (const FrameSet& set : second.sets)
      writer.write(set);
  }
  EXPECT_EQ(names(), (std::set<std::string>{"000000-0.png", "000000-1.png", "000001-0.png", "000001-1.png",
                                            "recording.toml", "times.csv"}));
  const Recording back = load_recording(folder);
  FrameSet set;
  read_entry(back, 1, set);
  expect_same(second.sets[1], set);

  const auto refused = [&] {
    return test::error_of([&] { RecordingWriter(folder, second.cameras, Existing::replaced); }, Exit::usage);
  };
  for (const char* mine : {"notes.txt", "000000.png", "times.csv.old", "mask.png"}) {
    test::write_text(folder / mine, "mine");
    EXPECT_CONTAINS(refused(), std::string("has ") + mine + ", which is not part of a recording");
    fs::remove(folder / mine);
  }
  fs::create_directory(folder / "000002-0.png");
  EXPECT_CONTAINS(refused(), "not part of a recording");
  fs::remove(folder / "000002-0.png");
  fs::remove(folder / "recording.toml");
  EXPECT_CONTAINS(refused(), "no recording.toml");
  EXPECT_TRUE(fs::exists(folder / "000001-1.png"));
}

TEST(Recording, WriterLeavesWholeFramesOnAFullDisk) {
  const fs::path folder = fresh("full");
  Take take = random_take(3, 11);
  // Images smaller than times.csv, so that times.csv is the file that does not fit.
  for (std::size_t c = 0; c < 2; ++c) {
    take.cameras[c].width = take.cameras[c].height = 2;
    for (FrameSet& set : take.sets)
      set.frames[c].depth.resize(4);
  }
  std::string whole;
  {
    RecordingWriter writer(folder, take.cameras);
    for (std::size_t i = 0; i < 10; ++i)
      writer.write(take.sets[i]);
    whole = test::read_text(folder / "times.csv");
    const test::FileSizeLimit limit(whole.size() + 5);
    const std::string line = test::error_of([&] { writer.write(take.sets[10]); }, Exit::failed);
    EXPECT_EQ(line, (folder / "times.csv").string() + ": cannot be written: File too large");
  }
  EXPECT_EQ(test::read_text(folder / "times.csv"), whole);
  const Recording recording = load_recording(folder);
  ASSERT_EQ(recording.entries.size(), 10u);
  FrameSet set;
  read_entry(recording, 9, set);
  expect_same(set, take.sets[9]);
}

TEST(Recording, WriterLeavesOutFramesThatAreNotLater) {
  const fs::path folder = fresh("back");
  const Take take = random_take(5, 4);
  RecordingWriter writer(folder, take.cameras);
  EXPECT_TRUE(writer.write(take.sets[1]));
  EXPECT_FALSE(writer.write(take.sets[0])) << "its time and number are earlier";
  EXPECT_FALSE(writer.write(take.sets[1])) << "the same again";
  FrameSet renumbered = take.sets[2];
  renumbered.sequence = 0;
  EXPECT_FALSE(writer.write(renumbered)) << "its number is earlier, which no recording may have";
  EXPECT_TRUE(writer.write(take.sets[3]));
  EXPECT_EQ(writer.frames(), 2u);
  const Recording recording = load_recording(folder);
  ASSERT_EQ(recording.entries.size(), 2u);
  for (const auto& [entry, set] : {std::pair(0, 1), std::pair(1, 3)}) {
    FrameSet read;
    read_entry(recording, static_cast<std::size_t>(entry), read);
    expect_same(read, take.sets[static_cast<std::size_t>(set)]);
  }
}

TEST(Recording, AFullDiskIsAFailure) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "skipped: no /dev/full";
  const fs::path folder = fresh("full");
  const Take take = random_take(4, 1);
  RecordingWriter writer(folder, take.cameras);
  fs::create_symlink("/dev/full", folder / "000000-1.png");
  EXPECT_ERROR(writer.write(take.sets[0]), Exit::failed, "000000-1.png: cannot be written");
  EXPECT_EQ(writer.frames(), 0u);
}

const std::string camera_text = "[[camera]]\nwidth = 4\nheight = 3\nfx = 5\nfy = 5\ncx = 2\ncy = 1\nrate_hz = 30\n";

/// A folder of 4x3 images as another program might leave it.
fs::path foreign(const std::string& name, const std::vector<std::string>& files) {
  fs::path folder = fresh(name);
  fs::create_directories(folder / "depth");
  for (std::size_t i = 0; i < files.size(); ++i) {
    write_png16(folder / files[i], 4, 3, std::vector<std::uint16_t>(12, static_cast<std::uint16_t>(100 + i)));
  }
  return folder;
}

Recording load_text(const fs::path& folder, const std::string& text) {
  test::write_text(folder / "recording.toml", text);
  return load_recording(folder);
}

TEST(Recording, ForeignSequencesByPattern) {
  const fs::path folder = foreign("pattern", {"depth/f_7.png", "depth/f_8.png", "depth/f_9.png", "depth/f_10.png"});
  const std::string text = "[recording]\nfiles = [\"depth/f_%d.png\"]\nfirst = 7\n";
  const Recording all = load_text(folder, text + camera_text);
  ASSERT_EQ(all.entries.size(), 4u);
  EXPECT_EQ(all.entries[3].time_s, 3 / 30.0);
  FrameSet set;
  read_entry(all, 3, set);
  EXPECT_EQ(set.frames[0].depth[0], 103);
  EXPECT_EQ(set.sequence, 3u);
  const Recording some = load_text(folder, text + "count = 2\nrate_hz = 10\n" + camera_text);
  ASSERT_EQ(some.entries.size(), 2u);
  EXPECT_EQ(some.entries[1].time_s, 0.1);
  EXPECT_REFUSED(load_text(folder, text + "count = 5\n" + camera_text), "f_11.png: no such image");
  EXPECT_REFUSED(load_text(folder, "[recording]\nfiles = [\"depth/f_%d.png\"]\n" + camera_text),
                 "f_0.png: no such image");
  for (const char* bad : {"depth/f.png", "%s.png", "%d%d.png", "%n", "%", "%99999999999d.png", "%-3d.png", "%*d"}) {
    EXPECT_REFUSED(load_text(folder, "[recording]\nfiles = [\"" + std::string(bad) + "\"]\n" + camera_text),
                   "line 2: files must hold one number each");
  }
}

TEST(Recording, AMissingImageBeforeOthersIsToldAndCountMayBeBesideTimes) {
  const fs::path folder = foreign("gap", {"f_1.png", "f_2.png", "f_5.png"});
  const std::string text = "[recording]\nfiles = [\"f_%d.png\"]\nfirst = 1\n";
  const auto loaded = [&](const std::string& more, std::size_t frames) {
    return test::stderr_of([&] { EXPECT_EQ(load_text(folder, text + more + camera_text).entries.size(), frames); });
  };
  EXPECT_CONTAINS(loaded("", 2),
                  "recording.toml: line 2: the recording ends after 2 frames, because an image of number 3 is missing, "
                  "but there are images of number 5");
  EXPECT_EQ(loaded("count = 2\n", 2), "");
  fs::remove(folder / "f_5.png");
  EXPECT_EQ(loaded("", 2), "");
  test::write_text(folder / "t.csv", "sequence,time_0_s\n3,0.5\n4,0.75\n");
  const Recording some = load_text(folder, text + "times = \"t.csv\"\ncount = 1\n" + camera_text);
  ASSERT_EQ(some.entries.size(), 1u);
  EXPECT_EQ(some.entries[0].sequence, 3u);
  EXPECT_EQ(some.entries[0].time_s, 0.5);
  EXPECT_REFUSED(load_text(folder, text + "times = \"t.csv\"\ncount = 3\n" + camera_text),
                 "line 5: count is 3, but times has 2 lines");
}

TEST(Recording, TimesInAnotherUnitAreTold) {
  const fs::path folder = foreign("unit", {"0.png", "1.png", "2.png"});
  const auto warning = [&](const std::string& csv, const std::string& camera) {
    test::write_text(folder / "t.csv", "sequence,time_0_s\n" + csv);
    return test::stderr_of(
        [&] { load_text(folder, "[recording]\nfiles = [\"%d.png\"]\ntimes = \"t.csv\"\n" + camera); });
  };
  const std::string no_rate = camera_text.substr(0, camera_text.find("rate_hz"));
  EXPECT_CONTAINS(warning("0,0\n1,33\n2,66\n", camera_text),
                  "recording.toml: its frames are 33 s apart, but its rate_hz of 30 means 0.0333 s");
  EXPECT_CONTAINS(warning("0,0\n1,0.00003\n2,0.00006\n", camera_text), "3e-05 s apart, but its rate_hz");
  EXPECT_CONTAINS(warning("0,0\n1,33\n2,66\n", no_rate), "33 s apart; if the times are in another unit");
  EXPECT_EQ(warning("0,0\n1,0.033\n2,60\n", camera_text), "");
  EXPECT_EQ(warning("0,0\n1,3\n2,6\n", no_rate), "");
}

TEST(Recording, FrameNumbersInsteadOfTimesAreTold) {
  const fs::path folder = foreign("numbers", {"0.png", "1.png", "2.png", "3.png"});
  const auto warning = [&](const std::string& csv, const std::string& rate) {
    test::write_text(folder / "t.csv", "sequence,time_0_s\n" + csv);
    const std::string camera = camera_text.substr(0, camera_text.find("rate_hz")) + rate;
    return test::stderr_of(
        [&] { load_text(folder, "[recording]\nfiles = [\"%d.png\"]\ntimes = \"t.csv\"\n" + camera); });
  };
  const std::string counted = "0,0\n1,1\n2,2\n3,3\n", gap = "0,6\n1,7\n2,8\n3,11\n";
  const std::string meant = "; if the times are frame numbers, convert them: they must be in seconds\n";
  for (const std::string& csv : {counted, gap}) {
    EXPECT_CONTAINS(warning(csv, "rate_hz = 30\n"),
                    "its frames are 1 s apart, but its rate_hz of 30 means 0.0333 s" + meant);
    EXPECT_CONTAINS(warning(csv, "rate_hz = 5\n"), "1 s apart, but its rate_hz of 5 means 0.2 s" + meant);
    EXPECT_CONTAINS(warning(csv, ""), "its frames are 1 s apart" + meant);
    EXPECT_EQ(warning(csv, "rate_hz = 1\n"), "");
  }
  EXPECT_EQ(warning("0,0\n1,1.001\n2,2\n3,3\n", ""), "");
}

TEST(Recording, ALastLineOfTimesWithoutItsEndIsReadIfItIsWhole) {
  const fs::path folder = foreign("last", {"0.png", "1.png", "2.png"});
  const auto frames = [&](const std::string& csv, const std::string& said) {
    test::write_text(folder / "t.csv", "sequence,time_0_s\n" + csv);
    std::vector<double> times;
    const std::string line = test::stderr_of([&] {
      for (const Recording::Entry& entry :
           load_text(folder, "[recording]\nfiles = [\"%d.png\"]\ntimes = \"t.csv\"\n" + camera_text).entries)
        times.push_back(entry.time_s);
    });
    EXPECT_EQ(line, said.empty() ? ""
                                 : "palpa: warning: " + (folder / "t.csv").string() +
                                       ": line 4 has no end, and is no whole frame; it is left out: " + said + "\n");
    return times;
  };
  using Times = std::vector<double>;
  EXPECT_EQ(frames("0,0.1\n1,0.2\n2,0.3", ""), (Times{0.1, 0.2, 0.3}));
  const std::string expected = "expected a sequence number and 1 time in seconds, none beyond 1e12";
  for (const char* torn : {"2", "2,", "2,0.", "2,0.0"}) {
    const std::string why =
        std::string(torn) == "2" || std::string(torn) == "2," ? expected : "the time does not increase";
    EXPECT_EQ(frames(std::string("0,0.1\n1,0.2\n") + torn, why), (Times{0.1, 0.2})) << torn;
  }
  EXPECT_REFUSED(frames("0,0.1\n1,0.2\n2,\n", ""), "t.csv: line 4: " + expected);
}

TEST(Recording, WhoseTimesWereFoundToBeFrameNumbersIsWarnedOfAndPlayedWhole) {
  PALPA_SHARED_OR_SKIP(folder, "found-more/frame-numbers");
  const std::string said = test::stderr_of([&] { EXPECT_EQ(load_recording(folder).entries.size(), 4u); });
  EXPECT_CONTAINS(said, "1 s apart, but its rate_hz of 30 means 0.0333 s; if the times are frame numbers");
}

TEST(Recording, ForeignSequencesByList) {
  const fs::path folder = foreign("list", {"b.png", "a.png"});
  const auto frames = [](const std::string& first, const std::string& second) {
    return "[[frame]]\nfiles = [\"b.png\"]\n" + first + "[[frame]]\nfiles = [\"a.png\"]\n" + second + "[recording]\n";
  };
  const Recording recording = load_text(folder, camera_text + frames("time_s = 5\n", "time_s = 5.5\n"));
  ASSERT_EQ(recording.entries.size(), 2u);
  EXPECT_EQ(recording.entries[1].time_s, 5.5);
  FrameSet set;
  read_entry(recording, 0, set);
  EXPECT_EQ(set.frames[0].depth[0], 100);
  EXPECT_EQ(load_text(folder, camera_text + frames("", "")).entries[1].time_s, 1 / 30.0);
  EXPECT_REFUSED(load_text(folder, camera_text + frames("time_s = 5\n", "time_s = 5\n")), "the time does not increase");
  EXPECT_REFUSED(load_text(folder, camera_text + frames("time_s = 5\n", "")), "frame 1 has no time_s");
  EXPECT_REFUSED(load_text(folder, camera_text + frames("", "time_s = 5\n")), "the time does not increase");
  EXPECT_REFUSED(load_text(folder, camera_text + frames("", "times = 5\n")), "unknown key times in [[frame]]");
}

TEST(Recording, FaultsAreNamed) {
  const fs::path folder = foreign("faults", {"0.png", "1.png"});
  const std::string text = "[recording]\nfiles = [\"%d.png\"]\n";
  EXPECT_REFUSED(load_recording(folder / "none"), "no such file");
  EXPECT_REFUSED(load_text(folder, text), "[[camera]] is missing");
  EXPECT_REFUSED(load_text(folder, camera_text), "[recording] is missing");
  EXPECT_REFUSED(load_text(folder, "[recording]\n" + camera_text), "files is missing");
  EXPECT_REFUSED(load_text(folder, text + "speed = 3\n" + camera_text), "line 3: unknown key speed in [recording]");
  EXPECT_REFUSED(load_text(folder, text + camera_text + camera_text), "files has 1 pattern for 2 cameras");
  EXPECT_REFUSED(load_text(folder, text + "times = \"t.csv\"\n" + camera_text), "t.csv: no such file");
  const auto with_times = [&](const std::string& csv) {
    test::write_text(folder / "t.csv", csv);
    return load_text(folder, text + "times = \"t.csv\"\n" + camera_text);
  };
  EXPECT_EQ(with_times("sequence,time_0_s\n3,0.5\r\n4,0.75\n").entries[1].sequence, 4u);
  EXPECT_REFUSED(with_times("sequence,time_0_s\n3,0.5\n4,0.5\n"), "t.csv: line 3: the time does not increase");
  EXPECT_EQ(with_times("sequence,time_0_s\r\n3,-1e12\n4,1e12\n").entries[1].time_s, 1e12);
  EXPECT_REFUSED(with_times("3,0.5\n4,0.75\n5,1\n"), "t.csv: line 1: expected the heading sequence,time_0_s");
  EXPECT_REFUSED(with_times("sequence,time\n3,0.5\n4,0.75\n"), "line 1: expected the heading");
  EXPECT_REFUSED(with_times("sequence,time_0_s,time_1_s\n3,0.5\n4,0.75\n"), "line 1: expected the heading");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n3,0.5\n4,1.1e12\n"), "t.csv: line 3: expected");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n3,0.5\n3,0.6\n"),
                 "t.csv: line 3: the sequence number does not increase");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n3,nan\n"),
                 "t.csv: line 2: expected a sequence number and 1 time in seconds");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n3,1,2\n"), "line 2: expected");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n3\n"), "line 2: expected");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n-1,3\n"), "line 2: expected");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n"), "the recording has no frame");
  EXPECT_REFUSED(with_times("sequence,time_0_s\n0,1\n1,2\n2,3\n"), "2.png: no such image");
  Recording recording = load_text(folder, text + camera_text);
  recording.cameras[0].width = 5;
  FrameSet set;
  EXPECT_REFUSED(read_entry(recording, 0, set), "0.png: is 4x3 pixels, but its camera is 5x3");
  fs::remove(folder / "1.png");
  EXPECT_REFUSED(read_entry(recording, 1, set), "1.png: no such file");
}

TEST(Recording, LoopsWithTimesRunningOn) {
  const fs::path folder = fresh("loop");
  const Take take = random_take(6, 3);
  write(folder, take);
  const auto source = make_replay(load_recording(folder), {.paced = false, .loop = true});
  FrameSet set;
  double last_time = -1;
  std::int64_t last_sequence = -1;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(source->next(set, 1));
    EXPECT_GT(set.time_s, last_time);
    EXPECT_GT(static_cast<std::int64_t>(set.sequence), last_sequence);
    EXPECT_EQ(set.frames[0].depth, take.sets[i % 3].frames[0].depth);
    last_time = set.time_s;
    last_sequence = static_cast<std::int64_t>(set.sequence);
  }
  EXPECT_NEAR(last_time, take.sets[0].time_s + 9 / 90.0, 0.004);
}

TEST(Recording, PacedReplayWaitsAndDropsWhatIsLate) {
  const fs::path folder = foreign("paced", {"0.png", "1.png", "2.png", "3.png"});
  const auto at = [&](const std::string& rate_hz) {
    return make_replay(
        load_text(folder, "[recording]\nfiles = [\"%d.png\"]\nrate_hz = " + rate_hz + "\n" + camera_text), {});
  };
  FrameSet set;
  const auto slow = at("0.001");
  ASSERT_TRUE(slow->next(set, 1));
  EXPECT_EQ(set.sequence, 0u);
  ASSERT_TRUE(slow->next(set, 0.001));
  EXPECT_TRUE(set.frames.empty()) << "not due yet";
  const auto quick = at("1000");
  ASSERT_TRUE(quick->next(set, 1));
  std::this_thread::sleep_for(std::chrono::milliseconds(4));
  ASSERT_TRUE(quick->next(set, 1));
  EXPECT_EQ(set.sequence, 3u) << "the last one is never dropped";
  EXPECT_FALSE(quick->next(set, 1));
}

TEST(Recording, ARealSequenceBecomesOne) {
  PALPA_SHARED_OR_SKIP(data, "depth-hand-sr305-ondris");
  const fs::path folder = fresh("real");
  fs::create_directories(folder);
  std::string frames;
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(data)) {
    if (entry.path().extension() != ".png" || entry.path().filename().string().find("230536") == std::string::npos)
      continue;
    frames += "[[frame]]\nfiles = [\"" + fs::absolute(entry.path()).string() + "\"]\n";
    ++count;
  }
  ASSERT_GT(count, 0u);
  allow_outside_references(true);  // the images stay where they are
  const Recording recording =
      load_text(folder,
                "[recording]\nrate_hz = 30\n[[camera]]\nname = \"SR305\"\nwidth = 640\nheight = 480\nfx = 476.007\n"
                "fy = 476.007\ncx = 313.683\ncy = 242.755\ndepth_unit_m = 0.000125\n" +
                    frames);
  allow_outside_references(false);
  EXPECT_EQ(recording.entries.size(), count);
  FrameSet set;
  for (std::size_t i = 0; i < count; ++i)
    read_entry(recording, i, set);
}

}  // namespace
}  // namespace palpa::sensing
