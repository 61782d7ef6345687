// SPDX-License-Identifier: GPL-3.0-or-later
// Which conditions a schema knows, and which of them hold in a document.
#include "app/budget/judge_budget.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "format/names.h"

namespace meshlode::app {
namespace {

constexpr const char* kSchema = R"({"type":"object","properties":{
  "bytes":{"type":"integer"},"label":{"type":"string"},"tier":{"enum":["qem","measured"]},"is_good":{"type":"boolean"},
  "psnr":{"type":["number","null"]},"anything":{},
  "totals":{"type":"object","properties":{"clusters":{"type":"integer"},"stuck_groups":{"type":"integer"}}},
  "reasons":{"type":"object","additionalProperties":{"type":"integer"}},
  "kinds":{"type":"object","propertyNames":{"enum":["red","green"]},"additionalProperties":{"type":"integer"}},
  "ratios":{"type":"object","additionalProperties":{"type":"number"}},
  "none":{"type":["object","null"],"additionalProperties":{"type":"integer"}},
  "uv_sets":{"type":"array","items":{"type":"integer"}},
  "meshes":{"type":"array","items":{"$ref":"#/$defs/mesh"}}},
  "$defs":{"mesh":{"type":"object","properties":{"name":{"type":"string"},"roots":{"type":"integer"},
    "levels":{"type":"array","items":{"type":"object","properties":{"error":{"type":["number","null"]}}}}}}}})";

constexpr const char* kDocument = R"({"bytes":1000,"label":"a","tier":"qem","is_good":true,"psnr":null,"anything":[1],
  "totals":{"clusters":20,"stuck_groups":0},"reasons":{"no progress":3},"kinds":{"red":2},"ratios":{},
  "none":null,"uv_sets":[],
  "meshes":[{"name":"rock","roots":1,"levels":[{"error":0},{"error":0.5}]},
            {"name":"moss","roots":2,"levels":[{"error":0},{"error":null},{"error":0.25}]},
            {"name":"","roots":2,"levels":[]}]})";

std::string refusal(const std::string& text) {
  const auto read = read_budget(text, kSchema);
  if (read) return "taken";
  EXPECT_EQ(read.error().code, ErrorCode::kUsage);
  return read.error().detail;
}

/// The messages of what holds in the document, one a line; the error where there is one.
std::string judged(const std::string& text) {
  const auto conditions = read_budget(text, kSchema);
  if (!conditions) return conditions.error().detail;
  const auto broken = judge_budget(*conditions, kDocument);
  if (!broken) return broken.error().detail;
  std::string lines;
  for (const BrokenCondition& one : *broken) lines += (lines.empty() ? "" : "\n") + one.message();
  return lines;
}

bool holds(const std::string& text) {
  const std::string message = judged(text);
  EXPECT_TRUE(message.empty() || message.starts_with("budget exceeded: ")) << message;
  return !message.empty();
}

TEST(Budget, AKeyThatThereIsNotIsAnErrorWithTheNearest) {
  EXPECT_EQ(refusal("totals.cluster>1"), "totals.cluster>1: totals has no key 'cluster'; the nearest is 'clusters'");
  EXPECT_EQ(refusal("Total.clusters>1"), "Total.clusters>1: the document has no key 'Total'; the nearest is 'totals'");
  EXPECT_EQ(refusal("any(meshes).any(levels).errors>1"),
            "any(meshes).any(levels).errors>1: any(meshes).any(levels) has no key 'errors'; the nearest is 'error'");
  EXPECT_EQ(refusal("bytes.ratio>1"), "bytes.ratio>1: bytes has no keys");
}

TEST(Budget, AListNeedsAQuantifierAndAnObjectAKey) {
  EXPECT_EQ(refusal("meshes.roots>1"),
            "meshes.roots>1: meshes is a list: any(meshes), all(meshes), count(meshes) or meshes[0]");
  EXPECT_EQ(refusal("any(meshes).levels>1"),
            "any(meshes).levels>1: any(meshes).levels is a list: any(meshes).any(levels), any(meshes).all(levels), "
            "any(meshes).count(levels) or any(meshes).levels[0]");
  EXPECT_EQ(refusal("uv_sets>1").substr(0, 31), "uv_sets>1: uv_sets is a list: a");
  EXPECT_EQ(refusal("totals>1"), "totals>1: totals is not a value: it has the keys clusters, stuck_groups");
  EXPECT_EQ(refusal("any(totals).clusters>1"), "any(totals).clusters>1: totals is not a list");
  EXPECT_EQ(refusal("totals[0]>1"), "totals[0]>1: totals is not a list");
  EXPECT_EQ(refusal("uv_sets['a']>1"), "uv_sets['a']>1: the elements of uv_sets have no names");
}

