// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mouse, keys and buttons in any order on a small mesh. Nothing is thrown; host, session and record are the same to the
// bit; undoing all gives the mesh back, redoing all the edit; the record replays from JSON with any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <thread>

#include "drag_support.h"
#include "lapedit/json/edit_script.h"
#include "random_mesh.h"

using namespace lapedit;
using namespace lapedit::fuzz;
using support::Window;

namespace {

constexpr int kMostEvents = 60, kMostSteps = 6;

Vector3 direction(Choices& choose) {
  return {choose.below(9) - 4.0, choose.below(9) - 4.0, 0.5 + choose.below(4)};
}

DragSettings settings(Choices& choose, DragSettings result) {
  result.radius *= 0.25 * choose.below(12);
  result.padding = 0.1 * choose.below(12);
  result.handle_fraction = 0.3 * choose.below(4);
  result.falloff = static_cast<Falloff>(choose.below(4));
  result.connect_gap = choose.below(4) == 0 ? 0.25 * choose.below(8) : 0;
  result.brush_pixels = 10 * choose.below(10);
  const Setting& setting =
      settings_table()[static_cast<std::size_t>(choose.below(static_cast<int>(settings_table().size())))];
  setting.set(result.edit, choose.below(5));
  return result;
}

struct Player {
  Window window;
  Choices& choose;
  Edit saved;

  DragSession& session() { return window.session; }

  Cursor cursor() {
    const int x = choose.byte();
    Cursor result =
        x < 32 ? window.at(Vector2(25 * x, 10 * choose.below(60)))
               : window.at(choose.index(vertex_count(window.session.mesh())), Vector2(x % 9 - 4, x / 9 % 9 - 4));
    result.snap = x % 4 == 1;
    return result;
  }

  void mouse(int kind) {
    const Cursor at = cursor();
    const int held = choose.below(8);
    const PressModifiers modifiers{held == 1, held == 2};
    if (kind == 0) return void(session().hover(at, modifiers));
    if (kind == 1 || kind == 2) return void(session().press(at, modifiers));
    if (kind == 3) return session().release(at);
    if (kind == 4) {
      return void(session().key(static_cast<DragKey>(choose.below(static_cast<int>(DragKey::Redo) + 1)), at));
    }
    if (kind == 6) return session().move(at);
    // A drag in one event: else few inputs come that far.
    session().press(at, modifiers);
    session().move(cursor());
    session().release(cursor());
  }

  void button(int kind) {
    DragSession& s = session();
    const TriangleMesh& mesh = s.mesh();
    const auto key = [&](DragKey which) { s.key(which); };
    if (kind == 0) return s.set_settings(settings(choose, s.settings()));
    if (kind == 1) {
      s.set(&Tools::paint, choose.flag() ? std::optional(static_cast<BrushTarget>(choose.below(3))) : std::nullopt);
      choose.flag() ? s.change_painted(static_cast<PaintChange>(choose.below(3))) : s.leave();
      return s.set_mode(static_cast<HandleMode>(choose.below(2)));
    }
    if (kind == 2) {
      s.set(&Tools::gizmo, choose.flag());
      s.set(&Tools::axes, static_cast<GizmoAxes>(choose.below(3)));
      return s.set(&Tools::pivot, static_cast<Pivot>(choose.below(3)));
    }
    if (kind == 3) return s.set_painted(BrushTarget::Anchors, random_vertices(choose, mesh));
    if (kind == 4) return s.set_painted(BrushTarget::Region, random_vertices(choose, mesh));
    if (kind == 5) {
      const int axis = choose.below(4);
      return s.set(&Tools::mirror,
                   axis == 3 ? std::nullopt : std::optional(MirrorPlane{direction(choose), Vector3::Unit(axis)}));
    }
    if (kind == 6) return choose.flag() ? s.find_mirror() : s.leave();
    if (kind == 7) return key(choose.flag() ? DragKey::Grow : DragKey::Shrink);
    if (kind == 8) return choose.flag() ? s.whole_component() : key(DragKey::NewRegion);
    if (kind == 9) return choose.flag() ? key(DragKey::NextGroup) : s.clear();
    if (kind == 10) return choose.flag() ? key(DragKey::Apply) : s.cancel();
    if (kind == 11) return choose.flag() ? s.undo() : s.redo();
    if (kind == 12) return void(saved = s.recorded());
    if (kind == 13) return saved.steps.size() < 3 ? s.load(saved) : void();
    if (kind == 14) {
      return void(window.view = support::view_from(10 * direction(choose), mesh.vertices.row(0).transpose()));
    }
    s.finish({});
  }

