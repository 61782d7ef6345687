// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/sweep/sweep.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/try.h"
#include "format/names.h"
#include "lab/child/child.h"
#include "lab/sweep/collect.h"
#include "lab/sweep/facts.h"
#include "lab/sweep/machine.h"
#include "lab/sweep/report_folder.h"
#include "lab/sweep/source_measure.h"
#include "lab/sweep/state.h"
#include "lab/sweep/work_folder.h"
#include "run/decode/decode.h"
#include "scene/import/import.h"

namespace meshlode::lab {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Points whose asset is the same.
struct Group {
  std::string key;
  std::vector<std::size_t> points;
};

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t at = text.rfind('\n');
  return at == std::string::npos ? text : text.substr(at + 1);
}

/// A build that ended because everything is to end.
bool was_interrupted(const ChildRun& run) {
  return run.exit_code == 128 + SIGINT || run.exit_code == 128 + SIGTERM || run.exit_code == 128 + SIGHUP;
}

class Sweep {
 public:
  Sweep(const SweepOptions& options, const SweepWatcher& watcher, scene::Scene scene, State state, WorkFolder work,
        std::string picture_tag, SweepResult& result)
      : options_(options),
        watcher_(watcher),
        scene_(std::move(scene)),
        source_(scene_, result.fineness.samples, result.fineness.searches),
        state_(std::move(state)),
        work_(std::move(work)),
        picture_tag_(std::move(picture_tag)),
        result_(result) {}

  Status run(const KeepResult& keep) {
    if (Status ready = measure_baseline(); !ready) return ready;
    plan();
    for (round_ = 1; round_ <= options_.rounds; ++round_) {
      if (Status done = round_ == 1 ? do_first_round() : do_groups(); !done) return done;
      result_.is_complete = round_ == options_.rounds;
      result_.spent = spent();
      collect_results(state_, options_.rounds, result_);
      if (Status kept = keep(result_); !kept) return kept;
    }
    return Ok{};
  }

 private:
  [[nodiscard]] double spent() const { return state_.spent() + unrecorded_; }

  /// The baseline's asset stays until the end: views and knobs come from it. Its settings key is empty.
  Status measure_baseline() {
    const fs::path file = work_.path() / "baseline.lode";
    Status built = build({}, file, 1);
    if (!built) return built;
    if (const Measurement* failed = state_.find(MeasurementKind::kBuild, {}, 1); failed && !failed->error.empty()) {
      return Error{ErrorCode::kBuildFailed, options_.scene.string(), failed->error};
    }
    TRY_LET(asset, run::Asset::open(file, options_.max_decoded));
    const SceneFacts facts = facts_of(*asset);
    result_.knobs = make_knobs(facts, options_.knobs);
    result_.idle_knobs = find_idle_knobs(facts, options_.knobs);
    views_.views = make_views(options_.frame_scene(*asset, result_.fineness.width, result_.fineness.height));
    views_.max_decoded = options_.max_decoded;
    if (Status drawn = draw_full(*asset, views_); !drawn) return drawn;
    result_.views = views_.views;
    for (std::size_t v = 0; v < views_.views.size(); ++v) {
      result_.full_pictures.push_back("pictures/full-" + views_.views[v].name + ".png");
      if (Status written = write_picture(result_.full_pictures.back(), views_.full[v]); !written) return written;
    }
    result_.machine.vulkan = result_.fineness.is_device_asked ? ask_device(*asset, views_)
                                                              : DeviceAnswer{"", "not asked for a short budget"};
    for (Point& point : make_points(result_.knobs)) {
      PointResult one;
      one.id = point_id(result_.knobs, point);
      one.label = point_label(result_.knobs, point);
      one.point = std::move(point);
      result_.points.push_back(std::move(one));
    }
    round_ = 1;
    return look_at(*asset, {{}, {0}});
  }

