// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/gltf/check_base.h"

namespace meshlode::scene {

std::string pointer_part(std::string_view key) {
  std::string out;
  for (const char c : key.substr(0, 64)) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    }
  }
  return out;
}

bool JsonChecker::fail(const std::string& path, std::string detail, ErrorCode code) {
  if (!error_) error_ = Error{code, file_ + ": " + (path.empty() ? "/" : path), std::move(detail)};
  return false;
}

bool JsonChecker::objects(const Json& object, const std::string& path, std::string_view key) {
  if (!ok()) return false;
  const Json* member = object.find(key);
  if (member == nullptr) return true;
  const std::string here = path + "/" + std::string(key);
  if (!member->is_array()) return fail(here, "not an array");
  for (std::size_t i = 0; i < member->array()->size(); ++i) {
    const Json::Object* item = (*member->array())[i].object();
    if (item == nullptr) return fail(here + "/" + std::to_string(i), "not an object");
    if (item->size() > kMaxMembers) {
      return fail(here + "/" + std::to_string(i), "more than " + std::to_string(kMaxMembers) + " members");
    }
  }
  return true;
}

bool JsonChecker::optional_object(const Json& object, const std::string& path, std::string_view key) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  return member == nullptr || member->is_object() || fail(path + "/" + std::string(key), "not an object");
}

bool JsonChecker::optional_string(const Json& object, const std::string& path, std::string_view key) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  return member == nullptr || member->is_string() || fail(path + "/" + std::string(key), "not a string");
}

bool JsonChecker::optional_bool(const Json& object, const std::string& path, std::string_view key) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  return member == nullptr || member->is_bool() || fail(path + "/" + std::string(key), "not true or false");
}

bool JsonChecker::optional_number(const Json& object, const std::string& path, std::string_view key) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  return member == nullptr || member->is_number() || fail(path + "/" + std::string(key), "not a number");
}

bool JsonChecker::optional_numbers(const Json& object, const std::string& path, std::string_view key,
                                   std::size_t count) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  if (member == nullptr) return true;
  const std::string here = path + "/" + std::string(key);
  if (!member->is_array() || member->array()->size() != count) {
    return fail(here, "not an array of " + std::to_string(count) + " numbers");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!(*member->array())[i].is_number()) return fail(here + "/" + std::to_string(i), "not a number");
  }
  return true;
}

bool JsonChecker::check_index(const Json& value, const std::string& path, std::uint64_t limit) {
  const auto index = value.index();
  if (!index) return fail(path, "not a whole number of zero or more");
  if (*index >= limit) {
    return fail(path, std::to_string(*index) + " is out of range: it must be below " + std::to_string(limit));
  }
  return true;
}

bool JsonChecker::optional_index(const Json& object, const std::string& path, std::string_view key,
                                 std::uint64_t limit) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  return member == nullptr || check_index(*member, path + "/" + std::string(key), limit);
}

bool JsonChecker::required_index(const Json& object, const std::string& path, std::string_view key,
                                 std::uint64_t limit) {
  if (!ok()) return false;
  if (object.find(key) == nullptr) return fail(path + "/" + std::string(key), "missing");
  return optional_index(object, path, key, limit);
}

bool JsonChecker::optional_indices(const Json& object, const std::string& path, std::string_view key,
                                   std::uint64_t limit) {
  const Json* member = object.find(key);
  if (!ok()) return false;
  if (member == nullptr) return true;
  const std::string here = path + "/" + std::string(key);
  if (!member->is_array()) return fail(here, "not an array");
  for (std::size_t i = 0; i < member->array()->size(); ++i) {
    if (!check_index((*member->array())[i], here + "/" + std::to_string(i), limit)) return false;
  }
  return true;
}

bool JsonChecker::index_map(const Json& object, const std::string& path, std::uint64_t limit) {
  if (!ok()) return false;
  if (!object.is_object()) return fail(path, "not an object");
  for (const JsonMember& member : *object.object()) {
    if (!check_index(member.value, path + "/" + pointer_part(member.key), limit)) return false;
  }
  return true;
}

std::uint64_t index_or(const Json& object, std::string_view key, std::uint64_t fallback) {
  const Json* member = object.find(key);
  if (member == nullptr) return fallback;
  return member->index().value_or(fallback);
}

}  // namespace meshlode::scene
