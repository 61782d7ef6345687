// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/samples/noise.h"

#include <cmath>

#include "base/random.h"

namespace meshlode::lab {

namespace {

constexpr double kTau = 6.283185307179586;

/// \pre |x| <= tau / 8
double sin_series(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int k = 17; k >= 3; k -= 2) sum = (1.0 - sum) * s / static_cast<double>(k * (k - 1));
  return x * (1.0 - sum);
}

double cos_series(double x) {
  const double s = x * x;
  double sum = 0.0;
  for (int k = 18; k >= 2; k -= 2) sum = (1.0 - sum) * s / static_cast<double>(k * (k - 1));
  return 1.0 - sum;
}

double lattice(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed) {
  std::uint64_t h = mix64(seed + kGoldenGamma);
  h = mix64(h ^ static_cast<std::uint64_t>(x) * kGoldenGamma);
  h = mix64(h ^ static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Full);
  h = mix64(h ^ static_cast<std::uint64_t>(z) * 0x165667B19E3779F9ull);
  return static_cast<double>(h >> 11) * 0x1p-52 - 1.0;
}

}  // namespace

double sin_turns(double turns) {
  const double t = turns - std::floor(turns);
  const int quarter = static_cast<int>(std::floor(t * 4.0 + 0.5));
  const double rest = (t - 0.25 * quarter) * kTau;
  switch (quarter & 3) {
    case 0: return sin_series(rest);
    case 1: return cos_series(rest);
    case 2: return -sin_series(rest);
    default: return -cos_series(rest);
  }
}

double cos_turns(double turns) {
  return sin_turns(turns + 0.25);
}

double value_noise(const Vec3d& p, std::uint64_t seed) {
  const Vec3d base(std::floor(p.x), std::floor(p.y), std::floor(p.z));
  const auto x = static_cast<std::int64_t>(base.x);
  const auto y = static_cast<std::int64_t>(base.y);
  const auto z = static_cast<std::int64_t>(base.z);
  const auto fade = [](double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); };
  const Vec3d t(fade(p.x - base.x), fade(p.y - base.y), fade(p.z - base.z));
  double planes[2];
  for (int k = 0; k < 2; ++k) {
    double rows[2];
    for (int j = 0; j < 2; ++j) {
      const double a = lattice(x, y + j, z + k, seed), b = lattice(x + 1, y + j, z + k, seed);
      rows[j] = a + (b - a) * t.x;
    }
    planes[k] = rows[0] + (rows[1] - rows[0]) * t.y;
  }
  return planes[0] + (planes[1] - planes[0]) * t.z;
}

double fractal_noise(const Vec3d& p, std::uint32_t octaves, std::uint64_t seed) {
  double sum = 0.0, strength = 0.5, frequency = 1.0;
  for (std::uint32_t octave = 0; octave < octaves; ++octave) {
    sum += strength * value_noise(p * frequency, seed + octave);
    strength *= 0.5;
    frequency *= 2.0;
  }
  return sum;
}

}  // namespace meshlode::lab
