// SPDX-License-Identifier: MIT
// src/draw/raster/screen.cpp and the planes of src/draw/raster/projection.cpp again, bit for bit (I9): doubles with + and * in a
// fixed order, then integers. Quotients are estimates that an exact integer remainder corrects.

layout(constant_id = 8) const uint kOverdraw = 0u;  // 1: how often each pixel is drawn is counted

const int kSubpixelBits = 8;
const int kSubpixels = 256;
const double kGuardPixels = 1048576.0lf;

struct ScreenVertex {
  int x, y;
  uint depth;
  bool is_snapped;
};

// ((x * px + y * py) + z * pz) + constant
double clip_row(uint slot, uint row, dvec3 p) {
  const uint at = 4u * row;
  precise double value = frame.visible.at[slot].clip[at] * p.x;
  precise double y = frame.visible.at[slot].clip[at + 1u] * p.y;
  precise double z = frame.visible.at[slot].clip[at + 2u] * p.z;
  precise double xy = value + y;
  precise double xyz = xy + z;
  precise double all = xyz + frame.visible.at[slot].clip[at + 3u];
  return all;
}

dvec4 clip_vertex(uint slot, ivec3 q) {
  const dvec3 p = dvec3(q);
  return dvec4(clip_row(slot, 0u, p), clip_row(slot, 1u, p), clip_row(slot, 2u, p), clip_row(slot, 3u, p));
}

double power_of_two(int exponent) { return packDouble2x32(uvec2(0u, uint(exponent + 1023) << 20u)); }
int exponent_of(double value) { return int((unpackDouble2x32(value).y >> 20u) & 0x7FFu) - 1023; }

bool is_usable(dvec4 v) {
  const double largest = 1e150lf;
  return abs(v.x) <= largest && abs(v.y) <= largest && abs(v.z) <= largest && abs(v.w) <= largest;
}

double plane_distance(dvec4 v, int plane) {
  precise double guard = kGuardPixels * v.w;
  precise double d;
  if (plane == 0) d = v.w - v.z;
  else if (plane == 1) d = guard - v.x;
  else if (plane == 2) d = guard + v.x;
  else if (plane == 3) d = guard - v.y;
  else d = guard + v.y;
  return d;
}

// 1 / x to some 40 bits: where an integer remainder corrects the quotient anyway, a division of doubles is wasted.
// \pre 1 <= x < 2^62
double estimate_reciprocal(double x) {
  const double first = double(1.0 / float(x));
  return first * (2.0lf - x * first);
}

// floor((2 s + w) / (2 w)), from an estimate of 1 / (2 w)
int64_t nearest_quotient(int64_t s, int64_t w, double inverse) {
  const int64_t numerator = 2l * s + w, denominator = 2l * w;
  int64_t q = int64_t(floor(double(numerator) * inverse));
  int64_t r = numerator - q * denominator;
  while (r < 0l) { q -= 1l; r += denominator; }
  while (r >= denominator) { q += 1l; r -= denominator; }
  return q;
}

int divide_axis(double c, double vw, double scale, int64_t w, double inverse, uint side) {
  precise double limit = kGuardPixels * vw;
  precise double inside = c < -limit ? -limit : (c > limit ? limit : c);
  precise double scaled = inside * scale;
  precise double subpixels = scaled * 256.0lf;
  precise double shifted = subpixels + 0.5lf;
  return int(nearest_quotient(int64_t(floor(shifted)), w, inverse)) + int(side) * (kSubpixels / 2);
}

// \pre w is normal and positive, and usable
ScreenVertex divide(dvec4 v) {
  ScreenVertex o;
  const double scale = power_of_two(30 - exponent_of(v.w));
  precise double w_scaled = v.w * scale;
  precise double w_shifted = w_scaled + 0.5lf;
  const int64_t w = int64_t(floor(w_shifted));
  const double inverse = 0.5lf * estimate_reciprocal(double(w));
  o.x = divide_axis(v.x, v.w, scale, w, inverse, frame.width);
  o.y = divide_axis(v.y, v.w, scale, w, inverse, frame.height);
  precise double z = v.z * scale;
  z = z < 0.0lf ? 0.0lf : (z > w_scaled ? w_scaled : z);
  precise double z32 = z * 4294967296.0lf;
  const int64_t numerator = int64_t(z32);
  int64_t q = int64_t(floor(double(numerator) * (2.0lf * inverse)));
  int64_t r = numerator - q * w;
  while (r < 0l) { q -= 1l; r += w; }
  while (r >= w) { q += 1l; r -= w; }
  o.depth = q > 0xFFFFFFFFl ? 0xFFFFFFFFu : uint(q);
  o.is_snapped = true;
  return o;
}

ScreenVertex snap_vertex(dvec4 v) {
  ScreenVertex o;
  o.x = 0;
  o.y = 0;
  o.depth = 0u;
  o.is_snapped = false;
  if (!is_usable(v)) return o;
  for (int plane = 0; plane < 5; ++plane) {
    if (!(plane_distance(v, plane) >= 0.0lf)) return o;
  }
  if (!(v.w >= 1e-200lf)) return o;
  return divide(v);
}

// First and last pixel whose centres lie in [low, high] subpixels, clamped; empty where first > last.
ivec2 pixels_between(int low, int high, uint count) {
  return ivec2(max((low + kSubpixels / 2 - 1) >> kSubpixelBits, 0), min((high - kSubpixels / 2) >> kSubpixelBits, int(count) - 1));
}

// -1 where a pixel centre on the edge is outside: neither a top nor a left edge. In 32 bits, which hold every difference:
// Mesa 22.3's lavapipe takes the 64-bit comparison of a widened negative number with 0 for false.
int edge_bias(int dx, int dy) { return dy < 0 || (dy == 0 && dx > 0) ? 0 : -1; }

// floor(sum / area) where the sum is known modulo 2^64 only: the estimate is off by less than 2, so the remainder is not.
// Straight code: lavapipe counts the iterations of every loop, and one for a loop that is not entered (raster_clip.comp).
uint divide_depth(uint64_t sum, double estimate, int64_t area) {
  int64_t q = int64_t(floor(estimate));
  int64_t r = int64_t(sum - uint64_t(q) * uint64_t(area));
  [[unroll]] for (int step = 0; step < 2; ++step) {
    const int64_t add = r < 0l ? -1l : r >= area ? 1l : 0l;
    q += add;
    r -= add * area;
  }
  return uint(q);
}

// The same where the area has 31 bits: then so has the remainder. \pre inverse = estimate_reciprocal(area)
uint divide_depth_small(uint64_t sum, double inverse, uint area) {
  const uint q = uint(min(double(sum) * inverse, 4294967295.0lf));
  const int r = int(uint(sum) - q * area);
  return r < 0 ? q - 1u : r >= int(area) ? q + 1u : q;
}

uint64_t pixel_value(uint depth, uint item, uint triangle) {
  return (uint64_t(depth) << 32) | uint64_t(~((item << 8u) | triangle));
}

void put_pixel(int x, int y, uint64_t value) {
  const uint at = uint(y) * frame.width + uint(x);
  if (kOverdraw != 0u) atomicAdd(frame.overdraw.at[at], 1u);
  atomicMax(frame.pixels.at[at], value);  // no look at the old value first: that would wait for memory, this does not
}

// For the hardware's own clipping and divide: the same clip coordinates, rounded to float.
vec4 hardware_position(dvec4 clip) {
  return vec4(float(clip.x * (2.0lf / double(frame.width))), float(clip.y * (2.0lf / double(frame.height))),
              float(clip.z), float(clip.w));
}
