// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep has measured so far, in a file of its report's folder: a sweep that was interrupted goes on from there,
// and a second one over the same scene takes over what cannot have changed.
//
// A line is a measurement: hash, fingerprint, JSON. It is appended in one write and synced, so that a killed sweep
// loses the measurement under way and nothing else; a line that is cut off or broken does not match its hash and counts
// as not there. Lines of another program, machine or scene have another fingerprint and are passed over.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>

#include <meshlode/result.h>

#include "lab/sweep/measurement.h"

namespace meshlode::lab {

class State {
 public:
  /// `fingerprint`: of all that figures depend on beside a point's settings. Errors: kIo; a missing file is an empty
  /// state.
  [[nodiscard]] static Result<State> open(const std::filesystem::path& file, const std::string& fingerprint);

  /// Null where it has not been measured.
  [[nodiscard]] const Measurement* find(MeasurementKind kind, const std::string& key, std::uint32_t round = 0) const;
  /// A measurement of an asset with that content; null where there is none.
  [[nodiscard]] const Measurement* find_content(const std::string& content_hash) const;
  /// Keeps it, on disk first; a link is not followed. Errors: kIo.
  [[nodiscard]] Status add(Measurement measurement);
  /// In memory alone.
  void keep_for_this_run(Measurement measurement);
  /// Wall seconds of all measurements.
  [[nodiscard]] double spent() const;

 private:
  State(std::filesystem::path file, std::string fingerprint)
      : file_(std::move(file)), fingerprint_(std::move(fingerprint)) {}

  std::filesystem::path file_;
  std::string fingerprint_;
  bool ends_in_line_ = true;  ///< the file's last line is whole
  std::map<std::tuple<MeasurementKind, std::string, std::uint32_t>, Measurement> measurements_;
};

}  // namespace meshlode::lab
