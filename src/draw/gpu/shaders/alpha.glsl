// SPDX-License-Identifier: MIT
// src/draw/raster/alpha_cutoff.cpp again, bit for bit (I9). Only shaders compiled with ALPHA_MASK have it: a scene without masked
// materials is drawn by shaders that know nothing of masks. After page.glsl and screen.glsl.
#ifdef ALPHA_MASK

const double kLargestQuotient = 70368744177664.0lf;
const double kLeastWeight = 1e-280lf, kLeastSum = 1e-260lf, kLargestSum = 1e250lf;

struct AlphaTest {
  dvec3 x, y, w;      // clip coordinates of the corners
  dvec3 u, v, alpha;  // grid integers of the UVs, 0 … 255 of the vertex colours
  uint mask;          // kNone: not masked
  uint has_image;
  double unit;        // of the UVs
};

AlphaTest open_alpha(uint slot, ClusterData data, uint triangle, uvec3 corners) {
  AlphaTest t;
  t.has_image = 0u;
  t.unit = 1.0lf;
  t.u = t.v = dvec3(0.0lf);
  t.mask = frame.materials.at[cluster_material(data, triangle)].mask;
  if (t.mask == kNone) return t;
  const uint mesh = frame.visible.at[slot].mesh;
  const uint source = frame.mesh_uvs.at[mesh].source, wanted = frame.masks.at[t.mask].uv_set;
  uint stored_set = data.uv_set_count;
  for (uint set = data.uv_set_count; set-- > 0u;) {
    if ((source >> (8u * set) & 255u) == wanted) stored_set = set;
  }
  if (frame.masks.at[t.mask].width > 0u && stored_set < data.uv_set_count) {
    t.has_image = 1u;
    t.unit = power_of_two(frame.mesh_uvs.at[mesh].log2[stored_set]);
  }
  const bool has_color = frame.meshes.at[mesh].has_color != 0u;
  [[unroll]] for (uint k = 0u; k < 3u; ++k) {
    const uvec3 raw = lode_raw_position(data, corners[k]);
    const dvec3 p = dvec3(lode_position(data, raw));
    t.x[k] = clip_row(slot, 0u, p);
    t.y[k] = clip_row(slot, 1u, p);
    t.w[k] = clip_row(slot, 3u, p);
    t.alpha[k] = has_color ? double(lode_color(data, corners[k]).a) : 255.0lf;
    if (t.has_image != 0u) {
      const ivec2 uv = lode_uv(data, stored_set, corners[k], raw);
      t.u[k] = double(uv.x);
      t.v[k] = double(uv.y);
    }
  }
  return t;
}

double cross_term(double a, double b, double c, double d) {
  precise double ab = a * b;
  precise double cd = c * d;
  precise double difference = ab - cd;
  return difference;
}

double weigh(dvec3 weight, dvec3 value) {
  precise double a = weight.x * value.x;
  precise double b = weight.y * value.y;
  precise double c = weight.z * value.z;
  precise double ab = a + b;
  precise double abc = ab + c;
  return abc;
}

double sum_of(dvec3 weight) {
  precise double xy = weight.x + weight.y;
  precise double xyz = xy + weight.z;
  return xyz;
}

dvec3 find_weights(AlphaTest t, double px, double py) {
  dvec3 x, y;
  [[unroll]] for (uint k = 0u; k < 3u; ++k) {
    precise double moved_x = px * t.w[k];
    precise double moved_y = py * t.w[k];
    precise double at_x = t.x[k] - moved_x;
    precise double at_y = t.y[k] - moved_y;
    x[k] = at_x;
    y[k] = at_y;
  }
  dvec3 weight = dvec3(cross_term(x[1], y[2], x[2], y[1]), cross_term(x[2], y[0], x[0], y[2]),
                       cross_term(x[0], y[1], x[1], y[0]));
  if (sum_of(weight) < 0.0lf) weight = -weight;
  [[unroll]] for (uint k = 0u; k < 3u; ++k) {
    if (!(weight[k] >= kLeastWeight)) weight[k] = 0.0lf;
  }
  const double sum = sum_of(weight);
  return sum >= kLeastSum && sum <= kLargestSum ? weight : dvec3(1.0lf);
}

