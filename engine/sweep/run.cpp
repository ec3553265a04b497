#include "sweep/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/locked_bytes.hpp"
#include "base/log.hpp"
#include "base/sha256.hpp"
#include "base/version.hpp"
#include "gpu/handle.hpp"
#include "sweep/cases.hpp"
#include "sweep/results.hpp"
#include "sweep/workbench.hpp"

namespace palpa::sweep {
namespace {

using Clock = std::chrono::steady_clock;

/// The locks of a plan's cases: byte i is for case i.
std::string claims_file(const std::string& out, const std::vector<Case>& cases) {
  std::string ids;
  for (const Case& one : cases)
    ids += one.id;
  return std::filesystem::path(out) / fmt::format("claims-{}", sha256(ids).substr(0, 16));
}

class Sweep {
 public:
  Sweep(const Plan& plan, const SweepTask& task, const AfterCase& after)
      : plan_(plan), task_(task), after_(after), inputs_(plan) {}

  SweepReport run() {
    const Clock::time_point begin = Clock::now();
    std::optional<Cancellable> cancellable;
    if (task_.stop) cancellable.emplace(*task_.stop);
    refuse_hopeless(plan_);
    const Store store(task_.out);
    store.check_version();
    const std::vector<Case> all = list_cases(plan_, inputs_, true);
    report_.cases = all.size();
    todo(deal(all, task_.claim ? Shard() : task_.shard), store);
    if (!todo_.empty()) compute(all);
    report_.all_in_vain = is_all_in_vain(all);
    report_.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    return report_;
  }

 private:
  void todo(std::vector<Case> mine, const Store& store) {
    report_.mine = mine.size();
    look_at(store, false);
    std::vector<Case> failed;
    for (Case& one : mine) {
      report_.ids.push_back(one.id);
      const auto known = states_.find(one.id);
      if (known == states_.end()) {
        todo_.push_back(std::move(one));
      } else if (known->second == State::failed) {
        failed.push_back(std::move(one));
      } else {
        ++report_.before;
      }
    }
    // What failed once may fail again, and should not keep the others waiting.
    std::ranges::move(failed, std::back_inserter(todo_));
  }

  void compute(const std::vector<Case>& all) {
    bench_.emplace(task_.compute);
    RunInfo info{{}, version(), commit(), plan_.command, sha256(plan_.text), {}, host_name(), bench_->device_name(),
                 {}};
    info.shard = task_.claim ? "claim" : fmt::format("{}/{}", task_.shard.index, task_.shard.count);
    info.backend = setup::on_gpu(task_.compute) ? "gpu" : "cpu";
    info.started_s = seconds_now();
    writer_ = std::make_unique<StoreWriter>(task_.out, info);
    if (task_.claim) {
      claim_all(all);
      return;
    }
    for (const Case& one : todo_) {
      if (!compute_one(one)) return;
    }
  }

  /// Takes one case after the other that nobody has. What others hold is looked at once more at the end: if they were
  /// killed meanwhile, it is free and has no result.
  void claim_all(const std::vector<Case>& all) {
    LockedBytes& claims = claims_.emplace(claims_file(task_.out, all));
    std::vector<Case> left;
    for (const Case& one : todo_) {
      if (!claims.try_lock(one.index)) {
        left.push_back(one);
        continue;
      }
      // Its holder marks a case when its line is in the file.
      const bool marked = claims.is_marked(one.index);
      if (marked) left.push_back(one);
      if (!marked && !compute_one(one)) return;
      claims.unlock(one.index);
    }
    if (left.empty()) return;
    look_again();
    for (const Case& one : left) {
      if (has_result(one) || failed_elsewhere_.contains(one.id)) continue;
      if (!claims.try_lock(one.index)) {
        ++report_.elsewhere;
        continue;
      }
      look_again();
      const bool is_open = !has_result(one) && !failed_elsewhere_.contains(one.id);
      if (is_open && !compute_one(one)) return;
      claims.unlock(one.index);
    }
  }

  /// At the results that others have written meanwhile.
  void look_again() { look_at(Store(task_.out, writer_->name()), true); }

  /// Reads only what has been added since the last look. What another process has tried in vain since this run began
  /// is not tried by this one, too.
  void look_at(const Store& store, bool since_begin) {
    const auto take = [&](std::size_t, std::string_view id, State state, std::string_view) {
      const auto [known, is_new] = states_.emplace(std::string(id), state);
      if (!is_new) known->second = std::min(known->second, state);
      if (since_begin && state == State::failed) failed_elsewhere_.emplace(id);
    };
    store.each(take, &places_);
  }

  bool has_result(const Case& one) const {
    const auto known = states_.find(one.id);
    return known != states_.end() && known->second != State::failed;
  }

