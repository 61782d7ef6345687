// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/batch/shard/read_manifest.h"
#include "app/batch/tell/tell.h"
#include "app/batch/tell/time_left.h"
#include "app/batch/work/warnings.h"
#include "scene/import/json.h"

namespace meshlode::app {
namespace {

JobResult result_of(const std::string& name, JobStatus status) {
  JobResult r;
  r.job = {name, name + ".lode"};
  r.status = status;
  r.facts.triangles = 1234567;
  r.facts.bytes = 89;
  if (status == JobStatus::kFailed) {
    r.exit_code = 3;
    r.error = "<bad> & \"worse\" \x01\xFF\xED\xA0\x80\xE2\x82\xAC";
  }
  return r;
}

TEST(Junit, HoldsEveryKindOfResultAndNoByteThatXmlForbids) {
  const std::string xml = junit_xml(
      {result_of("a", JobStatus::kBuilt), result_of("b", JobStatus::kFailed), result_of("c", JobStatus::kSkipped)});
  EXPECT_NE(xml.find("tests=\"3\" failures=\"1\" errors=\"0\" skipped=\"1\""), std::string::npos) << xml;
  const std::string lost = "\xEF\xBF\xBD";
  EXPECT_NE(
      xml.find("message=\"&lt;bad&gt; &amp; &quot;worse&quot; " + lost + lost + lost + lost + lost + "\xE2\x82\xAC\""),
      std::string::npos)
      << xml;
  EXPECT_NE(xml.find("<skipped"), std::string::npos);
  EXPECT_EQ(xml.find('\x01'), std::string::npos);
}

TEST(Summary, SumsWhatWasMadeAndCountsTheRest) {
  const std::vector<JobResult> results{result_of("a", JobStatus::kBuilt), result_of("b", JobStatus::kFailed),
                                       result_of("c", JobStatus::kUnchanged)};
  EXPECT_TRUE(
      summary_text(results).starts_with("3 files: 1 built, 1 unchanged, 1 failed; 2,469,134 triangles, 178 bytes, "))
      << summary_text(results);
  EXPECT_EQ(summary_line({results[2]}), "nothing to do: 1 file unchanged");
}

TEST(Tell, TheSummaryCountsWhatTheCacheHad) {
  std::vector<JobResult> results(4);
  for (JobResult& r : results) r.status = JobStatus::kBuilt;
  EXPECT_EQ(summary_text(results).find("cache"), std::string::npos) << "there is none";
  results[0].cache = results[1].cache = CacheUse::kHit;
  results[2].cache = CacheUse::kMiss;
  results[2].meshes_from_cache = 5;
  EXPECT_NE(summary_text(results).find("; cache: 2 hits, 1 miss, 5 meshes; "), std::string::npos)
      << summary_text(results);
  const scene::Json json = *scene::parse_json(report_json(results, 1, 0));
  const scene::Json* const cache = json.find("cache");
  ASSERT_NE(cache, nullptr);
  EXPECT_EQ(cache->find("hits")->index(), 2U);
  EXPECT_EQ(cache->find("misses")->index(), 1U);
  EXPECT_EQ(cache->find("meshes")->index(), 5U);
}

TEST(Tell, WarningsAreInEveryAccount) {
  JobResult r = result_of("a", JobStatus::kBuilt);
  r.warnings.push_back({"nothing-to-draw", "nothing to draw: it has no triangle"});
  const std::string text = "nothing to draw: it has no triangle";
  EXPECT_EQ(summary_line({r, result_of("b", JobStatus::kBuilt)}), "2 files: 2 built; 1 with warnings");
  EXPECT_NE(junit_xml({r}).find("warning: " + text), std::string::npos);
  for (const std::string& json : {report_json({r}, 1, 0), manifest_json({r}, {}, "", 0)}) {
    EXPECT_NE(json.find("\"id\": \"nothing-to-draw\""), std::string::npos) << json;
    EXPECT_NE(json.find(text), std::string::npos) << json;
  }
  const auto read = parse_manifest(manifest_json({r}, {}, "", 0));
  ASSERT_TRUE(read.ok()) << read.error().message();
  ASSERT_EQ(read->results[0].warnings.size(), 1U);
  EXPECT_EQ(read->results[0].warnings[0].text, text);
}

TEST(Warnings, SayWhyNothingIsDrawnAndWhatIsMissing) {
  const auto said = [](const JobFacts& facts) {
    std::string text;
    for (const JobWarning& warning : list_warnings(facts)) text += warning.id + "|" + warning.text + "|";
    return text;
  };
  JobFacts facts;
  EXPECT_EQ(said(facts), "");
  facts.draws_nothing = true;
  EXPECT_EQ(said(facts), "nothing-to-draw|nothing to draw: it has no triangle|");
  facts.triangles = 1200;
  EXPECT_EQ(said(facts), "nothing-to-draw|nothing to draw: none of its 1,200 triangles has an area|");
  facts.triangles = 0, facts.dropped = 12;
  EXPECT_EQ(said(facts), "nothing-to-draw|nothing to draw: --repair removed every triangle, 12 in all|");
  facts = {};
  facts.triangles = 115, facts.file_triangles = 120, facts.missing = 5;
  EXPECT_EQ(said(facts), "triangles-missing|triangles are missing: 5 of the 120 that the file holds|");
}

TEST(TimeLeft, IsAtThePaceOfTheFilesThatWereBuilt) {
  TimeLeft left({100, 300, 100, 500});
  EXPECT_FALSE(left.seconds_left(0, 0.5, 0.9));
  left.finish(0, 2.0, true);    // 50 a second
  left.finish(1, 0.01, false);  // from the cache
  EXPECT_DOUBLE_EQ(left.seconds_left(2, 0.5, 1.0).value(), (50.0 + 500.0) / 50.0);
  EXPECT_DOUBLE_EQ(left.fraction_done(2, 0.5), 0.45);
  EXPECT_EQ(time_left_text(0.2), "1 s left");
  EXPECT_EQ(time_left_text(100.0), "2 min left");
  EXPECT_EQ(time_left_text(7500.0), "2 h 05 min left");
}

}  // namespace
}  // namespace meshlode::app
