// SPDX-License-Identifier: GPL-3.0-or-later
// A law: what has to hold between an asset and its source, or between the assets of two sources that differ in one way.
// docs/explanation/numerics.md says of each why it is exact, or derives its bound.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "hard_case.h"
#include "run/read/asset.h"

namespace meshlode::test::hard {

enum class Verdict : std::uint8_t {
  kHolds,     ///< as promised
  kBound,     ///< what is lost is lost within a bound that the asset states
  kRefused,   ///< an error with its reason, and nothing written
  kNotAsked,  ///< the law says nothing about this sample
  kFails,     ///< a rule of the judge or a law is broken
};

struct LawResult {
  Verdict verdict = Verdict::kNotAsked;
  std::string detail;  ///< the first break; what was refused; why it was not asked
  /// The largest measured figure over its bound; 0 where the law is exact or nothing was measured.
  double share = 0.0;
};

/// A sample and what was built of it.
struct Built {
  Sample sample;
  std::vector<std::uint8_t> bytes;
  std::optional<run::Asset> asset;  ///< of the bytes; the build's other errors are Result's
};

/// Builds the sample. Errors: the build's.
[[nodiscard]] Result<Built> build_sample(Sample sample);

struct Law {
  const char* name;
  const char* kind;  ///< "exact", or the bound in words
  LawResult (*check)(const Built& base);
};

/// In the order of docs/explanation/numerics.md. The first is asked everywhere, the others at the easy end of each
/// case.
[[nodiscard]] std::span<const Law> laws();

// laws/invariants.cpp
[[nodiscard]] LawResult check_invariants(const Built& base);
[[nodiscard]] LawResult check_closed_cuts(const Built& base);
// laws/order.cpp
[[nodiscard]] LawResult check_renumbered(const Built& base);
[[nodiscard]] LawResult check_reordered(const Built& base);
[[nodiscard]] LawResult check_turned_corners(const Built& base);
[[nodiscard]] LawResult check_unused_vertex(const Built& base);
[[nodiscard]] LawResult check_negative_zeros(const Built& base);
// laws/motion.cpp
[[nodiscard]] LawResult check_translated(const Built& base);
[[nodiscard]] LawResult check_doubled(const Built& base);
[[nodiscard]] LawResult check_tripled(const Built& base);
// laws/turn.cpp
[[nodiscard]] LawResult check_quarter_turn(const Built& base);
[[nodiscard]] LawResult check_mirrored(const Built& base);
// laws/company.cpp
[[nodiscard]] LawResult check_company(const Built& base);
// laws/views.cpp
[[nodiscard]] LawResult check_views(const Built& base);

}  // namespace meshlode::test::hard
