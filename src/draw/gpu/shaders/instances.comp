// SPDX-License-Identifier: MIT
// Instances that may be seen get a slot with everything that depends on camera and instance: src/run/select/view.cpp and
// make_grid_to_clip() of src/draw/raster/projection.cpp again, bit for bit: + and * of doubles in the same order, one rounding
// to float. Pass 1 looks again at those that last frame's depth hid.
#version 460
#define GROUP_SIZE 64
#include "common.glsl"
#include "cull.glsl"
#include "resident.glsl"

layout(constant_id = 3) const uint kHardware = 0u;  // 1: every cluster is asked for its size: no instance is far
const bool kFarRaster = kHardware == 0u && kStreams == 0u;  // pages of decoded roots could be evicted

const double kGrowth = 1.00000095367431640625lf;  // 1 + 2^-20
const double kMinFactor = 1.1754943508222875e-38lf, kMaxFactor = 8.507059173023462e37lf;  // 2^-126, 2^126
const double kMinNear = 9.094947017729282379150390625e-13lf;                              // 2^-40
const double kMaxNear = 2305843009213693952.0lf;                                          // 2^61

// frexp's exponent: value in [2^(e-1), 2^e). \pre finite and above 0
int frexp_exponent(double value) {
  const int biased = int((unpackDouble2x32(value).y >> 20u) & 0x7FFu);
  if (biased != 0) return biased - 1022;
  return int((unpackDouble2x32(value * 18014398509481984.0lf).y >> 20u) & 0x7FFu) - 1022 - 54;  // 2^54
}
bool is_finite(double value) { return (unpackDouble2x32(value).y & 0x7FF00000u) != 0x7FF00000u; }
double power_of_two(int exponent) { return packDouble2x32(uvec2(0u, uint(exponent + 1023) << 20u)); }

float float_above(double value) {
  const float nearest = float(value);
  return double(nearest) < value ? uintBitsToFloat(floatBitsToUint(nearest) + 1u) : nearest;
}
double clamp_or_high(double value, double low, double high) {
  return value < high ? (value < low ? low : value) : high;
}

double dot_exactly(double ax, double ay, double az, double bx, double by, double bz) {
  precise double x = ax * bx;
  precise double y = ay * by;
  precise double z = az * bz;
  precise double xy = x + y;
  precise double xyz = xy + z;
  return xyz;
}

#define INSTANCE frame.instances.at[id]
#define MESH frame.meshes.at[INSTANCE.mesh]

double choose_unit(double reach_world, double distance2, double sigma) {
  // The larger of reach and sqrt(distance2) by their exponents alone: frexp(sqrt(d)) = ceil(frexp(d) / 2).
  if (!is_finite(reach_world) || !is_finite(distance2)) return 1.0lf;
  if (!(reach_world > 0.0lf) && !(distance2 > 0.0lf)) return 1.0lf;
  int exponent = -100000;
  if (reach_world > 0.0lf) exponent = frexp_exponent(reach_world);
  if (distance2 > 0.0lf) exponent = max(exponent, (frexp_exponent(distance2) + 1) >> 1);
  int unit = 30 - exponent;
  if (sigma > 0.0lf && is_finite(sigma)) unit = min(unit, 100 - frexp_exponent(sigma));
  return power_of_two(clamp(unit, -1000, 1000));
}

