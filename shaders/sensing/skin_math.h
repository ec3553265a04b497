// The arithmetic of skin points, for the shaders and their twin; see exact_math.h.
#ifndef PALPA_SHADERS_SKIN_MATH_H
#define PALPA_SHADERS_SKIN_MATH_H
#include "shaders/sensing/skin.h"
#include "shaders/shared/exact_math.h"
PALPA_SHADER_BEGIN

// A coordinate of a point in another frame, from a row of the transform.
PALPA_FN float in_frame(vec4 row, Float3 p) {
  PALPA_EXACT float along = ((row.x * p.x + row.y * p.y) + row.z * p.z) + row.w;
  return along;
}

// The point of a pixel with this depth and ray.
PALPA_FN Float3 pixel_point(float depth, float ray_x, float ray_y) {
  PALPA_EXACT Float3 p;
  p.x = ray_x * depth;
  p.y = ray_y * depth;
  p.z = depth;
  return p;
}

// Whether a point is no skin because of this volume.
PALPA_FN bool drops_point(SkinVolume volume, Float3 p) {
  if (volume.kind == skin_room)
    return p.x < volume.x.x || p.y < volume.x.y || p.z < volume.x.z || p.x > volume.y.x || p.y > volume.y.y ||
           p.z > volume.y.z;
  const float x = in_frame(volume.x, p);
  const float y = in_frame(volume.y, p);
  const float z = in_frame(volume.z, p);
  return x >= -volume.half_width && x <= volume.half_width && y >= -volume.half_height && y <= volume.half_height &&
         z >= -skin_behind_m && z <= skin_before_m;
}

PALPA_SHADER_END
#endif
