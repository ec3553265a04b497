// The inputs of the drives, read as texels: a software device fetches 16 bytes in one piece.

layout(set = 0, binding = 0) uniform samplerBuffer transducers;
layout(set = 0, binding = 1) uniform samplerBuffer foci;
layout(set = 0, binding = 2) uniform usamplerBuffer slots;

DrivePoint transducer_at(uint n) {
  return DrivePoint(texelFetch(transducers, int(2u * n)), texelFetch(transducers, int(2u * n + 1u)));
}
DriveFocus focus_at(uint j) { return DriveFocus(texelFetch(foci, int(2u * j)), texelFetch(foci, int(2u * j + 1u))); }
DriveSlot slot_at(uint s) {
  const uvec4 words = texelFetch(slots, int(s));
  return DriveSlot(words.x, words.y, uintBitsToFloat(words.z), words.w);
}
// Relative to the gain of the focus' slot.
float gain_of(uint j) { return texelFetch(foci, int(2u * j + 1u)).w; }