MetricView make_view(uint id) {
  MetricView view;
  view.row0 = vec4(0.0);
  view.row1 = vec4(0.0);
  view.row2 = vec4(0.0);
  view.scale = 0.0;
  view.reserved = 0.0;
  if (frame.camera.any_error_fails != 0u) {
    view.error_scale = float(kMaxFactor);
    view.near_distance = float(kMinNear);
    return view;
  }
  const double sigma = INSTANCE.scale;
  precise double factor = sigma * frame.camera.pixels_per_error;
  if (frame.camera.is_orthographic != 0u) {
    precise double grown = factor * kGrowth;
    view.error_scale = float_above(clamp_or_high(grown, kMinFactor, kMaxFactor));
    view.near_distance = 1.0;
    return view;
  }
  double translation[3];
  [[unroll]] for (uint i = 0u; i < 3u; ++i) {
    const uint at = 4u * i;
    precise double relative = INSTANCE.transform[at + 3u] - frame.camera.eye[i];
    precise double moved = dot_exactly(INSTANCE.transform[at], INSTANCE.transform[at + 1u], INSTANCE.transform[at + 2u],
                                       MESH.origin[0], MESH.origin[1], MESH.origin[2]) + relative;
    translation[i] = moved;
  }
  const double distance2 = dot_exactly(translation[0], translation[1], translation[2], translation[0], translation[1],
                                       translation[2]);
  precise double reach_world = sigma * MESH.reach;
  const double unit = choose_unit(reach_world, distance2, sigma);
  vec4 rows[3];
  [[unroll]] for (uint i = 0u; i < 3u; ++i) {
    const uint at = 4u * i;
    precise double x = INSTANCE.transform[at] * unit;
    precise double y = INSTANCE.transform[at + 1u] * unit;
    precise double z = INSTANCE.transform[at + 2u] * unit;
    precise double w = translation[i] * unit;
    rows[i] = vec4(float(x), float(y), float(z), float(w));
  }
  view.row0 = rows[0];
  view.row1 = rows[1];
  view.row2 = rows[2];
  precise double scaled = sigma * unit;
  precise double grown_scale = scaled * kGrowth;
  view.scale = float_above(clamp_or_high(grown_scale, 0.0lf, kMaxFactor));
  precise double scaled_factor = factor * unit;
  precise double grown_factor = scaled_factor * kGrowth;
  view.error_scale = float_above(clamp_or_high(grown_factor, kMinFactor, kMaxFactor));
  precise double near = frame.camera.near_distance * unit;
  view.near_distance = float(clamp_or_high(near, kMinNear, kMaxNear));
  return view;
}

struct Clip {
  double at[16];
};

void set_row(inout Clip clip, uint row, double axis[3], double scale, double columns[9], double offset[3]) {
  [[unroll]] for (uint k = 0u; k < 3u; ++k) {
    precise double value = dot_exactly(axis[0], axis[1], axis[2], columns[3u * k], columns[3u * k + 1u],
                                       columns[3u * k + 2u]) * scale;
    clip.at[4u * row + k] = value;
  }
  precise double constant = dot_exactly(axis[0], axis[1], axis[2], offset[0], offset[1], offset[2]) * scale;
  clip.at[4u * row + 3u] = constant;
}

Clip make_clip(uint id, GpuCamera camera) {
  double columns[9], offset[3];
  const double step = MESH.step;
  [[unroll]] for (uint axis = 0u; axis < 3u; ++axis) {
    [[unroll]] for (uint row = 0u; row < 3u; ++row) {
      precise double value = INSTANCE.transform[4u * row + axis] * step;
      columns[3u * axis + row] = value;
    }
  }
  [[unroll]] for (uint row = 0u; row < 3u; ++row) {
    const uint at = 4u * row;
    precise double moved = dot_exactly(INSTANCE.transform[at], INSTANCE.transform[at + 1u], INSTANCE.transform[at + 2u],
                                       MESH.origin[0], MESH.origin[1], MESH.origin[2]) + INSTANCE.transform[at + 3u];
    precise double relative = moved - camera.eye[row];
    offset[row] = relative;
  }
  Clip clip;
  for (uint i = 0u; i < 16u; ++i) clip.at[i] = 0.0lf;
  set_row(clip, 0u, camera.right, camera.pixels_per_unit, columns, offset);
  set_row(clip, 1u, camera.up, -camera.pixels_per_unit, columns, offset);
  if (camera.is_orthographic != 0u) {
    clip.at[15] = 1.0lf;
    set_row(clip, 2u, camera.forward, camera.minus_inverse_range, columns, offset);
    precise double constant = clip.at[11] + camera.far_over_range;
    clip.at[11] = constant;
  } else {
    set_row(clip, 3u, camera.forward, 1.0lf, columns, offset);
    clip.at[11] = camera.near_distance;
  }
  return clip;
}

vec4 cull_row(Clip clip, uint row, double inverse_step) {
  return vec4(float(clip.at[4u * row] * inverse_step), float(clip.at[4u * row + 1u] * inverse_step),
              float(clip.at[4u * row + 2u] * inverse_step), float(clip.at[4u * row + 3u]));
}
float gradient(vec4 row) { return length(row.xyz) * 1.00001; }

