// SPDX-License-Identifier: MIT
// Is a sphere certainly outside the view, or certainly behind what the depth pyramid holds? Floats, each rounded away from
// culling: what is culled would not have changed a pixel, so the picture does not depend on any of this.
//
// The clip coordinates are affine in the point, so over a sphere each lies within (its value at the centre) ± (length of
// its gradient) · radius: exact for mirrored and unevenly scaled instances too.

layout(constant_id = 1) const uint kFrustum = 1u;
layout(constant_id = 2) const uint kOcclusion = 0u;

struct ClipBounds {
  vec4 center;  // x y z w at the centre
  vec4 reach;   // how far each may be off, rounding included
};

float affine(vec4 row, vec3 p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w; }
// Over the rounding of `affine` (4 operations) and of the rows themselves.
float slack(vec4 row, vec3 p) {
  return 4e-6 * (abs(row.x * p.x) + abs(row.y * p.y) + abs(row.z * p.z) + abs(row.w));
}

ClipBounds bounds_of(vec4 x, vec4 y, vec4 z, vec4 w, vec4 norm, vec3 center, float radius) {
  ClipBounds b;
  b.center = vec4(affine(x, center), affine(y, center), affine(z, center), affine(w, center));
  b.reach = norm * radius + vec4(slack(x, center), slack(y, center), slack(z, center), slack(w, center));
  return b;
}

bool is_outside(ClipBounds b, vec4 plane_norm, float radius, float guard_slack) {
  const vec2 half_size = 0.5 * vec2(frame.width, frame.height);
  const vec2 edge = half_size * b.center.w;
  const float slack_x = guard_slack * half_size.x, slack_y = guard_slack * half_size.y;
  return b.center.x + edge.x < -(plane_norm.x * radius + slack_x) ||
         edge.x - b.center.x < -(plane_norm.y * radius + slack_x) ||
         b.center.y + edge.y < -(plane_norm.z * radius + slack_y) ||
         edge.y - b.center.y < -(plane_norm.w * radius + slack_y) ||
         b.center.z - b.reach.z > b.center.w + b.reach.w;
}

uint pyramid_at(uint level, uint x, uint y) {
  const uint width = (frame.width + (1u << level) - 1u) >> level;
  return frame.pyramid.at[frame.pyramid_offset[level] + y * width + x];
}

bool is_hidden(ClipBounds b, float near, bool is_orthographic) {
  const float low_w = b.center.w - b.reach.w, high_w = b.center.w + b.reach.w;
  if (!(low_w > near) && !is_orthographic) return false;
  if (!(low_w > 0.0)) return false;
  const vec2 low = b.center.xy - b.reach.xy, high = b.center.xy + b.reach.xy;
  const vec2 half_size = 0.5 * vec2(frame.width, frame.height);
  const vec2 low_px = half_size + vec2(low.x / (low.x < 0.0 ? low_w : high_w), low.y / (low.y < 0.0 ? low_w : high_w)) - 1.0;
  const vec2 high_px =
      half_size + vec2(high.x / (high.x > 0.0 ? low_w : high_w), high.y / (high.y > 0.0 ? low_w : high_w)) + 1.0;
  const vec2 last = vec2(frame.width, frame.height) - 1.0;
  if (!(low_px.x <= last.x && low_px.y <= last.y && high_px.x >= 0.0 && high_px.y >= 0.0)) return false;
  const uvec2 first = uvec2(clamp(floor(low_px), vec2(0.0), last)), end = uvec2(clamp(ceil(high_px), vec2(0.0), last));
  uint level = 1u;
  while (level < frame.pyramid_levels &&
         ((end.x >> level) - (first.x >> level) > 1u || (end.y >> level) - (first.y >> level) > 1u)) ++level;
  const float nearest_z = (b.center.z + b.reach.z) / low_w;
  const float nearest = nearest_z * 4294967296.0 * (1.0 + 4e-6) + 2.0;
  if (!(nearest_z > 1e-30)) return false;  // a near distance that floats do not hold
  for (uint y = first.y >> level; y <= end.y >> level; ++y) {
    for (uint x = first.x >> level; x <= end.x >> level; ++x) {
      if (!(nearest < float(pyramid_at(level, x, y)) * (1.0 - 1e-6))) return false;
    }
  }
  return true;
}

const uint kVisibleNow = 0u;
const uint kOutside = 1u;
const uint kHiddenBefore = 2u;  // pass 0: to be tried again in pass 1

// \pre slot is filled
uint cull_sphere(uint slot, vec3 center, float radius) {
  if (kFrustum == 0u) return kVisibleNow;
  const ClipBounds b =
      bounds_of(frame.visible.at[slot].cull_x, frame.visible.at[slot].cull_y, frame.visible.at[slot].cull_z,
                frame.visible.at[slot].cull_w, frame.visible.at[slot].row_norm, center, radius);
  const float guard = slack(frame.visible.at[slot].cull_w, center) +
                      max(slack(frame.visible.at[slot].cull_x, center) * 2.0 / float(frame.width),
                          slack(frame.visible.at[slot].cull_y, center) * 2.0 / float(frame.height));
  if (is_outside(b, frame.visible.at[slot].plane_norm, radius, guard)) return kOutside;
  if (kOcclusion == 0u) return kVisibleNow;
  if (pass == 1u) {
    return is_hidden(b, float(frame.camera.near_distance), frame.camera.is_orthographic != 0u) ? kOutside : kVisibleNow;
  }
  const ClipBounds before =
      bounds_of(frame.visible.at[slot].last_x, frame.visible.at[slot].last_y, frame.visible.at[slot].last_z,
                frame.visible.at[slot].last_w, frame.visible.at[slot].last_norm, center, radius);
  return is_hidden(before, float(frame.last.near_distance), frame.last.is_orthographic != 0u) ? kHiddenBefore
                                                                                                : kVisibleNow;
}