  void plan() {
    for (const PointResult& one : result_.points) points_.push_back(one.point);
    const std::string none;
    cost_.build = seconds_of(MeasurementKind::kBuild, none, 1);
    cost_.measure = seconds_of(MeasurementKind::kAsset, none, 0) + seconds_of(MeasurementKind::kDraw, none, 0);
    cost_.draw = seconds_of(MeasurementKind::kFrames, none, 1);
    planned_ = plan_points(result_.knobs, points_, cost_, options_.rounds, options_.budget);
    group_chosen();
  }

  /// Those that are chosen and in no group yet.
  void group_chosen() {
    for (const PlannedPoint& one : planned_) {
      PointResult& point = result_.points[one.point];
      if (point.is_chosen) continue;
      point.is_chosen = one.is_chosen;
      point.estimate = one.estimate;
      point.first = one.first;
      if (!one.is_chosen) continue;
      const std::string key = build_key(result_.knobs, point.point);
      auto group = std::ranges::find(groups_, key, &Group::key);
      if (group == groups_.end()) group = groups_.insert(group, {key, {}});
      group->points.push_back(one.point);
    }
  }

  Status do_groups() {
    for (const Group& group : groups_) {
      if (Status done = do_group(group); !done) return done;
    }
    return Ok{};
  }

  /// The first round, and as many points more as it leaves time for.
  Status do_first_round() {
    round_ = 1;
    for (;;) {
      if (Status done = do_groups(); !done) return done;
      if (options_.budget <= 0.0) return Ok{};
      // By the first rounds alone, which a run that goes on finds in the state: to the same plan.
      double took = 0.0;
      for (const Group& group : groups_) {
        if (is_missing(group) && !has_failed(group)) return Ok{};
        took += seconds_of(MeasurementKind::kAsset, group.key, 0) + seconds_of(MeasurementKind::kBuild, group.key, 1);
        for (const std::size_t p : group.points) {
          took += seconds_of(MeasurementKind::kDraw, key_of(p), 0) + seconds_of(MeasurementKind::kFrames, key_of(p), 1);
        }
      }
      const std::size_t more =
          choose_more(result_.knobs, points_, cost_, options_.rounds, options_.budget, took, planned_);
      if (more == 0) return Ok{};
      group_chosen();
    }
  }

  [[nodiscard]] double seconds_of(MeasurementKind kind, const std::string& key, std::uint32_t round) const {
    const Measurement* found = state_.find(kind, key, round);
    return found ? found->seconds : 0.0;
  }

  [[nodiscard]] std::string key_of(std::size_t point) const {
    return settings_key(result_.knobs, result_.points[point].point);
  }

  /// What is not measured yet of a group in this round.
  [[nodiscard]] bool is_unmeasured(const Group& group) const {
    if (!state_.find(MeasurementKind::kBuild, group.key, round_)) return true;
    if (!state_.find(MeasurementKind::kAsset, group.key)) return true;
    return std::any_of(group.points.begin(), group.points.end(), [&](std::size_t p) {
      return !state_.find(MeasurementKind::kDraw, key_of(p), 0) ||
             !state_.find(MeasurementKind::kFrames, key_of(p), round_);
    });
  }
  /// Or a picture of it is gone.
  [[nodiscard]] bool is_missing(const Group& group) const {
    return is_unmeasured(group) || std::any_of(group.points.begin(), group.points.end(), [&](std::size_t p) {
             return !find_measured(MeasurementKind::kDraw, key_of(p), 0);
           });
  }

  [[nodiscard]] bool has_failed(const Group& group) const {
    const Measurement* build = state_.find(MeasurementKind::kBuild, group.key, 1);
    const Measurement* now = state_.find(MeasurementKind::kBuild, group.key, round_);
    const Measurement* asset = state_.find(MeasurementKind::kAsset, group.key);
    return (build && !build->error.empty()) || (now && !now->error.empty()) || (asset && !asset->error.empty());
  }

