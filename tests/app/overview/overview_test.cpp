// SPDX-License-Identifier: GPL-3.0-or-later
// What is told of a batch in four forms, of names and messages that try to be more than text in each of them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "app/overview/overview.h"
#include "base/hash.h"
#include "scene/import/json.h"
#include "support/sample_asset.h"

namespace meshlode::app {
namespace {

const std::vector<std::string> kHostile{
    "<img src=x onerror=pwned()>.glb",
    "</script><script>pwned()</script>",
    "<!--<script>",
    "a|b\n::error::injected\r\n# head",
    "javascript:pwned()",
    "https://example.org/x.glb",
    "\xE2\x80\xAE"
    "turned.glb",
    "100%0A, a:b, c.glb",
    "[link](javascript:pwned()) `x` ~y~",
    "\xFF\x80 not UTF-8",
};

JobResult job(const std::string& name, JobStatus status, std::uint64_t bytes = 1000) {
  JobResult r;
  r.job = {"in/" + name, "out/" + name};
  r.status = status;
  if (status == JobStatus::kFailed) r.exit_code = 3;
  if (status == JobStatus::kFailed || status == JobStatus::kSkipped) r.error = name + ": broken, " + name;
  r.facts.bytes = r.has_asset() ? bytes : 0;
  return r;
}

Manifest manifest_of(std::vector<JobResult> results) {
  Manifest manifest;
  manifest.generator = "meshlode 1.2.3";
  manifest.results = std::move(results);
  return manifest;
}

Overview hostile_overview() {
  std::vector<JobResult> results;
  for (const std::string& name : kHostile) {
    results.push_back(job(name, JobStatus::kFailed));
    results.push_back(job(name + "2", JobStatus::kBuilt));  // no such file: unread
    results.back().warnings.push_back({name, name});
    results.back().cache = CacheUse::kMiss;
    results.back().reason = name;
  }
  return make_overview(manifest_of(std::move(results)), nullptr, {}, 1);
}

std::size_t count_of(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string data_of(const std::string& page) {
  constexpr std::string_view kBegin = "id=\"data\">";
  const std::size_t begin = page.find(kBegin) + kBegin.size();
  return page.substr(begin, page.find("</script>", begin) - begin);
}

TEST(BatchPage, NoNameIsMarkup) {
  const std::string page = batch_page(hostile_overview(), "<b>\"@DATA@\"</b>", "");
  EXPECT_EQ(count_of(page, "<script"), 2U);
  EXPECT_EQ(count_of(page, "</script>"), 2U);
  EXPECT_EQ(count_of(page, "<img"), 0U);
  EXPECT_EQ(count_of(page, "<!--"), 1U) << "the licence's";
  EXPECT_EQ(count_of(page, "&lt;b&gt;&quot;@DATA@&quot;&lt;/b&gt;"), 2U);
  const auto data = scene::parse_json(data_of(page));
  ASSERT_TRUE(data) << data.error().message();
  const scene::Json::Array& assets = data->items("assets");
  ASSERT_EQ(assets.size(), 2 * kHostile.size());
  for (std::size_t i = 0; i + 1 < kHostile.size(); ++i) {  // the last is not UTF-8
    EXPECT_EQ(*assets[2 * i].find("input")->string(), "in/" + kHostile[i]);
    const std::string_view link = *assets[2 * i + 1].find("link")->string();
    EXPECT_TRUE(link.starts_with("./out/")) << link;
    EXPECT_EQ(link.find_first_of(":<\"' \n"), std::string::npos) << link;
  }
  EXPECT_EQ(data_of(page).find('\n'), std::string::npos);
}

TEST(BatchPage, LinksGoFromThePageToTheAsset) {
  Manifest manifest = manifest_of({job("a b.lode", JobStatus::kBuilt)});
  manifest.results[0].job.output = "javascript:pwned()";
  const Overview overview = make_overview(std::move(manifest), nullptr, {}, 1);
  EXPECT_NE(batch_page(overview, "t", "").find("\"link\": \"./javascript%3Apwned%28%29\""), std::string::npos);
  EXPECT_NE(batch_page(overview, "t", "deep/er").find("\"link\": \"../../javascript%3A"), std::string::npos);
}

TEST(OverviewMarkdown, NoNameIsMarkupOrACellOfItsOwn) {
  const std::string text = overview_markdown(hostile_overview());
  std::size_t rows = 0;
  bool is_in_failures = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.starts_with("#")) is_in_failures = line == "### Failures";
    EXPECT_TRUE(line.empty() || line[0] == '|' || line[0] == '#' || line.starts_with("and ")) << line;
    if (!is_in_failures || !line.starts_with("|")) continue;
    ++rows;
    std::size_t bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool is_escaped = i > 0 && line[i - 1] == '\\';
      bars += line[i] == '|' && !is_escaped ? 1 : 0;
      EXPECT_TRUE(is_escaped || std::string_view("<>`*_[]~").find(line[i]) == std::string_view::npos) << line;
    }
    EXPECT_EQ(bars, 3U) << line;
  }
  EXPECT_EQ(rows, 2U + 2 * kHostile.size());
}

