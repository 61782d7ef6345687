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
std::string escaped_for_xml(std::string_view text) {
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

/// What a build says of a job, as a test case.
TestCase case_of(const JobResult& r) {
  TestCase test{r.job.input.string(), r.seconds, r.exit_code, {}, r.status == JobStatus::kSkipped};
  if (r.status == JobStatus::kFailed) {
    test.text = r.error;
  } else if (test.is_skipped) {
    test.text = r.error.empty() ? "a file before it failed" : r.error;
  } else {
    test.text = std::string(name_of(r.status)) + ": " + r.job.output.string() + "\n";
    for (const JobWarning& warning : r.warnings) test.text += "warning: " + warning.text + "\n";
    for (const scene::LeftOut& left : r.facts.left_out) {
      test.text += "left out: " + left.what + ": " + left.why + "\n";
    }
  }
  return test;
}

std::string case_xml(const std::string& verb, const TestCase& test) {
  std::string text = "    <testcase classname=\"meshlode." + verb + "\" name=\"" + escaped_for_xml(test.name) + "\"";
  append_format(text, " time=\"%.3f\"", test.seconds);
  if (test.is_skipped)
    return text + ">\n      <skipped message=\"" + escaped_for_xml(test.text) + "\"/>\n    </testcase>\n";
  if (test.exit_code != 0) {
    return text + ">\n      <failure type=\"" + kind_of(test.exit_code) + "\" message=\"" + escaped_for_xml(test.text) +
           "\"/>\n    </testcase>\n";
  }
  return text + ">\n      <system-out>" + escaped_for_xml(test.text) + "</system-out>\n    </testcase>\n";
}

}  // namespace

std::string junit_xml(const std::vector<JobResult>& results) {
  std::vector<TestCase> tests;
  tests.reserve(results.size());
  for (const JobResult& r : results) tests.push_back(case_of(r));
  return junit_xml("build", tests);
}

std::string junit_xml(const std::string& verb, const std::vector<TestCase>& tests) {
  std::size_t failed = 0, skipped = 0;
  double seconds = 0.0;
  std::string cases;
  for (const TestCase& test : tests) {
    skipped += test.is_skipped ? 1 : 0;
    failed += !test.is_skipped && test.exit_code != 0 ? 1 : 0;
    seconds += test.seconds;
    cases += case_xml(verb, test);
  }
  std::string counts;
  append_format(counts, " tests=\"%zu\" failures=\"%zu\" errors=\"0\" skipped=\"%zu\" time=\"%.3f\"", tests.size(),
                failed, skipped, seconds);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"meshlode\"" + counts +
         ">\n  <testsuite name=\"meshlode " + verb + "\"" + counts + ">\n" + cases + "  </testsuite>\n</testsuites>\n";
}

}  // namespace meshlode::app
