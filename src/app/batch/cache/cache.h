// SPDX-License-Identifier: GPL-3.0-or-later
// The cache of whole assets: ingredients in, record and bytes out.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "app/batch/cache/record.h"
#include "app/batch/cache/store.h"
#include "base/hash.h"

namespace meshlode::app {

class Cache {
 public:
  /// `program`: find_program_id(), what assets of other programs are told apart by.
  Cache(Store store, const Hash128& program) : store_(std::move(store)), program_(program) {}

  [[nodiscard]] const Store& store() const { return store_; }
  [[nodiscard]] const Hash128& program() const { return program_; }

  [[nodiscard]] std::optional<AssetRecord> find_record(const std::string& ingredients) const;
  /// The asset first, so that whoever finds the record finds it too.
  void keep(const AssetRecord& record, std::span<const std::uint8_t> asset) const;

  /// What an output was made of last, here: for words alone, never for a decision.
  void remember(const std::filesystem::path& output, const std::string& ingredients) const;
  /// Why an output has to be built from these ingredients, that the cache has no record of.
  [[nodiscard]] std::string explain(const std::filesystem::path& output, const std::string& ingredients) const;

 private:
  Store store_;
  Hash128 program_;
};

}  // namespace meshlode::app