  /// Until what was asked is answered. Not wait(): that is also for the pause of the mouse after which a drag is posed
  /// in full, up to a second.
  void settle() {
    while (session().state() == DragSession::State::Settling || session().preparation().running ||
           session().searching() || session().busy()) {
      std::this_thread::yield();
      session().poll();
    }
    session().poll();
  }

  /// What a window asks for while it draws. @param has_waited  so that strokes began at the known region
  void look(bool has_waited) {
    DragSession& s = session();
    require(!s.message().empty(), "there is always a message");
    const DragFigures figures = s.figures();
    require(figures.handle >= 0 && figures.free >= 0, "counts are counts");
    if (const std::optional<Gizmo> gizmo = s.gizmo(window.view)) {
      require(s.selection().active >= 0, "a gizmo is at a group");
      s.pivot_position();
    }
    s.active_map();
    if (s.shown().region() != nullptr) {
      require(s.shown().pose().rows() == s.shown().region()->size(),
              "a pose has a position for each vertex of the region");
    }
    const Selection& selection = s.selection();
    require(selection.groups.size() <= s.mirrored_groups().size() || s.mirrored_groups().empty(),
            "images come behind groups");
    require((selection.active < 0) == selection.groups.empty() &&
                selection.active < static_cast<int>(selection.groups.size()) &&
                selection.discs.curves.size() == selection.groups.size() &&
                !contains(selection.along, selection.active),
            "one group is active");
    std::vector<int> all;
    for (const std::vector<int>& group : selection.groups) {
      require(!group.empty() && std::is_sorted(group.begin(), group.end()), "groups are ascending");
      all.insert(all.end(), group.begin(), group.end());
    }
    std::sort(all.begin(), all.end());
    require(std::adjacent_find(all.begin(), all.end()) == all.end(), "groups have no vertex in common");
    require(
        !has_waited || selection.region.kind != RegionSpec::Kind::Vertices ||
            std::includes(selection.region.vertices.begin(), selection.region.vertices.end(), all.begin(), all.end()),
        "groups are in the region");
  }

  void check() {
    DragSession& s = session();
    s.finish({});
    settle();
    require(s.state() != DragSession::State::Dragging && s.state() != DragSession::State::Settling,
            "finish() leaves nothing in progress");
    require(same_bits(window.host(), s.mesh().vertices), "host and session have the same bits");
    const Points edited = s.mesh().vertices;
    const Edit edit = s.recorded();
    Points replayed = s.original().vertices;
    if (!edit.steps.empty()) {
      const EditResult result =
          apply_edit(s.original(), read_edit(write_edit(edit)), 1, StoredScalar::Float, {}, {1 + choose.below(3)});
      scatter(result.vertices, result.positions, replayed);
    }
    require(same_bits(replayed, edited), "the record replays from JSON to the same bits");
    const std::size_t actions = s.timeline().done().size();
    s.go_to(0);
    settle();
    require(same_bits(window.host(), s.original().vertices), "undoing all gives the mesh back");
    while (s.can_redo() && s.timeline().done().size() < actions) {
      s.redo();
      settle();
    }
    require(same_bits(window.host(), edited), "redoing all gives the edit back");
  }
};

/// What the window can show: else most inputs would be of no use.
TriangleMesh showable(TriangleMesh mesh) {
  mesh.vertices = mesh.vertices.unaryExpr([](double x) { return std::abs(x) < 1e6 ? x : 0.0; }).eval();
  return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Choices choose(data, size);
  const TriangleMesh mesh = showable(random_mesh(choose));
  // Waiting after each event makes a run the same each time; not waiting, events meet what is not ready yet.
  const bool waits = choose.below(4) != 0;
  Player player{Window(mesh), choose, {}};
  for (int event = 0; choose.more() && event < kMostEvents && player.session().figures().steps < kMostSteps; ++event) {
    const int kind = choose.byte();
    if (kind % 3 != 0) {
      player.mouse(kind / 3 % 7);
    } else {
      player.button(kind / 3 % 16);
    }
    player.session().poll();
    if (waits) player.settle();
    player.look(waits);
    require(player.window.host().allFinite(), "what the host is given is finite");
  }
  player.check();
  return 0;
}
