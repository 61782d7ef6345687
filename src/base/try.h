// SPDX-License-Identifier: MIT
// Returns of errors in one line, for functions that return meshlode::Status or a meshlode::Result.
#pragma once

/// Returns the error of `...`, a Status or a Result whose value is not asked for, where it is one.
#define TRY(...)                                                                 \
  do {                                                                           \
    if (auto try_status = (__VA_ARGS__); !try_status) return try_status.error(); \
  } while (false)

/// Declares `name`, the Result of `...`, and returns its error where it is one: `*name` is the value afterwards.
#define TRY_LET(name, ...)   \
  auto name = (__VA_ARGS__); \
  if (!(name)) return (name).error()
