#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "scan.h"

// Brings the groups' contacts together, in input order.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = contacts_points) readonly buffer Points { uvec4 points[]; };
layout(std430, set = 0, binding = contacts_length) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = contacts_hits) readonly buffer Hits { Hit hits[]; };
layout(std430, set = 0, binding = contacts_counts) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = contacts_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = contacts_out) writeonly buffer Contacts { ContactRecord contacts[]; };
layout(push_constant) uniform Push { ContactsPush push; };

void main() {
  const uint group = gl_WorkGroupID.x;
  const uint groups = (min(given.total, push.most_points) + contacts_group - 1u) / contacts_group;
  if (group >= groups) return;
  const uint first = counts[group];
  const uint end = group + 1u < groups ? counts[group + 1u] : found.total;
  const uint place = first + gl_LocalInvocationIndex;
  if (place >= end || place >= push.most_contacts) return;

  const Hit hit = hits[group * contacts_group + gl_LocalInvocationIndex];
  const uvec4 point = points[group * contacts_group + (hit.place & 63u)];
  ContactRecord contact;
  contact.x = uintBitsToFloat(point.x);
  contact.y = uintBitsToFloat(point.y);
  contact.z = uintBitsToFloat(point.z);
  contact.point = point.w;
  contact.solid = hit.place >> 6u;
  contact.depth = hit.depth;
  contact.finger = no_finger;
  contact.unused0 = 0u;
  contacts[place] = contact;
}
