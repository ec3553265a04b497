// Shared by viewer/ and shaders/viewer/view_sheet*: triangles that lie flat on a whole picture, and the glyphs on them.
#ifndef PALPA_SHADERS_VIEW_SHEET_H
#define PALPA_SHADERS_VIEW_SHEET_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST sheet_corners = 0u;
PALPA_CONST sheet_glyphs = 1u;  // coverages 0..255, four to a word, row by row
PALPA_CONST sheet_buffers = 2u;

// A corner of a triangle. Three in a row are one triangle.
struct SheetCorner {
  vec4 place;   // x, y: pixels from the top left; z, w: texel of the glyphs; below 0: no glyph, the colour alone
  vec4 colour;  // rgb as on the screen, alpha
};
PALPA_CHECK_SIZE(SheetCorner, 32);
PALPA_CHECK_OFFSET(SheetCorner, colour, 16);

struct SheetPush {
  vec4 size;  // x, y: of the picture in pixels; z: texels in a row of glyphs
};
PALPA_CHECK_SIZE(SheetPush, 16);

PALPA_SHADER_END

#ifndef __cplusplus
layout(push_constant) uniform Push {
  SheetPush push;
};
#endif

#endif
