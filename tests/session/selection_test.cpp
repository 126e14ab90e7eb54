// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/painting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "lapedit/base/error.h"
#include "lapedit/mesh/region.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::selection_test {
namespace {

using Groups = std::vector<std::vector<int>>;
using Kind = RegionSpec::Kind;
using Next = Selection::Next;

constexpr int kSide = 40;
constexpr int at(int i, int j) {
  return kSide * i + j;
}
constexpr int kMiddle = at(20, 20);

/// A mesh with a selection on it, as a session holds them.
struct Chooser {
  TriangleMesh mesh = shapes::grid(kSide, kSide);
  Adjacency adjacency = support::adjacency_of(mesh);
  DragSettings settings = settings_for(mesh);
  Selection selection;
  std::unique_ptr<Region> region;
  std::string refusal;

  Chooser() {
    settings.radius = 6;
    settings.handle_fraction = 0;
  }

  Surface surface() const { return {mesh, adjacency, settings, region.get(), region && !region->distance.empty()}; }
  /// Takes a choice, and prepares for it.
  bool take(const Choice& choice) {
    if (const Refusal* refused = std::get_if<Refusal>(&choice)) {
      refusal = refused->sentence;
      return false;
    }
    selection = std::get<Selection>(choice);
    region.reset();
    try {
      region = std::make_unique<Region>(build_region(mesh, adjacency, selection.region, selection.groups));
    } catch (const EditError&) {  // no handle, or nothing but it
      if (selection.has_region) {
        region = std::make_unique<Region>(painted_region(mesh, adjacency, selection.region.vertices, selection.groups));
      }
    }
    return true;
  }
  bool pick(int vertex) { return take(lapedit::pick(surface(), selection, vertex)); }
  bool refused_with(const std::string& text) const { return refusal.find(text) != std::string::npos; }
};

std::vector<int> block(int from, int to) {
  std::vector<int> set;
  for (int i = from; i <= to; ++i) {
    for (int j = from; j <= to; ++j) {
      set.push_back(at(i, j));
    }
  }
  return set;
}

bool has(const std::vector<int>& set, int vertex) {
  return std::binary_search(set.begin(), set.end(), vertex);
}

// --- Clicks on a vertex ---------------------------------------------------------------------------------------------

TEST(Selection, FirstPickTakesARegionOfTheRadius) {
  Chooser c;
  c.settings.padding = 0.3;
  ASSERT_TRUE(c.pick(kMiddle));
  EXPECT_EQ(c.selection.groups, Groups{{kMiddle}});
  EXPECT_EQ(c.selection.active, 0);
  EXPECT_EQ(c.selection.region.kind, Kind::Radius);
  EXPECT_EQ(c.selection.region.radius, 6);
  EXPECT_EQ(c.selection.region.padding, 0.3);
  EXPECT_EQ(c.selection.taken, 1);
  EXPECT_FALSE(c.selection.by_hand);
}

TEST(Selection, PickInsideKeepsTheRegionAndItsAnchors) {
  Chooser c;
  c.pick(kMiddle);
  const Region before = *c.region;
  ASSERT_TRUE(c.pick(at(22, 21)));
  EXPECT_EQ(c.selection.groups, (Groups{{at(22, 21)}}));
  EXPECT_EQ(c.selection.region.kind, Kind::Vertices);
  EXPECT_EQ(c.selection.region.vertices, before.mesh_vertex);
  EXPECT_EQ(c.selection.region.anchors.vertices, anchors_of(before).vertices);
  EXPECT_EQ(c.selection.taken, 1);
  c.pick(at(5, 5));
  EXPECT_EQ(c.selection.region.kind, Kind::Radius);
  EXPECT_EQ(c.selection.taken, 2);
}

TEST(Selection, AnchorsThatHoldNothingOrAreNotKnownAreFoundAnew) {
  Chooser c;
  c.settings.radius = 12;
  c.settings.padding = 1;  // up to the handle's neighbours, whose weight is 1 / 12
  c.pick(kMiddle);
  c.pick(at(22, 21));
  EXPECT_EQ(c.selection.region.kind, Kind::Vertices);
  EXPECT_TRUE(c.selection.region.anchors.empty());

  Chooser unprepared;
  unprepared.pick(kMiddle);
  unprepared.region->distance.clear();
  unprepared.pick(at(22, 21));
  EXPECT_EQ(unprepared.selection.region.kind, Kind::Vertices);
  EXPECT_TRUE(unprepared.selection.region.anchors.empty());
}

TEST(Selection, AnotherGroupLeavesTheOthersAndTheRegionAsTheyAre) {
  Chooser c;
  EXPECT_FALSE(c.take(with_next_group(c.selection)));
  EXPECT_TRUE(c.refused_with("no handle"));
  c.pick(kMiddle);
  const std::vector<int> before = c.region->mesh_vertex;
  ASSERT_TRUE(c.take(with_next_group(c.selection)));
  c.settings.handle_fraction = 2.5 / c.settings.radius;
  ASSERT_TRUE(c.pick(at(22, 20)));
  ASSERT_EQ(c.selection.groups.size(), 2U);
  EXPECT_EQ(c.selection.groups[0], std::vector<int>{kMiddle});
  EXPECT_TRUE(has(c.selection.groups[1], at(21, 20)));
  EXPECT_FALSE(has(c.selection.groups[1], kMiddle));
  EXPECT_EQ(c.selection.active, 1);
  EXPECT_EQ(c.selection.next, Next::Handle);
  EXPECT_EQ(c.region->mesh_vertex, before);
  ASSERT_TRUE(c.take(with_next_group(c.selection)));
  ASSERT_TRUE(c.pick(at(33, 20)));  // outside: the region of its own radius is added
  EXPECT_EQ(c.selection.groups.size(), 3U);
  Chooser other;
  other.pick(at(33, 20));
  EXPECT_EQ(c.region->mesh_vertex, united(before, other.region->mesh_vertex));
  c.pick(at(19, 19));  // the next click is a plain one again
  EXPECT_EQ(c.selection.groups.size(), 1U);
}

TEST(Selection, RegionMadeByHandIsLeftOnlyOnDemand) {
  Chooser c;
  ASSERT_TRUE(c.take(with_region(c.surface(), c.selection, block(10, 20))));
  EXPECT_FALSE(c.pick(at(30, 30)));
  EXPECT_TRUE(c.refused_with("Vertex 1230 is outside the region"));
  EXPECT_FALSE(c.take(add_to_handle(c.surface(), c.selection, at(30, 30))));
  EXPECT_TRUE(c.pick(at(15, 15)));
  EXPECT_EQ(c.selection.region.vertices, block(10, 20));
  c.selection = with_next_region(c.selection);
  EXPECT_TRUE(c.pick(at(30, 30)));
  EXPECT_EQ(c.selection.region.kind, Kind::Radius);
  EXPECT_FALSE(c.selection.by_hand);
}

TEST(Selection, CurveLeadsOnByShortestPathsAroundOtherGroups) {
  Chooser c;
  c.settings.radius = 15;
  c.pick(at(20, 25));
  c.take(with_next_group(c.selection));
  c.selection = with_mode(c.selection, HandleMode::Curve);
  c.pick(at(20, 20));
  ASSERT_TRUE(c.pick(at(20, 30)));
  EXPECT_EQ(c.selection.groups[0], std::vector<int>{at(20, 25)});
  EXPECT_EQ(c.selection.groups[1].size(), 10U);
  EXPECT_FALSE(has(c.selection.groups[1], at(20, 25)));
  EXPECT_EQ(c.selection.curve_end, at(20, 30));
  // Nothing is left of the curve to lead on once the mode has changed.
  c.selection = with_mode(c.selection, HandleMode::Curve);
  c.pick(at(22, 20));
  EXPECT_EQ(c.selection.groups, (Groups{{at(22, 20)}}));
}

TEST(Selection, CurveStaysOnItsPieceAndInItsRegion) {
  Chooser c;
  c.take(with_region(c.surface(), with_mode(c.selection, HandleMode::Curve), block(10, 20)));
  c.pick(at(15, 18));
  EXPECT_FALSE(c.pick(at(15, 24)));
  EXPECT_TRUE(c.refused_with("4 vertices of the curve are outside the region, for example vertex 621"));

  Chooser pieces;
  pieces.mesh = shapes::two_pieces(2);
  pieces.adjacency = support::adjacency_of(pieces.mesh);
  pieces.settings = settings_for(pieces.mesh);
  pieces.selection = with_mode(pieces.selection, HandleMode::Curve);
  pieces.pick(0);
  EXPECT_FALSE(pieces.pick(static_cast<int>(pieces.mesh.vertices.rows()) - 1));
  EXPECT_TRUE(pieces.refused_with("No path along edges"));
}

TEST(Selection, WhatIsAddedToAHandleCanBeTakenAgain) {
  Chooser c;
  ASSERT_TRUE(c.take(add_to_handle(c.surface(), c.selection, kMiddle)));
  EXPECT_EQ(c.selection.groups, Groups{{kMiddle}});
  ASSERT_TRUE(c.take(add_to_handle(c.surface(), c.selection, at(21, 20))));
  EXPECT_EQ(c.selection.groups, (Groups{{kMiddle, at(21, 20)}}));
  EXPECT_FALSE(c.take(take_from_handle(c.surface(), c.selection, at(25, 20))));
  EXPECT_TRUE(c.refused_with("Vertex 1020 is in no handle"));
  ASSERT_TRUE(c.take(take_from_handle(c.surface(), c.selection, at(21, 20))));
  EXPECT_EQ(c.selection.groups, Groups{{kMiddle}});
  const std::vector<int> region = c.region->mesh_vertex;
  ASSERT_TRUE(c.take(take_from_handle(c.surface(), c.selection, kMiddle)));
  EXPECT_TRUE(c.selection.groups.empty());
  EXPECT_EQ(c.selection.active, -1);
  EXPECT_EQ(c.selection.region.kind, Kind::Vertices) << "grown by radius it would have no handle to be grown from";
  EXPECT_EQ(c.selection.region.vertices, region);
}

// --- Regions --------------------------------------------------------------------------------------------------------

TEST(Selection, BrushAddsAndTakesButNoHandle) {
  Chooser c;
  c.pick(kMiddle);
  const std::vector<int> before = c.region->mesh_vertex;
  const std::vector<int> patch = block(20, 32);
  ASSERT_TRUE(c.take(brushed(c.surface(), c.selection, BrushTarget::Region, patch, true)));
  const std::vector<int> larger = c.selection.region.vertices;
  EXPECT_TRUE(std::includes(larger.begin(), larger.end(), patch.begin(), patch.end()));
  EXPECT_TRUE(std::includes(larger.begin(), larger.end(), before.begin(), before.end()));
  EXPECT_TRUE(c.selection.by_hand);
  ASSERT_TRUE(c.take(brushed(c.surface(), c.selection, BrushTarget::Region, patch, false)));
  EXPECT_FALSE(has(c.selection.region.vertices, at(21, 21)));
  EXPECT_TRUE(has(c.selection.region.vertices, kMiddle));
  EXPECT_EQ(c.selection.groups, Groups{{kMiddle}});
  EXPECT_FALSE(std::get<Selection>(brushed(c.surface(), Selection(), BrushTarget::Region, block(0, kSide - 1), false))
                   .has_region);
}

TEST(Selection, GivenRegionKeepsTheHandlesInsideIt) {
  Chooser c;
  c.pick(kMiddle);
  c.take(with_next_group(c.selection));
  c.settings.handle_fraction = 1 / c.settings.radius;
  c.pick(at(24, 20));
  std::vector<int> given = block(22, 26);
  given.erase(std::find(given.begin(), given.end(), at(25, 20) + 4));
  std::reverse(given.begin(), given.end());
  given.push_back(at(22, 22));
  c.selection.groups[1].push_back(at(25, 22));
  ASSERT_FALSE(c.take(with_region(c.surface(), c.selection, {})));
  EXPECT_TRUE(c.refused_with("No vertices are selected"));
  for (const int outside : {-1, kSide * kSide}) {
    ASSERT_FALSE(c.take(with_region(c.surface(), c.selection, {kMiddle, outside})));
    EXPECT_TRUE(c.refused_with("1600 vertices"));
  }
  ASSERT_TRUE(c.take(with_region(c.surface(), c.selection, given)));
  EXPECT_EQ(c.selection.region.vertices.size(), 24U);
  EXPECT_TRUE(std::is_sorted(c.selection.region.vertices.begin(), c.selection.region.vertices.end()));
  EXPECT_EQ(c.selection.groups, (Groups{{at(25, 22)}}));
  EXPECT_EQ(c.selection.active, 0);
}

TEST(Selection, RingGrownIsShrunkAgainDownToTheHandles) {
  Chooser c;
  EXPECT_FALSE(c.take(grown_by_a_ring(c.surface(), c.selection)));
  EXPECT_TRUE(c.refused_with("no region yet"));
  c.pick(kMiddle);
  const std::vector<int> before = c.region->mesh_vertex;
  c.take(grown_by_a_ring(c.surface(), c.selection));
  EXPECT_GT(c.selection.region.vertices.size(), before.size());
  c.take(shrunk_by_a_ring(c.surface(), c.selection));
  EXPECT_EQ(c.selection.region.vertices, before);
  const Groups groups = c.selection.groups;
  c.selection.groups.clear();
  c.region->mesh_vertex = {kMiddle};
  EXPECT_FALSE(c.take(shrunk_by_a_ring(c.surface(), c.selection)));
  EXPECT_TRUE(c.refused_with("no vertices left"));
  c.selection.groups = groups;
  const Choice kept = shrunk_by_a_ring(c.surface(), c.selection);
  ASSERT_TRUE(std::holds_alternative<Selection>(kept));
  EXPECT_EQ(std::get<Selection>(kept).region.vertices, std::vector<int>{kMiddle});
}

TEST(Selection, ComponentIsThatOfAHandle) {
  Chooser c;
  EXPECT_FALSE(c.take(whole_component(c.surface(), c.selection)));
  EXPECT_TRUE(c.refused_with("whose component"));
  c.pick(kMiddle);
  ASSERT_TRUE(c.take(whole_component(c.surface(), c.selection)));
  EXPECT_EQ(c.region->size(), kSide * kSide);
}

TEST(Selection, AnotherPaddingLetsGoOfKeptAnchors) {
  Chooser c;
  c.pick(kMiddle);
  c.pick(at(22, 21));
  ASSERT_FALSE(c.selection.region.anchors.empty());
  EXPECT_FALSE(with_padding(c.selection, c.settings).region.anchors.empty());
  c.settings.padding = 0.3;
  const Selection other = with_padding(c.selection, c.settings);
  EXPECT_TRUE(other.region.anchors.empty());
  EXPECT_EQ(other.region.padding, 0.3);
}

TEST(Selection, StepGivesBackItsHandlesAndRegion) {
  EditStep step;
  step.region.radius = 3;
  step.handles = {{{kMiddle}, {}}, {{at(21, 21)}, {}}, {{at(19, 19)}, {}}};
  Selection before;
  before.mode = HandleMode::Curve;
  before.by_hand = true;
  const Selection after = selection_of(step, {0, 1}, before, DragSettings());
  EXPECT_EQ(after.groups.size(), 3U);
  EXPECT_EQ(after.active, 1) << "the last one that moved";
  EXPECT_EQ(after.along, std::vector<int>{0});
  EXPECT_EQ(after.region.kind, Kind::Radius);
  EXPECT_EQ(after.mode, HandleMode::Curve);
  EXPECT_FALSE(after.by_hand);
}

}  // namespace
}  // namespace lapedit::selection_test
