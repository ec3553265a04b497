#include "sensing/rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/outputs.hpp"
#include "sensing/rays.hpp"
#include "sensing/rig_toml.hpp"

namespace palpa::sensing {
namespace {

constexpr double most_metres = 1e4;
constexpr std::size_t most_cameras = 64;

/// A layout is a built-in name unless it looks like a file; files are found from where the rig stands.
std::string resolve_layout(const std::string& layout, const std::filesystem::path& rig_file) {
  const std::filesystem::path path(layout);
  if (path.extension() != ".toml" && layout.find('/') == std::string::npos) return layout;
  return std::filesystem::absolute(rig_file.parent_path() / path).lexically_normal().string();
}

}  // namespace

static Camera read_camera(TomlTable& table, std::size_t place) {
  Camera camera;
  camera.name = table.text_or("name", fmt::format("camera {}", place + 1));
  camera.width = static_cast<std::uint32_t>(table.whole("width", 1, 16384));
  camera.height = static_cast<std::uint32_t>(table.whole("height", 1, 16384));
  camera.fx = table.number("fx", 1e-3, 1e7);
  camera.fy = table.number("fy", 1e-3, 1e7);
  camera.cx = table.number("cx", -1e6, 1e6);
  camera.cy = table.number("cy", -1e6, 1e6);
  if (table.has("distortion")) {
    const std::vector<double> values = table.numbers("distortion", camera.distortion.size());
    std::copy(values.begin(), values.end(), camera.distortion.begin());
    if (const auto blind = find_blind_pixel(camera)) {
      throw table.fault(
          "distortion",
          fmt::format("distortion cannot be undone at pixel ({:.0f}, {:.0f}): no ray of this lens reaches "
                      "it before the model folds back on itself; give a calibration of the whole image",
                      blind->x, blind->y));
    }
  }
  camera.depth_unit_m = table.number_or("depth_unit_m", camera.depth_unit_m, 1e-9, 1);
  camera.min_range_m = table.number_or("min_range_m", 0, 0, most_metres);
  camera.rate_hz = table.number_or("rate_hz", 0, 0, 1e6);
  if (table.has("T_world_camera")) camera.T_world_camera = table.pose("T_world_camera");
  table.done();
  return camera;
}

std::vector<Camera> read_cameras(TomlTable& root) {
  std::vector<Camera> cameras;
  for (TomlTable& table : root.tables("camera")) {
    if (cameras.size() == most_cameras) throw table.fault("", fmt::format("more than {} cameras", most_cameras));
    cameras.push_back(read_camera(table, cameras.size()));
    if (const std::uint64_t pixels = padded_pixels(cameras); pixels > most_pixels) {
      throw table.fault("width",
                        fmt::format("the cameras so far have {} pixels together (rows padded to blocks of {}); "
                                    "palpa takes at most {}",
                                    pixels, block_pixels, most_pixels));
    }
  }
  return cameras;
}

Rig load_rig(const std::filesystem::path& file) {
  TomlTable root = TomlTable::load(file, "a rig");
  Rig rig;
  rig.file = file.string();
  rig.cameras = read_cameras(root);
  if (auto table = root.table("array")) {
    ArrayPlacement& array = rig.array.emplace();
    array.layout = resolve_layout(table->text("layout"), file);
    array.where = table->place("layout");
    if (array.layout.find('/') != std::string::npos) refuse_output_as_input(std::filesystem::path(array.layout));
    if (table->has("T_world_layout")) array.T_world_layout = table->pose("T_world_layout");
    table->done();
  }
  if (auto table = root.table("screen")) {
    Screen& screen = rig.screen.emplace();
    screen.width_m = table->number("width_m", 1e-3, 1e3);
    screen.height_m = table->number("height_m", 1e-3, 1e3);
    screen.T_world_screen = table->pose("T_world_screen");
    const std::vector<double> eye = table->numbers("eye_m", 3);
    for (int i = 0; i < 3; ++i) {
      if (std::abs(eye[i]) > most_metres)
        throw table->fault("eye_m", fmt::format("eye_m lies more than {} m away", most_metres));
      screen.eye_m[i] = eye[i];
    }
    table->done();
  }
  root.done();
  return rig;
}

std::string to_toml(const Camera& camera) {
  const auto& k = camera.distortion;
  std::string text = "[[camera]]\n";
  text += fmt::format("name = {}\nwidth = {}\nheight = {}\n", toml_string(camera.name), camera.width, camera.height);
  text += fmt::format("fx = {}\nfy = {}\ncx = {}\ncy = {}\n", toml_number(camera.fx), toml_number(camera.fy),
                      toml_number(camera.cx), toml_number(camera.cy));
  text += fmt::format("distortion = [{}, {}, {}, {}, {}]\n", toml_number(k[0]), toml_number(k[1]), toml_number(k[2]),
                      toml_number(k[3]), toml_number(k[4]));
  text += fmt::format("depth_unit_m = {}\nmin_range_m = {}\nrate_hz = {}\n", toml_number(camera.depth_unit_m),
                      toml_number(camera.min_range_m), toml_number(camera.rate_hz));
  text += fmt::format("T_world_camera = {}\n", toml_pose(camera.T_world_camera));
  return text;
}

std::string to_toml(const Rig& rig) {
  std::string text;
  for (const Camera& camera : rig.cameras)
    text += to_toml(camera) + "\n";
  if (rig.array) {
    text += fmt::format("[array]\nlayout = {}\n", toml_string(rig.array->layout));
    if (rig.array->T_world_layout) text += fmt::format("T_world_layout = {}\n", toml_pose(*rig.array->T_world_layout));
    text += "\n";
  }
  if (rig.screen) {
    const Screen& screen = *rig.screen;
    text += fmt::format("[screen]\nwidth_m = {}\nheight_m = {}\nT_world_screen = {}\neye_m = [{}, {}, {}]\n",
                        toml_number(screen.width_m), toml_number(screen.height_m), toml_pose(screen.T_world_screen),
                        toml_number(screen.eye_m.x), toml_number(screen.eye_m.y), toml_number(screen.eye_m.z));
  }
  return text;
}

}  // namespace palpa::sensing