  /// What a round of the group will take: as it took before, else as planned.
  [[nodiscard]] double expected(const Group& group, std::uint32_t round) const {
    double seconds = seconds_of(MeasurementKind::kBuild, group.key, 1);
    for (const std::size_t p : group.points) {
      seconds += seconds_of(MeasurementKind::kFrames, key_of(p), 1);
    }
    if (round > 1 && seconds > 0.0) return seconds;
    double planned = 0.0;
    for (const std::size_t p : group.points) {
      if (!state_.find(MeasurementKind::kFrames, key_of(p), round)) planned += result_.points[p].first;
    }
    return planned;
  }

  Status do_group(const Group& group) {
    if (!is_missing(group) || has_failed(group)) return Ok{};
    const bool is_beyond_budget = options_.budget > 0.0 && spent() + expected(group, round_) > options_.budget;
    if (is_beyond_budget && is_unmeasured(group)) return Ok{};  // the report needs the pictures of what is measured
    tell(group);
    const bool is_baseline = group.key.empty();
    const fs::path file = work_.path() / (is_baseline ? "baseline.lode" : "point.lode");
    if (Status built = build(result_.points[group.points.front()].point, file, round_); !built) return built;
    if (has_failed(group)) return Ok{};
    TRY_LET(asset, run::Asset::open(file, options_.max_decoded));
    const Status looked = look_at(*asset, group);
    std::error_code ignored;
    if (!is_baseline) fs::remove(file, ignored);
    return looked;
  }

  void tell(const Group& group) const {
    if (!watcher_) return;
    SweepProgress progress;
    progress.label = result_.points[group.points.front()].label;
    progress.round = round_;
    progress.rounds = options_.rounds;
    progress.point = static_cast<std::size_t>(&group - groups_.data());
    progress.points = groups_.size();
    double left = 0.0;
    for (std::uint32_t round = round_; round <= options_.rounds; ++round) {
      const std::size_t first = round == round_ ? progress.point : 0;
      for (std::size_t g = first; g < groups_.size(); ++g) left += expected(groups_[g], round);
    }
    if (options_.budget > 0.0) left = std::min(left, std::max(0.0, options_.budget - spent()));
    progress.seconds_left = left;
    progress.fraction = spent() + left > 0.0 ? spent() / (spent() + left) : 0.0;
    watcher_(progress);
  }

  /// Builds into `file` and, where the state lacks it, keeps what that took. Errors: kIo, and where the sweep is to
  /// end.
  Status build(const Point& point, const fs::path& file, std::uint32_t round) {
    const std::string key = point.values.empty() ? std::string() : build_key(result_.knobs, point);
    const bool is_known = state_.find(MeasurementKind::kBuild, key, round) != nullptr;
    std::error_code ignored;
    if (is_known && key.empty() && is_baseline_there_) return Ok{};
    std::vector<std::string> arguments{build_verb(result_.knobs, point),
                                       options_.scene.string(),
                                       "-o",
                                       file.string(),
                                       "--quiet",
                                       "--no-settings-file",
                                       "--jobs",
                                       std::to_string(options_.jobs)};
    if (!options_.scene_choice.empty()) arguments.insert(arguments.end(), {"--scene", options_.scene_choice});
    if (!options_.max_decoded_text.empty()) {
      arguments.insert(arguments.end(), {"--max-decoded", options_.max_decoded_text});
    }
    for (const fs::path& folder : options_.allow_outside) {
      arguments.insert(arguments.end(), {"--allow-outside", folder.string()});
    }
    if (!point.values.empty()) {
      const std::vector<std::string> settings = build_arguments(result_.knobs, point);
      arguments.insert(arguments.end(), settings.begin(), settings.end());
    }
    fs::remove(file, ignored);
    const auto start = Clock::now();
    TRY_LET(run, run_child(options_.program, arguments));
    if (was_interrupted(*run)) return Error{ErrorCode::kIo, "sweep", "interrupted; run it again to go on"};
    Measurement m;
    m.kind = MeasurementKind::kBuild;
    m.key = key;
    m.round = round;
    if (run->exit_code != 0) {
      m.error = last_line(run->errors);
      if (m.error.empty()) m.error = "exit code " + std::to_string(run->exit_code);
    } else {
      m.figures["build_user_seconds"] = run->user_seconds;
      m.figures["build_wall_seconds"] = run->wall_seconds;
      if (run->peak_bytes > 0) m.figures["build_peak_bytes"] = static_cast<double>(run->peak_bytes);
      if (Status loaded = time_loading(file, m); !loaded) return loaded;
      is_baseline_there_ = is_baseline_there_ || key.empty();
    }
    m.seconds = seconds_since(start);
    if (is_known) {
      unrecorded_ += m.seconds;
      return Ok{};
    }
    // Whoever killed it, or a disk that was full, may not be there the next time: that is not kept for another run.
    constexpr int kNotFound = 127, kSignal = 128;
    const bool is_of_this_run =
        run->exit_code == static_cast<int>(ErrorCode::kIo) || run->exit_code == kNotFound || run->exit_code > kSignal;
    if (is_of_this_run) {
      state_.keep_for_this_run(std::move(m));
      return Ok{};
    }
    return state_.add(std::move(m));
  }

