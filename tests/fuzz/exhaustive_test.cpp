// SPDX-License-Identifier: GPL-3.0-or-later
// Not a sample: every truncation and every changed byte of small files, each of its eight bits and all of them at once.
// As they come, checksums see each one; made to fit, what is behind the checksums refuses or reads them (I11).
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "fuzz/read_all.h"
#include "run/unpack/unpack.h"
#include "support/reseal.h"
#include "support/sample_asset.h"

namespace meshlode {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Whether the file is found wrong anywhere: at opening or in a page. Everything readable is read.
bool is_refused(const Bytes& bytes) {
  const auto asset = run::Asset::from_vector({bytes.begin(), bytes.end()});
  fuzz::read_all_c(bytes);
  if (!asset) return true;
  fuzz::read_all(*asset);
  for (std::size_t p = 0; p < asset->pages().size(); ++p) {
    if (!run::load_page(*asset, PageId(p))) return true;
  }
  return false;
}

class Exhaustive : public testing::TestWithParam<format::Codec> {
 protected:
  const Bytes bytes_ = test::asset_bytes_of(test::sample_tetrahedron(), GetParam());
};

TEST_P(Exhaustive, TheFileItselfIsRead) {
  EXPECT_FALSE(is_refused(bytes_));
  EXPECT_LT(bytes_.size(), 4096U);
}

TEST_P(Exhaustive, EveryTruncationIsRefused) {
  for (std::size_t size = 0; size < bytes_.size(); ++size) {
    Bytes cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_TRUE(is_refused(cut)) << size;
    if (size < sizeof(format::FileHeader)) continue;
    const std::uint64_t file_bytes = size;
    std::memcpy(cut.data() + offsetof(format::FileHeader, file_bytes), &file_bytes, sizeof(file_bytes));
    test::reseal(cut);
    ASSERT_TRUE(is_refused(cut)) << size << ", its checksums made to fit";
  }
}

TEST_P(Exhaustive, EveryChangedByteIsRefusedOrReadWithItsChecksumsMadeToFit) {
  std::size_t refused = 0, read = 0;
  for (std::size_t at = 0; at < bytes_.size(); ++at) {
    for (std::uint32_t bit = 0; bit <= 8; ++bit) {
      Bytes changed = bytes_;
      changed[at] ^= static_cast<std::uint8_t>(bit < 8 ? 1U << bit : 0xFFU);
      ASSERT_TRUE(is_refused(changed)) << "byte " << at << ", bit " << bit;
      test::reseal(changed);
      ++(is_refused(changed) ? refused : read);
    }
  }
  EXPECT_GT(refused, 1000U) << "the checks behind the checksums were reached";
  EXPECT_GT(read, 100U) << "some changes are harmless";
}

INSTANTIATE_TEST_SUITE_P(Codecs, Exhaustive,
                         testing::Values(format::Codec::kNone, format::Codec::kLz4, format::Codec::kZstd,
                                         format::Codec::kStrips),
                         [](const auto& codec) { return "codec" + std::to_string(static_cast<int>(codec.param)); });

}  // namespace
}  // namespace meshlode
