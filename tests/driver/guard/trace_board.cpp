#include "trace_board.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/system/descriptor.hpp"
#include "driver/guard/channel.hpp"

namespace palpa::test {
namespace {

class TraceBoard final : public driver::Board {
 public:
  TraceBoard(const std::string& file, bool sure, driver::BoardNotes& notes)
      : file_(::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600)),
        sure_(sure),
        lost_(access((file + "-lost").c_str(), F_OK) == 0),
        notes_(notes) {
    if (!file_) throw failure(file + ": cannot be opened");
    write("open\n");
    allocations_ = allocations();
  }

  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override {
    const float first = drive[0].phase;
    const bool whole = std::all_of(drive.begin(), drive.end(), [&](const auto& t) {
      return t.phase == first && t.amplitude == drive[0].amplitude;
    });
    written_.drives += session::sounds(drive) ? 1 : 0;
    write_line(whole ? "play %llu %g\n" : "torn %llu %g\n", slot, static_cast<double>(drive[0].amplitude));
    if (slot >= throws_from_slot) throw failure("a board must not throw");
    if (slot == 7) notes_.warning("what it has to say");
  }

  void plan(const driver::BoardPlan& plan) override {
    written_.plans += plan.slots.cycle.is_listed() ? 1 : 0;
    write_line("plan %llu %g\n", plan.slots.from, static_cast<double>(plan.slots.cycle.length));
    if (!plan.foci.empty()) write_line("foci %llu %g\n", plan.foci.size(), plan.foci.back().x);
  }

  void all_off() override { write("off\n"); }

  /// Everything in the file has arrived.
  driver::BoardCounts counts() const override {
    return {.submitted = written_, .completed = written_, .out_of_reach = lost_};
  }

  bool close() override {
    const std::uint64_t since = allocations() - allocations_;
    if (since != 0) write_line("allocated %llu %g\n", since, 0);
    write("close\n");
    return sure_;
  }

 private:
  void write(std::string_view line) const {
    if (::write(file_.get(), line.data(), line.size()) < 0) std::abort();
  }
  void write_line(const char* form, std::uint64_t number, double value) const {
    std::array<char, 80> line{};
    const int size = std::snprintf(line.data(), line.size(), form, static_cast<unsigned long long>(number), value);
    write({line.data(), static_cast<std::size_t>(size)});
  }

  Descriptor file_;
  bool sure_, lost_;
  driver::BoardNotes& notes_;
  std::uint64_t allocations_ = 0;
  session::Passed written_;
};

}  // namespace

driver::BoardKind trace_board() {
  return {
      "trace", "trace:FILE: every order to a board, into a file",
      [](const driver::BoardSpec& spec, driver::BoardNotes& notes) -> std::unique_ptr<driver::Board> {
        if (spec.argument == "refuse") throw bad_input("trace:refuse", "there is no such board");
        if (spec.argument == "told")
          throw bad_input("trace:told", fmt::format("sound at {} m/s, slots of {} s, a ramp of {} s, {}, {}, {}",
                                                    spec.sound_speed_m_s, spec.slot_s, spec.ramp_s,
                                                    spec.foci_move ? "foci move" : "foci stand",
                                                    spec.steps ? "steps" : "jumps", spec.nulls ? "nulls" : "no nulls"));
        const std::string die_once = "die-once:";
        if (spec.argument.starts_with(die_once)) {
          const std::string file = spec.argument.substr(die_once.size());
          const std::string before = file + "-died";
          if (access(before.c_str(), F_OK) == 0) return std::make_unique<TraceBoard>(file, true, notes);
          const Descriptor mark(::open(before.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
          static_cast<void>(std::raise(SIGKILL));
        }
        const std::string unsure = "unsure:";
        const bool sure = !spec.argument.starts_with(unsure);
        return std::make_unique<TraceBoard>(sure ? spec.argument : spec.argument.substr(unsure.size()), sure, notes);
      },
      true};
}

}  // namespace palpa::test