  Status time_loading(const fs::path& file, Measurement& m) const {
    const auto start = Clock::now();
    TRY_LET(asset, run::Asset::open(file, options_.max_decoded));
    m.figures["load_seconds"] = seconds_since(start);
    const auto opened = Clock::now();
    TRY_LET(decoded, run::decode_all(*asset));
    m.figures["decode_seconds"] = seconds_since(opened);
    return Ok{};
  }

  /// Takes a measurement that the state lacks, or whose picture is gone; where it fails, so does the point.
  template <class Take>
  Status take(MeasurementKind kind, const std::string& key, std::uint32_t round, const Take& measure) {
    if (find_measured(kind, key, round)) return Ok{};
    Measurement m;
    m.kind = kind;
    m.key = key;
    m.round = round;
    const auto start = Clock::now();
    if (const Status done = measure(m); !done) {
      if (done.error().code == ErrorCode::kIo) return done;
      m.error = done.error().message();
    }
    m.seconds = seconds_since(start);
    if (const Measurement* first = state_.find(kind, key, round)) {  // drawn again: the plan depends on the first time
      unrecorded_ += m.seconds;
      m.seconds = first->seconds;
    }
    return state_.add(std::move(m));
  }

  /// Deviations are those of cuts by positions, pictures those of what the asset promises.
  Status look_at(const run::Asset& opened, const Group& group) {
    TRY(take(MeasurementKind::kAsset, group.key, 0, [&](Measurement& m) { return measure_content(opened, m); }));
    const std::string word = word_of(result_.knobs, result_.points[group.points.front()].point, "promise");
    TRY_LET(promised, opened.with_promise(value_in(format::kPromiseNames, word).value_or(format::Promise::kPosition)));
    const run::Asset& asset = *promised;
    Status done = Ok{};
    for (std::size_t i = 0; done && i < group.points.size(); ++i) {
      const PointResult& one = result_.points[group.points[i]];
      const double pixels = number_of(result_.knobs, one.point, "pixel_error", 1.0);
      const std::string key = key_of(group.points[i]);
      if (const Measurement* twin = find_drawn_twin(asset, pixels);
          twin && !find_measured(MeasurementKind::kDraw, key, 0)) {
        Measurement same = *twin;
        same.key = key;
        same.seconds = seconds_of(MeasurementKind::kDraw, key, 0);
        same.is_stored = false;
        if (done = state_.add(std::move(same)); !done) break;
      }
      done = take(MeasurementKind::kDraw, key, 0, [&](Measurement& m) {
        return draw_point(
            asset, views_, pixels, one.id + "-" + picture_tag_,
            [&](const std::string& path, const draw::Image& image) { return write_picture(path, image); }, m);
      });
      if (!done) break;
      done = take(MeasurementKind::kFrames, key, round_, [&](Measurement& m) {
        return time_frames(asset, views_, pixels, !result_.machine.vulkan.name.empty(), m);
      });
    }
    return done;
  }

