// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of laws/ share: how a law's outcome is put, and the builds that it compares.
#pragma once

#include <string>
#include <utility>

#include "laws/law.h"

namespace meshlode::test::hard {

[[nodiscard]] inline LawResult not_asked(std::string why) {
  return {Verdict::kNotAsked, std::move(why), 0.0};
}
[[nodiscard]] inline LawResult broken(std::string what) {
  return {Verdict::kFails, std::move(what), 0.0};
}
[[nodiscard]] inline LawResult kept(double share = 0.0) {
  return {Verdict::kHolds, {}, share};
}

/// kHolds where the bytes of both builds are the same. The sample is `base`'s, changed in a way that must not matter.
[[nodiscard]] inline LawResult same_bytes(const Built& base, Sample changed) {
  const Result<Built> other = build_sample(std::move(changed));
  if (!other) return broken("refused: " + other.error().message());
  if (other->bytes == base.bytes) return kept();
  std::size_t at = 0;
  while (at < other->bytes.size() && at < base.bytes.size() && other->bytes[at] == base.bytes[at]) ++at;
  return broken("bytes differ from " + std::to_string(at) + " on, " + std::to_string(base.bytes.size()) + " and " +
                std::to_string(other->bytes.size()) + " in all");
}

}  // namespace meshlode::test::hard
