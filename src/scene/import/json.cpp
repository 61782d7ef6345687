// SPDX-License-Identifier: GPL-3.0-or-later
// The one file of this room that sees nlohmann-json. Its SAX parser keeps no stack of its own frames, so depth is
// bounded here and a deep document cannot overflow ours when the tree is destroyed.
#include "scene/import/json.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

namespace meshlode::scene {

namespace {

const Json::Array kNoItems;

bool has_duplicate_keys(const Json::Object& object) {
  if (object.size() < 2) return false;
  std::vector<std::string_view> keys;
  keys.reserve(object.size());
  for (const JsonMember& member : object) keys.push_back(member.key);
  std::sort(keys.begin(), keys.end());
  return std::adjacent_find(keys.begin(), keys.end()) != keys.end();
}

/// How many values each array and object of a JSON text has, in the order in which they open, so that each takes its
/// memory once: one that doubles would hold up to three times its values while it grows. Of a text that is none the
/// counts are only hints, and end where it is nested too deep.
std::vector<std::uint32_t> count_items(std::string_view text) {
  std::vector<std::uint32_t> counts;
  counts.reserve(static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return c == '[' || c == '{';  // in strings too
  })));
  std::vector<std::size_t> open;
  bool is_first = false;  // what comes next is the first thing in the innermost one
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const bool is_end = c == ']' || c == '}';
    if (!open.empty() && (c == ',' || (is_first && !is_end))) ++counts[open.back()];
    is_first = c == '[' || c == '{';
    if (is_first) {
      if (open.size() == kMaxJsonDepth) break;
      open.push_back(counts.size());
      counts.push_back(0);
    } else if (is_end && !open.empty()) {
      open.pop_back();
    } else if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\' ? 1 : 0;
    }
  }
  return counts;
}

/// Receives the parser's events and builds the tree.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit TreeBuilder(std::string_view text) : unclaimed_(text.size()), counts_(count_items(text)) {}

  bool null() override { return put(Json{}) != nullptr; }
  bool boolean(bool flag) override { return put(Json{flag}) != nullptr; }
  bool number_integer(number_integer_t n) override { return put(Json{std::int64_t{n}}) != nullptr; }
  bool number_unsigned(number_unsigned_t n) override { return put(Json{std::uint64_t{n}}) != nullptr; }
  bool number_float(number_float_t n, const string_t&) override { return put(Json{n}) != nullptr; }
  bool string(string_t& text) override { return put(Json::make_string(text)) != nullptr; }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::Object{}); }
  bool start_array(std::size_t) override { return open(Json::Array{}); }
  bool key(string_t& name) override {
    key_ = std::move(name);
    return true;
  }
  bool end_object() override {
    const bool duplicate = has_duplicate_keys(*open_.back()->object());
    open_.pop_back();
    if (duplicate) problem = "an object has the same key twice";
    return !duplicate;
  }
  bool end_array() override {
    open_.pop_back();
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) override {
    std::string text = error.what();
    // "[json.exception.parse_error.101] parse error at line 1, column 2: …": the bracket says nothing to a user.
    if (const std::size_t end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
    // Of "syntax error while parsing value - invalid literal; last read: 'b'" what is in the middle.
    const std::size_t syntax = text.find("syntax error while parsing "), dash = text.find(" - ", syntax);
    if (syntax != std::string::npos && dash != std::string::npos) text.erase(syntax, dash + 3 - syntax);
    text.erase(std::min(text.find("; last read: "), text.size()));
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    }
    problem = "not JSON at byte " + std::to_string(position) + ": " + text;
    return false;
  }

  Json root;
  std::string problem;

 private:
  Json* put(Json value) {
    if (open_.empty()) {
      root = std::move(value);
      return &root;
    }
    if (auto* array = std::get_if<Json::Array>(&open_.back()->value)) return &array->push_back(std::move(value));
    auto& object = std::get<Json::Object>(open_.back()->value);
    return &object.push_back({std::exchange(key_, {}), std::move(value)}).value;
  }
  template <class List>
  bool open(List list) {
    if (open_.size() >= kMaxJsonDepth) {
      problem = "values nested deeper than " + std::to_string(kMaxJsonDepth);
      return false;
    }
    // An item is "0," and a member "\"\":0," at least, and no two share a byte: text that is not JSON gets no more
    // memory than text that is, however it is nested.
    constexpr std::size_t kLeastBytes = std::is_same_v<List, Json::Object> ? 5 : 2;
    if (opened_ < counts_.size()) {
      const std::size_t count = std::min<std::size_t>(counts_[opened_++], unclaimed_ / kLeastBytes + 1);
      unclaimed_ -= std::min(unclaimed_, count * kLeastBytes);
      list.reserve(count);
    }
    // A container's address is stable while it is open: only the innermost one grows.
    open_.push_back(put(Json{std::move(list)}));
    return true;
  }

  std::size_t unclaimed_;  ///< bytes of the text that no item was counted for
  std::vector<std::uint32_t> counts_;
  std::size_t opened_ = 0;  ///< containers so far: the place in counts_
  std::vector<Json*> open_;
  std::string key_;
};

