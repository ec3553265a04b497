#include "sensing/rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/files/outputs.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rays.hpp"
#include "sensing/rig_toml.hpp"

namespace palpa::sensing {
namespace {

constexpr double most_metres = 1e4;
constexpr std::size_t most_cameras = 64;

/// File names are relative to the rig's folder.
std::string resolve(const std::filesystem::path& folder, const std::string& file) {
  return std::filesystem::absolute(folder / file).lexically_normal().string();
}

/// A layout is a built-in name unless it looks like a file name.
std::string resolve_layout(const std::string& layout, const std::filesystem::path& rig_file) {
  const std::filesystem::path path(layout);
  if (path.extension() != ".toml" && layout.find('/') == std::string::npos) return layout;
  return resolve(rig_file.parent_path(), layout);
}

/// Warns if the pose is probably in millimetres.
Transform plausible_pose(TomlTable& table, const char* key) {
  constexpr double farthest = 20;  // metres
  const Transform pose = table.pose(key);
  const double away = glm::length(Vec3(pose[3]));
  if (away > farthest) {
    log::warning(
        fmt::format("{}: {} lies {:.3g} m from the world's origin; if its last column is in millimetres, "
                    "multiply that by 0.001",
                    table.place(key), key, away));
  }
  return pose;
}

PixelBox read_roi(TomlTable& table, const Camera& camera) {
  const std::vector<double> n = table.numbers("roi", 4);
  const auto whole = [](double value) { return value >= 0 && value <= 16384 && value == std::floor(value); };
  if (!std::all_of(n.begin(), n.end(), whole)) {
    throw table.fault("roi", "roi must be four whole numbers of pixels: [x, y, width, height]");
  }
  const bool empty = n[2] == 0 || n[3] == 0;
  if (empty || n[0] + n[2] > camera.width || n[1] + n[3] > camera.height) {
    throw table.fault("roi", fmt::format("roi [{}, {}, {}, {}] {} of {}x{} pixels", n[0], n[1], n[2], n[3],
                                         empty ? "holds no pixel of the image" : "reaches outside of the image",
                                         camera.width, camera.height));
  }
  const auto pixels = [](double value) { return static_cast<std::uint32_t>(value); };
  return {pixels(n[0]), pixels(n[1]), pixels(n[0] + n[2]), pixels(n[1] + n[3])};
}

/// `rate_hz` 0: unknown.
DeviceSetting read_device(TomlTable& table, double rate_hz) {
  DeviceSetting device;
  const std::string lens = table.text_or("calibration", "file");
  if (lens != "file" && lens != "device")
    throw table.fault("calibration", "calibration is '" + lens + "'; known are file and device");
  device.own_lens = lens == "device";
  if (table.has("exposure_s")) {
    device.exposure_s = table.number("exposure_s", 0, 0.2);
    if (*device.exposure_s * rate_hz > 1) {
      throw table.fault("exposure_s", fmt::format("exposure_s of {:g} is longer than a frame at {:g} Hz: at most {:g}, "
                                                  "or a lower rate_hz",
                                                  *device.exposure_s, rate_hz, std::floor(1e4 / rate_hz) * 1e-4));
    }
  }
  if (table.has("hardware_preset")) device.preset = static_cast<std::uint8_t>(table.whole("hardware_preset", 0, 255));
  return device;
}

bool sees_anything(const Camera& camera) {
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      if (!is_ignored(camera, u, v)) return true;
    }
  }
  return false;
}

void read_mask(TomlTable& table, const std::filesystem::path& folder, Camera& camera) {
  auto mask = std::make_shared<Mask>();
  mask->file = resolve(folder, table.text("mask"));
  try {
    read_png8(mask->file, camera.width, camera.height, mask->pixels);
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    throw table.fault("mask", fmt::format("mask {}", error.what()));
  }
  camera.mask = std::move(mask);
  if (!sees_anything(camera)) {
    throw table.fault("mask", fmt::format("mask {}: leaves this camera no pixel; pixels of 0 are ignored{}",
                                          camera.mask->file, camera.roi ? ", and so are those outside roi" : ""));
  }
}

/// The words by which a background's image names its camera.
std::string camera_of_background(const Camera& camera) {
  return fmt::format("{} with depth_unit_m = {}", camera.name, toml_number(camera.depth_unit_m));
}

void read_background(TomlTable& table, const std::filesystem::path& folder, Camera& camera) {
  auto background = std::make_shared<Background>();
  background->file = resolve(folder, table.text("background"));
  background->margin_m = table.number("background_margin_m", 0, 1);
  std::string learned_by;
  try {
    read_png16(background->file, camera.width, camera.height, background->depth, learned_by);
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    throw table.fault("background", fmt::format("background {}", error.what()));
  }
  const std::string own = camera_of_background(camera);
  if (!learned_by.empty() && learned_by != own) {
    throw table.fault("background",
                      fmt::format("background {}: is of the camera {}, and this is {}; name its own image, or learn a "
                                  "new one with palpa calibrate --background",
                                  background->file, printable(learned_by, 80), printable(own, 80)));
  }
  camera.background = std::move(background);
}

}  // namespace

void write_background(const std::filesystem::path& file, const Camera& camera) {
  write_png16(file, camera.width, camera.height, camera.background->depth, camera_of_background(camera));
}

