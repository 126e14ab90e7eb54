// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small mesh and an edit of it. The result is finite and what the mesh can store; what is refused says why; it has
// the same bits with any number of threads, beside other fractions and read from JSON; fraction 0 is the mesh.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/edit/edit.h"
#include "lapedit/edit/positions.h"
#include "lapedit/json/edit_script.h"
#include "random_mesh.h"

using namespace lapedit;
using namespace lapedit::fuzz;

namespace {

Vector3 vector(Choices& choose) {
  const double x = choose.real(), y = choose.real();
  return {x, y, choose.real()};
}

HandleTransform transform(Choices& choose) {
  HandleTransform result;
  const int kind = choose.below(16);
  result.translation = vector(choose);
  if (kind == 0) {
    result.matrix.emplace();
    for (int k = 0; k < 12; ++k) (*result.matrix)(k / 4, k % 4) = choose.real();
  }
  if ((kind & 1) != 0) {
    result.axis = vector(choose);
    result.degrees = 100 * choose.real();
  }
  if ((kind & 2) != 0) result.scale = choose.real();
  if ((kind & 4) != 0) result.center = vector(choose);
  return result;
}

RegionSpec region(Choices& choose, const TriangleMesh& mesh) {
  RegionSpec result;
  const int kind = choose.below(4);
  if (kind == 0) {
    result.kind = RegionSpec::Kind::Component;
  } else if (kind == 1) {
    result.kind = RegionSpec::Kind::Vertices;
    result.vertices = random_vertices(choose, mesh);
    if (choose.flag()) {
      result.anchors.vertices = random_vertices(choose, mesh);
      for (std::size_t k = 0; k < result.anchors.vertices.size(); ++k) {
        result.anchors.weights.push_back(choose.below(5) / 4.0);
        result.anchors.depths.push_back(choose.below(5) / 4.0);
      }
      result.anchors.reach = choose.real();
    }
  } else {
    result.radius = choose.real();
  }
  if (choose.flag()) {
    result.padding = choose.below(11) / 10.0;
    result.connect_gap = choose.below(4) == 0 ? choose.real() : 0;
  }
  return result;
}

EditSettings settings(Choices& choose) {
  EditSettings result;
  if (choose.below(4) == 0) result = EditSettings::of(EditMethod::Paper);
  for (int k = choose.below(4); k > 0; --k) {
    const Setting& setting =
        settings_table()[static_cast<std::size_t>(choose.below(static_cast<int>(settings_table().size())))];
    const bool is_choice = setting.kind == Setting::Kind::Choice;
    if (is_choice || setting.kind == Setting::Kind::Whole) {
      setting.set(result, choose.below(is_choice ? static_cast<int>(setting.choices.size()) : 5));
    } else {
      setting.set(result, choose.flag() ? choose.byte() : choose.real());
    }
  }
  return result;
}

Edit edit_of(Choices& choose, const TriangleMesh& mesh) {
  Edit edit;
  for (int steps = 1 + choose.below(2); steps > 0; --steps) {
    EditStep step;
    for (int groups = 1 + choose.below(8) / 6; groups > 0; --groups) {
      HandleGroup group{random_vertices(choose, mesh), transform(choose)};
      for (std::size_t k = choose.below(8) == 0 ? group.vertices.size() : 0; k > 0; --k) {
        group.weights.push_back((1 + choose.below(4)) / 4.0);
      }
      step.handles.push_back(std::move(group));
    }
    step.region = region(choose, mesh);
    step.settings = settings(choose);
    if (choose.below(8) == 0) step.mirror = MirrorPlane{vector(choose), vector(choose)};
    edit.steps.push_back(std::move(step));
  }
  return edit;
}

/// Points near vertices, or far from all.
VertexQuery positions(Choices& choose, const TriangleMesh& mesh) {
  const auto point = [&] {
    const Vector3 vertex = mesh.vertices.row(choose.index(vertex_count(mesh)));
    return choose.below(4) == 1 ? vector(choose) : vertex;
  };
  VertexQuery result;
  const int kind = choose.below(3);
  result.selected = kind == 0;
  if (kind == 1) result.within = VertexQuery::Disc{point(), choose.real()};
  for (int k = kind == 2 ? choose.below(5) : -1; k >= 0; --k) result.points.push_back(point());
  return result;
}

/// Says of some handles and regions where they are, instead of their vertices. @return the edit, located again
/// @throws EditError
Edit by_position(Choices& choose, const TriangleMesh& mesh, Edit edit) {
  for (EditStep& step : edit.steps) {
    for (HandleGroup& group : step.handles) {
      if (choose.flag()) {
        group.query = positions(choose, mesh);
        group.vertices.clear();
        group.weights.clear();
        const bool has_targets = choose.flag() && !group.query.points.empty();
        group.transform = has_targets ? HandleTransform() : group.transform;
        for (std::size_t k = has_targets ? group.query.points.size() : 0; k > 0; --k) {
          group.targets.push_back(vector(choose));
          group.names.emplace_back("point");
          group.weights.push_back((1 + choose.below(4)) / 4.0);
        }
      }
    }
    if (choose.flag()) {
      step.region.kind = RegionSpec::Kind::Vertices;
      step.region.vertices.clear();
      step.region_query = positions(choose, mesh);
    }
  }
  validate(mesh);
  const Adjacency adjacency = build_adjacency(vertex_count(mesh), mesh.faces);
  edit = located(mesh, adjacency, edit, {random_vertices(choose, mesh), random_vertices(choose, mesh)});
  return choose.flag() ? located(mesh, adjacency, with_positions(mesh, adjacency, edit)) : edit;
}

/// Replaces mesh and edit by a grid with thousands of small handle groups.
void take_many_groups(Choices& choose, TriangleMesh& mesh, Edit& edit) {
  mesh = shapes::grid(40 + choose.below(40), 40);
  edit.steps.resize(1);
  EditStep& step = edit.steps[0];
  step = EditStep();
  step.region.kind = choose.flag() ? RegionSpec::Kind::Component : RegionSpec::Kind::Radius;
  step.region.radius = 1 + choose.below(5);
  const int stride = 1 + choose.below(3), largest = choose.below(4);
  for (int first = 0, size = 1; first + size <= vertex_count(mesh); first += size + stride - 1) {
    size = 1 + (largest > 0 ? first % largest : 0);
    HandleGroup group;
    for (int v = first; v < std::min(first + size, vertex_count(mesh)); ++v) group.vertices.push_back(v);
    group.transform.translation = Vector3(0, 0, first % 7 / 8.0);
    step.handles.push_back(std::move(group));
  }
}

/// The same edit after it was text; nothing if it cannot be one.
std::optional<Edit> reread(const Edit& edit) {
  try {
    return read_edit(write_edit(edit));
  } catch (const EditError&) {
    return {};
  }
}

void check_result(const TriangleMesh& mesh, const EditResult& result) {
  require(result.positions.allFinite(), "a result is finite");
  require(result.positions == result.positions.cast<float>().cast<double>(), "a result fits into single precision");
  require(result.positions.rows() == static_cast<Eigen::Index>(result.vertices.size()), "a position for each vertex");
  require(
      std::is_sorted(result.vertices.begin(), result.vertices.end(), std::less_equal<>()) &&
          (result.vertices.empty() || (result.vertices.front() >= 0 && result.vertices.back() < vertex_count(mesh))),
      "vertices are ascending and in the mesh");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Choices choose(data, size);
  TriangleMesh mesh = random_mesh(choose);
  const int threads = 1 + choose.below(3);
  const double fraction = choose.below(9) / 8.0;
  Edit edit = edit_of(choose, mesh);
  if (choose.below(3) == 1) {
    try {
      edit = by_position(choose, mesh, std::move(edit));
    } catch (const EditError& error) {
      require(std::strlen(error.what()) > 10, "a refusal is a sentence");
      return 0;
    }
  }
  if (choose.below(64) == 63) take_many_groups(choose, mesh, edit);
  const TriangleMesh before = mesh;

  EditResult alone;
  std::string refusal;
  try {
    alone = apply_edit(mesh, edit, 1, StoredScalar::Float);
    check_result(mesh, alone);
  } catch (const EditError& error) {
    refusal = error.what();
    require(refusal.size() > 10, "a refusal is a sentence");
  }
  const std::optional<Edit> again = reread(edit);
  if (!again) return 0;
  try {
    validate(mesh);
    const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
    const std::vector<EditResult> poses =
        apply_edit(mesh, adjacency, *again, {}, {0, 1, fraction}, StoredScalar::Float, {}, {threads});
    require(refusal.empty(), "what is refused alone is refused beside other fractions");
    for (const EditResult& pose : poses) check_result(mesh, pose);
    for (std::size_t k = 0; k < poses[0].vertices.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      // But for the sign of a zero.
      require(poses[0].positions.row(row) == mesh.vertices.row(poses[0].vertices[k]), "fraction 0 is the mesh");
    }
    require(poses[1].vertices == alone.vertices, "the same vertices alone and beside other fractions");
    require(same_bits(poses[1].positions, alone.positions), "the same bits with any threads, from JSON, beside others");
  } catch (const EditError& error) {
    // A second step may not fit to what is left of the first.
    const bool refused = !refusal.empty() || edit.steps.size() > 1;
    require(refused || std::strstr(error.what(), "At fraction") != nullptr, "what is done alone is done beside others");
    if (!refused && std::strstr(error.what(), "At fraction 0:") != nullptr) {
      std::fprintf(stderr, "%s\n", error.what());
      require(false, "what is done in full is done at fraction 0");
    }
  }
  require(same_bits(mesh.vertices, before.vertices) && mesh.faces == before.faces, "the mesh is not touched");
  return 0;
}
