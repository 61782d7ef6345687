// SPDX-License-Identifier: GPL-3.0-or-later
// nlohmann-json, seen by this file alone in this room.
#include "app/budget/judge_budget.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/nearest_name.h"
#include "base/printable.h"
#include "base/try.h"

namespace meshlode::app {

namespace {

using Json = nlohmann::json;  // sorted: an ordered one looks for each key among all, and a file chooses how many

Error usage(std::string detail) {
  return {ErrorCode::kUsage, "--fail-if", std::move(detail)};
}

/// A text of the document or of the command line, on its way to a terminal.
std::string in_quotes(std::string_view name) {
  return "'" + printable(name, 64) + "'";
}

std::string nearest_or_all_quoted(std::string_view key, const std::vector<std::string>& known) {
  const auto near = find_near_name(key, known);
  if (near) return "; the nearest is '" + *near + "'";
  return known.empty() ? std::string() : "; it has " + printable(list_of_choices(known), 400);
}

/// Follows one `$ref` to the schema's own definitions, which refer to no other.
const Json& resolve(const Json& schema, const Json& root) {
  const auto ref = schema.find("$ref");
  if (ref == schema.end()) return schema;
  const std::string path = ref->get<std::string>().substr(1);  // "#/$defs/mesh" -> "/$defs/mesh"
  return root.at(Json::json_pointer(path));
}

/// Whether a value of this schema may be of the type; a schema without types and choices allows all.
bool allows(const Json& schema, std::string_view type) {
  if (const auto choices = schema.find("enum"); choices != schema.end()) return type == "string";
  const auto types = schema.find("type");
  if (types == schema.end()) return true;
  if (types->is_string()) return types->get<std::string>() == type;
  for (const Json& one : *types) {
    if (one.get<std::string>() == type) return true;
  }
  return false;
}

bool is_list(const Json& schema) {
  return schema.contains("items");
}
bool has_keys(const Json& schema) {
  return schema.contains("properties") ||
         (schema.contains("additionalProperties") && schema["additionalProperties"].is_object());
}

std::vector<std::string> keys_of(const Json& schema) {
  std::vector<std::string> names;
  if (!schema.contains("properties")) return names;
  for (const auto& [name, property] : schema["properties"].items()) names.push_back(name);
  return names;
}

/// A path on its way through the schema; `where` is what it has gone so far, for errors.
class SchemaWalk {
 public:
  explicit SchemaWalk(const Json& root) : root_(root), at_(&root) {}

  /// Marks the steps into maps of counts too.
  Status check(Condition& condition) {
    for (Step& step : condition.path) {
      const Status taken = take(step);
      if (!taken) return usage(printable(condition.text, 200) + ": " + taken.error().detail);
    }
    const Status value = check_value(condition);
    if (!value) return usage(printable(condition.text, 200) + ": " + value.error().detail);
    return Ok{};
  }

 private:
  /// What was gone so far, with the quantifier around what follows the last one: any(meshes).any(levels).
  [[nodiscard]] std::string quantified(const char* word) const {
    const std::size_t first = quantified_bytes_ == 0 ? 0 : quantified_bytes_ + 1;  // behind the dot
    if (first > where_.size()) return std::string(word) + "(" + where_ + ")";      // a list of lists
    return where_.substr(0, first) + word + "(" + where_.substr(first) + ")";
  }
  [[nodiscard]] std::string place() const { return where_.empty() ? "the document" : where_; }