TEST(Budget, AValueIsComparedWithItsOwnKind) {
  EXPECT_EQ(refusal("label>1"), "label>1: label is not a number");
  EXPECT_EQ(refusal("tier==1"), "tier==1: tier is not a number");
  EXPECT_EQ(refusal("bytes==big"), "bytes==big: bytes is not a text");
  EXPECT_EQ(refusal("bytes==true"), "bytes==true: bytes is neither true nor false");
  EXPECT_EQ(refusal("anything==big, anything==1, anything==true, totals==null"), "taken");
}

TEST(Budget, ConditionsThatHoldAreToldWithPlaceAndValue) {
  EXPECT_EQ(judged("bytes>1000, bytes<1000, bytes!=1000"), "");
  EXPECT_EQ(judged("bytes>=1000"), "budget exceeded: bytes>=1000: bytes is 1000");
  EXPECT_EQ(judged("totals.clusters>0.01K"), "budget exceeded: totals.clusters>0.01K: totals.clusters is 20");
  EXPECT_EQ(judged("tier==qem,label!=a, is_good==false"), "budget exceeded: tier==qem: tier is \"qem\"");
  EXPECT_EQ(judged("any(meshes).roots>1"),
            "budget exceeded: any(meshes).roots>1: meshes[1].roots (moss) is 2, and 1 more");
  EXPECT_EQ(judged("meshes[\"moss\"].levels[2].error<1"),
            "budget exceeded: meshes[\"moss\"].levels[2].error<1: meshes[1].levels[2].error (moss) is 0.25");
  EXPECT_EQ(judged("count(meshes)==3"), "budget exceeded: count(meshes)==3: count(meshes) is 3");
  EXPECT_EQ(judged("any(meshes).count(levels)>2"),
            "budget exceeded: any(meshes).count(levels)>2: count(meshes[1].levels) (moss) is 3");
  EXPECT_EQ(judged("reasons['no progress']>2"), "budget exceeded: reasons['no progress']>2: reasons.no progress is 3");
  EXPECT_EQ(judged("bytes>1, label==a").find('\n'), std::string("budget exceeded: bytes>1: bytes is 1000").size());
}

TEST(Budget, WhatIsNullOrMissingIsLargerThanAnyNumberAndEqualToNullAlone) {
  for (const char* key : {"psnr", "ratios['other']", "none['other']"}) {
    const std::string k = key;
    EXPECT_TRUE(holds(k + ">1e300")) << k;
    EXPECT_TRUE(holds(k + ">=0")) << k;
    EXPECT_FALSE(holds(k + "<1e300")) << k;
    EXPECT_FALSE(holds(k + "<=0")) << k;
    EXPECT_FALSE(holds(k + "==0")) << k;
    EXPECT_TRUE(holds(k + "!=0")) << k;
    EXPECT_TRUE(holds(k + "==null")) << k;
  }
  EXPECT_FALSE(holds("bytes==null"));
}

TEST(Budget, AnAbsentCountOfAMapIsZero) {
  EXPECT_FALSE(holds("reasons['other']>0"));
  EXPECT_TRUE(holds("reasons['other']==0"));
  EXPECT_FALSE(holds("reasons['other']==null"));
  EXPECT_TRUE(holds("reasons['no progress']>2"));
  EXPECT_FALSE(holds("kinds.green>0"));
  EXPECT_EQ(judged("kinds.green<1"), "budget exceeded: kinds.green<1: kinds.green is 0");
  // Where the schema names the keys a misspelt one is no count of nothing.
  EXPECT_EQ(refusal("kinds.gren>0"), "kinds.gren>0: kinds has no key 'gren'; the nearest is 'green'");
  EXPECT_EQ(refusal("kinds['violet']>0"), "kinds['violet']>0: kinds has no key 'violet'; it has red or green");
}

TEST(Budget, TheSchemaKnowsEveryReasonWhyAGroupIsStuck) {
  for (const auto& [reason, name] : format::kStuckReasonNames) {
    if (reason == format::StuckReason::kNotStuck) continue;
    EXPECT_TRUE(read_budget("any(meshes).stuck_reasons['" + std::string(name) + "']>0", info_schema())) << name;
  }
  EXPECT_FALSE(read_budget("any(meshes).stuck_reasons['lokced']>0", info_schema()));
}

