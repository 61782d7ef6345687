// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/trial.h"

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "run/child.h"

namespace meshlode::test::hard {

namespace {

/// Tabs and line ends part fields.
std::string one_line(std::string text) {
  for (char& c : text) c = c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  return text.substr(0, 300);
}

bool is_refusal(ErrorCode code) {
  return code == ErrorCode::kInvalid || code == ErrorCode::kBuildFailed || code == ErrorCode::kUnsupported;
}

Trial refused(const Error& error) {
  Trial trial;
  trial.laws.resize(laws().size());
  // A refusal is a line with its reason; anything else is a failure of the program.
  const bool is_well = is_refusal(error.code) && !error.detail.empty();
  trial.verdict = is_well ? Verdict::kRefused : Verdict::kFails;
  trial.detail = "exit " + std::to_string(static_cast<int>(error.code)) + ": " + error.message();
  return trial;
}

}  // namespace

Trial try_case(const HardCase& hard_case, double parameter, bool all_laws, const lab::Care& care) {
  Result<Sample> sample = hard_case.make(parameter);
  if (!sample) return refused(sample.error());
  builder::BuildHooks hooks;
  if (care != lab::Care{}) {
    hooks = lab::hooks_of({care, lab::Simplifier::kOwn});
    sample->options.hooks = &hooks;
  }
  const Result<Built> built = build_sample(std::move(*sample));
  if (!built) return refused(built.error());
  Trial trial;
  trial.verdict = Verdict::kHolds;
  trial.laws.resize(laws().size());
  for (std::size_t i = 0; i < laws().size(); ++i) {
    // Views are what their cases are about: they are asked at each parameter.
    const bool is_asked = all_laws || i == 0 || (laws()[i].check == check_views && !built->sample.views.empty());
    if (!is_asked) continue;
    trial.laws[i] = laws()[i].check(*built);
    const LawResult& law = trial.laws[i];
    if (law.verdict == Verdict::kNotAsked || law.verdict <= trial.verdict) continue;
    trial.verdict = law.verdict;
    trial.detail = std::string(laws()[i].name) + ": " + law.detail;
  }
  return trial;
}

std::string text_of(const Trial& trial) {
  char line[64];
  std::snprintf(line, sizeof line, "%d\t%zu\t", static_cast<int>(trial.verdict), trial.laws.size());
  std::string text = line + one_line(trial.detail) + "\n";
  for (const LawResult& law : trial.laws) {
    std::snprintf(line, sizeof line, "%d\t%.9g\t", static_cast<int>(law.verdict), law.share);
    text += line + one_line(law.detail) + "\n";
  }
  return text;
}

bool parse_trial(const std::string& text, Trial& trial) {
  std::istringstream in(text);
  std::string line;
  const auto fields = [&](int& verdict, double& number, std::string& rest) {
    if (!std::getline(in, line)) return false;
    const std::size_t first = line.find('\t'), second = line.find('\t', first + 1);
    if (first == std::string::npos || second == std::string::npos) return false;
    verdict = std::atoi(line.c_str());
    number = std::strtod(line.c_str() + first + 1, nullptr);
    rest = line.substr(second + 1);
    return verdict >= 0 && verdict <= static_cast<int>(Verdict::kFails);
  };
  int verdict = 0;
  double number = 0.0;
  if (!fields(verdict, number, trial.detail) || number != static_cast<double>(laws().size())) return false;
  trial.verdict = static_cast<Verdict>(verdict);
  trial.laws.assign(laws().size(), {});
  for (LawResult& law : trial.laws) {
    if (!fields(verdict, law.share, law.detail)) return false;
    law.verdict = static_cast<Verdict>(verdict);
  }
  return true;
}

Trial try_apart(const std::string& program, const HardCase& hard_case, double parameter, bool all_laws,
                const std::string& care) {
  char number[40];
  std::snprintf(number, sizeof number, "%.17g", parameter);
  std::vector<std::string> arguments{"trial", hard_case.name, number};
  if (all_laws) arguments.emplace_back("--laws");
  if (!care.empty()) arguments.insert(arguments.end(), {"--care", care});
  ChildLimits limits;
  if (all_laws) limits.cpu_seconds *= 8.0;
  const ChildResult ran = run_child(program, std::move(arguments), limits);
  Trial trial;
  if (ran.exit_code == 0 && parse_trial(ran.out, trial)) return trial;
  trial.laws.assign(laws().size(), {});
  trial.verdict = Verdict::kFails;
  trial.detail = ran.timed_out       ? "did not end in time"
                 : ran.exit_code < 0 ? "ended by signal " + std::to_string(ran.signal)
                                     : "ended with exit code " + std::to_string(ran.exit_code);
  return trial;
}

}  // namespace meshlode::test::hard