  /// Pages stored in another way decode to the same.
  Status measure_content(const run::Asset& asset, Measurement& m) {
    const Measurement* twin = state_.find_content(content_hash_of(asset));
    if (twin == nullptr) return source_.measure(asset, m);
    describe_sizes(asset, m);
    take_content_figures(*twin, m);
    return Ok{};
  }

  /// Pictures of the same content at the same pixel error; null where there are none yet.
  [[nodiscard]] const Measurement* find_drawn_twin(const run::Asset& asset, double pixels) const {
    const std::string hash = content_hash_of(asset);
    for (const PointResult& one : result_.points) {
      if (number_of(result_.knobs, one.point, "pixel_error", 1.0) != pixels) continue;
      const Measurement* other = state_.find(MeasurementKind::kAsset, build_key(result_.knobs, one.point));
      if (other == nullptr || other->asset.content_hash != hash) continue;
      const Measurement* drawn = find_measured(MeasurementKind::kDraw, settings_key(result_.knobs, one.point), 0);
      if (drawn != nullptr && drawn->error.empty()) return drawn;
    }
    return nullptr;
  }

  /// Null, too, where a picture of it is gone.
  [[nodiscard]] const Measurement* find_measured(MeasurementKind kind, const std::string& key,
                                                 std::uint32_t round) const {
    const Measurement* found = state_.find(kind, key, round);
    if (found == nullptr) return nullptr;
    const auto is_gone = [&](const std::string& path) {
      std::error_code ignored;
      return !path.empty() && !fs::exists(options_.report / path, ignored);
    };
    const bool is_whole = std::none_of(found->pictures.begin(), found->pictures.end(), [&](const PictureRow& row) {
      return is_gone(row.picture) || is_gone(row.heat);
    });
    return is_whole ? found : nullptr;
  }

  [[nodiscard]] Status write_picture(const std::string& path, const draw::Image& image) const {
    return write_file_atomically(options_.report / path, draw::encode_png(image));
  }

  const SweepOptions& options_;
  const SweepWatcher& watcher_;
  scene::Scene scene_;
  SourceMeasure source_;  ///< of scene_
  State state_;
  WorkFolder work_;
  std::string picture_tag_;  ///< in pictures' names: another scene or program has others of the same settings
  SweepResult& result_;
  ViewSet views_;
  std::vector<Point> points_;  ///< of result_
  BaselineCost cost_;
  std::vector<PlannedPoint> planned_;
  std::vector<Group> groups_;
  std::uint32_t round_ = 1;
  double unrecorded_ = 0.0;  ///< of what was built or drawn again because it is gone
  bool is_baseline_there_ = false;
};

}  // namespace

Status run_sweep(const SweepOptions& options, const SweepWatcher& watcher, const KeepResult& keep) {
  scene::ImportOptions import;
  import.scene = options.scene_choice;
  import.max_decoded = options.max_decoded;
  import.may_lack_images = true;
  import.allow_outside = options.allow_outside;
  std::vector<FileId> read;
  import.files_read = &read;
  TRY_LET(scene, scene::import_scene(options.scene, import));
  if (Status made = make_report_folder(options.report, read); !made) return made;
  TRY_LET(work, WorkFolder::make(options.report));
  SweepResult result;
  result.scene = summary_of(*scene);
  result.fineness = choose_fineness(options.budget, result.scene.meshes, result.scene.vertices);
  if (options.samples > 0) result.fineness.samples = options.samples;
  if (options.diagnose_scene) result.diagnoses = options.diagnose_scene(*scene);
  const MachineFacts machine = describe_machine();
  result.machine = {
      machine.processor, machine.system, options.jobs > 0 ? options.jobs : machine.threads, machine.memory_bytes, {}};
  const std::string fingerprint = fingerprint_of(options, result);
  TRY_LET(state, State::open(state_file_of(options.report), fingerprint));
  Sweep sweep(options, watcher, std::move(*scene), std::move(*state), std::move(*work), fingerprint.substr(0, 8),
              result);
  return sweep.run([&](const SweepResult& so_far) {
    answer_all(options.wishes, result);
    return keep(so_far);
  });
}

}  // namespace meshlode::lab
