// SPDX-License-Identifier: GPL-3.0-or-later
// Workflow commands as GitHub and Gitea read them on stdout: ::LEVEL file=FILE,title=ID::TEXT.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "app/overview/overview.h"

namespace meshlode::app {

namespace {

/// `is_property`: between commas and colons, which then mean nothing else.
std::string command_text(std::string_view text, bool is_property) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '%': out += "%25"; break;
      case '\r': out += "%0D"; break;
      case '\n': out += "%0A"; break;
      case ':': out += is_property ? "%3A" : ":"; break;
      case ',': out += is_property ? "%2C" : ","; break;
      default: out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
    }
  }
  return out;
}

const char* command_of(Remark::Level level) {
  switch (level) {
    case Remark::Level::kError: return "error";
    case Remark::Level::kWarning: return "warning";
    case Remark::Level::kNote: break;
  }
  return "notice";
}

}  // namespace

std::string overview_annotations(const Overview& overview) {
  // Hosts show the first few of a step (GitHub: ten of each kind): what failed comes first.
  std::vector<Remark> remarks = list_remarks(overview);
  std::stable_sort(remarks.begin(), remarks.end(), [](const Remark& a, const Remark& b) { return a.level < b.level; });
  std::string text;
  for (const Remark& remark : remarks) {
    text += std::string("::") + command_of(remark.level) + " file=" + command_text(remark.file, true) +
            ",title=" + command_text("meshlode: " + remark.id, true) + "::" + command_text(remark.text, false) + "\n";
  }
  return text;
}

}  // namespace meshlode::app
