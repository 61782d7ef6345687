// SPDX-License-Identifier: GPL-3.0-or-later
// A file includes the standard headers of what it names, itself or by headers of ours. The compiler does not see where
// one is missing: the floors share a precompiled header that has most of them (cmake/MeshlodeFloors.cmake).
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "source_tree.h"

namespace meshlode::house {
namespace {

struct Header {
  std::string_view name, gives;
};

// What begin(), size() and std::size_t are in comes with nearly every header. A name that two headers give is here
// twice.
constexpr Header kHeaders[] = {
    {"algorithm",
     "sort stable_sort min max minmax clamp find find_if find_if_not any_of all_of none_of count "
     "count_if fill fill_n copy copy_n copy_if copy_backward equal lower_bound upper_bound equal_range "
     "binary_search unique remove_if reverse rotate transform for_each max_element min_element "
     "minmax_element nth_element partition stable_partition partial_sort is_sorted merge inplace_merge "
     "set_difference set_intersection set_union includes next_permutation replace replace_if search "
     "mismatch lexicographical_compare swap_ranges generate push_heap pop_heap make_heap sort_heap "
     "adjacent_find partition_point is_permutation unique_copy"},
    {"array", "array to_array tuple_size_v"},
    {"atomic",
     "atomic atomic_flag atomic_ref memory_order memory_order_relaxed memory_order_acquire "
     "memory_order_release"},
    {"bit",
     "bit_cast popcount countl_zero countr_zero countl_one countr_one bit_width bit_ceil bit_floor "
     "has_single_bit endian"},
    {"charconv", "from_chars to_chars chars_format from_chars_result errc"},
    {"chrono", "chrono"},
    {"cmath",
     "sqrt floor ceil abs fabs pow sin cos tan asin acos atan atan2 exp exp2 log log2 log10 hypot "
     "isfinite isnan isinf ldexp frexp fma round lround llround trunc nextafter copysign cbrt fmod "
     "ilogb signbit scalbn nearbyint remainder fmin fmax modf"},
    {"concepts",
     "same_as integral unsigned_integral signed_integral floating_point invocable convertible_to "
     "derived_from"},
    {"cstdint", "uint8_t uint16_t uint32_t uint64_t int8_t int16_t int32_t int64_t uintptr_t intptr_t uintmax_t"},
    {"cstdio",
     "FILE fopen fclose fread fwrite printf fprintf snprintf vsnprintf fputs puts fputc fflush sscanf "
     "perror"},
    {"cstdlib", "getenv exit abort strtol strtoul strtod strtoull malloc free mkstemp system abs"},
    {"cstring", "memcpy memcmp memset memmove memchr strlen strcmp strncmp strchr strrchr strerror strstr"},
    {"exception", "exception exception_ptr current_exception rethrow_exception terminate"},
    {"filesystem", "filesystem error_code"},
    {"fstream", "ifstream ofstream"},
    {"functional", "function reference_wrapper ref cref hash bind"},
    {"iterator", "back_inserter inserter make_move_iterator next prev distance advance istreambuf_iterator"},
    {"limits", "numeric_limits"},
    {"map", "map multimap"},
    {"memory", "unique_ptr shared_ptr weak_ptr make_unique make_shared addressof"},
    {"mutex", "mutex lock_guard unique_lock scoped_lock once_flag call_once"},
    {"new", "bad_alloc nothrow align_val_t set_new_handler"},
    {"numbers", "numbers"},
    {"numeric", "accumulate iota partial_sum exclusive_scan inclusive_scan gcd lcm midpoint reduce inner_product"},
    {"optional", "optional nullopt nullopt_t make_optional in_place"},
    {"set", "set multiset"},
    {"span", "span as_bytes dynamic_extent"},
    {"sstream", "ostringstream istringstream stringstream"},
    {"stdexcept", "runtime_error logic_error out_of_range invalid_argument length_error"},
    {"string", "hash string to_string stoi stoul stoull stod u8string"},
    {"string_view", "string_view"},
    {"system_error", "error_code errc system_error generic_category system_category make_error_code"},
    {"thread", "thread jthread this_thread"},
    {"tuple", "tuple tie make_tuple forward_as_tuple apply ignore tuple_size_v"},
    {"type_traits",
     "is_same_v is_void_v enable_if_t decay_t remove_cvref_t is_trivially_copyable_v is_signed_v "
     "is_unsigned_v make_unsigned_t make_signed_t conditional_t underlying_type_t is_integral_v "
     "is_floating_point_v is_enum_v invoke_result_t is_invocable_v is_base_of_v"},
    {"utility",
     "move forward pair make_pair swap exchange as_const declval in_place cmp_less in_range "
     "index_sequence"},
    {"variant", "variant visit get_if holds_alternative monostate"},
    {"vector", "vector"},
};

/// Headers by what they give.
std::map<std::string, std::set<std::string>> givers() {
  std::map<std::string, std::set<std::string>> headers;
  for (const Header& header : kHeaders) {
    std::istringstream names{std::string(header.gives)};
    for (std::string name; names >> name;) headers[name].insert(std::string(header.name));
  }
  return headers;
}

/// The text without comments and strings.
std::string code_of(const std::string& text) {
  std::string code;
  for (std::size_t i = 0; i < text.size();) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 2, "/*") == 0) {
      const std::size_t end = text.find("*/", i + 2);
      i = end == std::string::npos ? text.size() : end + 2;
    } else if (text.compare(i, 2, "R\"") == 0) {
      const std::size_t open = std::min(text.find('(', i), text.size());
      const std::string close = ")" + text.substr(i + 2, open - i - 2) + "\"";
      const std::size_t end = text.find(close, open);
      i = end == std::string::npos ? text.size() : end + close.size();
    } else if (text.compare(i, 3, "'\"'") == 0) {
      i += 3;
    } else if (text[i] == '"') {
      for (++i; i < text.size() && text[i] != '"' && text[i] != '\n'; ++i) {
        if (text[i] == '\\') ++i;
      }
      ++i;
    } else {
      code += text[i++];
    }
  }
  return code;
}

