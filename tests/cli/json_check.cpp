// SPDX-License-Identifier: GPL-3.0-or-later
// json_check SCHEMA < DOCUMENT: the part of JSON Schema that docs/schemas/ uses: type, required, properties, items,
// enum, additionalProperties (a schema or false), propertyNames (an enum), minimum, $ref to #/$defs. A key that the
// schema does not know fails where additionalProperties is false, so that a schema which falls behind is noticed.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::json;

struct Checker {
  const Json& root;
  int complaints = 0;

  void complain(const std::string& where, const std::string& what) {
    ++complaints;
    std::cout << (where.empty() ? "/" : where) << ": " << what << "\n";
  }

  static bool has_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    return false;
  }

  void check_type(const Json& schema, const Json& value, const std::string& where) {
    const auto type = schema.find("type");
    if (type == schema.end()) return;
    bool ok = false;
    std::string wanted;
    if (type->is_string()) {
      wanted = type->get<std::string>();
      ok = has_type(value, wanted);
    } else {
      for (const Json& one : *type) {
        wanted += one.get<std::string>() + " ";
        ok = ok || has_type(value, one.get<std::string>());
      }
    }
    if (!ok) complain(where, "is not " + wanted);
  }

  void check_object(const Json& schema, const Json& value, const std::string& where) {
    if (const auto required = schema.find("required"); required != schema.end()) {
      for (const Json& key : *required) {
        if (!value.contains(key.get<std::string>())) complain(where, "has no " + key.get<std::string>());
      }
    }
    const Json properties = schema.value("properties", Json::object());
    for (const auto& [key, member] : value.items()) {
      if (const auto names = schema.find("propertyNames"); names != schema.end()) {
        const Json& known = names->at("enum");
        if (std::find(known.begin(), known.end(), key) == known.end()) complain(where, "no such name: " + key);
      }
      if (const auto it = properties.find(key); it != properties.end()) {
        check(*it, member, where + "/" + key);
      } else if (const auto more = schema.find("additionalProperties"); more != schema.end()) {
        if (more->is_object()) {
          check(*more, member, where + "/" + key);
        } else if (!more->get<bool>()) {
          complain(where, "the schema does not know " + key);
        }
      }
    }
  }

  void check(const Json& schema, const Json& value, const std::string& where) {
    if (const auto ref = schema.find("$ref"); ref != schema.end()) {
      const std::string path = ref->get<std::string>().substr(1);  // "#/$defs/level" -> "/$defs/level"
      check(root.at(Json::json_pointer(path)), value, where);
      return;
    }
    check_type(schema, value, where);
    if (const auto options = schema.find("enum"); options != schema.end()) {
      bool ok = false;
      for (const Json& option : *options) ok = ok || option == value;
      if (!ok) complain(where, "is none of " + options->dump());
    }
    if (const auto minimum = schema.find("minimum"); minimum != schema.end() && value.is_number()) {
      if (value.get<double>() < minimum->get<double>()) complain(where, "is below " + minimum->dump());
    }
    if (value.is_object()) check_object(schema, value, where);
    if (const auto items = schema.find("items"); items != schema.end() && value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) check(*items, value[i], where + "/" + std::to_string(i));
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    std::ifstream schema_file(argv[1]);
    const Json schema = Json::parse(schema_file);
    const std::string text((std::istreambuf_iterator<char>(std::cin)), std::istreambuf_iterator<char>());
    const Json document = Json::parse(text);
    Checker checker{schema};
    checker.check(schema, document, "");
    if (checker.complaints == 0) std::cout << "accepted by its schema\n";
    return checker.complaints == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::cout << "not checked: " << e.what() << "\n";
    return 1;
  }
}
