// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <utility>

#include "laws/law.h"

namespace meshlode::test::hard {

Result<Built> build_sample(Sample sample) {
  builder::PipelineReport report;
  auto bytes = builder::build_lode(sample.scene, sample.options, {}, report);
  if (!bytes) return bytes.error();
  Built built;
  built.sample = std::move(sample);
  built.bytes = std::move(*bytes);
  auto asset = run::Asset::from_bytes(built.bytes);
  // What the builder wrote and the reader refuses is no refusal.
  if (!asset) return Error{ErrorCode::kCheckFailed, "reader", asset.error().message()};
  built.asset = std::move(*asset);
  return built;
}

std::span<const Law> laws() {
  static constexpr std::array<Law, 14> kLaws{{
      {"invariants", "the rules L and V of the judge", check_invariants},
      {"closed cuts", "exact; edges of more than two triangles counted", check_closed_cuts},
      {"renumbered vertices", "exact: the same bytes", check_renumbered},
      {"reordered triangles", "exact: the same bytes", check_reordered},
      {"turned corners", "exact: the same bytes", check_turned_corners},
      {"unused vertex", "exact: its count alone", check_unused_vertex},
      {"negative zeros", "exact: the same bytes", check_negative_zeros},
      {"moved by whole steps", "exact: its origin alone", check_translated},
      {"scaled by 128", "exact: floats times 128", check_doubled},
      {"scaled by 3", "the same integers; errors of 3 e within what floats choose", check_tripled},
      {"quarter turn", "level 0 exact but for ties and needles", check_quarter_turn},
      {"mirrored", "level 0 exact but for ties and needles", check_mirrored},
      {"in company", "exact: each mesh's own content", check_company},
      {"views", "E + R - d within 8 u (2 |c| sigma + d)", check_views},
  }};
  return kLaws;
}

}  // namespace meshlode::test::hard
