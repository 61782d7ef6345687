// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/state.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/try.h"
#include "lab/sweep/measurement_json.h"

namespace meshlode::lab {

namespace {

std::string hash_of(std::string_view text) {
  return to_hex(hash128({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
}

Error failed(const std::filesystem::path& file) {
  return {ErrorCode::kIo, file.string(), std::strerror(errno)};
}

/// "HASH FINGERPRINT {…}"; nothing where it is broken or another's.
std::optional<Measurement> read_line(std::string_view line, std::string_view fingerprint) {
  const std::size_t hash_end = line.find(' ');
  if (hash_end == std::string_view::npos) return std::nullopt;
  const std::string_view rest = line.substr(hash_end + 1);
  if (!rest.starts_with(fingerprint) || rest.substr(fingerprint.size(), 1) != " ") return std::nullopt;
  if (line.substr(0, hash_end) != hash_of(rest)) return std::nullopt;
  return read_measurement(rest.substr(fingerprint.size() + 1));
}

}  // namespace

Result<State> State::open(const std::filesystem::path& file, const std::string& fingerprint) {
  State state(file, fingerprint);
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return state;
  TRY_LET(mapped, MappedFile::open(file));
  const std::string_view text(reinterpret_cast<const char*>(mapped->bytes().data()), mapped->bytes().size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    state.ends_in_line_ = end != std::string_view::npos;
    if (!state.ends_in_line_) break;
    if (auto measurement = read_line(text.substr(at, end - at), fingerprint)) {
      const std::tuple key(measurement->kind, measurement->key, measurement->round);
      state.measurements_.insert_or_assign(key, std::move(*measurement));
    }
    at = end + 1;
  }
  return state;
}

const Measurement* State::find(MeasurementKind kind, const std::string& key, std::uint32_t round) const {
  const auto found = measurements_.find({kind, key, round});
  return found == measurements_.end() ? nullptr : &found->second;
}

const Measurement* State::find_content(const std::string& content_hash) const {
  for (const auto& [key, measurement] : measurements_) {
    const bool is_whole = measurement.kind == MeasurementKind::kAsset && measurement.error.empty();
    if (is_whole && measurement.asset.content_hash == content_hash) return &measurement;
  }
  return nullptr;
}

Status State::add(Measurement measurement) {
  const std::string rest = fingerprint_ + " " + measurement_line(measurement);
  // What a killed sweep left of a line is ended first.
  const std::string line = (ends_in_line_ ? "" : "\n") + hash_of(rest) + " " + rest + "\n";
  const int out = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (out < 0) return failed(file_);
  const bool is_whole = ::write(out, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  ends_in_line_ = is_whole;
  const bool is_synced = is_whole && ::fsync(out) == 0;
  const Status status = is_synced ? Status(Ok{}) : Status(failed(file_));
  ::close(out);
  const std::tuple key(measurement.kind, measurement.key, measurement.round);
  if (status) measurements_.insert_or_assign(key, std::move(measurement));
  return status;
}

void State::keep_for_this_run(Measurement measurement) {
  const std::tuple key(measurement.kind, measurement.key, measurement.round);
  measurements_.insert_or_assign(key, std::move(measurement));
}

double State::spent() const {
  double seconds = 0.0;
  for (const auto& [key, measurement] : measurements_) seconds += measurement.seconds;
  return seconds;
}

}  // namespace meshlode::lab
