// Checks whether a mesh can scatter sound, with errors and warnings if it cannot.
#pragma once

#include <string>

#include "array/layouts/layout.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/surface/surface.hpp"

namespace palpa::acoustics {

/// `mesh` is welded; the result faces outwards and has the same triangles in the same order. Throws bad_input naming
/// `file`: no triangle, one without area, one too small for single precision, an open edge or one with more than two
/// faces, neighbours that face opposite ways, a surface that passes through itself or touches itself, a piece that lies
/// within another (a cavity, which no sound reaches). Pieces that face inwards are reversed, with a warning.
geometry::Mesh body_mesh(const std::string& file, const geometry::Mesh& mesh);

/// Mean length of a triangle's sides, metres.
double mean_side(const geometry::Mesh& mesh);

/// The length that 95 % of the sides of a mesh's triangles do not exceed, metres.
double long_side(const geometry::Mesh& mesh);

/// Linear elements can only represent a wave if they are small enough. Warns if the mean side exceeds a sixth of the
/// wavelength, or the long side 1/5.5 of it. If the mean side is above a third, throws bad_input, or warns if `force`.
void check_fineness(const std::string& file, const geometry::Mesh& body, double wavelength_m, bool force);

/// Warns of faces more than ten times as long as high, and names the worst. They take longer, because more of the other
/// faces are near to them. Elements that are fine across and coarse along represent a wave no better than the coarse
/// direction.
void warn_of_needles(const std::string& file, const geometry::Mesh& body);

/// The root mean square of the angles between neighbouring faces, weighted by their areas, in radians. Sharp edges
/// (elements/patches.hpp) do not count.
double mean_bend(const geometry::Mesh& body);
/// Warns if it is more than 12 degrees: on spheres of 80 and 180 faces, the radiation pressures of single faces are
/// then more than 2 % off, and the force may be 1 % off, however long the wave is.
void warn_of_bends(const std::string& file, const geometry::Mesh& body);

/// A wave that bends more sharply than the faces is not resolved. Warns if a point source is nearer than twice the mean
/// side of the face next to it. Throws bad_usage if the source is within the body. If it is nearer than half a side,
/// throws bad_usage, or warns if `force`.
void check_source(const geometry::Mesh& body, const Vec3& source, bool force);

/// Throws bad_input if a transducer stands within the body, or nearer to it than its radius, and if the body reaches
/// into the wall that the transducers form, or stands behind it. Both are in the same frame.
void check_clear_of(const std::string& file, const geometry::Mesh& body, const array::Layout& layout);

/// Throws failure if the solution needs more memory than is free. `wave_number` in 1/m.
void check_memory(const geometry::Mesh& body, double wave_number);

/// Tests whether points lie within the body, where there is no sound.
class Inside {
 public:
  explicit Inside(const geometry::Mesh& body);
  bool holds(const Vec3& point) const;

 private:
  Box bounds_;
  geometry::Surface surface_;
};

}  // namespace palpa::acoustics
