// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <string_view>

#include "app/batch/tell/tell.h"
#include "base/append_format.h"

namespace meshlode::app {

namespace {

/// How many bytes of UTF-8 one character has that XML 1.0 allows, 0 for what is neither.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return first >= 0x20 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  if (first >= 0xC2 && first < 0xE0) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first < 0xF0) {
    if (!follows(1) || !follows(2)) return 0;
    const std::uint32_t code = (first & 15U) << 12U | (byte(1) & 63U) << 6U | (byte(2) & 63U);
    return code < 0x800 || (code >= 0xD800 && code < 0xE000) || code >= 0xFFFE ? 0 : 3;
  }
  if (first >= 0xF0 && first < 0xF5) {
    if (!follows(1) || !follows(2) || !follows(3)) return 0;
    const std::uint32_t code = (first & 7U) << 18U | (byte(1) & 63U) << 12U | (byte(2) & 63U) << 6U | (byte(3) & 63U);
    return code < 0x10000 || code > 0x10FFFF ? 0 : 4;
  }
  return 0;
}

/// Text of an attribute: what XML cannot hold becomes U+FFFD.
std::string escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    switch (text.front()) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\t': out += "&#9;"; break;
      case '\n': out += "&#10;"; break;
      case '\r': out += "&#13;"; break;
      default: out += length == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

const char* kind_of(int exit_code) {
  switch (static_cast<ErrorCode>(exit_code)) {
    case ErrorCode::kUsage: return "usage";
    case ErrorCode::kIo: return "input or output failed";
    case ErrorCode::kInvalid: return "invalid input";
    case ErrorCode::kBuildFailed: return "build failed";
    case ErrorCode::kUnsupported: return "unsupported";
    case ErrorCode::kCheckFailed: return "a check failed";
  }
  return "failed";
}

std::string case_xml(const JobResult& r) {
  std::string text = "    <testcase classname=\"meshlode.build\" name=\"" + escaped(r.job.input.string()) + "\"";
  append_format(text, " time=\"%.3f\"", r.seconds);
  if (r.status == JobStatus::kFailed) {
    text += ">\n      <failure type=\"" + std::string(kind_of(r.exit_code)) + "\" message=\"" + escaped(r.error) +
            "\"/>\n    </testcase>\n";
  } else if (r.status == JobStatus::kSkipped) {
    const std::string why = r.error.empty() ? "a file before it failed" : r.error;
    text += ">\n      <skipped message=\"" + escaped(why) + "\"/>\n    </testcase>\n";
  } else {
    std::string lines;
    for (const JobWarning& warning : r.warnings) lines += "warning: " + warning.text + "\n";
    for (const scene::LeftOut& left : r.facts.left_out) lines += "left out: " + left.what + ": " + left.why + "\n";
    text += ">\n      <system-out>" +
            escaped(std::string(name_of(r.status)) + ": " + r.job.output.string() + "\n" + lines) +
            "</system-out>\n    </testcase>\n";
  }
  return text;
}

}  // namespace

std::string junit_xml(const std::vector<JobResult>& results) {
  std::size_t failed = 0, skipped = 0;
  double seconds = 0.0;
  std::string cases;
  for (const JobResult& r : results) {
    failed += r.status == JobStatus::kFailed ? 1 : 0;
    skipped += r.status == JobStatus::kSkipped ? 1 : 0;
    seconds += r.seconds;
    cases += case_xml(r);
  }
  std::string counts;
  append_format(counts, " tests=\"%zu\" failures=\"%zu\" errors=\"0\" skipped=\"%zu\" time=\"%.3f\"", results.size(),
                failed, skipped, seconds);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"meshlode\"" + counts +
         ">\n  <testsuite name=\"meshlode build\"" + counts + ">\n" + cases + "  </testsuite>\n</testsuites>\n";
}

}  // namespace meshlode::app