  Status take(Step& step) {
    switch (step.kind) {
      case StepKind::kKey: return take_key(step);
      case StepKind::kName:
        if (has_keys(*at_) && !is_list(*at_)) return take_key(step);
        if (Status item = take_item(); !item) return item;
        if (!at_->contains("properties") || !(*at_)["properties"].contains("name")) {
          return usage("the elements of " + where_ + " have no names");
        }
        where_ += "[\"" + printable(step.name, 64) + "\"]";
        return Ok{};
      case StepKind::kIndex:
        if (Status item = take_item(); !item) return item;
        where_ += "[" + std::to_string(step.index) + "]";
        return Ok{};
      case StepKind::kAny:
      case StepKind::kAll:
        if (Status item = take_item(); !item) return item;
        where_ = quantified(step.kind == StepKind::kAny ? "any" : "all");
        quantified_bytes_ = where_.size();
        return Ok{};
      case StepKind::kCount:
        if (Status item = take_item(); !item) return item;
        where_ = quantified("count");
        at_ = &number_;
        return Ok{};
    }
    return Ok{};
  }

  Status take_key(Step& step) {
    const std::string& key = step.name;
    if (is_list(*at_)) return is_a_list();
    if (!has_keys(*at_)) return usage(place() + " has no keys");
    if (at_->contains("properties") && (*at_)["properties"].contains(key)) {
      at_ = &resolve((*at_)["properties"][key], root_);
    } else if (at_->contains("additionalProperties") && (*at_)["additionalProperties"].is_object()) {
      if (const Status known = check_map_key(key); !known) return known;
      at_ = &resolve((*at_)["additionalProperties"], root_);
      const auto type = at_->find("type");
      step.is_count = type != at_->end() && *type == "integer";
    } else {
      return no_key(key, keys_of(*at_));
    }
    where_ += (where_.empty() ? "" : ".") + printable(key, 64);
    return Ok{};
  }

  [[nodiscard]] Error no_key(const std::string& key, const std::vector<std::string>& known) const {
    return usage(place() + " has no key " + in_quotes(key) + nearest_or_all_quoted(key, known));
  }

  /// A map whose schema names its keys (propertyNames) has no others.
  [[nodiscard]] Status check_map_key(const std::string& key) const {
    const auto names = at_->find("propertyNames");
    if (names == at_->end()) return Ok{};
    std::vector<std::string> known;
    for (const Json& name : names->at("enum")) known.push_back(name.get<std::string>());
    return std::find(known.begin(), known.end(), key) != known.end() ? Status(Ok{}) : Status(no_key(key, known));
  }

  Status take_item() {
    if (!is_list(*at_)) return usage(place() + " is not a list");
    at_ = &resolve((*at_)["items"], root_);
    return Ok{};
  }

  [[nodiscard]] Error is_a_list() const {
    return usage(where_ + " is a list: " + quantified("any") + ", " + quantified("all") + ", " + quantified("count") +
                 " or " + where_ + "[0]");
  }

  [[nodiscard]] Status check_value(const Condition& condition) const {
    if (is_list(*at_)) return is_a_list();
    const bool is_null = std::holds_alternative<std::monostate>(condition.value);
    if (has_keys(*at_) && !is_null) {
      std::string keys;
      for (const std::string& name : keys_of(*at_)) keys += (keys.empty() ? "" : ", ") + name;
      return usage(place() + " is not a value: it has the keys " + printable(keys, 400));
    }
    if (std::holds_alternative<double>(condition.value) && !allows(*at_, "number") && !allows(*at_, "integer")) {
      return usage(place() + " is not a number");
    }
    if (std::holds_alternative<std::string>(condition.value) && !allows(*at_, "string")) {
      return usage(place() + " is not a text");
    }
    if (std::holds_alternative<bool>(condition.value) && !allows(*at_, "boolean")) {
      return usage(place() + " is neither true nor false");
    }
    return Ok{};
  }

