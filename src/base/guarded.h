// SPDX-License-Identifier: MIT
// The last net under code whose errors are values: what is thrown all the same is memory that cannot be had, or a
// mistake of this program's, which is not blamed on the file that it was found with. What third-party libraries throw
// at a file's bytes is translated in their one wrapper file and does not come here.
#pragma once

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <meshlode/result.h>

namespace meshlode {

[[nodiscard]] inline Error out_of_memory(std::string where) {
  return {ErrorCode::kBuildFailed, std::move(where), "out of memory"};
}

/// A thread that cannot be started lacks its stack; oneTBB says so by a text alone.
[[nodiscard]] inline bool is_out_of_memory(const std::exception& thrown) {
  if (dynamic_cast<const std::bad_alloc*>(&thrown) != nullptr) return true;
  if (const auto* error = dynamic_cast<const std::system_error*>(&thrown)) {
    return error->code() == std::errc::resource_unavailable_try_again || error->code() == std::errc::not_enough_memory;
  }
  return std::string_view(thrown.what()).starts_with("pthread_create has failed");
}

[[nodiscard]] inline Error internal_error(std::string where, std::string_view what) {
  return {ErrorCode::kBuildFailed, std::move(where),
          "internal error (" + std::string(what) +
              "): a mistake of this program's, please report it with what it was given"};
}

/// What `body` returns, a Result. `where`: the file that was worked on, or empty, for where something is thrown.
template <class Body>
auto guarded(const std::filesystem::path& where, const Body& body) -> decltype(body()) {
  try {
    return body();
  } catch (const std::exception& thrown) {
    return is_out_of_memory(thrown) ? out_of_memory(where.string()) : internal_error(where.string(), thrown.what());
  } catch (...) {
    return internal_error(where.string(), "an exception of an unknown type");
  }
}

}  // namespace meshlode
