// SPDX-License-Identifier: GPL-3.0-or-later
#include "batch_show.h"

#include <algorithm>
#include <cstdio>

#include <unistd.h>

#include "app/batch/jobs/weigh.h"
#include "app/doctor/diagnosis.h"
#include "app/report/fold_reasons.h"
#include "base/printable.h"
#include "builder/stage_options.h"
#include "options.h"
#include "terminal.h"

namespace meshlode::cli {

namespace {

std::string plain(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return text;
}

/// Only a bar of several files has to tell how long they take.
std::vector<std::uint64_t> weights_of(const std::vector<app::Job>& jobs, bool is_wanted) {
  std::vector<std::uint64_t> weights;
  weights.reserve(jobs.size());
  for (const app::Job& job : jobs) weights.push_back(is_wanted && jobs.size() > 1 ? app::weigh_scene(job.input) : 1);
  return weights;
}

void print_repairs(const app::JobFacts& facts) {
  std::string text;
  for (const auto& [kind, count] : app::list_repairs(facts)) {
    if (count == 0) continue;
    text += text.empty() ? "" : ", ";
    text += std::to_string(count) + " " + kind;
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!text.empty()) std::fprintf(stderr, "  repaired: %s\n", text.c_str());
}

void print_warning(const std::string& text) {
  std::fprintf(stderr, "  %s %s\n", colored(Stream::kErr, Color::kYellow, "warning:").c_str(), text.c_str());
}

void print_line(const app::JobResult& r) {
  const std::string input = plain(r.job.input.string()), output = plain(r.job.output.string());
  if (r.status == app::JobStatus::kUnchanged) {
    std::fprintf(stderr, "%s: unchanged, %s is up to date\n", input.c_str(), output.c_str());
    return;
  }
  const std::string made = r.status == app::JobStatus::kCached ? "from the cache, " : "";
  std::fprintf(stderr, "%s -> %s: %s in %s, %s bytes, %s%.2f s\n", input.c_str(), output.c_str(),
               app::counted(r.facts.triangles, "triangles").c_str(), app::counted(r.facts.meshes, "meshes").c_str(),
               grouped_digits(r.facts.bytes).c_str(), made.c_str(), r.seconds);
  if (!r.decided.empty()) std::fprintf(stderr, "  decided: %s\n", plain(r.decided).c_str());
}

void print_left_out(const app::JobFacts& facts) {
  print_repairs(facts);
  for (const scene::LeftOut& left : facts.left_out) {
    std::fprintf(stderr, "  left out: %s: %s\n", plain(left.what).c_str(), plain(left.why).c_str());
  }
  std::vector<app::Reason> losses;
  for (const scene::LeftOut& loss : facts.losses) {
    if (!loss.what.starts_with(builder::kUnknownAggregate)) {
      losses.push_back({loss.what, loss.why});
      continue;
    }
    const std::string name = plain(loss.what.substr(builder::kUnknownAggregate.size() - 1));
    print_warning("--aggregate " + name + ": " + loss.why);
  }
  for (const app::Reason& loss : app::fold_reasons(losses, facts.meshes)) {
    std::fprintf(stderr, "  left out: %s: %s\n", plain(loss.what).c_str(), plain(loss.why).c_str());
  }
}

}  // namespace

BatchShow::BatchShow(const std::vector<app::Job>& jobs, bool quiet, bool has_lines)
    : jobs_(jobs),
      has_bar_(!quiet && ::isatty(STDERR_FILENO) == 1),
      has_lines_(!quiet && has_lines),
      time_left_(weights_of(jobs, has_bar_)) {}

void BatchShow::start(std::size_t job) {
  job_ = job;
  name_ = plain(jobs_[job].input.filename().string());
  fraction_ = 0.0;
  started_ = std::chrono::steady_clock::now();
}

void BatchShow::wipe() {
  if (is_drawn_) std::fputs("\r\033[K", stderr);
  is_drawn_ = false;
}

void BatchShow::show(const builder::ProgressEvent& event) {
  // Meshes finish in any order: a bar that runs backwards helps nobody.
  fraction_ = std::max(fraction_, std::clamp(event.fraction, 0.0, 1.0));
  const double done = time_left_.fraction_done(job_, fraction_);
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  const auto left = time_left_.seconds_left(job_, fraction_, elapsed);
  constexpr std::size_t kWidth = 24;
  const auto filled = static_cast<std::size_t>(done * kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  const std::string place =
      jobs_.size() > 1 ? "[" + std::to_string(job_ + 1) + "/" + std::to_string(jobs_.size()) + "] " : "";
  std::fprintf(stderr, "\r\033[K%s%.20s [%s] %3d%% mesh %u/%u level %u%s%s", place.c_str(), name_.c_str(), bar.c_str(),
               static_cast<int>(100.0 * done), event.mesh + 1, event.mesh_count, event.level, left ? ", " : "",
               left ? app::time_left_text(*left).c_str() : "");
  std::fflush(stderr);
  is_drawn_ = true;
}

void BatchShow::end(std::size_t job, const app::JobResult& result, const Error* error) {
  wipe();
  time_left_.finish(job, result.seconds, result.status == app::JobStatus::kBuilt);
  if (error != nullptr) print_error(*error);
  if (error != nullptr || !has_lines_) return;
  if (jobs_.size() > 1) std::fprintf(stderr, "[%zu/%zu] ", job + 1, jobs_.size());
  print_line(result);
  for (const app::JobWarning& warning : result.warnings) print_warning(warning.text);
  print_left_out(result.facts);
}

app::BatchWatcher BatchShow::watcher() {
  app::BatchWatcher watcher;
  watcher.on_start = [this](std::size_t job) { start(job); };
  watcher.on_end = [this](std::size_t job, const app::JobResult& result, const Error* error) {
    end(job, result, error);
  };
  if (has_bar_) {
    watcher.on_progress = [this](const builder::ProgressEvent& event) {
      show(event);
      return true;
    };
  }
  return watcher;
}

}  // namespace meshlode::cli
