// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what the floating-point environment does, of this thread and of another: the test of what is preloaded.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <thread>

int main(int count, char**) {
  // Of arguments that no compiler knows.
  const double x = 0.7 + count;
  std::printf("%a %a %a %a %a %a\n", std::sin(x), std::cos(x), std::exp(x), std::log(x), std::pow(x, 2.4),
              static_cast<double>(std::sin(static_cast<float>(x))));
  const auto print_denormal = [count] {
    const double smallest = std::numeric_limits<double>::min() * count;
    std::printf("%d\n", smallest * 0.5 > 0.0 ? 1 : 0);
  };
  print_denormal();
  std::thread(print_denormal).join();
  return EXIT_SUCCESS;
}
