// A rig without real cameras: renders meshes into 16-bit depth frames as a D415 would see them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "sensing/depth_noise.hpp"
#include "sensing/depth_source.hpp"
#include "sensing/rays.hpp"

namespace palpa::sensing {

enum class Noise {
  none,  ///< exact depths, rounded to the camera's depth unit
  d415,  ///< depth_noise.hpp
};

/// A mesh and its pose.
struct Posed {
  const geometry::Mesh* mesh = nullptr;
  Transform T_world_mesh{1.0};
  std::string name = "the mesh";  ///< its file, for errors
};

/// Renders by casting each pixel centre's ray (through the lens distortion) at the triangles; the nearest hit wins.
/// Static parts and everything derived from them are rendered once. The time for a frame depends on the area that the
/// skin covers, plus the noise of everything visible. Throws bad_input for a mesh in which so many layers lie behind
/// each other that an image would take more than 64 rays per pixel.
class SyntheticRig {
 public:
  /// `occluders` (world coordinates, e.g. the array's boards) never move. They are visible and hide what is behind
  /// them.
  SyntheticRig(std::vector<Camera> cameras, const geometry::Mesh& occluders, Noise noise, std::uint64_t seed,
               const std::string& occluders_name = "the occluders");

  const std::vector<Camera>& cameras() const { return cameras_; }
  /// The frames of all cameras with `skin` in them. Does not set times. The same seed, `sequence` and meshes give the
  /// same bytes.
  void render(std::span<const Posed> skin, std::uint64_t sequence, FrameSet& out);

 private:
  struct Layer {
    std::vector<float> depth, slant;  ///< as in DepthImage
    std::vector<Risk> risks;          ///< only with noise
    void copy(const Layer& from, const PixelBox& box, std::uint32_t width);
  };
  /// The images of one camera.
  struct CameraImages {
    Layer still, shown;                       ///< the occluders alone; the occluders with the skin of the last frame,
    PixelBox skin;                            ///< the pixels outside which both are equal
    std::vector<RowSpan> still_spans, spans;  ///< the same for the spans
  };
  struct Drawing;
  DepthImage image(std::size_t camera, const Layer& layer) const;
  PixelBox draw(std::size_t camera, const geometry::Mesh& mesh, const Transform& T_world_mesh, const std::string& name,
                Layer& layer);
  void finish_still(std::size_t camera);
  void show(std::size_t camera, std::span<const Posed> skin);

  std::vector<Camera> cameras_;
  RayTables tables_;
  std::vector<CameraImages> images_;
  DepthNoise noise_maker_;
  Noise noise_;
  std::uint64_t seed_;

  /// A corner of a mesh in the camera's coordinates.
  struct Corner {
    Vec3 position;
    double x = 0, y = 0;  ///< of its ray
  };
  std::vector<Corner> corners_;
};

/// The pose of the skin at a given time.
using Motion = std::function<Transform(double time_s)>;

/// A fingertip that dips into an object whose top is at y = 0 and comes out again every 2 s, between y = +4 and -4 mm,
/// with a lateral sway of a few millimetres. It starts at y = 0, moving down.
Transform dipping_motion(double time_s);

struct SyntheticOptions {
  Motion motion = dipping_motion;
  Noise noise = Noise::d415;
  std::uint64_t seed = 1;
  std::string skin_name = "the mesh", occluders_name = "the occluders";  ///< their files, for errors
  double rate_hz = 0;  ///< 0: the first camera's, or 90 if that is not set
  /// Frames come in real time at the rate, and those that are not fetched are dropped. Otherwise frames come as fast as
  /// requested, and none is dropped.
  bool paced = true;
  std::optional<std::uint64_t> frames;  ///< the stream ends after this many sequence numbers
};

/// Frame s is taken at s / rate on the source's clock.
std::unique_ptr<DepthSource> make_synthetic_source(std::vector<Camera> cameras, geometry::Mesh skin,
                                                   const geometry::Mesh& occluders, SyntheticOptions options = {});

}  // namespace palpa::sensing
