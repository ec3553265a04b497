// Prints how loud a solver makes the weakest focus, relative to its optimum (tests/array/loud_optima.txt), and how even
// the foci are. It is not a test; run it by hand. Arguments: layout, solver, constraint, and optionally the number of
// sets of each kind, and "gpu" for the device instead of the twin.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/drive_pass.hpp"
#include "array/loud_optima.hpp"
#include "array/loud_sets.hpp"
#include "support/device.hpp"

namespace palpa::array {
namespace {

using Sets = std::vector<std::vector<SlotFocus>>;

std::vector<Drive> on_host(const Layout& layout, const Sets& sets, const DriveOptions& options) {
  std::vector<Drive> drives(sets.size(), Drive(layout.transducers.size()));
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::jthread> threads;
  for (unsigned core = 0; core < cores; ++core) {
    threads.emplace_back([&, core] {
      DriveScratch scratch;
      for (std::size_t s = core; s < sets.size(); s += cores)
        drive_for(layout, sets[s], options, drives[s], scratch);
    });
  }
  threads.clear();
  return drives;
}

std::vector<Drive> on_device(const Layout& layout, const Sets& sets, const DriveOptions& options) {
  static const DrivePasses passes(test::test_device(), options.solver);
  std::size_t foci = 0;
  for (const auto& set : sets)
    foci += set.size();
  DriveMemory memory(test::test_device(), layout, options, static_cast<std::uint32_t>(sets.size()),
                     static_cast<std::uint32_t>(foci));
  for (const auto& set : sets) {
    if (!memory.add_slot(set)) std::abort();
  }
  test::run_on_device([&](VkCommandBuffer commands) { memory.record(commands, passes); });
  memory.solve_on_host();
  std::vector<Drive> drives;
  for (std::uint32_t s = 0; s < memory.slots(); ++s)
    drives.emplace_back(memory.drive(s).begin(), memory.drive(s).end());
  return drives;
}

void run(const LoudOptima& optima, const DriveOptions& options, std::size_t most_sets, bool device) {
  const Layout layout = load_layout(optima.layout);
  Sets sets;
  for (std::uint32_t s = 0; s < std::min(most_sets, optima.pascals.size()); ++s)
    sets.push_back(loud_set(s, optima.fewest, optima.most, middle_of(layout)));
  if (sets.empty()) return;
  const auto drives_of = device ? on_device : on_host;
  if (device) drives_of(layout, sets, options);
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Drive> drives = drives_of(layout, sets, options);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::vector<std::pair<double, std::size_t>> parts;
  std::vector<double> evenness;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const acoustics::FociPressure heard =
        acoustics::pressure_at_foci(layout, drives[s], sets[s], options.medium, options.directivity);
    parts.emplace_back(*std::ranges::min_element(heard.pascals) / optima.pascals[s], s);
    evenness.push_back(heard.evenness);
  }
  std::ranges::sort(parts);
  std::ranges::sort(evenness);
  const auto reaches = [&](double part) {
    return 100.0 *
           static_cast<double>(std::ranges::count_if(parts, [&](const auto& own) { return own.first >= part; })) /
           static_cast<double>(parts.size());
  };
  std::printf("%-8s %2zu-%2zu foci, %3zu sets: median %.3f, 0.98 in %.1f, 0.95 in %.1f, 0.93 in %.1f, 0.90 in %.1f %%;",
              optima.layout.c_str(), optima.fewest, optima.most, sets.size(), parts[parts.size() / 2].first,
              reaches(0.98), reaches(0.95), reaches(0.93), reaches(0.90));
  std::printf(" worst");
  for (std::size_t i = 0; i < std::min<std::size_t>(4, parts.size()); ++i)
    std::printf(" %.3f (%zu)", parts[i].first, parts[i].second);
  std::printf("; loudest %.3f; even: tenth %.2f, median %.3f; %.0f/s\n", parts.back().first,
              evenness[evenness.size() / 10], evenness[evenness.size() / 2], static_cast<double>(sets.size()) / took);
}

int main_of(const std::vector<std::string>& words) {
  if (words.size() < 3) {
    std::fprintf(stderr, "give: layout or all, solver, constraint, and optionally the number of sets and gpu\n");
    return 2;
  }
  DriveOptions options;
  const auto solver = value_of(solver_words, words[1]);
  const auto constraint = value_of(constraint_words, words[2]);
  if (!solver || !constraint) return 2;
  options.solver = *solver;
  options.constraint = *constraint;
  for (const LoudOptima& optima : loud_optima()) {
    if (words[0] == "all" || words[0] == optima.layout)
      run(optima, options, words.size() > 3 ? std::stoul(words[3]) : 500, words.size() > 4 && words[4] == "gpu");
  }
  return 0;
}

}  // namespace
}  // namespace palpa::array

int main(int count, char** words) {
  return palpa::array::main_of({words + 1, words + count});
}
