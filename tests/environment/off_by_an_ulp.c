/* SPDX-License-Identifier: GPL-3.0-or-later
 * Preloaded: the mathematical library with every result a unit in the last place off, up or down by the bits of the
 * argument. No library is this wrong everywhere, so whatever comes out the same with it depends on none (I10). What
 * IEEE 754 rounds exactly (sqrt, floor, fma) is as it was. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

static double off(double value, double argument) {
  uint64_t bits;
  if (!isfinite(value) || value == 0.0) return value;
  memcpy(&bits, &argument, sizeof bits);
  bits ^= bits >> 32;
  bits ^= bits >> 16;
  bits ^= bits >> 8;
  return nextafter(value, bits & 1 ? INFINITY : -INFINITY);
}
static float off_float(float value, float argument) {
  uint32_t bits;
  if (!isfinite(value) || value == 0.0F) return value;
  memcpy(&bits, &argument, sizeof bits);
  bits ^= bits >> 16;
  bits ^= bits >> 8;
  return nextafterf(value, bits & 1 ? INFINITY : -INFINITY);
}

/* Threads may both look a name up: they find the same. */
#define ONE(name)                                                    \
  double name(double x) {                                            \
    static double (*real)(double);                                   \
    if (!real) real = (double (*)(double))dlsym(RTLD_NEXT, #name);   \
    return off(real(x), x);                                          \
  }                                                                  \
  float name##f(float x) {                                           \
    static float (*real)(float);                                     \
    if (!real) real = (float (*)(float))dlsym(RTLD_NEXT, #name "f"); \
    return off_float(real(x), x);                                    \
  }
#define TWO(name)                                                           \
  double name(double x, double y) {                                         \
    static double (*real)(double, double);                                  \
    if (!real) real = (double (*)(double, double))dlsym(RTLD_NEXT, #name);  \
    return off(real(x, y), x + y);                                          \
  }                                                                         \
  float name##f(float x, float y) {                                         \
    static float (*real)(float, float);                                     \
    if (!real) real = (float (*)(float, float))dlsym(RTLD_NEXT, #name "f"); \
    return off_float(real(x, y), x + y);                                    \
  }

ONE(sin)
ONE(cos)
ONE(tan)
ONE(asin)
ONE(acos)
ONE(atan)
ONE(exp)
ONE(exp2)
ONE(expm1)
ONE(log)
ONE(log2)
ONE(log10)
ONE(log1p)
ONE(cbrt)
ONE(sinh)
ONE(cosh)
ONE(tanh)
TWO(pow)
TWO(atan2)
TWO(hypot)

void sincos(double x, double* sine, double* cosine) {
  *sine = sin(x);
  *cosine = cos(x);
}
void sincosf(float x, float* sine, float* cosine) {
  *sine = sinf(x);
  *cosine = cosf(x);
}
