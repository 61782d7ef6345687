// SPDX-License-Identifier: GPL-3.0-or-later
#include "table/table.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace meshlode::test::hard {

namespace {

constexpr const char* kHead =
    "<!-- SPDX-License-Identifier: GPL-3.0-or-later -->\n"
    "# Hard cases: where each one ends\n"
    "\n"
    "Written by `hard_cases sweep --table docs/reference/hard-cases.md --picture docs/pictures/hard-cases.png` "
    "(`tests/hard/main.cpp`);\n"
    "edit the program, not this page. What each law says, and why it is exact or where its bound comes from:\n"
    "[numerics.md](../explanation/numerics.md). `meshlode doctor` names the case that a fault of a scene belongs to.\n"
    "\n"
    "A case is tried along its parameter, from easy to absurd, and bisected where the verdict changes:\n"
    "\n"
    "- *holds*: built, valid and proved against its source, and the smallest feature is kept;\n"
    "- *bound*: the same, but positions are off by more than half the smallest feature, or most triangles have no area "
    "on the\n"
    "  grid; the asset says by how much;\n"
    "- *refused*: nothing is built; the reason and the exit code are given;\n"
    "- **fails**: a rule or a law is broken, or the program crashed or did not end in time.\n"
    "\n"
    "*Laws*: those that were tried at the easy end and how many of them hold. *Worst*: the largest measured figure "
    "over its\n"
    "bound, of all laws that measure one, with that law's name; for the invariants it is the true deviation of a cut "
    "over the\n"
    "1.05 times that the asset states of it (V206).\n"
    "\n"
    "![Each case at the second parameter of its sweep, with its number](../pictures/hard-cases.png)\n";

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

/// Markdown's own signs are taken for what they are.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') out += '\\';
    out += c;
  }
  return out;
}

std::string range_of(const Stretch& s) {
  return s.from == s.to ? number(s.from) : number(s.from) + " … " + number(s.to);
}

std::string verdicts_of(const Swept& swept, const char* line_end) {
  std::string text;
  for (const Stretch& stretch : swept.stretches) {
    if (!text.empty()) text += line_end;
    text += range_of(stretch) + " " + name_of(stretch.verdict);
    if (!stretch.detail.empty()) text += ": " + escaped(stretch.detail);
  }
  return text;
}

/// The parameter up to which the case holds, as tried.
std::string end_of(const Swept& swept) {
  const Stretch* last = nullptr;
  for (const Stretch& stretch : swept.stretches) {
    if (stretch.verdict == Verdict::kHolds) last = &stretch;
  }
  if (last == nullptr) return "nowhere";
  return last == &swept.stretches.back() ? "to the end" : "to " + number(last->to);
}

struct LawCount {
  std::size_t asked = 0, kept = 0;
  double worst = 0.0;
  std::string worst_law, broken;
};

LawCount count_laws(const Swept& swept) {
  LawCount count;
  for (std::size_t i = 0; i < swept.easy.laws.size(); ++i) {
    const LawResult& law = swept.easy.laws[i];
    if (law.verdict == Verdict::kNotAsked) continue;
    ++count.asked;
    if (law.verdict == Verdict::kFails) {
      count.broken += (count.broken.empty() ? "" : ", ") + std::string(laws()[i].name);
    } else {
      ++count.kept;
    }
    if (law.share > count.worst) {
      count.worst = law.share;
      count.worst_law = laws()[i].name;
    }
  }
  return count;
}

std::string laws_of(const LawCount& count) {
  return std::to_string(count.kept) + " of " + std::to_string(count.asked);
}

std::string anchor_of(const std::string& name) {
  return "<a id=\"" + name + "\"></a>";
}

std::string row_of(const Swept& swept, std::size_t number_of_row) {
  const LawCount count = count_laws(swept);
  const std::string name = swept.hard_case->name;
  std::string row = "| " + std::to_string(number_of_row) + " | " + anchor_of(name) + "`" + name + "` | " +
                    swept.hard_case->parameter + " | " + end_of(swept) + " | " + laws_of(count);
  if (!count.broken.empty()) row += "; **fails**: " + count.broken;
  row += " | " + (count.worst > 0.0 ? number(count.worst) + " (" + count.worst_law + ")" : std::string("-"));
  return row + " | " + verdicts_of(swept, "<br>") + " |\n";
}

