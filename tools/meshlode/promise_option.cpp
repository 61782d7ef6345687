// SPDX-License-Identifier: GPL-3.0-or-later
#include "promise_option.h"

#include "format/names.h"

namespace meshlode::cli {

void add_promise_option(OptionParser& parser, std::string& promise) {
  parser.add_value(
      "--promise", promise,
      "what the pixel error or error limits: position; texels: also texture coordinates; appearance: also normals",
      all_names(format::kPromiseNames));
}

Result<run::Asset> with_promise(const run::Asset& asset, const std::string& promise) {
  return asset.with_promise(value_in(format::kPromiseNames, promise).value_or(format::Promise::kPosition));
}

}  // namespace meshlode::cli
