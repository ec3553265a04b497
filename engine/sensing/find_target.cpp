#include "sensing/find_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "geometry/mesh/topology.hpp"
#include "sensing/flat_patches.hpp"
#include "sensing/target.hpp"

namespace palpa::sensing {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double angle_tolerance = 5 * degree;   // between two patches
constexpr double across_m = 0.16;                // maximum distance between the middles of two patches on the target
constexpr double on_face_m = 3e-3;               // maximum distance of a patch's middle from the target
constexpr double sample_m = 4e-3;                // distance between samples of the target's surface
constexpr double hit_m = 2.5e-3, past_m = 8e-3;  // a seen point is on the surface; is behind the surface
// Samples beyond the faces: their distances from the target; a seen point is in the plane; the cosine from which on
// they are looked at; as many, and as many of the hits, are no chance.
constexpr double least_beyond_m = 8e-3, most_beyond_m = 14e-3, in_plane_m = 1.5e-3, facing_beyond = 0.1;
constexpr int many_beyond = 10;
constexpr double share_beyond = 0.01;
constexpr double least_facing = 0.25;       // cosine above which a sample should be visible
constexpr std::uint64_t least_seen = 2000;  // pixels
constexpr int least_hits = 100;             // samples: 16 square centimetres
constexpr double least_agreement = 0.8;
constexpr double rival_share = 0.8;  // of the best score: a rival with more is too close
constexpr std::size_t most_candidates = 8, most_points = 30000;
constexpr double most_scale = 0.1;             // larger errors would have prevented finding it
constexpr double wide_gate_m = 6e-3;           // for a target of another scale
constexpr double scale_off = 0.015, sure = 6;  // minimum reported error, and its minimum number of standard deviations
constexpr double same_m = 0.01, same_angle = 8 * degree;

struct Sample {
  Vec3 position, normal;  // target frame
};

struct Candidate {
  Transform T_target_camera{1.0};
  int hits = 0, past = 0;
  int beyond = 0;  ///< samples beyond a face where the camera sees something in the face's plane
  bool goes_on() const { return beyond >= many_beyond && beyond > share_beyond * hits; }
  double score() const { return hits - 2.0 * (past + beyond); }
  double agreement() const { return hits > 0 ? static_cast<double>(hits) / (hits + past + beyond) : 0; }
};

Error refused(const Camera& camera, const std::string& fault) {
  return bad_input(fmt::format("camera \"{}\"", printable(camera.name, 60)), fault);
}

/// The images used, and how much of them is usable.
std::string what_is_seen(const StillImage& image) {
  return fmt::format("{} of its {} pixels have a depth and stand still in {} ({} have a depth)", image.seen,
                     image.points.size(),
                     image.first == image.last ? fmt::format("frame {}", image.first)
                                               : fmt::format("frames {} to {}", image.first, image.last),
                     image.deep);
}

/// Samples evenly spread over the mesh, except its underside.
std::vector<Sample> samples_of(const geometry::Mesh& mesh) {
  std::vector<Sample> samples;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const Vec3 normal = unit_normal(mesh, face);
    if (normal.z <= 0) continue;
    const glm::uvec3& t = mesh.triangles[face];
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const int n = std::max(1, static_cast<int>(std::lround(longest_side(mesh, face) / sample_m)));
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        const double u = (i + 1.0 / 3) / n, v = (j + 1.0 / 3) / n;
        samples.push_back({a + u * (b - a) + v * (c - a), normal});
      }
    }
  }
  return samples;
}

/// Samples of the faces' planes just beyond the faces. Where the target is, nothing is seen there; but a wrong pose
/// that takes a board for the plate, 6 mm above it, shifts the slopes in their own planes.
std::vector<Sample> samples_beyond(const std::vector<geometry::Plane>& faces, const geometry::MeshFit& fit) {
  constexpr double reach_m = 0.1;
  std::vector<Sample> samples;
  for (const geometry::Plane& face : faces) {
    const bool plate = face.normal.z == 1;
    const Vec3 across = plate ? Vec3(1, 0, 0) : glm::normalize(glm::cross(Vec3(0, 0, 1), face.normal)),
               up = glm::cross(face.normal, across);
    for (double u = -reach_m; u <= reach_m; u += sample_m) {
      for (double v = -reach_m; v <= reach_m; v += sample_m) {
        const Vec3 at = face.offset * face.normal + u * across + v * up;
        const double side = std::max(std::abs(at.x), std::abs(at.y));
        if (plate ? side < TargetSize::plate_half : at.z < TargetSize::plate_thickness) continue;
        const double off_m = fit.distance(at, most_beyond_m);
        if (off_m > least_beyond_m && off_m < most_beyond_m) samples.push_back({at, face.normal});
      }
    }
  }
  return samples;
}

