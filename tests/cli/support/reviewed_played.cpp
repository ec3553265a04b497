#include "cli/support/process.hpp"
#include "cli/support/reviewed_options.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

std::vector<ReviewedLine> of_played(const std::string& scratch) {
  const std::string file = scratch + "/played.json";
  write_text(file, R"({"slot_s": 0.0015, "frames": [{"slot": 3, "time_s": 1, "fingers": [{"id": 0, "solid": "",)"
                   R"("foci_m": [[0, 0.15, 0], [0.01, 0.15, 0]], "order": [1, 0], "dwell_s": 0.0015,)"
                   R"("modulation_hz": 0, "gain": 1}]}]})");
  const std::string told = "has no effect with --played";
  return {{.line = {"export", "--played", file, "--drives", "-"},
           .idle = {{{"--scene", source_file("assets/cube.glb").string()}, told},
                    {{"--source", "synthetic"}, told},
                    {{"--frames", "1"}, told},
                    {{"--foci", "-"}, told},
                    {{"--foci-count", "8"}, told},
                    {{"--dwell", "2ms"}, told},
                    {{"--pressure", "1kPa"}, told},
                    {{"--events", "-"}, told},
                    {{"--gpu", "0"}, told}},
           .tried_as = {"export", "--played", file, "--layout", "openmpd", "--drives", "OUT/drives.bin"},
           .effective = {{{"--layout", "autd3"}}, {{"--hold", "20ms"}}, {{"--ceiling", "0.5"}}, {{"--ramp", "5ms"}}}}};
}

}  // namespace palpa::test