/// As nlohmann-json writes it. Of text beyond ASCII it checks the UTF-8; a tree of its own is never made, for it cannot
/// be destroyed where memory is short.
void append_string(std::string_view text, std::string& out) {
  const bool is_plain = std::none_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte >= 0x80 || c == '"' || c == '\\';
  });
  if (!is_plain) {
    out += nlohmann::json(text).dump();
    return;
  }
  out += '"';
  out += text;
  out += '"';
}

template <class Integer>
void append_integer(Integer number, std::string& out) {
  std::array<char, 24> digits{};
  out.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
}

void append_double(double number, std::string& out) {
  if (!std::isfinite(number)) {
    out += "null";
    return;
  }
  std::array<char, 64> digits{};
  out.append(digits.data(), nlohmann::detail::to_chars(digits.data(), digits.data() + digits.size(), number));
}

/// Appends to one text, and allocates nothing else. \pre nested at most about kMaxJsonDepth deep
void append_json(const Json& json, std::string& out) {
  if (const auto* array = json.array()) {
    out += '[';
    for (const Json& item : *array) {
      if (&item != array->data()) out += ',';
      append_json(item, out);
    }
    out += ']';
  } else if (const auto* object = json.object()) {
    out += '{';
    for (const JsonMember& member : *object) {
      if (&member != object->data()) out += ',';
      append_string(member.key, out);
      out += ':';
      append_json(member.value, out);
    }
    out += '}';
  } else if (const auto text = json.string()) {
    append_string(*text, out);
  } else if (const auto* flag = std::get_if<bool>(&json.value)) {
    out += *flag ? "true" : "false";
  } else if (const auto* n = std::get_if<std::int64_t>(&json.value)) {
    append_integer(*n, out);
  } else if (const auto* u = std::get_if<std::uint64_t>(&json.value)) {
    append_integer(*u, out);
  } else if (const auto* d = std::get_if<double>(&json.value)) {
    append_double(*d, out);
  } else {
    out += "null";
  }
}

}  // namespace

bool Json::is_number() const {
  return std::holds_alternative<std::int64_t>(value) || std::holds_alternative<std::uint64_t>(value) ||
         std::holds_alternative<double>(value);
}

const Json* Json::find(std::string_view key) const {
  const Object* members = object();
  if (members == nullptr) return nullptr;
  for (const JsonMember& member : *members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

Json* Json::find(std::string_view key) {
  return const_cast<Json*>(std::as_const(*this).find(key));
}

const Json::Array& Json::items(std::string_view key) const {
  const Json* member = find(key);
  const Array* array = member != nullptr ? member->array() : nullptr;
  return array != nullptr ? *array : kNoItems;
}

std::optional<double> Json::number() const {
  if (const auto* d = std::get_if<double>(&value)) return *d;
  if (const auto* n = std::get_if<std::int64_t>(&value)) return static_cast<double>(*n);
  if (const auto* u = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*u);
  return std::nullopt;
}

std::optional<std::uint64_t> Json::index() const {
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 53;
  if (const auto* u = std::get_if<std::uint64_t>(&value)) {
    if (*u <= kLimit) return *u;
  } else if (const auto* n = std::get_if<std::int64_t>(&value)) {
    if (*n >= 0 && static_cast<std::uint64_t>(*n) <= kLimit) return static_cast<std::uint64_t>(*n);
  } else if (const auto* d = std::get_if<double>(&value)) {
    if (*d >= 0.0 && *d <= 9007199254740992.0 && std::floor(*d) == *d) return static_cast<std::uint64_t>(*d);
  }
  return std::nullopt;
}

void Json::set(std::string_view key, Json member) {
  if (Json* old = find(key)) {
    *old = std::move(member);
  } else {
    std::get<Object>(value).push_back({std::string(key), std::move(member)});
  }
}

void Json::erase(std::string_view key) {
  if (auto* members = std::get_if<Object>(&value)) {
    members->erase_if([&](const JsonMember& m) { return m.key == key; });
  }
}

void Json::erase_all(const std::vector<std::string>& keys) {
  if (auto* members = std::get_if<Object>(&value)) {
    members->erase_if([&](const JsonMember& m) { return std::binary_search(keys.begin(), keys.end(), m.key); });
  }
}

Json Json::make_object() {
  return Json{Object{}};
}
Json Json::make_array() {
  return Json{Array{}};
}
Json Json::make_index(std::uint64_t index) {
  return Json{index};
}
Json Json::make_string(std::string_view text) {
  return Json{Text(text.data(), text.size())};
}
Json Json::make_number(double number) {
  return Json{number};
}
Json Json::make_bool(bool flag) {
  return Json{flag};
}

Result<Json> parse_json(std::string_view text) {
  TreeBuilder builder(text);
  try {
    if (nlohmann::json::sax_parse(text.begin(), text.end(), &builder)) return std::move(builder.root);
  } catch (const nlohmann::json::exception& error) {
    builder.problem = error.what();
  }
  if (builder.problem.empty()) builder.problem = "not JSON";
  return Error{ErrorCode::kInvalid, "", builder.problem};
}

std::string dump_json(const Json& json) {
  std::string out;
  append_json(json, out);
  return out;
}

}  // namespace meshlode::scene
