// SPDX-License-Identifier: GPL-3.0-or-later
#include "explain.h"
#include "base/try.h"

#include <algorithm>
#include <span>
#include <vector>

#include "app/preview/plan_report.h"
#include "app/preview/scene_plan.h"
#include "app/report/fold_reasons.h"
#include "app/report/read_meta.h"
#include "base/printable.h"
#include "build_options.h"
#include "draw/gpu/pass_plan.h"

namespace meshlode::cli {

namespace {

constexpr std::size_t kMaxRows = 40;

std::string more_rows(std::size_t rows) {
  if (rows <= kMaxRows) return "";
  return "  … and " + std::to_string(rows - kMaxRows) + " more (--format json of plan and info lists all)\n";
}

}  // namespace

std::string describe_settings(const app::Settled& settled, const std::vector<app::SettledMesh>& meshes,
                              const scene::Scene& scene) {
  const std::string use = app::describe_use(settled);
  std::string text = "settings" + (use.empty() ? "" : " " + use) + "\n";
  const auto line = [&](const std::string& of, app::Setting setting, const app::SettledWord& word) {
    text += "  " + of + app::info_of(setting).name + " " + (word.word.empty() ? "(none)" : printable(word.word, 100)) +
            ": " + printable(word.from, 200) + "\n";
  };
  for (const app::SettingInfo& info : app::all_settings()) {
    line("", info.setting, settled[info.setting]);
  }
  std::size_t rows = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::string label = printable(builder::mesh_label(scene.meshes[i], i), 120) + ": ";
    for (const auto& [setting, word] : meshes[i].own) {
      if (rows++ < kMaxRows) line(label, setting, word);
    }
  }
  return text + more_rows(rows);
}

Result<std::string> explain_build(const std::vector<app::SettingLayer>& layers, const builder::PipelineOptions& options,
                                  const scene::Scene& scene) {
  TRY_LET(settled, app::settle(layers));
  TRY_LET(meshes, app::settle_meshes(layers, app::names_of_meshes(scene)));
  TRY_LET(plan, app::plan_scene(scene, options));
  return describe_settings(*settled, *meshes, scene) + app::describe_plan(*plan);
}

std::string describe_recorded_plan(const run::Asset& asset) {
  const app::MetaInfo meta = app::read_meta(asset.meta_json());
  std::vector<app::Reason> kept, left_out;
  for (const app::MetaInfo::Decision& decision : meta.decisions) {
    if (decision.is_kept) kept.push_back({decision.what, decision.reason});
  }
  for (const app::MetaInfo::LeftOut& left : meta.left_outs) left_out.push_back({left.what, left.why});
  std::string text = "plan of the asset\n";
  std::size_t rows = 0;
  const auto add = [&](const char* fate, std::span<const app::Reason> reasons) {
    for (const app::Reason& reason : app::fold_reasons(reasons, asset.meshes().size())) {
      if (rows++ >= kMaxRows) continue;
      text += std::string("  ") + fate + printable(reason.what, 120) + ": " + printable(reason.why, 300) + "\n";
    }
  };
  add("kept      ", kept);
  add("left out  ", left_out);
  return text + more_rows(rows);
}

std::string describe_cpu_passes(const run::Asset& asset, const draw::AlphaMasks& masks, draw::View view) {
  const auto materials = asset.materials();
  const bool has_double_sided = std::any_of(materials.begin(), materials.end(),
                                            [](const format::MaterialRecord& m) { return m.double_sided != 0; });
  const auto has_texture = [](const draw::MaterialTextures& m) { return m.base_color || m.normal; };
  const auto textures = draw::read_material_textures(asset);
  const bool has_textures = std::any_of(textures.begin(), textures.end(), has_texture);
  const bool is_shaded = view == draw::View::kShaded;
  draw::PassPlan plan;
  plan.decisions.push_back(
      {"select", std::to_string(asset.instances().size()) + " instances by the BVH or one error", true});
  plan.decisions.push_back({"software", "every cluster of the cut, by integers", true});
  plan.decisions.push_back({"double-sided",
                            has_double_sided ? "a material is double sided: its back faces are drawn"
                                             : "no material is double sided: back faces are dropped",
                            has_double_sided});
  plan.decisions.push_back({"alpha-mask",
                            masks.is_empty() ? "no sample can fail an alpha test: no image is decoded for it"
                                             : "a material is masked: its samples look their texel up",
                            !masks.is_empty()});
  plan.decisions.push_back({"textures",
                            !has_textures ? "no material has a base colour or normal texture"
                            : is_shaded   ? "colours are shaded: base colours and normals, with their mip levels"
                                          : "the view shows none: no image is decoded but those of masks",
                            has_textures && is_shaded});
  return "passes of the CPU\n" + draw::describe_plan(plan, "  ");
}

}  // namespace meshlode::cli
