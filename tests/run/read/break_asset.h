// SPDX-License-Identifier: GPL-3.0-or-later
// One field of a sound asset changed and every checksum written anew: only the rule about that field can object.
#pragma once

#include <cstring>
#include <vector>

#include "support/sample_asset.h"

namespace meshlode::test {

template <class Record, class Change>
std::vector<std::uint8_t> with_changed_record(std::vector<std::uint8_t> asset, format::SectionId id, std::size_t index,
                                              const Change& change) {
  const std::uint64_t at = section_offset(asset, id) + index * sizeof(Record);
  Record record;
  std::memcpy(&record, asset.data() + at, sizeof(Record));
  change(record);
  std::memcpy(asset.data() + at, &record, sizeof(Record));
  reseal(asset);
  return asset;
}

}  // namespace meshlode::test
