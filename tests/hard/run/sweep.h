// SPDX-License-Identifier: GPL-3.0-or-later
// Along the parameter of a case: where does the verdict change?
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "run/trial.h"

namespace meshlode::test::hard {

/// The verdict from `from` to `to`, both of them tried.
struct Stretch {
  double from = 0.0, to = 0.0;
  Verdict verdict = Verdict::kHolds;
  std::string detail;
};

struct Swept {
  const HardCase* hard_case = nullptr;
  std::vector<Stretch> stretches;  ///< in the order of the sweep
  Trial easy;                      ///< every law at the first parameter
};

/// A parameter's verdict; of a process of its own, or of a test.
using Ask = std::function<Trial(double parameter, bool all_laws)>;

/// How near to each other two parameters of different verdicts are brought.
struct Closeness {
  int steps = 6;  ///< halvings at most: of the ratio, or of the difference where the parameters are counts
};

/// Tries each parameter of the sweep, and bisects where two neighbours have different verdicts. Without steps, the
/// parameters alone; `only_first` leaves all but the first out.
[[nodiscard]] Swept sweep_case(const HardCase& hard_case, const Ask& ask, const Closeness& closeness, bool only_first);

/// Between two parameters, nearer to neither: the geometric mean where both have the sign that this needs, else the
/// middle; whole where the case counts. Equal to `low` or `high` where nothing lies between.
[[nodiscard]] double between(double low, double high, bool is_whole);

}  // namespace meshlode::test::hard
