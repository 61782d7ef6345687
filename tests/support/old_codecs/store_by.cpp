// SPDX-License-Identifier: GPL-3.0-or-later
// store_by CODEC FROM TO: an asset as `meshlode repack` gave it while the codec was written: lz4, zstd and draco too.
#include <cstdio>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/try.h"
#include "builder/write_meta.h"
#include "format/names.h"
#include "support/old_codecs/old_codecs.h"

namespace meshlode {
namespace {

Status store(const std::string& name, const char* from, const char* to) {
  const auto codec = value_in(format::kCodecNames, name);
  if (!codec) return Error{ErrorCode::kUsage, name, "is no codec"};
  TRY_LET(asset, run::Asset::open(from));
  TRY_LET(bytes, test::stored_by(*asset, *codec, builder::meta_with_codec(asset->meta_json(), *codec)));
  return write_file_atomically(to, *bytes);
}

}  // namespace
}  // namespace meshlode

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "store_by CODEC FROM TO\n"), 2;
  const meshlode::Status status = meshlode::store(argv[1], argv[2], argv[3]);
  if (!status) std::fprintf(stderr, "store_by: %s\n", status.error().message().c_str());
  return status ? 0 : 1;
}
