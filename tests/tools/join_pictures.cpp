// join_pictures LEFT.png RIGHT.png OUT.png: joins the two side by side.

#include "assets/generators/program.hpp"
#include "base/error.hpp"
#include "drawing/png.hpp"

namespace {

void join(const char* left_file, const char* right_file, const char* out_file) {
  const palpa::drawing::Pixels left = palpa::drawing::read_png(left_file), right = palpa::drawing::read_png(right_file);
  if (left.height != right.height)
    throw palpa::bad_input(right_file, "is not as high as the picture that goes to its left");
  palpa::drawing::Pixels out;
  out.width = left.width + right.width;
  out.height = left.height;
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (const auto* part : {&left, &right})
      out.rgba.insert(out.rgba.end(), part->at(0, y), part->at(0, y) + std::size_t{4} * part->width);
  }
  palpa::drawing::write_png(out_file, out);
}

}  // namespace

int main(int argc, char** argv) {
  return palpa::assets::run_program([&] {
    if (argc != 4) throw palpa::bad_usage("usage: join_pictures LEFT.png RIGHT.png OUT.png");
    join(argv[1], argv[2], argv[3]);
  });
}
