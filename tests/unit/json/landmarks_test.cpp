// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/landmarks.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "script_support.h"
#include "temporary_folder.h"

namespace lapedit::landmarks_test {
namespace {

/// As MeshLab writes it.
constexpr char kPicked[] = R"(<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData>
  <DateTime date="2026-11-24" time="04:00:00"/>
  <User name="user > root"/>
  <DataFileName name="head.ply"/>
 </DocumentData>
 <!-- <point x="9" y="9" z="9" active="1" name="comment"/> -->
 <point x="0.25" y='-1' z="1e-3" active="1" name="nose &amp; tip"/>
 <point z="3" x="1" name="chin" y="2" active="1"/>
 <point x="0" y="0" z="0" active="0" name="not picked"/>
</PickedPoints>
)";

/// As 3D Slicer writes them.
constexpr char kFiducials[] = R"(# Markups fiducial file version = 4.11
# CoordinateSystem = LPS
# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID
1,0.25,-1,0.001,0,0,0,1,1,1,0,nose & tip,,,2,0
2,1,2,3,0,0,0,1,1,1,0,"chin",,,2,0
)";
constexpr char kMarkups[] =
    R"({"@schema": "https://raw.githubusercontent.com/slicer/Slicer/main/markups-schema-v1.0.3.json#",
 "markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "controlPoints": [
  {"id": "1", "label": "nose & tip", "position": [0.25, -1, 1e-3], "positionStatus": "defined"},
  {"id": "2", "label": "chin", "position": [1.0, 2.0, 3.0]},
  {"id": "3", "label": "not placed", "position": [], "positionStatus": "undefined"}]}]})";

using Named = std::vector<std::pair<std::string, Vector3>>;

Named read(const std::string& text, const std::string& name) {
  Named all;
  for (const Landmark& landmark : read_landmarks(text, name).landmarks) {
    all.emplace_back(landmark.name, landmark.point);
  }
  return all;
}

const Named kBoth = {{"nose & tip", {0.25, -1, 0.001}}, {"chin", {1, 2, 3}}};

TEST(Landmarks, AllFormatsAreRead) {
  EXPECT_EQ(read(kPicked, "a.pp"), kBoth);
  EXPECT_EQ(read(kFiducials, "a.fcsv"), kBoth);
  EXPECT_EQ(read_landmarks(kFiducials, "a.fcsv").system, "LPS");
  EXPECT_EQ(read_landmarks("#\n#=\n# columnss\n# coordinatesystem=ras\n1,1,2,3,0,0,0,1,1,1,0,a\n", "a.fcsv").system,
            "RAS");
  EXPECT_EQ(read(kMarkups, "A.MRK.JSON"), kBoth);
  EXPECT_EQ(read_landmarks(kMarkups, "a.mrk.json").system, "LPS");
  EXPECT_EQ(read("nose & tip,0.25,-1,1e-3\nchin,1,2,3\n", "a.csv"), kBoth);
  EXPECT_EQ(read("\xEF\xBB\xBFX;Name;Y;Z\r\n0.25;\"nose & tip\";-1;1e-3\r\n\r\n# comment\r\n+1;chin;2;3", "a.csv"),
            kBoth);
  EXPECT_EQ(read("0.25,-1,1e-3\n1,2,3\n", "a.csv"), (Named{{"1", {0.25, -1, 0.001}}, {"2", {1, 2, 3}}}));
}

std::string refusal(const std::string& text, const std::string& name) {
  return refusal_of([&] { read_landmarks(text, name); });
}

