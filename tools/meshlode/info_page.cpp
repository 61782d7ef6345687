// SPDX-License-Identifier: GPL-3.0-or-later
#include "info_page.h"
#include "base/try.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "app/page/viewer_page.h"
#include "repacked.h"

namespace meshlode::cli {

namespace {

#ifdef MESHLODE_HAS_WASM
constexpr std::uint8_t kModule[] = {
#include "meshlode.wasm.inc"
};
constexpr std::span<const std::uint8_t> kRuntime = kModule;
#else
constexpr std::span<const std::uint8_t> kRuntime;
#endif

bool are_readable(const run::Asset& asset) {
  return std::all_of(asset.pages().begin(), asset.pages().end(), [](const format::PageRecord& page) {
    return page.codec == format::Codec::kStrips || page.codec == format::Codec::kNone;
  });
}

std::uint64_t stored_bytes(const run::Asset& asset) {
  std::uint64_t bytes = 0;
  for (const format::PageRecord& page : asset.pages()) bytes += page.stored_bytes;
  return bytes;
}

}  // namespace

Status can_write_info_page() {
  if (!kRuntime.empty()) return Ok{};
  return Error{
      ErrorCode::kUnsupported, "--html",
      "this program was built without the WebAssembly runtime that the page needs: clang 14 and Debian's wasi-libc, "
      "libc++-14-dev-wasm32 and libclang-rt-14-dev-wasm32 were missing, or MESHLODE_WASM was off"};
}

Result<std::string> info_page(const run::Asset& asset, const std::string& path,
                              const std::optional<app::ByteMap>& byte_map, std::uint64_t max_page_bytes) {
  TRY(can_write_info_page());
  app::ViewerInput input;
  const std::string name = std::filesystem::path(path).filename().string();
  input.title = name;
  input.runtime = kRuntime;
  input.byte_map = byte_map;
  input.max_page_bytes = max_page_bytes;
  TRY_LET(strips, repacked(asset, format::Codec::kStrips));
  TRY_LET(smaller, run::Asset::from_bytes(*strips));
  const bool is_own = are_readable(asset) && stored_bytes(asset) <= stored_bytes(*smaller);
  if (!is_own) input.file = &asset;
  return app::viewer_page(is_own ? asset : *smaller, input);
}

}  // namespace meshlode::cli
