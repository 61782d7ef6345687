// SPDX-License-Identifier: GPL-3.0-or-later
#include "repacked.h"

#include "app/rewrite/rewrite_asset.h"
#include "builder/write_meta.h"

namespace meshlode::cli {

Result<std::vector<std::uint8_t>> repacked(const run::Asset& asset, format::Codec codec) {
  return app::rewrite_asset(asset, {codec, builder::meta_with_codec(asset.meta_json(), codec)});
}

}  // namespace meshlode::cli