TEST(Annotations, EachIsOneCommandOfOneLine) {
  const Overview overview = hostile_overview();
  const std::string text = overview_annotations(overview);
  EXPECT_EQ(count_of(text, "\n"), list_remarks(overview).size());
  EXPECT_EQ(text.find('\r'), std::string::npos);
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1) {
    const std::string line = text.substr(at, text.find('\n', at) - at);
    EXPECT_TRUE(line.starts_with("::error file=") || line.starts_with("::warning file=")) << line;
    const std::string properties = line.substr(2, line.find("::", 2) - 2);
    EXPECT_EQ(count_of(properties, ","), 1U) << line;
    EXPECT_EQ(count_of(properties, ":"), 0U) << line;
  }
  EXPECT_NE(text.find("file=in/100%250A%2C a%3Ab%2C c.glb,title=meshlode%3A failed::100%250A, a:b, c.glb: broken"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("in/a|b%0A%3A%3Aerror%3A%3Ainjected%0D%0A# head,"), std::string::npos) << text;
}

TEST(Sarif, ListsFailuresAndFindingsWithPlacesThatAreNoSchemes) {
  const Overview overview = hostile_overview();
  const auto root = scene::parse_json(overview_sarif(overview));
  ASSERT_TRUE(root) << root.error().message();
  EXPECT_EQ(*root->find("version")->string(), "2.1.0");
  const scene::Json& run = root->items("runs")[0];
  const scene::Json::Array& rules = run.find("tool")->find("driver")->items("rules");
  const scene::Json::Array& results = run.items("results");
  EXPECT_EQ(*run.find("tool")->find("driver")->find("version")->string(), "1.2.3");
  ASSERT_EQ(results.size(), list_remarks(overview).size());
  for (const scene::Json& result : results) {
    const std::size_t index = *result.find("ruleIndex")->index();
    ASSERT_LT(index, rules.size());
    EXPECT_EQ(*rules[index].find("id")->string(), *result.find("ruleId")->string());
    EXPECT_FALSE(result.find("message")->find("text")->string()->empty());
    const std::string_view uri =
        *result.items("locations")[0].find("physicalLocation")->find("artifactLocation")->find("uri")->string();
    EXPECT_EQ(uri.find_first_of(":<> \n|"), std::string::npos) << uri;
  }
  EXPECT_EQ(uri_of("/a b/\xFF"), "file:///a%20b/%FF");
}