/// X of every std::X.
std::set<std::string> standard_names(const std::string& text) {
  const std::string code = code_of(text);
  std::set<std::string> names;
  for (std::size_t at = code.find("std::"); at != std::string::npos; at = code.find("std::", at + 5)) {
    std::size_t end = at + 5;
    while (end < code.size() && (std::isalnum(static_cast<unsigned char>(code[end])) != 0 || code[end] == '_')) ++end;
    names.insert(code.substr(at + 5, end - at - 5));
  }
  return names;
}

class Tree {
 public:
  explicit Tree(std::vector<SourceFile> files) {
    for (SourceFile& file : files) {
      const std::string path = file.path.generic_string();
      files_.emplace(path, std::move(file));
    }
  }
  [[nodiscard]] const std::map<std::string, SourceFile>& files() const { return files_; }

  /// Headers that are not ours, of the file and of ours that it includes.
  const std::set<std::string>& foreign_headers(const std::string& path) {
    const auto known = foreign_.find(path);
    if (known != foreign_.end()) return known->second;
    foreign_[path] = {};  // ends the walk where headers include each other
    std::set<std::string> found;
    const SourceFile& file = files_.at(path);
    for (const Include& include : file.includes()) {
      const std::string ours = find(file, include.path);
      if (ours.empty()) {
        found.insert(include.path);
      } else {
        found.merge(std::set(foreign_headers(ours)));
      }
    }
    return foreign_[path] = std::move(found);
  }

 private:
  [[nodiscard]] std::string find(const SourceFile& file, const std::string& path) const {
    for (const std::string& folder :
         {file.path.parent_path().generic_string(), std::string("src"), std::string("include"), std::string("tools")}) {
      const std::string candidate = (std::filesystem::path(folder) / path).lexically_normal().generic_string();
      if (files_.contains(candidate)) return candidate;
    }
    return {};
  }

  std::map<std::string, SourceFile> files_;
  std::map<std::string, std::set<std::string>> foreign_;
};

TEST(StandardHeaders, AFileIncludesThoseOfWhatItNames) {
  const auto headers_of = givers();
  Tree tree(read_tree({"src", "include", "tools"}, {".h", ".cpp", ".inl"}));
  ASSERT_GT(tree.files().size(), 1000U);
  for (const auto& [path, file] : tree.files()) {
    const std::set<std::string>& included = tree.foreign_headers(path);
    for (const std::string& name : standard_names(file.text)) {
      const auto headers = headers_of.find(name);
      if (headers == headers_of.end()) continue;
      const bool is_there = std::any_of(headers->second.begin(), headers->second.end(),
                                        [&](const std::string& header) { return included.contains(header); });
      EXPECT_TRUE(is_there) << path << " names std::" << name << " without <" << *headers->second.begin() << ">";
    }
  }
}

TEST(StandardHeaders, NamesInCommentsAndStringsAreNotLookedAt) {
  const std::set<std::string> expected = {"vector", "move"};
  EXPECT_EQ(
      standard_names("std::vector<int> v;  // std::map\n/* std::set */ f(\"std::span \\\" std::list\", std::move(v));"),
      expected);
  EXPECT_EQ(standard_names("if (c == '\"') std::vector v; f(R\"x(say \"std::map\" )\" std::set)x\"), std::move(v);"),
            expected);
}

}  // namespace
}  // namespace meshlode::house