/// Without its mask, which is only read once the total number of pixels has been checked.
static Camera read_camera(TomlTable& table, std::size_t place) {
  Camera camera;
  camera.name = table.text_or("name", fmt::format("camera {}", place + 1));
  camera.width = static_cast<std::uint32_t>(table.whole("width", 1, 16384));
  camera.height = static_cast<std::uint32_t>(table.whole("height", 1, 16384));
  camera.fx = table.number("fx", 1e-3, 1e7);
  camera.fy = table.number("fy", 1e-3, 1e7);
  camera.cx = table.number("cx", -1e6, 1e6);
  camera.cy = table.number("cy", -1e6, 1e6);
  if (const std::string odd = implausible_lens(camera); !odd.empty())
    log::warning(fmt::format("{}: {}", table.place("fx"), odd));
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
  if (const std::string odd = implausible_unit(camera.depth_unit_m); !odd.empty())
    log::warning(fmt::format("{}: {}", table.place("depth_unit_m"), odd));
  camera.min_range_m = table.number_or("min_range_m", 0, 0, most_metres);
  if (const std::string odd = implausible_range(camera.min_range_m); !odd.empty())
    log::warning(fmt::format("{}: {}", table.place("min_range_m"), odd));
  camera.rate_hz = table.number_or("rate_hz", 0, 0, 1e6);
  if (table.has("T_world_camera")) camera.T_world_camera = plausible_pose(table, "T_world_camera");
  if (table.has("residual_m")) camera.residual_m = table.number("residual_m", 0, 1);
  if (table.has("roi")) camera.roi = read_roi(table, camera);
  camera.device = read_device(table, camera.rate_hz);
  return camera;
}

std::vector<Camera> read_cameras(TomlTable& root, const std::filesystem::path& folder, ReferenceFolder* references) {
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
    if (table.has("mask")) {
      if (references != nullptr) references->find(table.text("mask"), "mask");
      read_mask(table, folder, cameras.back());
    }
    if (table.has("background")) {
      if (references != nullptr) references->find(table.text("background"), "background");
      read_background(table, folder, cameras.back());
    } else if (table.has("background_margin_m")) {
      throw table.fault("background_margin_m", "background_margin_m goes with background, the image without a hand");
    }
    table.done();
  }
  return cameras;
}

Rig load_rig(const std::filesystem::path& file) {
  TomlTable root = TomlTable::load(file, "a rig");
  Rig rig;
  rig.file = file.string();
  rig.cameras = read_cameras(root, file.parent_path());
  if (auto table = root.table("array")) {
    ArrayPlacement& array = rig.array.emplace();
    array.layout = resolve_layout(table->text("layout"), file);
    array.where = table->place("layout");
    if (array.layout.find('/') != std::string::npos) refuse_output_as_input(std::filesystem::path(array.layout));
    if (table->has("T_world_layout")) array.T_world_layout = plausible_pose(*table, "T_world_layout");
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
  if (auto table = root.table("room")) {
    Room& room = rig.room.emplace();
    room.where = table->place("");
    const std::vector<double> low = table->numbers("low_m", 3), high = table->numbers("high_m", 3);
    for (int i = 0; i < 3; ++i) {
      room.box.low[i] = low[i];
      room.box.high[i] = high[i];
      if (!(low[i] < high[i]))
        throw table->fault(
            "high_m", fmt::format("high_m must be above low_m in x, y and z, but {} is not above {}", high[i], low[i]));
      if (std::max(std::abs(low[i]), std::abs(high[i])) > most_metres)
        throw table->fault("high_m", fmt::format("the room reaches more than {} m away", most_metres));
    }
    table->done();
  }
  if (auto table = root.table("joints")) {
    rig.T_world_joints = plausible_pose(*table, "T_world_joints");
    if (table->has("residual_m")) rig.joints_residual_m = table->number("residual_m", 0, 1);
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
  if (camera.residual_m) text += fmt::format("residual_m = {}\n", toml_number(*camera.residual_m));
  if (const auto& roi = camera.roi)
    text += fmt::format("roi = [{}, {}, {}, {}]\n", roi->x0, roi->y0, roi->x1 - roi->x0, roi->y1 - roi->y0);
  if (camera.device.own_lens) text += "calibration = \"device\"\n";
  if (camera.device.exposure_s) text += fmt::format("exposure_s = {}\n", toml_number(*camera.device.exposure_s));
  if (camera.device.preset) text += fmt::format("hardware_preset = {}\n", *camera.device.preset);
  if (camera.mask) text += fmt::format("mask = {}\n", toml_string(camera.mask->file));
  if (camera.background) {
    text += fmt::format("background = {}\nbackground_margin_m = {}\n", toml_string(camera.background->file),
                        toml_number(camera.background->margin_m));
  }
  return text;
}

void check_camera(const Camera& camera, const std::string& name) {
  TomlTable root = TomlTable::parse(to_toml(camera), name, "a camera", {}, false);
  read_cameras(root, {});
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
  if (rig.room) {
    const Box& box = rig.room->box;
    text += fmt::format("{}[room]\nlow_m = [{}, {}, {}]\nhigh_m = [{}, {}, {}]\n", rig.screen ? "\n" : "",
                        toml_number(box.low.x), toml_number(box.low.y), toml_number(box.low.z), toml_number(box.high.x),
                        toml_number(box.high.y), toml_number(box.high.z));
  }
  if (rig.T_world_joints) {
    text += fmt::format("{}[joints]\nT_world_joints = {}\n", rig.screen || rig.room ? "\n" : "",
                        toml_pose(*rig.T_world_joints));
    if (rig.joints_residual_m) text += fmt::format("residual_m = {}\n", toml_number(*rig.joints_residual_m));
  }
  return text;
}

}  // namespace palpa::sensing