TEST(Overview, ComparesWithTheOlderBatchByOutput) {
  const Manifest old =
      manifest_of({job("a", JobStatus::kBuilt, 100), job("b", JobStatus::kBuilt, 100), job("c", JobStatus::kBuilt, 100),
                   job("gone", JobStatus::kBuilt, 70), job("e", JobStatus::kFailed)});
  const Overview now = make_overview(
      manifest_of({job("a", JobStatus::kBuilt, 90), job("b", JobStatus::kUnchanged, 100), job("c", JobStatus::kFailed),
                   job("new", JobStatus::kBuilt, 7), job("e", JobStatus::kBuilt, 5)}),
      &old, {}, 1);
  EXPECT_EQ(now.assets[0].growth(), -10);
  EXPECT_EQ(now.assets[1].growth(), 0);
  EXPECT_FALSE(now.assets[2].growth()) << "it has no asset now";
  EXPECT_FALSE(now.assets[3].growth()) << "it is new";
  EXPECT_FALSE(now.assets[4].growth()) << "it had no asset";
  ASSERT_EQ(now.gone.size(), 1U);
  EXPECT_EQ(now.gone[0].output, "out/gone");
  EXPECT_EQ(now.bytes(), 202U);
  EXPECT_EQ(now.old_bytes(), 370U);
  ASSERT_EQ(now.changed().size(), 1U);
  EXPECT_NE(overview_markdown(now).find("202 bytes, -168 (-45.4%): 1 asset changed, 2 new, 1 gone"), std::string::npos)
      << overview_markdown(now);
}

TEST(Overview, TheLargestChangeIsFirstWhicheverWay) {
  std::vector<JobResult> before, after;
  const std::vector<std::uint64_t> sizes{100, 180, 20, 110, 90};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    before.push_back(job(std::to_string(i), JobStatus::kBuilt, 100));
    after.push_back(job(std::to_string(i), JobStatus::kBuilt, sizes[i]));
  }
  const Manifest old = manifest_of(before);
  const Overview overview = make_overview(manifest_of(after), &old, {}, 1);
  std::vector<std::string> order;
  for (const OverviewAsset* asset : overview.changed()) order.push_back(asset->result.job.output.filename().string());
  EXPECT_EQ(order, (std::vector<std::string>{"1", "2", "3", "4"}));
}

TEST(Overview, StreamsAreAllOfTheFileAndOtherBytesAreNotThatAsset) {
  const auto bytes = test::sample_asset_bytes();
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "meshlode-overview-test.lode";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  JobResult right = job("x", JobStatus::kBuilt, bytes.size());
  right.job.output = path;
  right.asset_hash = hash128(bytes);
  JobResult wrong = right;
  wrong.asset_hash[0] ^= 1U;
  std::size_t advised = 0;
  const Overview overview = make_overview(
      manifest_of({right, wrong}), nullptr,
      [&](const run::Asset&, OverviewAsset& row, std::vector<Diagnosis>& diagnoses) {
        ++advised;
        row.pixel_triangles = 12;
        row.thumbnail = {'<', '/', 's'};
        diagnoses.push_back({"most", "title", "remedy", "", 3, 0.5, {}});
      },
      1);
  std::filesystem::remove(path);
  const OverviewAsset& asset = overview.assets[0];
  EXPECT_EQ(asset.unread, "");
  EXPECT_EQ(std::accumulate(asset.streams.begin(), asset.streams.end(), std::uint64_t{0}), bytes.size());
  EXPECT_GT(asset.streams[0], 0U) << "positions";
  EXPECT_GT(asset.triangles, 0U);
  ASSERT_FALSE(asset.findings.empty());
  EXPECT_EQ(asset.findings[0].id, "most");
  EXPECT_EQ(asset.findings[0].severity, "high");
  EXPECT_EQ(advised, 1U);
  EXPECT_NE(overview.assets[1].unread.find("is not the asset that the manifest lists"), std::string::npos);
  EXPECT_TRUE(overview.assets[1].findings.empty());
  EXPECT_EQ(overview.pixel_triangles(), 12U);
  const std::string page = batch_page(overview, "t", "");
  EXPECT_EQ(count_of(page, "\"at_pixel\": 12"), 1U);
  EXPECT_EQ(count_of(page, "\"thumbnail\": \"PC9z\""), 1U) << "base64";
}

}  // namespace
}  // namespace meshlode::app
