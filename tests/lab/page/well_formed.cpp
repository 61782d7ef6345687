// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/well_formed.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <vector>

#include "base/utf8.h"

namespace meshlode::lab::page {

namespace {

bool is_name_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == ':' || c == '_';
}

class Checker {
 public:
  explicit Checker(std::string_view text) : text_(text) {}

  std::string run() {
    constexpr std::string_view kDoctype = "<!DOCTYPE html>\n";
    if (text_.starts_with(kDoctype)) at_ = kDoctype.size();
    while (fault_.empty() && at_ < text_.size()) {
      if (text_[at_] == '<') {
        take_tag();
      } else {
        take_character(false);
      }
    }
    if (fault_.empty() && !open_.empty()) fault_ = "never closed: " + open_.back();
    return fault_;
  }

 private:
  void fail(const std::string& what) {
    fault_ = what + " before: " + std::string(text_.substr(std::min(at_, text_.size()), 60));
  }
  [[nodiscard]] bool is_next(std::string_view part) const {
    return at_ < text_.size() && text_.substr(at_).starts_with(part);
  }

  void take_character(bool is_in_value) {
    if (open_.empty() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0) return fail("text outside");
    if (text_[at_] == '&') {
      const std::string_view name = text_.substr(at_ + 1, text_.find(';', at_) - at_ - 1);
      static const std::set<std::string_view> names = {"amp", "lt", "gt", "quot", "#39"};
      if (!names.contains(name)) return fail("an unknown reference");
      at_ += name.size() + 2;
      return;
    }
    const std::size_t length = utf8_length(text_.substr(at_));
    const auto byte = static_cast<unsigned char>(text_[at_]);
    if (length == 0 || (byte < 0x20 && byte != '\n' && byte != '\t')) return fail("no character of XML");
    if (!is_in_value && is_next("]]>")) return fail("]]>");
    at_ += length;
  }

  std::string_view take_name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_name_character(text_[at_])) ++at_;
    if (at_ == begin) fail("no name");
    return text_.substr(begin, at_ - begin);
  }

  void take_attribute(std::set<std::string_view>& seen) {
    const std::string_view name = take_name();
    if (!fault_.empty()) return;
    if (!seen.insert(name).second) return fail("an attribute twice");
    if (!is_next("=\"")) return fail("no quoted value");
    at_ += 2;
    const std::size_t begin = at_;
    while (fault_.empty() && at_ < text_.size() && text_[at_] != '"') {
      if (text_[at_] == '<') return fail("< in a value");
      take_character(true);
    }
    if (at_ >= text_.size()) return fail("a value that does not end");
    if (name == "id" && !ids_.insert(text_.substr(begin, at_ - begin)).second) return fail("an id twice");
    ++at_;
  }

  void take_tag() {
    ++at_;
    if (is_next("/")) {
      ++at_;
      const std::string_view name = take_name();
      if (open_.empty() || open_.back() != name || !is_next(">")) return fail("a wrong end tag");
      open_.pop_back();
      ++at_;
      return;
    }
    open_.emplace_back(take_name());
    if (open_.size() == 1 && has_root_) return fail("a second root");
    has_root_ = true;
    std::set<std::string_view> seen;
    while (fault_.empty() && is_next(" ")) {
      ++at_;
      take_attribute(seen);
    }
    if (!fault_.empty()) return;
    if (is_next("/>")) {
      open_.pop_back();
      at_ += 2;
    } else if (is_next(">")) {
      ++at_;
    } else {
      fail("a tag that does not end");
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool has_root_ = false;
  std::vector<std::string> open_;
  std::set<std::string_view> ids_;
  std::string fault_;
};

}  // namespace

std::string find_fault(std::string_view text) {
  return Checker(text).run();
}

}  // namespace meshlode::lab::page