TEST(Budget, AnyIsOfOneAndAllIsOfEachAndOfSome) {
  EXPECT_TRUE(holds("any(meshes).any(levels).error>=0.5"));
  EXPECT_FALSE(holds("all(meshes).any(levels).error>=0.5"));  // the third has no level
  EXPECT_TRUE(holds("all(meshes).roots>=1"));
  EXPECT_FALSE(holds("all(meshes).roots>=2"));
  EXPECT_TRUE(holds("any(meshes).all(levels).error<=0.5"));
  EXPECT_FALSE(holds("all(uv_sets)>=0"));
  EXPECT_FALSE(holds("any(uv_sets)>=0"));
  // What an element of all(…) had before another refused is not told: the second mesh is the first that holds.
  EXPECT_EQ(judged("any(meshes).all(levels).error!=0.5"),
            "budget exceeded: any(meshes).all(levels).error!=0.5: meshes[1].levels[0].error (moss) is 0");
}

TEST(Budget, ASubscriptThatLeadsNowhereIsAnError) {
  EXPECT_EQ(judged("meshes[3].roots>1"), "meshes[3].roots>1: meshes: there is no [3]");
  EXPECT_EQ(judged("meshes['rok'].roots>1"), "meshes['rok'].roots>1: meshes: there is no 'rok'; the nearest is 'rock'");
  EXPECT_EQ(judged("any(meshes).levels[2].error<1"),
            "budget exceeded: any(meshes).levels[2].error<1: meshes[1].levels[2].error (moss) is 0.25");
  EXPECT_EQ(judged("all(meshes).levels[0].error==0"), "");
  EXPECT_EQ(judged("uv_sets[0]>1"), "uv_sets[0]>1: uv_sets: there is no [0]");
}

TEST(Budget, TheProgramKnowsItsOwnSchemas) {
  EXPECT_TRUE(read_budget("totals.bytes_per_source_triangle>10, any(meshes).stuck_groups>0, byte_map.pages.total>1, "
                          "any(meshes).any(levels).error_max>1, sections[\"PAGE\"].bytes>1, settings.preset!=best, "
                          "any(stuck).clusters>3, meshes[0].stuck_reasons[\"locked\"]>1",
                          info_schema())
                  .ok());
  EXPECT_TRUE(read_budget("file_bytes.ratio>1.02, any(meshes).levels.change!=0, picture.psnr<40, "
                          "any(meshes).any(by_level).error_max.ratio>1.05, count(materials_changed)>0, "
                          "content_equal==false, sections[\"PAGE\"].bytes.change>1KiB, any(settings).key==grid",
                          compare_schema())
                  .ok());
  const auto unknown = read_budget("totals.bytes_per_source_triangles>10", info_schema());
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.error().detail.find("the nearest is 'bytes_per_source_triangle'"), std::string::npos);
}

// A document comes from a file's names and numbers; its shape need not be the schema's.
TEST(Budget, DocumentsOfAnotherShapeAreJudgedAllTheSame) {
  const auto conditions = read_budget("any(meshes).any(levels).error>0, totals.clusters>1, count(meshes)>0", kSchema);
  ASSERT_TRUE(conditions.ok());
  for (const char* document :
       {"[]", "null", "{}", R"({"meshes":3,"totals":[]})", R"({"meshes":[1,null,[],{"levels":7}]})",
        R"({"totals":{"clusters":"many"},"meshes":{}})"}) {
    EXPECT_TRUE(judge_budget(*conditions, document).ok()) << document;
  }
  for (const char* document : {"", "{", "\xFF"}) EXPECT_FALSE(judge_budget(*conditions, document).ok()) << document;
}

TEST(Budget, OneErrorTellsAllThatHolds) {
  const auto conditions = read_budget("bytes>1,totals.clusters>1", kSchema);
  ASSERT_TRUE(conditions.ok());
  const auto broken = judge_budget(*conditions, kDocument);
  ASSERT_TRUE(broken.ok());
  const Error error = budget_error(*broken, "a.lode");
  EXPECT_EQ(error.code, ErrorCode::kCheckFailed);
  EXPECT_EQ(
      error.message(),
      "a.lode: budget exceeded: bytes>1: bytes is 1000; budget exceeded: totals.clusters>1: totals.clusters is 20");
}

}  // namespace
}  // namespace meshlode::app
