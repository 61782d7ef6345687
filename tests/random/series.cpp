// SPDX-License-Identifier: GPL-3.0-or-later
#include "series.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "shrink.h"
#include "tally.h"

namespace meshlode::test {

namespace fs = std::filesystem;

namespace {

bool write_file(const fs::path& path, const void* bytes, std::size_t size) {
  std::ofstream out(path, std::ios::binary);
  out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  return static_cast<bool>(out);
}

std::vector<std::uint8_t> read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Several jobs add to one tally, and each prints its entry in one piece.
class Series {
 public:
  explicit Series(bool verbose) : verbose_(verbose) {}

  void add(const Entry& entry) {
    const std::scoped_lock lock(mutex_);
    tally_.add(entry);
    print_entry(entry, verbose_);
    std::fflush(stdout);
  }
  [[nodiscard]] Tally tally() {
    const std::scoped_lock lock(mutex_);
    return tally_;
  }

 private:
  std::mutex mutex_;
  Tally tally_;
  bool verbose_;
};

/// What a thread has for itself.
struct Own {
  fs::path folder;
  StartedProgram* started = nullptr;  ///< null where each step is to start the program anew
};

/// Calls judge(item, own) with what `next` gives, until it gives nothing, on as many threads as asked for.
void for_each(const Arguments& arguments, const fs::path& folder,
              const std::function<std::optional<std::uint64_t>()>& next,
              const std::function<void(std::uint64_t, const Own&)>& judge) {
  std::vector<std::thread> threads;
  for (std::uint64_t job = 0; job < std::max<std::uint64_t>(1, arguments.jobs); ++job) {
    threads.emplace_back([&, own_folder = folder / std::to_string(job)] {
      fs::create_directory(own_folder);
      std::optional<StartedProgram> started;
      if (arguments.is_started) started.emplace(arguments.program, MESHLODE_STARTED);
      const Own own{own_folder, started ? &*started : nullptr};
      while (const auto item = next()) judge(*item, own);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

/// 0 … count - 1, each once.
std::function<std::optional<std::uint64_t>()> up_to(std::uint64_t count, std::atomic<std::uint64_t>& next) {
  return [count, &next]() -> std::optional<std::uint64_t> {
    const std::uint64_t i = next++;
    return i < count ? std::optional(i) : std::nullopt;
  };
}

TrialOptions trial_options(const Arguments& arguments, const fs::path& folder,
                           const std::vector<std::string>& build_options) {
  TrialOptions options{.program = arguments.program, .folder = folder, .build_options = build_options};
  options.judges_seen_surfaces = arguments.harm == Harm::kLayers;
  options.cpu_seconds = arguments.cpu_seconds;
  options.depth = arguments.depth;
  options.samples = arguments.samples;
  return options;
}

/// A budget or a grid that 24 bits cannot hold is refused by rule.
bool asks_for_accuracy(const RandomScene& scene) {
  return std::any_of(scene.build_options.begin(), scene.build_options.end(), [](const std::string& option) {
    return option == "--grid" || option == "--position-error" || option == "--uv-error";
  });
}

void keep_shrunk(std::uint64_t seed, const Entry& entry, const Arguments& arguments, const fs::path& folder) {
  for (const auto& [rule, findings] : entry.result.rules) {
    std::string name = "seed-" + std::to_string(seed) + "-" + rule + ".glb";
    for (char& c : name) c = c == ':' || c == ' ' ? '-' : c;
    const RandomScene small = shrunk(seed, rule, arguments, folder);
    const bool is_kept = write_scene(arguments.shrink_into / name, small);
    std::printf("seed %llu: %s in %llu triangles: %s%s\n", static_cast<unsigned long long>(seed), rule.c_str(),
                static_cast<unsigned long long>(small.triangle_count()), (arguments.shrink_into / name).c_str(),
                is_kept ? "" : ", which cannot be written");
  }
}

/// The scene of a seed as it is built.
RandomScene scene_of(std::uint64_t seed, const Arguments& arguments) {
  RandomScene scene = random_scene(seed, arguments.harm);
  if (!arguments.with.empty()) scene.build_options = arguments.with;
  return scene;
}

void try_seed(std::uint64_t seed, const Arguments& arguments, const Own& own, Series& series) {
  Entry entry;
  const RandomScene scene = scene_of(seed, arguments);
  entry.name = "seed " + std::to_string(seed);
  entry.contents = scene.contents;
  entry.triangles = scene.triangle_count();
  entry.build_options = scene.build_options;
  entry.was_skipped = entry.triangles > arguments.max_triangles;
  if (!entry.was_skipped) {
    TrialOptions options = trial_options(arguments, own.folder, entry.build_options);
    options.started = own.started;
    options.other_jobs_too = seed % 8 == 0;
    entry.result = try_scene(write_glb(scene), options);
    if (entry.result.refusal && !asks_for_accuracy(scene)) {
      entry.result.rules["build:refused"] = 1;  // these scenes are valid, and nothing but a budget can be too much
      entry.result.detail = std::exchange(entry.result.refusal, std::nullopt).value_or("");
    }
  }
  series.add(entry);
  if (!arguments.shrink_into.empty()) keep_shrunk(seed, entry, arguments, own.folder);
}

int conclude(Series& series, const Arguments& arguments) {
  const Tally tally = series.tally();
  print_tally(tally);
  return verdict(tally, arguments.max_refused_percent);
}

}  // namespace

WorkFolder::WorkFolder() {
  std::string name = (fs::temp_directory_path() / "random_scenes.XXXXXX").string();
  if (mkdtemp(name.data()) != nullptr) path_ = name;
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

bool write_scene(const fs::path& path, const RandomScene& scene) {
  const auto glb = write_glb(scene);
  if (!write_file(path, glb.data(), glb.size())) return false;
  fs::path options = path;
  options.replace_extension(".options");
  const std::string text = joined(scene.build_options) + "\n";
  return scene.build_options.empty() || write_file(options, text.data(), text.size());
}

RandomScene shrunk(std::uint64_t seed, const std::string& rule, const Arguments& arguments, const fs::path& folder) {
  const StillFails still_fails = [&](const RandomScene& scene) {
    TrialOptions options = trial_options(arguments, folder, scene.build_options);
    options.depth = depth_of(rule);
    options.other_jobs_too = rule == "build:jobs";
    return try_scene(write_glb(scene), options).rules.contains(rule);
  };
  return shrink_scene(scene_of(seed, arguments), still_fails, arguments.shrink_seconds);
}

int run_seeds(const Arguments& arguments, const std::vector<std::uint64_t>& seeds) {
  const WorkFolder work;
  Series series(arguments.verbose);
  std::atomic<std::uint64_t> next = 0;
  for_each(arguments, work.path(), up_to(seeds.size(), next),
           [&](std::uint64_t i, const Own& own) { try_seed(seeds[i], arguments, own, series); });
  return conclude(series, arguments);
}

int soak(const Arguments& arguments, std::uint64_t first, double minutes) {
  using Clock = std::chrono::steady_clock;
  const WorkFolder work;
  Series series(arguments.verbose);
  const Clock::time_point begin = Clock::now();
  const Clock::time_point end =
      begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(60.0 * minutes));
  std::atomic<std::uint64_t> next = first, minutes_told = 0;
  const auto next_seed = [&]() -> std::optional<std::uint64_t> {
    const Clock::time_point now = Clock::now();
    if (now >= end) return std::nullopt;
    const auto passed = static_cast<std::uint64_t>(std::chrono::duration<double>(now - begin).count() / 60.0);
    if (passed > minutes_told.exchange(passed)) {
      const Tally tally = series.tally();
      std::fprintf(stderr, "%llu min: %llu scenes, %llu failed\n", static_cast<unsigned long long>(passed),
                   static_cast<unsigned long long>(tally.scenes), static_cast<unsigned long long>(tally.failed));
    }
    return next++;
  };
  for_each(arguments, work.path(), next_seed,
           [&](std::uint64_t seed, const Own& own) { try_seed(seed, arguments, own, series); });
  std::printf("seeds %llu to %llu in %.1f min:\n", static_cast<unsigned long long>(first),
              static_cast<unsigned long long>(next.load() - 1),
              std::chrono::duration<double>(Clock::now() - begin).count() / 60.0);
  return conclude(series, arguments);
}

int replay(const Arguments& arguments, const fs::path& folder) {
  const WorkFolder work;
  std::vector<fs::path> files;
  for (const auto& item : fs::directory_iterator(folder)) {
    if (item.path().extension() == ".glb") files.push_back(item.path());
  }
  std::sort(files.begin(), files.end());
  Series series(arguments.verbose);
  std::atomic<std::uint64_t> next = 0;
  for_each(arguments, work.path(), up_to(files.size(), next), [&](std::uint64_t i, const Own& own) {
    Entry entry;
    entry.name = files[i].filename().string();
    entry.triangles = 1;  // not counted: speed is not the question here
    fs::path options_file = files[i];
    options_file.replace_extension(".options");
    std::ifstream in(options_file);
    for (std::string word; in >> word;) entry.build_options.push_back(word);
    TrialOptions options = trial_options(arguments, own.folder, entry.build_options);
    options.started = own.started;
    entry.result = try_scene(read_file(files[i]), options);
    series.add(entry);
  });
  return conclude(series, arguments);
}

}  // namespace meshlode::test
