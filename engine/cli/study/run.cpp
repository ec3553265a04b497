#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.hpp"
#include "cli/study/commands.hpp"
#include "line/option_table.hpp"
#include "line/values.hpp"
#include "setup/options/study_options.hpp"

namespace palpa::cli {
namespace {

/// The viewer takes the place of this process, so signals reach it, and its exit code is that of the command. It gets
/// the same options.
void run_study(setup::StudyRunOptions o, const line::Given& given) {
  setup::check(o);
  std::error_code fault;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", fault);
  const std::filesystem::path viewer = self.parent_path() / "palpa-viewer";
  if (!std::filesystem::exists(viewer, fault)) {
    throw failure(viewer.string() +
                  " is missing: a study needs palpa's viewer for its windows; install or build it beside palpa");
  }
  std::vector<std::string> words{viewer.string(), "--study=" + o.plan};
  const std::vector<std::string> more = line::words_of(given);
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(viewer.c_str(), arguments.data());
  throw failure(viewer.string() + " cannot be started: " + std::strerror(errno));
}

}  // namespace

void add_study_run(Program& program) {
  const auto options = std::make_shared<setup::StudyRunOptions>();
  CLI::App& command = add_command(
      program,
      {"study run", "a participant's sitting, in front of the array: opens windows",
       "  palpa study run my-plan.toml --participant 1 --out my-study \\\n"
       "                  --source v4l2:/dev/video0 --link openmpd:FT43NK5M --rig my-rig.toml\n"
       "  palpa study run assets/studies/five-minutes.toml --participant 1 --out five-minutes \\\n"
       "                  --rehearse 0.6 --size 1024x768",
       "--participant --out --source --link --rig --monitor --size --override --rehearse --hold",
       "Starts palpa-viewer --study, so it needs a display; without one, it ends with exit code 3. A sitting that was "
       "stopped is continued by the same command. docs/study.md explains the windows."});
  line::Group(command, "Study").text("plan", options->plan, "PLAN", "TOML file of the study");
  setup::add_study_run_options(command, *options);
  finish_command(program, command, options->common,
                 [options, &command] { run_study(*options, line::given_on(command)); });
}

}  // namespace palpa::cli
