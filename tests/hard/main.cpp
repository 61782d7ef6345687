// SPDX-License-Identifier: GPL-3.0-or-later
// hard_cases: the hard cases one by one, their sweeps, and the table of docs/reference/hard-cases.md.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/append_format.h"
#include "run/sweep.h"
#include "table/pictures.h"
#include "table/table.h"

namespace meshlode::test::hard {
namespace {

constexpr std::uint32_t kPictureColumns = 10;

struct Arguments {
  std::vector<std::string> names;
  std::string table, picture, against;
  bool is_quick = false;
  std::size_t jobs = 2;
};

const HardCase* find_case(const std::string& name) {
  const auto found =
      std::find_if(hard_cases().begin(), hard_cases().end(), [&](const HardCase& one) { return name == one.name; });
  return found == hard_cases().end() ? nullptr : &*found;
}

int usage() {
  std::fputs(
      "usage: hard_cases list\n"
      "       hard_cases trial CASE PARAMETER [--laws] [--care NAME=off]      the lines that a sweep reads\n"
      "       hard_cases sweep [CASE...] [--quick] [--jobs N] [--table FILE] [--picture FILE]\n"
      "                  [--against FILE]    fails where a case is not as that page says of it\n"
      "       hard_cases care NAME=off [CASE...] [--quick] [--jobs N]      whose verdict is worse without that care\n",
      stderr);
  return 1;
}

int trial(const std::vector<std::string>& words) {
  if (words.size() < 3) return usage();
  const HardCase* hard_case = find_case(words[1]);
  if (hard_case == nullptr) return usage();
  const bool all_laws = std::find(words.begin() + 3, words.end(), "--laws") != words.end();
  const auto care_word = std::find(words.begin() + 3, words.end(), "--care");
  const auto care = lab::parse_care(care_word == words.end() || care_word + 1 == words.end() ? "all" : care_word[1]);
  if (!care) return usage();
  const Trial result = try_case(*hard_case, std::strtod(words[2].c_str(), nullptr), all_laws, *care);
  std::fputs(text_of(result).c_str(), stdout);
  return 0;
}

bool write_file(const std::string& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out << bytes;
  out.close();
  if (!out) std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
  return static_cast<bool>(out);
}

/// How many of the cases are not as the page says.
std::size_t count_differences(const std::vector<Swept>& swept, const Arguments& arguments) {
  std::ifstream in(arguments.against, std::ios::binary);
  const std::string page(std::istreambuf_iterator<char>(in), {});
  std::size_t count = 0;
  for (const Swept& one : swept) {
    const std::string difference = difference_from_page(one, page, !arguments.is_quick);
    if (difference.empty()) continue;
    std::printf("%s: %s\n", one.hard_case->name, difference.c_str());
    ++count;
  }
  return count;
}

/// Those that are named; none named: all, or the quick ones. Empty where a name is none.
std::vector<const HardCase*> chosen_cases(const Arguments& arguments) {
  std::vector<const HardCase*> chosen;
  for (const std::string& name : arguments.names) {
    chosen.push_back(find_case(name));
    if (chosen.back() == nullptr) return {};
  }
  if (!arguments.names.empty()) return chosen;
  for (const HardCase& one : hard_cases()) {
    if (one.is_quick || !arguments.is_quick) chosen.push_back(&one);
  }
  return chosen;
}

/// body(i) returns what is printed of the i-th, whole.
template <class Body>
void for_each_case(std::size_t count, std::size_t jobs, const Body& body) {
  std::atomic<std::size_t> next = 0;
  std::mutex printing;
  std::vector<std::thread> threads;
  for (std::size_t job = 0; job < jobs; ++job) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) {
        const std::string text = body(i);
        const std::lock_guard lock(printing);
        std::fputs(text.c_str(), stdout);
        std::fflush(stdout);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

/// A line each parameter of a case, of those of its sweep, at which the verdict is worse without the care.
int study_care(const std::string& program, const Arguments& arguments, const std::string& care) {
  const std::vector<const HardCase*> chosen = chosen_cases(arguments);
  if (chosen.empty() || !lab::parse_care(care)) return usage();
  constexpr const char* kVerdicts[] = {"holds", "bound", "refused", "not asked", "fails"};
  static_assert(static_cast<int>(Verdict::kFails) == 4);
  std::atomic<std::size_t> worse = 0, tried = 0;
  for_each_case(chosen.size(), arguments.jobs, [&](std::size_t i) {
    const HardCase& one = *chosen[i];
    std::string text;
    for (std::size_t p = 0; p < one.sweep.size() && (p == 0 || !arguments.is_quick); ++p) {
      const Trial without = try_apart(program, one, one.sweep[p], p == 0, care);
      ++tried;
      if (without.verdict == Verdict::kHolds) continue;  // no worse than anything
      const Trial with = try_apart(program, one, one.sweep[p], p == 0);
      if (without.verdict <= with.verdict) continue;
      ++worse;
      append_format(text, "%s\t%s\t%.6g\t%s\t%s\t%.200s\n", care.c_str(), one.name, one.sweep[p],
                    kVerdicts[static_cast<int>(with.verdict)], kVerdicts[static_cast<int>(without.verdict)],
                    without.detail.c_str());
    }
    return text;
  });
  std::printf("%s\t%zu tried, %zu worse\n", care.c_str(), tried.load(), worse.load());
  return 0;
}

int sweep(const std::string& program, const Arguments& arguments) {
  const std::vector<const HardCase*> chosen = chosen_cases(arguments);
  if (chosen.empty()) return usage();
  std::vector<Swept> swept(chosen.size());
  for_each_case(chosen.size(), arguments.jobs, [&](std::size_t i) {
    const Ask ask = [&](double parameter, bool all_laws) {
      return try_apart(program, *chosen[i], parameter, all_laws);
    };
    swept[i] = sweep_case(*chosen[i], ask, {}, arguments.is_quick);
    return line_of(swept[i]);
  });
  if (!arguments.table.empty() && !write_file(arguments.table, table_of(swept))) return 2;
  if (!arguments.picture.empty()) {
    const std::vector<std::uint8_t> png = contact_sheet(chosen, kPictureColumns);
    if (!write_file(arguments.picture, {png.begin(), png.end()})) return 2;
  }
  const auto failed = std::count_if(swept.begin(), swept.end(), has_failed);
  const std::size_t different = arguments.against.empty() ? 0 : count_differences(swept, arguments);
  std::printf("%zu cases, %td fail, %zu are not as the page says\n", swept.size(), failed, different);
  return failed == 0 && different == 0 ? 0 : 6;
}

int dispatch(const std::string& program, const std::vector<std::string>& words) {
  if (words.empty()) return usage();
  if (words[0] == "trial") return trial(words);
  if (words[0] == "list") {
    for (const HardCase& one : hard_cases()) {
      std::printf("%-20s %-16s %s%s\n", one.name, one.room, one.parameter, one.is_quick ? " (quick)" : "");
    }
    return 0;
  }
  const bool is_care = words[0] == "care" && words.size() > 1;
  if (words[0] != "sweep" && !is_care) return usage();
  Arguments arguments;
  for (std::size_t i = is_care ? 2 : 1; i < words.size(); ++i) {
    if (words[i] == "--quick") {
      arguments.is_quick = true;
    } else if (words[i] == "--table" && i + 1 < words.size()) {
      arguments.table = words[++i];
    } else if (words[i] == "--picture" && i + 1 < words.size()) {
      arguments.picture = words[++i];
    } else if (words[i] == "--against" && i + 1 < words.size()) {
      arguments.against = words[++i];
    } else if (words[i] == "--jobs" && i + 1 < words.size()) {
      const std::string& text = words[++i];
      const auto parsed = std::from_chars(text.data(), text.data() + text.size(), arguments.jobs);
      if (parsed.ec != std::errc{} || arguments.jobs == 0) return usage();
    } else if (words[i].starts_with("--")) {
      return usage();
    } else {
      arguments.names.push_back(words[i]);
    }
  }
  return is_care ? study_care(program, arguments, words[1]) : sweep(program, arguments);
}

}  // namespace
}  // namespace meshlode::test::hard

int main(int argc, char** argv) {
  return meshlode::test::hard::dispatch("/proc/self/exe", {argv + 1, argv + argc});
}
