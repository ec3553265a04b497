// Which meshes sound can be scattered by, and what is said of others.
#pragma once

#include <string>

#include "array/layout.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/surface/surface.hpp"

namespace palpa::acoustics {

/// `mesh` welded, facing outwards; its triangles are the given ones, in the same order. Throws bad_input naming `file`:
/// no triangle, one without area, an open edge or one with more than two faces, neighbours that face opposite ways, a
/// surface that passes through itself or touches itself, a piece that lies within another (a cavity, where no sound
/// gets). Pieces that face inwards are turned over, with a warning.
geometry::Mesh body_mesh(const std::string& file, const geometry::Mesh& mesh);

/// Mean length of a triangle's sides, metres.
double mean_side(const geometry::Mesh& mesh);

/// Linear elements follow a wave if there are enough of them: warns where the mean side is above a sixth of the
/// wavelength, and above a third throws bad_input, or warns if `force`.
void check_fineness(const std::string& file, const geometry::Mesh& body, double wavelength_m, bool force);

/// Warns of faces more than ten times as long as high, and names the worst: they take longer, for more of the others
/// are near to them, and elements that are fine across and coarse along follow a wave no better than the coarse.
void warn_of_needles(const std::string& file, const geometry::Mesh& body);

/// A wave that bends more sharply than the faces is not resolved: warns where a point source is nearer than twice the
/// mean side of the face next to it, and throws bad_usage within the body, and nearer than half a side, of which it
/// warns if `force`.
void check_source(const geometry::Mesh& body, const Vec3& source, bool force);

/// Throws bad_input where a transducer stands within the body, or nearer to it than its radius; and where the body
/// reaches into the wall that transducers make, or stands behind it. Both in one frame.
void check_clear_of(const std::string& file, const geometry::Mesh& body, const array::Layout& layout);

/// Throws failure where the solution needs more memory than is free.
void check_memory(const geometry::Mesh& body);

/// Whether points lie within the body: there is no sound there.
class Inside {
 public:
  explicit Inside(const geometry::Mesh& body);
  bool holds(const Vec3& point) const;

 private:
  Box bounds_;
  geometry::Surface surface_;
};

}  // namespace palpa::acoustics