double product_of(double a, double b) {
  precise double product = a * b;
  return product;
}

// The q with q · divisor <= value < (q + 1) · divisor in rounded products. \pre divisor > 0
double floor_quotient(double value, double divisor) {
  precise double most = kLargestQuotient * divisor;
  if (!(abs(value) <= most)) return 0.0lf;
  double q = floor(value / divisor);
  // Off by one at most. Straight code: lavapipe counts every iteration of every loop (frame.h, CLIP_SLICES).
  q = product_of(q, divisor) > value ? q - 1.0lf : q;
  q = product_of(q, divisor) > value ? q - 1.0lf : q;
  q = product_of(q + 1.0lf, divisor) <= value ? q + 1.0lf : q;
  q = product_of(q + 1.0lf, divisor) <= value ? q + 1.0lf : q;
  return q;
}

uint wrap_texel(double quotient, uint count, uint wrap) {
  if (quotient >= 0.0lf && quotient < double(count)) return uint(quotient);
  if (wrap == WRAP_CLAMP) return quotient < 0.0lf ? 0u : count - 1u;
  const int64_t i = int64_t(quotient), period = int64_t(wrap == WRAP_MIRROR ? 2u * count : count);
  // In a period from 0 on, by operands that are not negative: of others GLSL leaves the remainder open.
  const int64_t rest = quotient < 0.0lf ? period - 1l - (-1l - i) % period : i % period;
  return uint(rest < int64_t(count) ? rest : period - 1l - rest);
}

uint mask_texel(AlphaTest t, uint axis, double u, double v, double sum) {
  precise double unit_u = frame.masks.at[t.mask].rows[3u * axis] * t.unit;
  precise double unit_v = frame.masks.at[t.mask].rows[3u * axis + 1u] * t.unit;
  precise double by_u = unit_u * u;
  precise double by_v = unit_v * v;
  precise double by_one = frame.masks.at[t.mask].rows[3u * axis + 2u] * sum;
  precise double by_uv = by_u + by_v;
  precise double at = by_uv + by_one;
  const uint count = axis == 0u ? frame.masks.at[t.mask].width : frame.masks.at[t.mask].height;
  return wrap_texel(floor_quotient(at, sum), count, frame.masks.at[t.mask].wrap[axis]);
}

bool passes_alpha(AlphaTest t, int x, int y) {
  if (t.mask == kNone) return true;
  const dvec3 weight = find_weights(t, double(x) + 0.5lf - 0.5lf * double(frame.width),
                                    double(y) + 0.5lf - 0.5lf * double(frame.height));
  const double sum = sum_of(weight);
  precise double half_sum = 0.5lf * sum;
  precise double rounded = weigh(weight, t.alpha) + half_sum;
  const uint vertex_alpha = uint(clamp(floor_quotient(rounded, sum), 0.0lf, 255.0lf));
  uint alpha = 255u;
  if (t.has_image != 0u) {
    const double u = weigh(weight, t.u), v = weigh(weight, t.v);
    const uint texel = mask_texel(t, 1u, u, v, sum) * frame.masks.at[t.mask].width + mask_texel(t, 0u, u, v, sum);
    alpha = frame.mask_texels.at[frame.masks.at[t.mask].first_word + (texel >> 2u)] >> (8u * (texel & 3u)) & 255u;
  }
  return alpha * vertex_alpha >= frame.masks.at[t.mask].threshold;
}

AlphaTest alpha_test;  // of the triangle that this invocation draws
#define BEGIN_ALPHA(slot, data, triangle, corners) alpha_test = open_alpha(slot, data, triangle, corners)
#define AND_ALPHA(x, y) && passes_alpha(alpha_test, x, y)

#else
#define BEGIN_ALPHA(slot, data, triangle, corners)
#define AND_ALPHA(x, y)
#endif