// Clip coordinates of spheres: rows and the lengths of their gradients.
struct CullRows {
  vec4 x, y, z, w, norm;
};
CullRows cull_rows(Clip clip, double inverse_step) {
  CullRows rows;
  rows.x = cull_row(clip, 0u, inverse_step);
  rows.y = cull_row(clip, 1u, inverse_step);
  rows.z = cull_row(clip, 2u, inverse_step);
  rows.w = cull_row(clip, 3u, inverse_step);
  rows.norm = vec4(gradient(rows.x), gradient(rows.y), gradient(rows.z), gradient(rows.w));
  return rows;
}
ClipBounds bounds_by(CullRows rows, vec3 center, float radius) {
  return bounds_of(rows.x, rows.y, rows.z, rows.w, rows.norm, center, radius);
}
// Lengths of the side planes' gradients.
vec4 plane_norms(CullRows rows) {
  const float half_width = 0.5 * float(frame.width), half_height = 0.5 * float(frame.height);
  return vec4(gradient(rows.x + half_width * rows.w), gradient(half_width * rows.w - rows.x),
              gradient(rows.y + half_height * rows.w), gradient(half_height * rows.w - rows.y));
}

// The terminal group of a far instance, if it alone is open: every other group passes where a bound that nests over all of
// them does (I4; run/select/far_instance.h). Most instances of a large scene are of this kind.
uint only_open_group(uint id, MetricView view) {
  const uint group = MESH.only_root;
  if (group == kNone) return kNone;
  return metric_passes(view, MESH.root_center[0], MESH.root_center[1], MESH.root_center[2], MESH.root_radius,
                       MESH.coarse_error)
             ? group
             : kNone;
}

// What raster_far.comp can draw: certainly in front of the near plane, near the picture, and small.
bool is_few_pixels(ClipBounds b) {
  const float low_w = (b.center.w - b.reach.w) * 0.99999;
  if (!(b.center.z + b.reach.z < low_w)) return false;
  const vec2 side = abs(b.center.xy);
  const vec2 extent = b.reach.xy + side * (b.reach.w / b.center.w);
  return max(side.x + extent.x, side.y + extent.y) <= 8000.0 * low_w && 2.0 * max(extent.x, extent.y) <= FAR_PIXELS * low_w;
}

// Its one cluster is drawn as it is, several go the way of an open group's.
void append_far(uint id, uint slot, uint group, bool is_far, MetricView view, CullRows rows) {
  uint cluster_count = 0u, cluster = 0u;
  bool is_small = false;
  if (is_far) {
    want_page(view, group);
    cluster_count = is_ready(group) ? frame.groups.at[group].cluster_count : 0u;
    cluster = frame.groups.at[group].first_cluster;
    const GpuCluster c = frame.clusters.at[cluster];
    is_small = kFarRaster && cluster_count == 1u &&
               is_few_pixels(bounds_by(rows, vec3(c.center[0], c.center[1], c.center[2]), c.radius));
  }
  const bool is_large = cluster_count == 1u && !is_small;
  const uint item = append_item(STAGE_SOFTWARE, is_large, counters.software_before[pass], 1u);
  if (is_large) {
    if (item < frame.item_capacity) frame.items.at[item] = item_of(slot, cluster);
    else report_overflow(OVERFLOW_CLUSTERS);
  }
  if (kFarRaster) {
    const uint back = append_item(STAGE_HARDWARE, is_small, counters.hardware_before[pass], kFarPerGroup);
    if (is_small) {
      const uint mirrored = (INSTANCE.flags & kInstanceMirrored) != 0u ? ITEM_IS_MIRRORED : 0u;
      if (back < frame.item_capacity) frame.items.at[frame.item_capacity - 1u - back] = item_of(slot | ITEM_IS_FAR | mirrored, cluster);
      else report_overflow(OVERFLOW_CLUSTERS);
    }
  }
  const uint at = append(STAGE_GROUPS + pass, cluster_count > 1u, kGroupLanes, 64u);
  if (cluster_count > 1u) {
    if (at < frame.group_capacity) frame.open_groups.at[at] = uvec2(slot, group);
    else report_overflow(OVERFLOW_GROUPS);
  }
}