  /// A shard may have only cases whose options do not fit together, while others compute the rest.
  bool is_all_in_vain(const std::vector<Case>& all) {
    if (report_.done + report_.failed + report_.elsewhere != 0 || stopped()) return false;
    if (writer_) look_again();
    std::uint64_t refused = 0;
    for (const Case& one : all) {
      const auto known = states_.find(one.id);
      if (known == states_.end()) continue;
      if (known->second != State::refused) return false;
      ++refused;
    }
    return refused == all.size() || (fitted_ && refused != 0);
  }

  /// For other processes: the case has a line in a file.
  void mark(const Case& one) {
    if (claims_) claims_->mark(one.index);
  }

  bool stopped() const { return task_.stop && *task_.stop; }

  /// False if the caller wants no more.
  bool compute_one(const Case& one) {
    // Two values of a plan may mean the same case.
    if (has_result(one)) {
      ++report_.before;
      mark(one);
      return true;
    }
    const std::vector<Setting> settings = plan_.settings(one.index);
    CaseLine line{.id = one.id};
    for (const Setting& setting : settings)
      line.settings.emplace_back(setting.option.substr(2), setting.shown());
    const Clock::time_point begin = Clock::now();
    std::string json;
    try {
      const std::unique_ptr<Line> options = read_line(command_of(plan_.command), given_by(inputs_.resolved(settings)));
      check_line(*options);
      fitted_ = true;
      json = bench_->compute(*options);
    } catch (const Error& error) {
      if (stopped()) return false;
      end_if_lost(error);
      const bool for_ever = error.code() == Exit::usage || error.code() == Exit::bad_input;
      line.state = for_ever ? State::refused : State::failed;
      line.error = error.what();
      line.exit_code = static_cast<int>(error.code());
    }
    if (line.state == State::done) keep(json, line);
    line.took_s = std::chrono::duration<double>(Clock::now() - begin).count();
    line.ended_s = seconds_now();
    writer_->add(line);
    mark(one);
    states_[one.id] = line.state;
    count(line, settings);
    if (stopped()) return false;
    return !after_ || after_(line, report_.done + report_.refused + report_.failed, todo_.size());
  }

  /// Throws bad_input if a path of the plan leads to no single value, which it would do in every case.
  void keep(const std::string& json, CaseLine& line) {
    try {
      const std::vector<std::string> texts = results_of(json, plan_.results);
      for (std::size_t i = 0; i < texts.size() && !plan_.keep_everything; ++i)
        line.results.emplace_back(plan_.results[i], texts[i]);
      if (plan_.keep_everything) line.everything = without_times(json);
      warn_of_names(json, texts);
    } catch (const Error& error) {
      throw bad_input(plan_.file, error.what());
    }
  }

  /// Once for each path. The results that a plan has by default are not in every case.
  void warn_of_names(const std::string& json, const std::vector<std::string>& texts) {
    for (std::size_t i = 0; plan_.results_given && i < texts.size(); ++i) {
      if (texts[i] != "null" || warned_.contains(plan_.results[i])) continue;
      const std::string fault = name_fault(json, plan_.results[i]);
      if (fault.empty()) continue;
      warned_.insert(plan_.results[i]);
      log::warning(fmt::format("{}: {}", plan_.file, fault));
    }
  }

  /// Without a device, every further case would fail, too.
  static void end_if_lost(const Error& error) {
    if (error.code() == Exit::no_device || gpu::device_abandoned) throw Error(error);
  }

  void count(const CaseLine& line, const std::vector<Setting>& settings) {
    if (line.state == State::done) {
      ++report_.done;
      return;
    }
    ++(line.state == State::refused ? report_.refused : report_.failed);
    if (!report_.first_fault.empty()) return;
    std::string varied;
    for (const Setting& setting : settings) {
      const std::vector<std::string> options = plan_.varied();
      if (std::ranges::find(options, setting.option) == options.end()) continue;
      varied += fmt::format("{}{} {}", varied.empty() ? "" : ", ", setting.option.substr(2), setting.shown());
    }
    report_.first_fault = fmt::format("the case {}: {}", varied.empty() ? line.id : varied, line.error);
  }

  const Plan& plan_;
  const SweepTask& task_;
  const AfterCase& after_;
  Inputs inputs_;
  SweepReport report_;
  bool fitted_ = false;  ///< the options of a case that was computed now fit together
  std::vector<Case> todo_;
  std::unordered_map<std::string, State> states_;
  std::unordered_set<std::string> failed_elsewhere_;  ///< since this run began
  std::unordered_set<std::string> warned_;            ///< paths of the plan
  Places places_;
  std::optional<LockedBytes> claims_;
  std::optional<Workbench> bench_;
  std::unique_ptr<StoreWriter> writer_;
};

}  // namespace

SweepReport run_sweep(const Plan& plan, const SweepTask& task, const AfterCase& after) {
  return Sweep(plan, task, after).run();
}

}  // namespace palpa::sweep
