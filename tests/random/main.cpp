// SPDX-License-Identifier: GPL-3.0-or-later
// random_scenes: scenes nobody chose, through the program.
//   run FIRST COUNT        each seed is built, validated, verified and decoded; exit 6 where one fails
//   seeds SEED...          the same for the seeds named
//   replay FOLDER          the same for the GLBs of a folder, with the build options of NAME.options beside them
//   pieces TRIANGLES       what each kind of piece costs alone, at so many triangles and at four times as many
//   write SEED OUT.glb     the scene and, on stdout, its contents and build options
//   shrink SEED OUT.glb    the smallest scene that still breaks the rule named by --rule
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>

#include "scene.h"
#include "shapes.h"
#include "shrink.h"
#include "trial.h"

namespace {

namespace fs = std::filesystem;
using namespace meshlode::test;

struct Arguments {
  std::vector<std::string> positional;
  fs::path program = MESHLODE_PROGRAM;
  std::uint64_t jobs = 1;
  std::uint64_t max_triangles = UINT64_MAX;  ///< larger scenes are passed over
  std::uint64_t max_refused_percent = 100;
  double cpu_seconds = 120.0;
  fs::path shrink_into;          ///< failures are shrunk into this folder
  double shrink_seconds = 60.0;  ///< each
  std::string rule;
  bool verbose = false;
  Depth depth = Depth::kAll;
};

/// A scene by name: a seed's or a file's.
struct Entry {
  std::string name, contents;
  std::uint64_t triangles = 0;
  std::vector<std::string> build_options;
  TrialResult result;
  bool was_skipped = false;
};

class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (fs::temp_directory_path() / "random_scenes.XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

bool write_file(const fs::path& path, const void* bytes, std::size_t size) {
  std::ofstream out(path, std::ios::binary);
  out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  return static_cast<bool>(out);
}

bool write_scene(const fs::path& path, const RandomScene& scene) {
  const auto glb = write_glb(scene);
  if (!write_file(path, glb.data(), glb.size())) return false;
  fs::path options = path;
  options.replace_extension(".options");
  const std::string text = joined(scene.build_options) + "\n";
  return scene.build_options.empty() || write_file(options, text.data(), text.size());
}

std::vector<std::uint8_t> read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

RandomScene shrunk(std::uint64_t seed, const std::string& rule, const Arguments& arguments, const fs::path& folder) {
  const StillFails still_fails = [&](const RandomScene& scene) {
    TrialOptions options{.program = arguments.program, .folder = folder, .build_options = scene.build_options};
    options.depth = depth_of(rule);
    options.cpu_seconds = arguments.cpu_seconds;
    options.other_jobs_too = rule == "build:jobs";
    return try_scene(write_glb(scene), options).rules.contains(rule);
  };
  return shrink_scene(random_scene(seed), still_fails, arguments.shrink_seconds);
}

/// Calls judge(index, folder) for each of `count` on as many threads as asked for.
void for_each(std::size_t count, std::uint64_t jobs, const fs::path& folder, auto judge) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (std::uint64_t job = 0; job < std::max<std::uint64_t>(1, jobs); ++job) {
    const fs::path own = folder / std::to_string(job);
    fs::create_directory(own);
    threads.emplace_back([&, own] {
      for (std::size_t i = next++; i < count; i = next++) judge(i, own);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

void print_entry(const Entry& entry, bool verbose) {
  const TrialResult& r = entry.result;
  if (entry.was_skipped || (r.is_clean() && !verbose)) return;
  std::string outcome;
  for (const auto& [rule, count] : r.rules)
    outcome += (outcome.empty() ? "" : " ") + rule + "x" + std::to_string(count);
  if (r.refusal) outcome = "refused, " + *r.refusal;
  if (outcome.empty()) outcome = "clean";
  std::printf("%s: %llu triangles, %.2f s to build, %.2f s in all: %s\n", entry.name.c_str(),
              static_cast<unsigned long long>(entry.triangles), r.build_seconds, r.total_seconds, outcome.c_str());
  std::printf("    %s%s%s\n", entry.contents.c_str(), entry.build_options.empty() ? "" : "  ",
              joined(entry.build_options).c_str());
  if (!r.detail.empty()) std::printf("    %s\n", r.detail.c_str());
}

struct Summary {
  std::uint64_t scenes = 0, clean = 0, refused = 0, failed = 0, triangles = 0, cuts = 0, cuts_above = 0;
  double build_seconds = 0.0, total_seconds = 0.0, largest_ratio = 0.0;
};

Summary print_summary(const std::vector<Entry>& entries) {
  Summary sum;
  std::map<std::string, std::uint64_t> rules, refusals;
  const Entry* slowest = nullptr;
  const auto rate = [](const Entry& e) { return 1e4 * e.result.build_seconds / static_cast<double>(e.triangles); };
  for (const Entry& entry : entries) {
    const TrialResult& r = entry.result;
    if (entry.was_skipped) continue;
    ++sum.scenes;
    ++(r.refusal ? sum.refused : r.rules.empty() ? sum.clean : sum.failed);
    for (const auto& [rule, count] : r.rules) ++rules[rule];
    if (r.refusal) ++refusals[*r.refusal];
    sum.triangles += entry.triangles;
    sum.cuts += r.cuts;
    sum.cuts_above += r.cuts_above;
    sum.largest_ratio = std::max(sum.largest_ratio, r.largest_ratio);
    sum.build_seconds += r.build_seconds;
    sum.total_seconds += r.total_seconds;
    // What starting the program costs says nothing about its speed.
    if (entry.triangles >= 1000 && (slowest == nullptr || rate(entry) > rate(*slowest))) slowest = &entry;
  }
  const auto whole = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("%llu scenes, %llu triangles: %llu clean, %llu refused, %llu failed; %.1f s to build, %.1f s in all\n",
              whole(sum.scenes), whole(sum.triangles), whole(sum.clean), whole(sum.refused), whole(sum.failed),
              sum.build_seconds, sum.total_seconds);
  for (const auto& [reason, count] : refusals) std::printf("  refused %llu: %s\n", whole(count), reason.c_str());
  for (const auto& [rule, count] : rules) std::printf("  failed %llu: %s\n", whole(count), rule.c_str());
  std::printf("I7: %llu cuts measured, %llu deviate by more than they store (%.2f%%), largest true/stored %.3f\n",
              whole(sum.cuts), whole(sum.cuts_above),
              sum.cuts == 0 ? 0.0 : 100.0 * static_cast<double>(sum.cuts_above) / static_cast<double>(sum.cuts),
              sum.largest_ratio);
  if (slowest != nullptr) {
    std::printf("slowest: %s, %.2f s to build 10,000 of its triangles (%llu triangles)\n", slowest->name.c_str(),
                rate(*slowest), whole(slowest->triangles));
  }
  return sum;
}

/// 6 where a scene failed, where more were refused than may be, or where more than 1% of the cuts of a long series
/// deviate by more than they store (I7).
int verdict(const Summary& sum, const Arguments& arguments) {
  bool is_well = sum.failed == 0;
  if (100 * sum.refused > arguments.max_refused_percent * sum.scenes) {
    std::printf("too many refused: at most %llu%% may be\n",
                static_cast<unsigned long long>(arguments.max_refused_percent));
    is_well = false;
  }
  if (sum.cuts >= 1000 && 100 * sum.cuts_above > sum.cuts) {
    std::puts("more than 1% of the cuts deviate by more than they store");
    is_well = false;
  }
  return is_well ? 0 : 6;
}

TrialOptions trial_options(const Arguments& arguments, const fs::path& folder, const Entry& entry) {
  TrialOptions options{.program = arguments.program, .folder = folder, .build_options = entry.build_options};
  options.cpu_seconds = arguments.cpu_seconds;
  options.depth = arguments.depth;
  return options;
}

/// A budget or a grid that 24 bits cannot hold is refused by rule.
bool asks_for_accuracy(const RandomScene& scene) {
  return std::any_of(scene.build_options.begin(), scene.build_options.end(), [](const std::string& option) {
    return option == "--grid" || option == "--position-error" || option == "--uv-error";
  });
}

int run_seeds(const Arguments& arguments, const std::vector<std::uint64_t>& seeds) {
  const WorkFolder work;
  std::vector<Entry> entries(seeds.size());
  for_each(seeds.size(), arguments.jobs, work.path(), [&](std::size_t i, const fs::path& folder) {
    Entry& entry = entries[i];
    const std::uint64_t seed = seeds[i];
    const RandomScene scene = random_scene(seed);
    entry.name = "seed " + std::to_string(seed);
    entry.contents = scene.contents;
    entry.triangles = scene.triangle_count();
    entry.build_options = scene.build_options;
    entry.was_skipped = entry.triangles > arguments.max_triangles;
    if (entry.was_skipped) return;
    TrialOptions options = trial_options(arguments, folder, entry);
    options.other_jobs_too = seed % 8 == 0;
    entry.result = try_scene(write_glb(scene), options);
    if (entry.result.refusal && !asks_for_accuracy(scene)) {
      entry.result.rules["build:refused"] = 1;  // these scenes are valid, and nothing but a budget can be too much
      entry.result.detail = std::exchange(entry.result.refusal, std::nullopt).value_or("");
    }
    print_entry(entry, arguments.verbose);
    std::fflush(stdout);
    if (entry.result.rules.empty() || arguments.shrink_into.empty()) return;
    for (const auto& [rule, findings] : entry.result.rules) {
      std::string name = "seed-" + std::to_string(seed) + "-" + rule + ".glb";
      for (char& c : name) c = c == ':' || c == ' ' ? '-' : c;
      const RandomScene small = shrunk(seed, rule, arguments, folder);
      write_scene(arguments.shrink_into / name, small);
      std::printf("seed %llu: %s in %llu triangles: %s\n", static_cast<unsigned long long>(seed), rule.c_str(),
                  static_cast<unsigned long long>(small.triangle_count()), (arguments.shrink_into / name).c_str());
    }
  });
  return verdict(print_summary(entries), arguments);
}

int replay(const Arguments& arguments, const fs::path& folder) {
  const WorkFolder work;
  std::vector<fs::path> files;
  for (const auto& item : fs::directory_iterator(folder)) {
    if (item.path().extension() == ".glb") files.push_back(item.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Entry> entries(files.size());
  for_each(files.size(), arguments.jobs, work.path(), [&](std::size_t i, const fs::path& own) {
    Entry& entry = entries[i];
    entry.name = files[i].filename().string();
    entry.triangles = 1;  // not counted: speed is not the question here
    fs::path options_file = files[i];
    options_file.replace_extension(".options");
    std::ifstream in(options_file);
    for (std::string word; in >> word;) entry.build_options.push_back(word);
    entry.result = try_scene(read_file(files[i]), trial_options(arguments, own, entry));
    print_entry(entry, arguments.verbose);
  });
  return verdict(print_summary(entries), arguments);
}

/// Seconds to build 10,000 triangles of each kind, at a size and at four times that: what grows with the square shows.
int time_pieces(const Arguments& arguments, std::uint32_t triangles) {
  const WorkFolder work;
  std::printf("%-18s %28s   %s\n", "seconds a 10,000", "one position, one vertex",
              "texture coordinates of each corner's own");
  for (std::size_t kind = 0; kind < shape_kinds().size(); ++kind) {
    std::printf("%-18s", shape_kinds()[kind].name);
    for (const bool torn : {false, true}) {
      for (const std::uint32_t count : {triangles, 4 * triangles}) {
        const RandomScene scene = scene_of_one_piece(kind, count, torn);
        TrialOptions options{.program = arguments.program, .folder = work.path(), .build_options = {}};
        options.depth = Depth::kBuild;
        options.cpu_seconds = arguments.cpu_seconds;
        const TrialResult result = try_scene(write_glb(scene), options);
        const double seconds = 1e4 * result.build_seconds / static_cast<double>(scene.triangle_count());
        std::printf("   %8.2f at %6llu", seconds, static_cast<unsigned long long>(scene.triangle_count()));
        if (!result.is_clean()) std::printf(" %s", result.refusal ? "refused" : result.rules.begin()->first.c_str());
        std::fflush(stdout);
      }
    }
    std::printf("\n");
  }
  return 0;
}

bool parse(std::string_view text, std::uint64_t& value) {
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
}

bool parse(int argc, char** argv, Arguments& arguments) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (!word.starts_with("--")) {
      arguments.positional.emplace_back(word);
      continue;
    }
    if (word == "--verbose") {
      arguments.verbose = true;
      continue;
    }
    if (word == "--without-deviation") {
      arguments.depth = Depth::kVerifyWithoutDeviation;
      continue;
    }
    if (++i == argc) return false;
    const std::string value = argv[i];
    std::uint64_t whole = 0;
    const bool is_whole = parse(value, whole);
    if (word == "--program")
      arguments.program = value;
    else if (word == "--shrink-into")
      arguments.shrink_into = value;
    else if (word == "--rule")
      arguments.rule = value;
    else if (!is_whole)
      return false;  // NOLINT(bugprone-branch-clone): what follows needs a number
    else if (word == "--jobs")
      arguments.jobs = whole;
    else if (word == "--max-triangles")
      arguments.max_triangles = whole;
    else if (word == "--max-refused")
      arguments.max_refused_percent = whole;
    else if (word == "--seconds")
      arguments.cpu_seconds = static_cast<double>(whole);
    else if (word == "--shrink-seconds")
      arguments.shrink_seconds = static_cast<double>(whole);
    else
      return false;
  }
  return !arguments.positional.empty();
}

int usage() {
  std::fputs(
      "usage: random_scenes run FIRST COUNT [--jobs N] [--max-triangles N] [--max-refused PERCENT]\n"
      "                     [--shrink-into FOLDER] [--verbose] [--without-deviation]\n"
      "       random_scenes seeds SEED... [the same]\n"
      "       random_scenes replay FOLDER [--jobs N] [--verbose]\n"
      "       random_scenes pieces TRIANGLES\n"
      "       random_scenes write SEED OUT.glb\n"
      "       random_scenes shrink SEED OUT.glb --rule ID [--shrink-seconds N]\n"
      "all:   [--program MESHLODE] [--seconds N]   processor time that a step may take\n",
      stderr);
  return 1;
}

int dispatch(const Arguments& arguments) {
  const auto& words = arguments.positional;
  std::uint64_t first = 0, count = 0;
  std::vector<std::uint64_t> seeds;
  if (words[0] == "run" && words.size() == 3 && parse(words[1], first) && parse(words[2], count)) {
    for (std::uint64_t i = 0; i < count; ++i) seeds.push_back(first + i);
    return run_seeds(arguments, seeds);
  }
  if (words[0] == "seeds" && words.size() > 1) {
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (!parse(words[i], seeds.emplace_back())) return usage();
    }
    return run_seeds(arguments, seeds);
  }
  if (words[0] == "replay" && words.size() == 2) return replay(arguments, words[1]);
  if (words[0] == "pieces" && words.size() == 2 && parse(words[1], count) && count > 0 && count <= 1000000) {
    return time_pieces(arguments, static_cast<std::uint32_t>(count));
  }
  if (words.size() != 3 || !parse(words[1], first)) return usage();
  if (words[0] == "write") {
    const RandomScene scene = random_scene(first);
    std::printf("%s\n%s\n", scene.contents.c_str(), joined(scene.build_options).c_str());
    return write_scene(words[2], scene) ? 0 : 2;
  }
  if (words[0] == "shrink" && !arguments.rule.empty()) {
    const WorkFolder work;
    const RandomScene scene = shrunk(first, arguments.rule, arguments, work.path());
    std::printf("%llu triangles\n%s\n", static_cast<unsigned long long>(scene.triangle_count()),
                joined(scene.build_options).c_str());
    return write_scene(words[2], scene) ? 0 : 2;
  }
  return usage();
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (!parse(argc, argv, arguments)) return usage();
  return dispatch(arguments);
}