/// What each law said over all cases.
std::string law_table(std::span<const Swept> swept) {
  std::string text =
      "\n## The laws\n\n| law | exact, or its bound | asked | holds | worst over bound | breaks |\n"
      "| --- | --- | ---: | ---: | ---: | --- |\n";
  for (std::size_t i = 0; i < laws().size(); ++i) {
    std::size_t asked = 0, kept = 0;
    double worst = 0.0;
    std::string breaks;
    for (const Swept& one : swept) {
      if (i >= one.easy.laws.size()) continue;
      const LawResult& law = one.easy.laws[i];
      if (law.verdict == Verdict::kNotAsked) continue;
      ++asked;
      kept += law.verdict != Verdict::kFails ? 1 : 0;
      worst = std::max(worst, law.share);
      if (law.verdict == Verdict::kFails) {
        breaks += (breaks.empty() ? "`" : "<br>`") + std::string(one.hard_case->name) + "`: " + escaped(law.detail);
      }
    }
    text += "| " + std::string(laws()[i].name) + " | " + escaped(laws()[i].kind) + " | " + std::to_string(asked) +
            " | " + std::to_string(kept) + " | " + (worst > 0.0 ? number(worst) : "-") + " | " + breaks + " |\n";
  }
  return text;
}

/// Edges of more than two triangles, where topology was broken on purpose.
std::string crowded_edges(std::span<const Swept> swept) {
  std::string text;
  for (const Swept& one : swept) {
    for (std::size_t i = 0; i < one.easy.laws.size(); ++i) {
      const LawResult& law = one.easy.laws[i];
      if (laws()[i].check != check_closed_cuts || law.verdict != Verdict::kHolds || law.detail.empty()) continue;
      text += "- `" + std::string(one.hard_case->name) + "`: " + law.detail + "\n";
    }
  }
  if (text.empty()) return {};
  return "\n## Cuts that are closed and no manifold\n\nA simplifier that closes a hole or joins two sheets may leave "
         "edges "
         "of more than two triangles.\n\n" +
         text;
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHolds: return "holds";
    case Verdict::kBound: return "bound";
    case Verdict::kRefused: return "refused";
    case Verdict::kNotAsked: return "not asked";
    case Verdict::kFails: break;
  }
  return "**fails**";
}

std::string table_of(std::span<const Swept> swept) {
  std::string text = kHead;
  const char* room = "";
  std::size_t row = 0;
  for (const Swept& one : swept) {
    if (std::string(room) != one.hard_case->room) {
      room = one.hard_case->room;
      text += "\n## " + std::string(room) + "\n\n|  | case | parameter | holds | laws | worst | verdicts |\n" +
              "| ---: | --- | --- | --- | --- | --- | --- |\n";
    }
    text += row_of(one, ++row);
  }
  return text + law_table(swept) + crowded_edges(swept);
}

std::string line_of(const Swept& swept) {
  const LawCount count = count_laws(swept);
  std::string text = std::string(swept.hard_case->name) + ": holds " + end_of(swept) + "; " +
                     std::to_string(count.kept) + " of " + std::to_string(count.asked) + " laws; worst " +
                     number(count.worst) + " " + count.worst_law + "\n    " + verdicts_of(swept, "\n    ") + "\n";
  for (std::size_t i = 0; i < swept.easy.laws.size(); ++i) {
    const LawResult& law = swept.easy.laws[i];
    if (law.verdict == Verdict::kFails) text += "    " + std::string(laws()[i].name) + ": " + law.detail + "\n";
  }
  return text;
}

std::string difference_from_page(const Swept& swept, std::string_view page, bool is_whole) {
  const std::size_t at = page.find(anchor_of(swept.hard_case->name));
  if (at == std::string_view::npos) return "the page has no such case";
  std::string_view rest = page.substr(at, page.find('\n', at) - at);
  std::vector<std::string> cells;  // name, parameter, holds, laws, ...
  for (std::size_t bar = rest.find(" | "); bar != std::string_view::npos; bar = rest.find(" | ")) {
    cells.emplace_back(rest.substr(0, bar));
    rest.remove_prefix(bar + 3);
  }
  if (cells.size() < 4) return "the page's row is none";
  const std::string laws_now = laws_of(count_laws(swept)), end_now = end_of(swept);
  if (cells[3] != laws_now) return laws_now + " laws hold, the page says " + cells[3];
  if (is_whole && cells[2] != end_now) return "holds " + end_now + ", the page says " + cells[2];
  return {};
}

bool has_failed(const Swept& swept) {
  return std::any_of(swept.stretches.begin(), swept.stretches.end(),
                     [](const Stretch& s) { return s.verdict == Verdict::kFails; });
}

}  // namespace meshlode::test::hard
