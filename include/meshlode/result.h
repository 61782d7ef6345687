// SPDX-License-Identifier: MIT
/// \file
/// Errors as values. A bad file or option yields an Error with code, place and detail; a mistake of the programmer is
/// an assert. No exception leaves the library, except std::bad_alloc where a header says so.
#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace meshlode {

/// The kinds of failure; the value is the exit code of the command line.
enum class ErrorCode : int {
  kUsage = 1,        ///< an option is outside its documented range
  kIo = 2,           ///< a file could not be read or written
  kInvalid = 3,      ///< input that breaks its own format's rules
  kBuildFailed = 4,  ///< valid input that no asset came of (cancelled, out of memory, a limit), or an internal error
  kUnsupported = 5,  ///< valid input that asks for something this program does not do
  kCheckFailed = 6,  ///< a check or budget was not met
};

/// One failure. `where` names the file and the place in it ("scene.gltf: /accessors/3/count"), `detail` says why.
struct Error {
  ErrorCode code = ErrorCode::kInvalid;  ///< the kind of failure
  std::string where;                     ///< file and place in it; may be empty
  std::string detail;                    ///< the reason

  /// "where: detail", or the detail alone where the place is empty.
  [[nodiscard]] std::string message() const { return where.empty() ? detail : where + ": " + detail; }
};

/// A value or an Error. `if (!r) return r.error();` passes an error on.
template <class T>
class [[nodiscard]] Result {
 public:
  /// Success.
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT(google-explicit-constructor)
  /// Failure.
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  /// Whether there is a value.
  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  /// ok().
  explicit operator bool() const { return ok(); }

  /// The value. \pre ok()
  [[nodiscard]] T& value() & {
    assert(ok());
    return *std::get_if<0>(&state_);
  }
  /// The value. \pre ok()
  [[nodiscard]] const T& value() const& {
    assert(ok());
    return *std::get_if<0>(&state_);
  }
  /// The value. \pre ok()
  [[nodiscard]] T&& value() && {
    assert(ok());
    return std::move(*std::get_if<0>(&state_));
  }
  /// value().
  T& operator*() & { return value(); }
  /// value().
  const T& operator*() const& { return value(); }
  /// value().
  T&& operator*() && { return std::move(*this).value(); }
  /// value().
  T* operator->() { return &value(); }
  /// value().
  const T* operator->() const { return &value(); }

  /// The error. \pre !ok()
  [[nodiscard]] const Error& error() const {
    assert(!ok());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

/// The value of a stage that yields nothing but success.
struct Ok {};
/// Success or an Error.
using Status = Result<Ok>;

}  // namespace meshlode
