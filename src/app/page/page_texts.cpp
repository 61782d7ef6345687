// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/page/page_texts.h"

#include <array>
#include <cstddef>
#include <string>

namespace meshlode::app {

namespace {

constexpr unsigned char kFrame[] = {
#include "viewer.html.inc"
};
constexpr unsigned char kViewerPage[] = {
#include "index.html.inc"
};
constexpr unsigned char kStyle[] = {
#include "viewer.css.inc"
};
constexpr unsigned char kLicence[] = {
#include "MIT.txt.inc"
};
constexpr unsigned char kNotice[] = {
#include "NOTICE.inc"
};
constexpr unsigned char kRuntime[] = {
#include "index.js.inc"
};
constexpr unsigned char kDag[] = {
#include "dag.js.inc"
};
constexpr unsigned char kGraph[] = {
#include "graph.js.inc"
};
constexpr unsigned char kOrbit[] = {
#include "orbit.js.inc"
};
constexpr unsigned char kTreemap[] = {
#include "treemap.js.inc"
};
constexpr unsigned char kAddress[] = {
#include "address.js.inc"
};
constexpr unsigned char kViewer[] = {
#include "viewer.js.inc"
};
constexpr unsigned char kMeshView[] = {
#include "mesh_view.js.inc"
};
constexpr unsigned char kEmbedded[] = {
#include "embedded.js.inc"
};

constexpr unsigned char kOverviewFrame[] = {
#include "overview.html.inc"
};
constexpr unsigned char kOverviewStyle[] = {
#include "overview.css.inc"
};
constexpr unsigned char kOverviewScript[] = {
#include "overview.js.inc"
};
constexpr unsigned char kCompareFrame[] = {
#include "compare.html.inc"
};
constexpr unsigned char kCompareStyle[] = {
#include "compare.css.inc"
};

template <std::size_t N>
std::string_view text_of(const unsigned char (&bytes)[N]) {
  return {reinterpret_cast<const char*>(bytes), N};
}

}  // namespace

std::string_view page_frame() {
  return text_of(kFrame);
}

std::string_view page_main() {
  constexpr std::string_view kEnd = "</main>\n";
  const std::string_view page = text_of(kViewerPage);
  const std::size_t begin = page.find("<main>");
  return page.substr(begin, page.find(kEnd) + kEnd.size() - begin);
}

std::string_view page_style() {
  return text_of(kStyle);
}

std::string_view page_licences() {
  static const std::string text = std::string(text_of(kLicence)) + "\n" + std::string(text_of(kNotice));
  return text;
}

std::span<const std::string_view> page_scripts() {
  static const std::array texts{text_of(kRuntime), text_of(kDag),      text_of(kGraph),
                                text_of(kOrbit),   text_of(kTreemap),  text_of(kAddress),
                                text_of(kViewer),  text_of(kMeshView), text_of(kEmbedded)};
  return texts;
}

std::string_view overview_frame() {
  return text_of(kOverviewFrame);
}

std::string_view overview_style() {
  return text_of(kOverviewStyle);
}

std::string_view overview_script() {
  return text_of(kOverviewScript);
}

std::string_view compare_frame() {
  return text_of(kCompareFrame);
}

std::string_view compare_style() {
  return text_of(kCompareStyle);
}

}  // namespace meshlode::app
