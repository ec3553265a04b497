// Prints how much foci move from frame to frame, without and with steady foci. It is not a test; run it by hand. It
// makes the tables of docs/notes/steady-foci.md. Argument: foci per finger (default 10).
#include <cstdio>
#include <cstdlib>

#include "cli/support/steady_films.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

void print(const char* how, const Movement& m) {
  std::printf("  %-22s %5.2f %5.2f %5.2f   %5.2f %5.2f", how, m.share(0.5) * 1e3, m.share(0.95) * 1e3, m.share(1) * 1e3,
              Movement::at(m.absolute, 0.95) * 1e3, Movement::at(m.absolute, 1) * 1e3);
}

void run(std::uint32_t foci) {
  std::printf(
      "mm per frame of the focus that moves most: median, 95 %%, most relative to the mean; 95 %%, most in all\n");
  for (const std::string object : {"cube", "semi-sphere", "pyramid", "prism"}) {
    std::vector<Film> films{resting(object, 60), dipping(object, 190), sliding(object, false, false), fast(object, 2)};
    if (object == "prism") films.push_back(sliding(object, true, false));
    for (const Film& film : films) {
      std::printf("%s, %s\n", film.object.c_str(), film.name.c_str());
      const int leave_out = film.name == "dipping" ? 3 : 0;
      const auto lines = played(film, {{object, touch::Axes::covariance, touch::Smoothing::none, foci},
                                       {object, touch::Axes::steady, touch::Smoothing::none, foci},
                                       {object, touch::Axes::steady, touch::Smoothing::one_euro, foci}});
      const auto &alone = lines[0], &steady = lines[1], &smooth = lines[2];
      print("each frame by itself", movement_of(alone, leave_out));
      std::printf("\n");
      print("steady axes", movement_of(steady, leave_out));
      std::printf("\n");
      print("and smoothing", movement_of(smooth, leave_out));
      std::printf("   lag %.1f ms, %zu frames\n", lag_of(steady, smooth) * 1e3, smooth.size());
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace palpa::test

int main(int argc, char** argv) {
  setenv("PALPA_ASSETS", palpa::test::source_file("assets").c_str(), 1);
  palpa::test::run(argc > 1 ? static_cast<std::uint32_t>(std::stoul(argv[1])) : 10);
}
