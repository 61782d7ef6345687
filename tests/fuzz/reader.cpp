// SPDX-License-Identifier: GPL-3.0-or-later
// The reader on any bytes, in C++ and in C: open, touch all tables, select, load and decode every page (I11). The
// mutator makes the checksums true again, so that the fuzzer gets behind them; the rest of its mutants keep their
// broken ones.
#include "asset_mutator.h"
#include "harness.h"
#include "read_all.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto asset = meshlode::run::Asset::from_vector({data, data + size});
  if (asset) {
    meshlode::fuzz::read_all(*asset);
  } else {
    meshlode::fuzz::require(!asset.error().detail.empty(), "a refusal without a reason");
  }
  meshlode::fuzz::read_all_c({data, size});
  return 0;
}

#ifdef MESHLODE_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return meshlode::fuzz::mutate_asset(data, size, max_size, seed, 0);
}
#endif