// Whether an instance is outside the picture or, in pass 1, hidden by now. Pass 0 is told what last frame's depth says of it:
// `is_hidden_before`, by `last`.
bool is_culled(uint id, CullRows rows, vec4 plane_norm, double inverse_step, inout CullRows last,
               inout bool is_hidden_before) {
  const vec3 center = vec3(MESH.root_center[0], MESH.root_center[1], MESH.root_center[2]);
  const float radius = MESH.root_radius;
  const ClipBounds b = bounds_by(rows, center, radius);
  const float guard = slack(rows.w, center) + max(slack(rows.x, center) * 2.0 / float(frame.width),
                                                  slack(rows.y, center) * 2.0 / float(frame.height));
  if (is_outside(b, plane_norm, radius, guard)) return true;
  if (kOcclusion == 0u) return false;
  if (pass == 1u) return is_hidden(b, float(frame.camera.near_distance), frame.camera.is_orthographic != 0u);
  last = cull_rows(make_clip(id, frame.last), inverse_step);
  is_hidden_before = is_hidden(bounds_by(last, center, radius), float(frame.last.near_distance),
                               frame.last.is_orthographic != 0u);
  return false;
}

// The root of its BVH into the first queue of the pass.
void append_root(uint id, uint slot, bool wants) {
  const uint at = append(STAGE_QUEUE + MAX_DEPTH * pass, wants, 1u, 64u);
  if (!wants) return;
  if (pass == 1u) {
    if (at < frame.retry_capacity) frame.retry_nodes.at[at] = uvec2(slot, MESH.first_node);
    else report_overflow(OVERFLOW_RETRY);
  } else {
    if (at < frame.queue_capacity) frame.queue.at[at] = uvec2(slot, MESH.first_node);
    else report_overflow(OVERFLOW_QUEUE);
  }
}

void store_rows(uint slot, CullRows rows, vec4 plane_norm, CullRows last) {
  frame.visible.at[slot].cull_x = rows.x;
  frame.visible.at[slot].cull_y = rows.y;
  frame.visible.at[slot].cull_z = rows.z;
  frame.visible.at[slot].cull_w = rows.w;
  frame.visible.at[slot].plane_norm = plane_norm;
  frame.visible.at[slot].row_norm = rows.norm;
  if (kOcclusion != 0u) {
    frame.visible.at[slot].last_x = last.x;
    frame.visible.at[slot].last_y = last.y;
    frame.visible.at[slot].last_z = last.z;
    frame.visible.at[slot].last_w = last.w;
    frame.visible.at[slot].last_norm = last.norm;
  }
}

void main() {
  uint id = thread_index();
  bool is_there = id < (pass == 0u ? frame.instance_count : counters.stages[STAGE_RETRY_INSTANCES].count);
  if (is_there && pass == 1u) id = frame.retry_instances.at[id];
  if (is_there) is_there = (INSTANCE.flags & kInstanceSingular) == 0u && MESH.node_count > 0u;

  Clip clip;
  CullRows rows, last;
  vec4 plane_norm;
  bool is_hidden_before = false;
  last.x = last.y = last.z = last.w = last.norm = vec4(0.0);
  if (is_there) {
    const double inverse_step = 1.0lf / MESH.step;
    clip = make_clip(id, frame.camera);
    rows = cull_rows(clip, inverse_step);
    plane_norm = plane_norms(rows);
    if (kFrustum != 0u) is_there = !is_culled(id, rows, plane_norm, inverse_step, last, is_hidden_before);
  }
  if (kOcclusion != 0u && pass == 0u) {
    const bool is_retried = is_there && is_hidden_before;
    const uint at = append(STAGE_RETRY_INSTANCES, is_retried, 1u, 64u);
    if (is_retried) frame.retry_instances.at[at] = id;  // as long as the scene's list of instances
    is_there = is_there && !is_hidden_before;
  }
  const uint slot = append(STAGE_SLOTS, is_there, 1u, 1u);
  const bool fits = is_there && slot < frame.slot_capacity;
  if (is_there && !fits) report_overflow(OVERFLOW_SLOTS);
  MetricView view;
  uint group = kNone;
  if (fits) {
    view = make_view(id);
    if (kHardware == 0u) group = only_open_group(id, view);
  }
  const bool is_far = group != kNone;
  if (kHardware == 0u) append_far(id, slot, group, is_far, view, rows);
  append_root(id, slot, fits && !is_far);
  if (!fits) return;
  frame.visible.at[slot].clip = clip.at;
  frame.visible.at[slot].view = view;
  frame.visible.at[slot].instance = id;
  frame.visible.at[slot].mesh = INSTANCE.mesh;
  frame.visible.at[slot].flags = INSTANCE.flags;
  if (is_far && frame.groups.at[group].cluster_count == 1u) return;  // nobody will cull anything of it
  store_rows(slot, rows, plane_norm, last);
}