  const Json& root_;
  const Json* at_;
  const Json number_ = Json::parse(R"({"type":"integer"})");  ///< of a count
  std::string where_;
  std::size_t quantified_bytes_ = 0;  ///< of where_: up to the last quantifier's bracket
};

bool relates(double a, Relation relation, double b) {
  switch (relation) {
    case Relation::kGreater: return a > b;
    case Relation::kGreaterEqual: return a >= b;
    case Relation::kLess: return a < b;
    case Relation::kLessEqual: return a <= b;
    case Relation::kEqual: return a == b;
    case Relation::kNotEqual: return a != b;
  }
  return false;
}

bool is_equal(const Json& value, const Literal& literal) {
  if (const auto* number = std::get_if<double>(&literal)) return value.is_number() && value.get<double>() == *number;
  if (const auto* truth = std::get_if<bool>(&literal)) return value.is_boolean() && value.get<bool>() == *truth;
  if (const auto* text = std::get_if<std::string>(&literal)) {
    return value.is_string() && value.get_ref<const std::string&>() == *text;
  }
  return value.is_null();
}

bool compares(const Json& value, const Condition& condition) {
  if (condition.relation == Relation::kEqual) return is_equal(value, condition.value);
  if (condition.relation == Relation::kNotEqual) return !is_equal(value, condition.value);
  const double limit = std::get<double>(condition.value);  // the parser's promise
  if (value.is_number()) return relates(value.get<double>(), condition.relation, limit);
  return value.is_null() && relates(std::numeric_limits<double>::infinity(), condition.relation, limit);
}

/// One condition over one document. Quantifiers nest as deep as the path has steps.
class DocumentWalk {
 public:
  explicit DocumentWalk(const Condition& condition) : condition_(condition) {}

  Result<std::optional<BrokenCondition>> judge(const Json& document) {
    const bool is_broken = holds(document, 0);
    if (error_) return *error_;
    if (!is_broken) return std::optional<BrokenCondition>();
    found_.condition = condition_.text;
    return std::optional<BrokenCondition>(std::move(found_));
  }

 private:
  /// A place: a list's element, or a key. Joined to a text only where one is wanted.
  struct Place {
    std::string_view key;
    std::size_t index = 0;
    const Json* node = nullptr;  ///< of an element
  };

  bool holds(const Json& node, std::size_t step) {
    if (step == condition_.path.size()) return holds_here(node);
    const Step& next = condition_.path[step];
    switch (next.kind) {
      case StepKind::kKey: return into_key(node, next.name, step);
      case StepKind::kName: return node.is_array() ? into_named(node, step) : into_key(node, next.name, step);
      case StepKind::kIndex:
        if (node.is_array() && next.index < node.size()) return into_element(node, next.index, step);
        return miss(step, "there is no [" + std::to_string(next.index) + "]");
      case StepKind::kAny:
      case StepKind::kAll: return holds_of_list(node, step);
      case StepKind::kCount: {
        count_ = node.is_array() ? node.size() : 0;
        return holds(count_, step + 1);
      }
    }
    return false;
  }

  bool holds_here(const Json& value) {
    if (!compares(value, condition_)) return false;
    if (found_.where.empty()) note(value);
    return true;
  }

  bool into_key(const Json& node, std::string_view key, std::size_t step) {
    const auto found = node.is_object() ? node.find(std::string(key)) : node.end();
    places_.push_back({key, 0, nullptr});
    const Json& absent = condition_.path[step].is_count && node.is_object() ? zero_ : nothing_;
    const bool is_true = holds(found == node.end() ? absent : *found, step + 1);
    places_.pop_back();
    return is_true;
  }

  bool into_element(const Json& list, std::size_t index, std::size_t step) {
    places_.push_back({{}, index, &list[index]});
    const bool is_true = holds(list[index], step + 1);
    places_.pop_back();
    return is_true;
  }

  bool into_named(const Json& list, std::size_t step) {
    const std::string& name = condition_.path[step].name;
    std::vector<std::string> known;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string_view other = name_of(list[i]);
      if (other == name) return into_element(list, i, step);
      if (known.size() < kMaxNames) known.emplace_back(other.substr(0, 64));
    }
    const auto near = find_near_name(name, known);
    return miss(step, "there is no " + in_quotes(name) + (near ? "; the nearest is " + in_quotes(*near) : ""));
  }

