// SPDX-License-Identifier: MIT
// What the files behind <meshlode/meshlode.h> share: the handle, and how errors leave.
#pragma once

#include <meshlode/meshlode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <utility>

#include "run/api/by_promise.h"
#include "run/api/camera_of_view.h"

struct meshlode_asset {
  meshlode::run::AssetByPromise assets;
  const meshlode::run::Asset& asset = assets.by_position();
};

namespace meshlode::run::c {

inline meshlode_status fail(meshlode_error* error, meshlode_status status, const char* text) {
  if (error == nullptr) return status;
  error->status = status;
  std::size_t size = std::min(std::strlen(text), sizeof error->text - 1);
  // Not in the middle of a character of UTF-8.
  const auto is_continuation = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U; };
  while (size > 0 && text[size] != '\0' && is_continuation(size)) --size;
  std::memcpy(error->text, text, size);
  error->text[size] = '\0';
  return status;
}

inline meshlode_status fail(meshlode_error* out, const Error& error) {
  meshlode_status status = MESHLODE_INVALID;
  switch (error.code) {
    case ErrorCode::kUsage: status = MESHLODE_USAGE; break;
    case ErrorCode::kIo: status = MESHLODE_IO; break;
    case ErrorCode::kUnsupported: status = MESHLODE_UNSUPPORTED; break;
    case ErrorCode::kInvalid:
    case ErrorCode::kBuildFailed:
    case ErrorCode::kCheckFailed: break;
  }
  return fail(out, status, error.message().c_str());
}

inline meshlode_status succeed(meshlode_error* error) {
  if (error != nullptr) {
    error->status = MESHLODE_OK;
    error->text[0] = '\0';
  }
  return MESHLODE_OK;
}

/// Calls `body`, which returns a status; memory that cannot be had is a status too.
template <class Body>
meshlode_status guard(meshlode_error* error, const Body& body) {
#ifdef __cpp_exceptions
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return fail(error, MESHLODE_OUT_OF_MEMORY, "out of memory");
  } catch (...) {
    return fail(error, MESHLODE_INVALID, "unexpected failure");
  }
#else
  // Nothing throws, and memory that cannot be had ends the program or module (tools/wasm/module.cpp).
  static_cast<void>(error);
  return body();
#endif
}

inline meshlode_status take(Result<run::Asset> asset, meshlode_asset** out, meshlode_error* error) {
  if (!asset) return fail(error, asset.error());
  *out = new meshlode_asset{run::AssetByPromise(std::move(*asset))};
  return succeed(error);
}

inline bool is_aligned(const void* memory) {
  return reinterpret_cast<std::uintptr_t>(memory) % 4 == 0;
}

/// The camera of what a caller selects with, or MESHLODE_USAGE.
inline meshlode_status read_view(const meshlode_view& view, double pixel_error, Camera& camera, meshlode_error* error) {
  const ViewFault fault = fault_of_view(view);
  if (fault.field != nullptr) {
    std::array<char, 96> text{};  // no memory is taken: nothing is thrown at a C caller
    std::snprintf(text.data(), text.size(), "view->%s %s", fault.field, fault.detail);
    return fail(error, MESHLODE_USAGE, text.data());
  }
  if (!(pixel_error >= 0.0) || !std::isfinite(pixel_error)) {
    return fail(error, MESHLODE_USAGE, "pixel_error is not a number >= 0");
  }
  camera = camera_of_view(view);
  return MESHLODE_OK;
}

}  // namespace meshlode::run::c
