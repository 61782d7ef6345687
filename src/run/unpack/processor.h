// SPDX-License-Identifier: MIT
// Hot loops are compiled twice: for any x86-64, and for processors whose shifts need no flags (BMI2, 2013 and later).
// The same integers come out of both.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define MESHLODE_HAS_BMI2_PATH 1
/// Everything that the function calls is compiled into it.
#define MESHLODE_FOR_BMI2 __attribute__((target("bmi,bmi2,popcnt"), flatten))
#else
#define MESHLODE_HAS_BMI2_PATH 0
#endif

namespace meshlode::run {

[[nodiscard]] inline bool has_bmi2() {
#if MESHLODE_HAS_BMI2_PATH
  return __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0 &&
         __builtin_cpu_supports("popcnt") != 0;
#else
  return false;
#endif
}

}  // namespace meshlode::run
