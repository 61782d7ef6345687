// SPDX-License-Identifier: GPL-3.0-or-later
// Writes markup that is both HTML and well-formed XML: every element is closed, every attribute has a value in quotes,
// and nothing gets in but through app::escape_html().
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace meshlode::lab::page {

struct Attribute {
  std::string_view name;
  std::string value;
};

class Markup {
 public:
  /// <tag name="value">
  Markup& open(std::string_view tag, std::initializer_list<Attribute> attributes = {});
  /// Ends the element that was opened last.
  Markup& close();
  /// <tag name="value"/>
  Markup& empty(std::string_view tag, std::initializer_list<Attribute> attributes = {});
  Markup& text(std::string_view text);
  /// An element with text alone.
  Markup& element(std::string_view tag, std::string_view text, std::initializer_list<Attribute> attributes = {});
  /// A name from a file: whichever way it is written, it does not turn its surroundings.
  Markup& name(std::string_view text) { return element("bdi", text); }
  /// \pre well-formed
  Markup& raw(std::string_view markup);
  Markup& line() { return raw("\n"); }

  /// \pre every element is closed
  [[nodiscard]] const std::string& str() const;

 private:
  void start(std::string_view tag, std::initializer_list<Attribute> attributes);

  std::string out_;
  std::vector<std::string> open_;
};

}  // namespace meshlode::lab::page
