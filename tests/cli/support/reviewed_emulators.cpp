#include "cli/support/reviewed_options.hpp"

namespace palpa::test {

std::vector<ReviewedLine> of_emulate() {
  std::vector<IdleOption> of_openmpd = no_gpu_at_all();
  of_openmpd.push_back({{"--port", "0"}, "--port goes with autd3, not with openmpd"});
  of_openmpd.push_back({{"--tactile"}, "--tactile goes with sonicsurface, not with openmpd"});
  of_openmpd.push_back({{"--layout", "openmpd"}, "--layout goes with --view"});
  of_openmpd.push_back({{"--board-files", "/"}, "--board-files goes with --view"});
  return {{.line = {"emulate", "openmpd", "--serial", "IDLE1"},
           .idle = of_openmpd,
           .untried = "--serial --uart --trace --view"},
          {.line = {"emulate", "autd3", "--port", "0"},
           .idle = {{{"--uart"}, "--uart goes with openmpd, not with autd3"},
                    {{"--serial", "A"}, "--serial goes with openmpd, not with autd3"},
                    {{"--tactile"}, "--tactile goes with sonicsurface, not with autd3"},
                    {{"--board-files", "/"}, "--board-files goes with openmpd and sonicsurface, not with autd3"}},
           .untried = "--port --layout"},
          {.line = {"emulate", "sonicsurface"},
           .idle = {{{"--uart"}, "--uart goes with openmpd, not with sonicsurface"},
                    {{"--serial", "A"}, "--serial goes with openmpd, not with sonicsurface"},
                    {{"--port", "1"}, "--port goes with autd3, not with sonicsurface"},
                    {{"--board-files", "/"}, "--board-files goes with --view"}},
           .untried = "--tactile --layout"}};
}

}  // namespace palpa::test