  bool holds_of_list(const Json& list, std::size_t step) {
    if (!list.is_array()) return false;
    const bool is_any = condition_.path[step].kind == StepKind::kAny;
    const BrokenCondition before = found_;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < list.size() && !error_; ++i) {
      if (into_element(list, i, step)) {
        ++count;
      } else if (!is_any) {
        found_ = before;  // what was found of this list is none
        return false;
      }
    }
    // Of nested lists the outermost count stands.
    if (count > 0) found_.others = count - 1;
    return count > 0;
  }

  static std::string_view name_of(const Json& element) {
    if (!element.is_object()) return {};
    const auto name = element.find("name");
    if (name == element.end() || !name->is_string()) return {};
    return name->get_ref<const std::string&>();
  }

  [[nodiscard]] std::string place_text() const {
    std::string text;
    for (const Place& place : places_) {
      if (place.node != nullptr) {
        text += "[" + std::to_string(place.index) + "]";
      } else {
        text += (text.empty() ? "" : ".") + printable(place.key, 64);
      }
    }
    return text;
  }

  void note(const Json& value) {
    found_.where = place_text();
    if (condition_.path.back().kind == StepKind::kCount) found_.where = "count(" + found_.where + ")";
    for (const Place& place : places_) {
      const std::string_view name = place.node == nullptr ? std::string_view() : name_of(*place.node);
      if (!name.empty()) found_.name = printable(name);
    }
    found_.value = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  /// A subscript that leads nowhere: for one element of any(…) or all(…) it does not hold, else it is an error.
  bool miss(std::size_t step, const std::string& what) {
    for (std::size_t i = 0; i < step; ++i) {
      const StepKind kind = condition_.path[i].kind;
      if (kind == StepKind::kAny || kind == StepKind::kAll) return false;
    }
    if (!error_) error_ = usage(printable(condition_.text, 200) + ": " + place_text() + ": " + what);
    return false;
  }

  static constexpr std::size_t kMaxNames = 10000;  ///< that are compared with one that is not there

  const Condition& condition_;
  std::vector<Place> places_;
  const Json nothing_;   ///< null
  const Json zero_ = 0;  ///< of a count that is absent
  Json count_;
  BrokenCondition found_;
  std::optional<Error> error_;
};

}  // namespace

std::string BrokenCondition::message() const {
  std::string text = "budget exceeded: " + printable(condition, 200) + ": " + where;
  if (!name.empty()) text += " (" + name + ")";
  text += " is " + printable(value, 80);
  return others == 0 ? text : text + ", and " + std::to_string(others) + " more";
}

Result<std::vector<Condition>> read_budget(std::string_view text, std::string_view schema) {
  TRY_LET(conditions, parse_conditions(text));
  if (conditions->empty()) return std::move(*conditions);
  const Json root = Json::parse(schema.begin(), schema.end());
  for (Condition& condition : *conditions) {
    TRY(SchemaWalk(root).check(condition));
  }
  return std::move(*conditions);
}

Result<std::vector<BrokenCondition>> judge_budget(const std::vector<Condition>& conditions, std::string_view document) {
  std::vector<BrokenCondition> broken;
  if (conditions.empty()) return broken;
  const Json json = Json::parse(document.begin(), document.end(), nullptr, false);
  if (json.is_discarded()) return Error{ErrorCode::kInvalid, "", "the document is not JSON"};
  for (const Condition& condition : conditions) {
    TRY_LET(judged, DocumentWalk(condition).judge(json));
    if (*judged) broken.push_back(std::move(**judged));
  }
  return broken;
}

Error budget_error(const std::vector<BrokenCondition>& broken, std::string where) {
  std::string detail;
  for (const BrokenCondition& one : broken) detail += (detail.empty() ? "" : "; ") + one.message();
  return {ErrorCode::kCheckFailed, std::move(where), std::move(detail)};
}

}  // namespace meshlode::app