/// The rotation nearest to a matrix that is nearly one: Newton's iteration for the polar decomposition.
glm::dmat3 nearest_rotation(glm::dmat3 m) {
  for (int i = 0; i < 20; ++i)
    m = 0.5 * (m + glm::transpose(glm::inverse(m)));
  return m;
}

class Search {
 public:
  Search(const Camera& camera, const StillImage& image)
      : camera_(camera),
        image_(image),
        mesh_(make_target()),
        fit_(mesh_),
        faces_(target_faces()),
        samples_(samples_of(mesh_)),
        beyond_(samples_beyond(faces_, fit_)),
        patches_(find_flat_patches(image)) {}

  FoundTarget run() {
    std::vector<Candidate> best = match();
    for (Candidate& candidate : best) {
      refine(candidate, {.gate_m = 8e-3, .steps = 4}, 4000);
      refine(candidate, {.gate_m = 4e-3, .steps = 4}, 4000);
      look(candidate);
    }
    best = distinct(std::move(best));
    const bool any = !best.empty();
    std::erase_if(best, [](const Candidate& candidate) { return candidate.goes_on(); });
    if (any && best.empty()) throw goes_on();
    if (best.empty() || best[0].hits < least_hits || best[0].agreement() < least_agreement) throw not_seen();
    if (best.size() > 1 && best[1].agreement() >= least_agreement && best[1].score() > rival_share * best[0].score()) {
      throw refused(camera_,
                    "two poses of the target explain its view equally well: move camera or target so that it sees more "
                    "of the slopes");
    }
    const geometry::MeshFitted fitted = refine(best[0], {}, most_points);
    const geometry::ScaleFitted scaled = scale_of(best[0]);
    look(best[0]);
    if (fitted.points < least_points) {
      throw refused(
          camera_,
          fmt::format("sees the target with {} points but needs {}: bring the target nearer, or use more pixels",
                      fitted.points, least_points));
    }
    if (fitted.hold < least_hold) {
      throw refused(camera_, fmt::format("its view does not fix the target in all six directions: a shift by 1 mm "
                                         "changes the view by at most {:.2f} mm; let the camera see three faces of the "
                                         "target, the plate and two slopes, each at more than 20 degrees",
                                         fitted.hold));
    }
    return {glm::inverse(fitted.T_mesh_points), fitted, best[0].agreement(), scaled.scale, scaled.deviation};
  }

 private:
  static constexpr std::uint32_t least_points = 500;

  Error not_seen() const {
    return refused(
        camera_,
        fmt::format(
            "does not see the target: {}, and no three of their {} flat patches are faces of the target; aim the "
            "camera so that it sees the plate and two slopes, nearer than 0.8 m and with nothing in front of them",
            what_is_seen(image_), patches_.size()));
  }

  Error goes_on() const {
    return refused(camera_,
                   "what looks like the target's plate or slopes goes on beyond them, and may be the board beneath it: "
                   "aim the camera from higher up, so that it sees the plate and two slopes, each at more than 20 "
                   "degrees, and take away what touches the target");
  }

