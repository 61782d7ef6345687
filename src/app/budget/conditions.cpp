// SPDX-License-Identifier: GPL-3.0-or-later
// A scanner without recursion: what stands in the brackets of any(…) is a plain path, so that no text nests.
#include "app/budget/conditions.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "base/printable.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

constexpr const char* kOption = "--fail-if";

constexpr std::array<EnumName<StepKind>, 3> kQuantifierNames{
    {{StepKind::kAny, "any"}, {StepKind::kAll, "all"}, {StepKind::kCount, "count"}}};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// What may stand behind a number.
std::optional<double> factor_of(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 10> kUnits{{{"", 1.0},
                                                                        {"K", 1e3},
                                                                        {"M", 1e6},
                                                                        {"G", 1e9},
                                                                        {"KB", 1e3},
                                                                        {"MB", 1e6},
                                                                        {"GB", 1e9},
                                                                        {"KiB", 0x1p10},
                                                                        {"MiB", 0x1p20},
                                                                        {"GiB", 0x1p30}}};
  for (const auto& [name, factor] : kUnits) {
    if (unit == name) return factor;
  }
  return std::nullopt;
}

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  Result<std::vector<Condition>> scan() {
    std::vector<Condition> conditions;
    skip_spaces();
    if (is_at_end()) return Error{ErrorCode::kUsage, kOption, "is empty: give a condition"};
    while (true) {
      TRY_LET(condition, scan_condition());
      conditions.push_back(std::move(*condition));
      if (is_at_end()) return conditions;
      if (!take(',')) return expected("a comma and another condition, or the end");
    }
  }

 private:
  [[nodiscard]] bool is_at_end() const { return at_ == text_.size(); }
  [[nodiscard]] char peek() const { return is_at_end() ? '\0' : text_[at_]; }

  void skip_spaces() {
    while (!is_at_end() && is_space(peek())) ++at_;
  }
  /// And the spaces behind it.
  bool take(char c) {
    if (is_at_end() || peek() != c) return false;
    ++at_;
    skip_spaces();
    return true;
  }

  [[nodiscard]] Error expected(const std::string& what) const {
    const std::string found = is_at_end() ? "the end" : "'" + printable(text_.substr(at_), 24) + "'";
    return {ErrorCode::kUsage, kOption, "expected " + what + ", found " + found};
  }

  Result<Condition> scan_condition() {
    skip_spaces();
    const std::size_t first = at_;
    Condition condition;
    TRY(scan_path(condition.path));
    const auto relation = scan_relation();
    if (!relation) return expected("one of > >= < <= == !=");
    condition.relation = *relation;
    TRY(scan_literal(condition.value));
    std::size_t last = at_;
    while (last > first && is_space(text_[last - 1])) --last;
    condition.text = text_.substr(first, last - first);
    if (is_ordered(condition.relation) && !std::holds_alternative<double>(condition.value)) {
      return Error{
          ErrorCode::kUsage, kOption,
          printable(condition.text, 200) + ": " + name_in(kRelationNames, condition.relation) + " compares numbers"};
    }
    return condition;
  }

  std::optional<Relation> scan_relation() {
    for (const auto& [relation, name] : kRelationNames) {
      const std::string_view word = name;
      if (text_.substr(at_, word.size()) != word) continue;
      at_ += word.size();
      skip_spaces();
      return relation;
    }
    return std::nullopt;
  }

  /// Keys, and quantifiers over keys, between dots.
  Status scan_path(std::vector<Step>& path) {
    do {
      if (Status step = scan_steps(path); !step) return step;
      if (path.size() > kMaxSteps) return Error{ErrorCode::kUsage, kOption, "a path of more than 32 steps"};
      if (path.back().kind == StepKind::kCount) break;
    } while (take('.'));
    return Ok{};
  }

  Status scan_steps(std::vector<Step>& path) {
    const std::size_t first = at_;
    if (!is_letter(peek())) return expected("a key");
    const auto quantifier = value_in(kQuantifierNames, scan_word());
    if (!quantifier || !take('(')) {
      at_ = first;
      return scan_key(path);
    }
    do {
      if (Status key = scan_key(path); !key) return key;
      if (path.size() > kMaxSteps) return expected("a shorter path");
    } while (take('.'));
    if (!take(')')) return expected("a closing bracket");
    path.push_back({*quantifier, {}, 0});
    return Ok{};
  }

  std::string_view scan_word() {
    const std::size_t first = at_;
    while (is_letter(peek()) || is_digit(peek())) ++at_;
    const std::string_view word = text_.substr(first, at_ - first);
    skip_spaces();
    return word;
  }

  /// A key and the subscripts behind it.
  Status scan_key(std::vector<Step>& path) {
    if (!is_letter(peek())) return expected("a key");
    path.push_back({StepKind::kKey, std::string(scan_word()), 0});
    while (take('[')) {
      Step step{StepKind::kIndex, {}, 0};
      if (peek() == '"' || peek() == '\'') {
        step.kind = StepKind::kName;
        if (!scan_quoted(step.name)) return expected("a closing quote");
      } else {
        const char* end = text_.data() + text_.size();
        const auto [behind, error] = std::from_chars(text_.data() + at_, end, step.index);
        if (error != std::errc{}) return expected("an index or a name in quotes");
        at_ = static_cast<std::size_t>(behind - text_.data());
        skip_spaces();
      }
      if (!take(']')) return expected("a closing bracket ]");
      path.push_back(std::move(step));
      if (path.size() > kMaxSteps) return expected("a shorter path");
    }
    return Ok{};
  }

  /// Everything up to the next quote of the same kind. \pre at a quote
  bool scan_quoted(std::string& out) {
    const std::size_t close = text_.find(peek(), at_ + 1);
    if (close == std::string_view::npos) return false;
    out = text_.substr(at_ + 1, close - at_ - 1);
    at_ = close + 1;
    skip_spaces();
    return true;
  }

  Status scan_literal(Literal& out) {
    constexpr const char* kWhat = "a number, a text, true, false or null";
    if (peek() == '"' || peek() == '\'') {
      std::string text;
      if (!scan_quoted(text)) return expected("a closing quote");
      out = std::move(text);
      return Ok{};
    }
    if (is_letter(peek())) {
      const std::size_t first = at_;
      while (is_letter(peek()) || is_digit(peek()) || peek() == '-') ++at_;
      const std::string_view word = text_.substr(first, at_ - first);
      skip_spaces();
      if (word == "null") return Ok{};
      if (word == "true" || word == "false") {
        out = word == "true";
      } else {
        out = std::string(word);
      }
      return Ok{};
    }
    const char* end = text_.data() + text_.size();
    double number = 0.0;
    const auto [behind, error] = std::from_chars(text_.data() + at_, end, number);
    if (error != std::errc{} || !std::isfinite(number)) return expected(kWhat);
    at_ = static_cast<std::size_t>(behind - text_.data());
    const std::size_t unit = at_;
    while (is_letter(peek()) || is_digit(peek())) ++at_;
    const auto factor = factor_of(text_.substr(unit, at_ - unit));
    if (!factor) {
      at_ = unit;
      return expected("K, M, G, KB, MB, GB, KiB, MiB, GiB or nothing behind a number");
    }
    skip_spaces();
    number *= *factor;
    if (!std::isfinite(number)) return Error{ErrorCode::kUsage, kOption, "a number beyond 1.8e308"};
    out = number;
    return Ok{};
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<std::vector<Condition>> parse_conditions(std::string_view text) {
  if (text.size() > kMaxConditionsBytes) return Error{ErrorCode::kUsage, kOption, "more than 16384 bytes"};
  return Scanner(text).scan();
}

bool mentions(const std::vector<Condition>& conditions, std::string_view key) {
  return std::any_of(conditions.begin(), conditions.end(), [&](const Condition& c) { return c.path[0].name == key; });
}

}  // namespace meshlode::app