TEST(Landmarks, WhatIsWrongIsSaidWithPlaceAndName) {
  expect_contains(refusal("", "a.csv"), "\"a.csv\" has no landmarks");
  expect_contains(refusal("name,x,y,z\n", "a.csv"), "\"a.csv\" has no landmarks");
  expect_contains(refusal("a,0,0,nan\n", "a.csv"), "\"a.csv\", line 1: the z of landmark \"a\" is \"nan\"");
  expect_contains(refusal("a,0,inf,0\n", "a.csv"), "line 1: the y of landmark \"a\" is \"inf\"");
  expect_contains(refusal("a;0,5;0;0\n", "a.csv"), "the x of landmark \"a\" is \"0,5\"; give a finite number with a");
  expect_contains(refusal("a,0,0,0\nb,0,0\n", "a.csv"), "line 2: has 3 columns, but 4 are needed");
  expect_contains(refusal("a 0 0 0\n", "a.csv"),
                  "line 1: has 1 column; give name, x, y and z with commas, semicolons or tabs");
  expect_contains(refusal("a,0\n", "a.csv"), "line 1: has 2 columns");
  expect_contains(refusal(std::string(1000, ','), "a.csv"), "line 1: has more than 1000 columns");
  expect_contains(refusal("a,0,0,0\n\na,1,0,0\n", "a.csv"), "line 3: there are two landmarks \"a\"");
  expect_contains(refusal(",0,0,0\n", "a.csv"), "line 1: the landmark has no name");
  expect_contains(refusal("a,0,0,0\n", "a.txt"), "has no suffix of a landmark file");
  expect_contains(refusal("label,r,a,s,defined\na,0,0,0,0\n", "a.csv"), "\"a.csv\" has no landmarks");
  expect_contains(refusal("label,r,a,s,defined\na,0,0,0\n", "a.csv"), "line 2: has 4 columns, but 5 are needed");
  expect_contains(refusal("", "a.pp"), "has no element PickedPoints");
  expect_contains(refusal("<PickedPoints></PickedPoints>", "a.pp"), "has no landmarks");
  expect_contains(refusal("<PickedPoints>\n<point x=\"1\" y=\"2\" name=\"a\"/>", "a.pp"),
                  "line 2: the z of landmark \"a\"");
  expect_contains(refusal("<PickedPoints><point x=\"1", "a.pp"), "is truncated within an element");
  expect_contains(refusal("<PickedPoints>\n<point x=\"1\" y=\"2\" z=\"3\" name=\"a\"/>\n", "a.pp"),
                  "\"a.pp\": is truncated after landmark \"a\"; save it again");
  expect_contains(refusal("1,0,0,zero,0,0,0,1,1,1,0,a\n", "a.fcsv"), "line 1: the z of landmark \"a\" is \"zero\"");
  expect_contains(refusal("# columns = a,b\n1,2\n", "a.fcsv"), "columns are not named x, y, z and label");
  expect_contains(refusal("{}", "a.json"), "no list markups");
  expect_contains(refusal("{", "a.json"), "\"a.json\": ");
  expect_contains(refusal(R"({"markups": [{"coordinateSystem": "RAS", "controlPoints": []},
                              {"coordinateSystem": "LPS", "controlPoints": []}]})",
                          "a.json"),
                  "\"a.json\": markups[1]: is in LPS coordinates, the list before in RAS; save them in one system.");
  expect_contains(refusal(R"({"markups": [{}]})", "a.json"), "markups[0]: has no list controlPoints");
  expect_contains(refusal(R"({"markups": [{"controlPoints": [{}]}]})", "a.json"), "controlPoints[0]: has no label");
  expect_contains(refusal(R"({"markups": [{"controlPoints": [{"label": "a", "position": [1, 2]}]}]})", "a.json"),
                  "the position of landmark \"a\" is not three numbers");
  expect_contains(refusal(R"({"markups": [{"controlPoints": [{"label": "a", "position": [1, 2, "NaN"]}]}]})", "a.json"),
                  "the z of landmark \"a\"");
}

class LandmarkFiles : public TemporaryFolder {
 protected:
  static std::string refusal(const std::string& from, const std::string& to) {
    return refusal_of([&] { load_landmarks(from, to); });
  }
};

TEST_F(LandmarkFiles, ArePairedByName) {
  const HandleGroup group = load_landmarks(write("a.pp", kPicked), write("b.csv", "chin,7,8,9\nnose & tip,4,5,6\n"));
  EXPECT_EQ(group.names, (std::vector<std::string>{"nose & tip", "chin"}));
  EXPECT_EQ(group.query.points, (std::vector<Vector3>{kBoth[0].second, kBoth[1].second}));
  EXPECT_EQ(group.targets, (std::vector<Vector3>{{4, 5, 6}, {7, 8, 9}}));
}

TEST_F(LandmarkFiles, WhatHasNoPartnerIsNamed) {
  const std::string one = write("one.csv", "a,0,0,0\nb,0,0,0\n"), two = write("two.csv", "a,0,0,0\nc,0,0,0\nd,0,0,0\n");
  const std::string sentence = refusal(one, two);
  expect_contains(sentence, "\"b\" is only in");
  expect_contains(sentence, "\"c\", \"d\" are only in");
  std::string many;
  for (int k = 0; k < 9; ++k) {
    many += "p" + std::to_string(k) + ",0,0,0\n";
  }
  expect_contains(refusal(write("many.csv", many + "a,0,0,0\n"), write("a.csv", "a,0,0,0\n")), "\"p4\" and 4 more");
}

}  // namespace
}  // namespace lapedit::landmarks_test