  /// The best poses according to sets of three patches.
  std::vector<Candidate> match() const {
    std::vector<Candidate> found;
    const std::size_t n = patches_.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) {
        if (!near(i, j)) continue;
        for (std::size_t k = j + 1; k < n; ++k) {
          if (near(i, k) && near(j, k)) match({i, j, k}, found);
        }
      }
    }
    return distinct(std::move(found));
  }

  bool near(std::size_t i, std::size_t j) const {
    return glm::distance(patches_[i].middle, patches_[j].middle) < across_m;
  }

  /// Matches these three patches with any three faces.
  void match(const std::array<std::size_t, 3>& three, std::vector<Candidate>& found) const {
    const std::size_t m = faces_.size();
    for (std::size_t a = 0; a < m; ++a) {
      for (std::size_t b = 0; b < m; ++b) {
        if (b == a || !angle_fits(three[0], three[1], a, b)) continue;
        for (std::size_t c = 0; c < m; ++c) {
          if (c == a || c == b || !angle_fits(three[0], three[2], a, c) || !angle_fits(three[1], three[2], b, c))
            continue;
          consider(three, {a, b, c}, found);
        }
      }
    }
  }

  bool angle_fits(std::size_t i, std::size_t j, std::size_t a, std::size_t b) const {
    const auto angle = [](const Vec3& p, const Vec3& q) { return std::acos(std::clamp(glm::dot(p, q), -1.0, 1.0)); };
    return std::abs(angle(patches_[i].plane.normal, patches_[j].plane.normal) -
                    angle(faces_[a].normal, faces_[b].normal)) < angle_tolerance;
  }

  void consider(const std::array<std::size_t, 3>& three, const std::array<std::size_t, 3>& faces,
                std::vector<Candidate>& found) const {
    glm::dmat3 seen(1.0), known(1.0);
    Vec3 offsets(0);
    for (int i = 0; i < 3; ++i) {
      const geometry::Plane& patch = patches_[three[static_cast<std::size_t>(i)]].plane;
      const geometry::Plane& face = faces_[faces[static_cast<std::size_t>(i)]];
      seen[i] = patch.normal;
      known[i] = face.normal;
      offsets[i] = face.offset - patch.offset;
    }
    // Mirrored matches have the other sign; nearly flat ones are inconclusive.
    if (std::abs(glm::determinant(seen)) < 0.1 || glm::determinant(seen) * glm::determinant(known) < 0) return;
    const glm::dmat3 rotation = nearest_rotation(known * glm::inverse(seen));
    const Vec3 shift = glm::inverse(glm::transpose(known)) * offsets;
    Candidate candidate;
    candidate.T_target_camera = Transform(rotation);
    candidate.T_target_camera[3] = Vec4(shift, 1);
    for (const std::size_t i : three) {
      if (fit_.distance(transform_point(candidate.T_target_camera, patches_[i].middle), 0.1) > on_face_m) return;
    }
    look(candidate);
    if (candidate.hits >= least_hits / 2 && candidate.score() > 0) found.push_back(candidate);
  }

  /// Compares the camera's view with the target's expected surface.
  void look(Candidate& candidate) const {
    const Transform T_camera_target = glm::inverse(candidate.T_target_camera);
    candidate.hits = candidate.past = candidate.beyond = 0;
    for (const Sample& sample : samples_) {
      const std::optional<Behind> seen = behind(T_camera_target, sample, least_facing);
      if (!seen) continue;
      if (std::abs(seen->off_m) < hit_m)
        ++candidate.hits;
      else if (seen->off_m < -hit_m && seen->farther_m > past_m)
        ++candidate.past;
    }
    for (const Sample& sample : beyond_) {
      const std::optional<Behind> seen = behind(T_camera_target, sample, facing_beyond);
      if (seen && std::abs(seen->off_m) < in_plane_m) ++candidate.beyond;
    }
  }

  /// What the camera sees in the direction of a sample: its distance from the sample's plane, and how much farther away
  /// it is.
  struct Behind {
    double off_m, farther_m;
  };
  /// nullopt where the sample faces away, or nothing is seen.
  std::optional<Behind> behind(const Transform& T_camera_target, const Sample& sample, double facing) const {
    const Vec3 at = transform_point(T_camera_target, sample.position);
    const Vec3 normal = transform_direction(T_camera_target, sample.normal);
    if (at.z <= 0 || glm::dot(normal, at) > -facing * glm::length(at)) return std::nullopt;
    const Vec2 pixel = project(camera_, at);
    const double u = std::round(pixel.x), v = std::round(pixel.y);
    if (!(u >= 0 && v >= 0 && u < image_.width && v < image_.height)) return std::nullopt;
    const glm::vec3& seen = image_.at(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
    if (seen.z <= 0) return std::nullopt;
    return Behind{glm::dot(normal, Vec3(seen) - at), seen.z - at.z};
  }

  /// The best candidate of each neighbourhood, the best first.
  static std::vector<Candidate> distinct(std::vector<Candidate> all) {
    std::stable_sort(all.begin(), all.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score() > b.score(); });
    std::vector<Candidate> kept;
    for (const Candidate& candidate : all) {
      if (kept.size() == most_candidates) break;
      if (std::none_of(kept.begin(), kept.end(), [&](const Candidate& k) { return same(k, candidate); }))
        kept.push_back(candidate);
    }
    return kept;
  }

  static bool same(const Candidate& a, const Candidate& b) {
    const Transform between = a.T_target_camera * glm::inverse(b.T_target_camera);
    const double trace = between[0][0] + between[1][1] + between[2][2];
    return glm::length(Vec3(between[3])) < same_m && std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) < same_angle;
  }

  /// Starts from the candidate's pose. Three faces fit at every scale, so the scale rests on the roof and other visible
  /// faces. These few points are so far off that they would count as outliers among the others. The first fit therefore
  /// treats nothing as an outlier.
  geometry::ScaleFitted scale_of(const Candidate& candidate) const {
    const std::vector<geometry::MeasuredPoint> near = points_near(candidate, wide_gate_m, most_points);
    const geometry::ScaleFitted first =
        fit_.fit_scale(near, candidate.T_target_camera, {.gate_m = wide_gate_m, .steps = 6, .tukey = 100});
    const geometry::ScaleFitted second = fit_.fit_scale(near, first.T_mesh_points, {});
    // An undetermined scale can take any value.
    return std::isfinite(second.deviation) && std::abs(second.scale - 1) < most_scale ? second
                                                                                      : geometry::ScaleFitted{};
  }

  /// The points inside the target's box, with their errors; at most `most`, evenly selected.
  std::vector<geometry::MeasuredPoint> points_near(const Candidate& candidate, double gate_m, std::size_t most) const {
    std::vector<geometry::MeasuredPoint> near;
    const double wide = TargetSize::plate_half + gate_m;
    const double high = TargetSize::plate_thickness + TargetSize::height + gate_m;
    for (const glm::vec3& point : image_.points) {
      if (point.z <= 0) continue;
      const Vec3 at = transform_point(candidate.T_target_camera, Vec3(point));
      if (std::abs(at.x) > wide || std::abs(at.y) > wide || at.z < 0 || at.z > high) continue;
      // Along the ray, and proportional to the squared distance, like a step of disparity.
      near.push_back({Vec3(point), Vec3(point) * static_cast<double>(point.z)});
    }
    if (near.size() > most) {
      std::vector<geometry::MeasuredPoint> fewer;
      for (std::size_t i = 0; i < most; ++i)
        fewer.push_back(near[i * near.size() / most]);
      near = std::move(fewer);
    }
    return near;
  }

  geometry::MeshFitted refine(Candidate& candidate, const geometry::FitOptions& options, std::size_t most) const {
    const std::vector<geometry::MeasuredPoint> near = points_near(candidate, options.gate_m, most);
    const geometry::MeshFitted fitted = fit_.fit(near, candidate.T_target_camera, options);
    candidate.T_target_camera = fitted.T_mesh_points;
    return fitted;
  }

  const Camera& camera_;
  const StillImage& image_;
  geometry::Mesh mesh_;
  geometry::MeshFit fit_;
  std::vector<geometry::Plane> faces_;
  std::vector<Sample> samples_, beyond_;
  std::vector<FlatPatch> patches_;
};

}  // namespace

bool scale_is_off(const FoundTarget& found) {
  const double off = std::abs(found.scale - 1);
  return off >= scale_off && off > sure * found.scale_deviation;
}

FoundTarget find_target(const Camera& camera, const StillImage& image) {
  if (image.seen < least_seen) {
    throw refused(camera,
                  fmt::format("only {}, but {} are needed: {}", what_is_seen(image), least_seen,
                              image.deep < least_seen
                                  ? fmt::format("is something in front of it, or is everything nearer than {:.2f} m?",
                                                camera.min_range_m)
                                  : "hold the camera and everything in front of it still"));
  }
  return Search(camera, image).run();
}

}  // namespace palpa::sensing
