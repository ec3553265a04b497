#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "cli/support/reviewed_options.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// A command of studies, which use no GPU.
ReviewedLine of_study(const std::vector<std::string>& line, const std::string& untried,
                      const std::vector<IdleOption>& more = {}) {
  std::vector<IdleOption> idle = no_gpu_at_all();
  idle.insert(idle.end(), more.begin(), more.end());
  return {.line = with({"study"}, line), .idle = idle, .untried = untried};
}

}  // namespace

std::vector<ReviewedLine> of_studies() {
  const std::string plan = source_file("assets/studies/paper.toml");
  return {
      of_study({"analyse", "none"}, "--html --csv"),
      of_study({"compare", "paper"}, "--html --csv"),
      of_study({"level", plan}, "", {{{"--override", "x"}, "--override has no effect"}}),
      of_study({"plan", plan}, "--participant --csv", {{{"--seed", "1"}, "--seed belongs to the plan"}}),
      of_study({"rehearse", plan, "--participant", "1", "--out", "none/x"}, "--participant --out --accuracy"),
      {.line = {"study", "run", plan, "--participant", "1", "--out", "none/x", "--rehearse", "1", "--size", "640x480"},
       .idle = {{{"--monitor", "1"}, "--monitor and --size exclude each other"},
                {{"--eyes-apart", "60mm"}, "--eyes-apart goes with --stereo"},
                {{"--barrier-pitch", "1mm"}, "go with --stereo columns or rows"},
                {{"--barrier-gap", "1mm"}, "go with --stereo columns or rows"},
                {{"--barrier-phase", "0.5"}, "go with --stereo columns or rows"},
                {{"--backend", "cpu", "--gpu", "0"}, "--gpu"},
                {{"--backend", "cpu", "--validation", "core"}, "--validation"}},
       .untried =
           "--participant --out --source --link --rig --board-files --hold --size --stereo --override --rehearse "
           "--gpu --validation"},
      of_study({"simulate", plan}, "--finger --beside --html --csv --prediction"),
      of_study({"withdraw", "1", "--out", "none"}, "--out"),
      of_study({"power"},
               "--html --csv --baseline --accuracy --spread --correlation --trials --alpha --power "
               "--people --studies")};
}

}  // namespace palpa::test
