// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlay.h"

#include <algorithm>
#include <cmath>

#include "lapedit/mesh/vertex_set.h"

using namespace lapedit;

namespace {

constexpr unsigned kNone = ~0U;
constexpr std::size_t kMostMovingFaces = 12000;

/// Returns the stipple of diagonal lines, eight pixels apart.
const GLubyte* hatch() {
  static const std::array<GLubyte, 128> pattern = [] {
    std::array<GLubyte, 128> bits{};
    for (std::size_t i = 0; i < bits.size(); ++i) {
      bits[i] = static_cast<GLubyte>(0xE0E0U << i / 4 % 8 >> 8);  // each row is shifted by one
    }
    return bits;
  }();
  return pattern.data();
}

/// Makes the lines that follow dashed.
void beginDashes() {
  glEnable(GL_LINE_STIPPLE);
  glLineStipple(static_cast<GLint>(std::ceil(pen::pixelRatio)), 0x0FF0);
}

void tint(const std::vector<unsigned>& corners, const pen::Color& color, double alpha) {
  pen::set(color, alpha);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(corners.size()), GL_UNSIGNED_INT, corners.data());
}

/// Draws faces with a tint and, over it, a hatch. Then lines and points may follow.
void faces(const std::vector<unsigned>& corners, const pen::Color& color, double alpha, const pen::Color& hatched,
           double hatchAlpha) {
  glDepthRange(0, 1);
  glEnable(GL_POLYGON_OFFSET_FILL);
  tint(corners, color, alpha);
  if (hatchAlpha > 0) {
    glEnable(GL_POLYGON_STIPPLE);
    tint(corners, hatched, hatchAlpha);
    glDisable(GL_POLYGON_STIPPLE);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDepthRange(0, pen::kAbove);
}

/// Draws lines. Fills the joints of wide lines if they are opaque; in other lines the fillings would be visible.
void drawChains(const Chains& chains, const pen::Color& color, double width, double alpha = 1, bool opaque = true) {
  pen::set(color, alpha);
  pen::setWidth(width);
  const unsigned* at = chains.vertices.data();
  for (const int length : chains.lengths) {
    glDrawElements(GL_LINE_STRIP, length, GL_UNSIGNED_INT, at);
    at += length;
  }
  if (opaque && width > 2) {
    pen::setSize(width);
    glDrawElements(GL_POINTS, static_cast<GLsizei>(chains.vertices.size()), GL_UNSIGNED_INT, chains.vertices.data());
  }
}

void points(const std::vector<unsigned>& indices, const pen::Color& color, double size, double alpha,
            bool rimmed = true) {
  pen::dots(color, size, alpha, rimmed,
            [&] { glDrawElements(GL_POINTS, static_cast<GLsizei>(indices.size()), GL_UNSIGNED_INT, indices.data()); });
}

}  // namespace

pen::Color stretchColor(float stretch) {
  constexpr pen::Color kLonger[] = {pen::kLight, pen::kYellow, pen::kVermillion, {94, 0, 36}};
  constexpr pen::Color kShorter[] = {pen::kLight, pen::kSkyBlue, pen::kBlue, {0, 18, 74}};
  const pen::Color* const stops = stretch > 0 ? kLonger : kShorter;
  // Colours at a half, one and two doublings or halvings.
  const float doublings = std::min(std::log2(1 + std::abs(stretch)), 2.0F);
  const float position = doublings < 1 ? 2 * doublings : 1 + doublings;
  const int stop = std::min(static_cast<int>(position), 2);
  pen::Color color;
  for (int k = 0; k < 3; ++k) {
    const float from = stops[stop][k], to = stops[stop + 1][k];
    color[k] = static_cast<unsigned char>(from + (position - static_cast<float>(stop)) * (to - from));
  }
  return color;
}

// --- Lists ----------------------------------------------------------------------------------------------------------

unsigned SurfacePicture::number(const Region* region, int vertex) const {
  if (region) {
    if (const int position = index_in(region->mesh_vertex, vertex); position >= 0) {
      return static_cast<unsigned>(position);
    }
  }
  const int position = index_in(outside_, vertex);
  return position >= 0 ? static_cast<unsigned>(position + (region ? region->size() : 0)) : kNone;
}

/// Returns whether the lists are those of the session's region and groups.
bool SurfacePicture::isListed(const DragSession& session) const {
  const std::vector<std::vector<int>>& groups = session.mirrored_groups();
  return session.shown().region_serial() == regionSerial_ && labelled_.size() == groups.size() + 2 &&
         std::equal(groups.begin(), groups.end(), labelled_.begin()) &&
         labelled_[groups.size()] == session.unconnected() && labelled_.back() == session.selection().held;
}

/// Sorts vertices and faces into the lists that draw() uses. O(mesh).
void SurfacePicture::list(const DragSession& session) {
  const Region* const region = session.shown().region().get();
  regionSerial_ = session.shown().region_serial();
  poseSerial_ = -1;
  stretch_ = nullptr;
  labelled_ = session.mirrored_groups();
  labelled_.push_back(session.unconnected());
  labelled_.push_back(session.selection().held);
  outside_.clear();
  for (const std::vector<int>& vertices : labelled_) {
    outside_.insert(outside_.end(), vertices.begin(), vertices.end());
  }
  outside_ = without(sorted_set(std::move(outside_)), region ? region->mesh_vertex : std::vector<int>());

  // A vertex of a handle has the handle's label.
  std::vector<int> labels(static_cast<std::size_t>(session.mesh().vertices.rows()), -1);
  for (std::size_t label = labelled_.size(); label-- > 0;) {
    for (const int v : labelled_[label]) {
      labels[v] = static_cast<int>(label);
    }
  }
  patches_.assign(labelled_.size(), {});
  listRegion(region, labels);
  for (std::size_t g = 0; g < patches_.size(); ++g) {
    listGroup(session, static_cast<int>(g), labels);
  }
  for (std::size_t g = 0; g < session.selection().groups.size(); ++g) {
    const HandleCurve& curve = session.selection().discs.curves[g];
    for (std::size_t k = 0; curve.bends() && k < curve.points.size(); ++k) {
      patches_[g].points.push_back(number(region, curve.path[curve.points[k]]));
    }
  }
}

/// Assigns the faces that no group has to the anchors or to the free vertices, and finds the outlines.
void SurfacePicture::listRegion(const Region* region, const std::vector<int>& labels) {
  free_ = band_ = Patch();
  std::vector<unsigned> inside, within;  // corners of all faces; of those that are not in the band
  for (Eigen::Index f = 0; region && f < region->faces.rows(); ++f) {
    const int* const corners = region->faces.row(f).data();
    const auto label = [&](int k) { return labels[region->mesh_vertex[corners[k]]]; };
    const bool ofGroup = label(0) >= 0 && label(1) == label(0) && label(2) == label(0);
    const bool ofBand =
        !ofGroup && std::any_of(corners, corners + 3, [&](int i) { return region->classes[i] == VertexClass::Anchor; });
    inside.insert(inside.end(), corners, corners + 3);
    if (!ofBand) {
      within.insert(within.end(), corners, corners + 3);
    }
    if (!ofGroup) {
      std::vector<unsigned>& faces = ofBand ? band_.faces : free_.faces;
      faces.insert(faces.end(), corners, corners + 3);
    }
  }
  rim_ = border_of(inside);
  free_.border = band_.faces.empty() ? Chains() : border_of(within);
}

/// Lists the faces of a group, and single vertices and curves, which have no faces.
void SurfacePicture::listGroup(const DragSession& session, int group, const std::vector<int>& labels) {
  const Region* const region = session.shown().region().get();
  const Adjacency& adjacency = session.adjacency();
  const Faces& faces = session.mesh().faces;
  const auto isOfGroup = [&](int f) {
    return labels[faces(f, 0)] == group && labels[faces(f, 1)] == group && labels[faces(f, 2)] == group;
  };
  const auto hasFace = [&](int v) {
    const CompressedRows::Row around = adjacency.faces[v];
    return std::any_of(around.begin(), around.end(), isOfGroup);
  };
  Patch& patch = patches_[static_cast<std::size_t>(group)];
  for (const int v : labelled_[static_cast<std::size_t>(group)]) {
    for (const int f : adjacency.faces[v]) {
      for (int k = 0; k < 3 && isOfGroup(f) && faces.row(f).minCoeff() == v; ++k) {
        patch.faces.push_back(number(region, faces(f, k)));
      }
    }
  }
  patch.border = border_of(patch.faces);
  for (const int v : labelled_[static_cast<std::size_t>(group)]) {
    if (labels[v] != group || hasFace(v)) {
      continue;
    }
    patch.loose.push_back(number(region, v));
    for (const int w : adjacency.neighbours[v]) {
      if (labels[w] == group && (v < w || hasFace(w))) {
        patch.border.vertices.insert(patch.border.vertices.end(), {number(region, v), number(region, w)});
        patch.border.lengths.push_back(2);
      }
    }
  }
}

void SurfacePicture::takePositions(const DragSession& session) {
  const std::size_t inside = session.shown().region() ? static_cast<std::size_t>(session.shown().region()->size()) : 0;
  positions_.resize(3 * (inside + outside_.size()));
  if (session.shown().serial() != poseSerial_ && inside > 0) {
    std::copy(session.shown().pose().data(), session.shown().pose().data() + 3 * inside, positions_.begin());
  }
  poseSerial_ = session.shown().serial();
  for (std::size_t i = 0; i < outside_.size(); ++i) {
    const double* const position = session.mesh().vertices.row(outside_[i]).data();
    std::copy(position, position + 3, positions_.begin() + static_cast<std::ptrdiff_t>(3 * (inside + i)));
  }
}

// --- Drawing --------------------------------------------------------------------------------------------------------

void SurfacePicture::draw(const DragSession& session, int hovered, Colours colours) {
  if (!isListed(session)) {
    list(session);
  }
  takePositions(session);
  glDisableClientState(GL_NORMAL_ARRAY);
  glDisableClientState(GL_TEXTURE_COORD_ARRAY);
  glDisableClientState(GL_COLOR_ARRAY);
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, positions_.data());
  glPolygonOffset(0, -4);  // without a slope, which would show the far side at silhouettes
  glPolygonStipple(hatch());
  if (session.shown().region()) {
    drawRegion(session, colours);
  }
  const std::size_t groups = patches_.size() - 2;
  for (std::size_t g = 0; g < groups; ++g) {
    drawGroup(session, g, session.group_of_image(static_cast<int>(g)) == hovered, colours);
  }
  const auto marked = [&](const Patch& patch, const pen::Color& color, double alpha, double hatchAlpha,
                          const pen::Color& outline) {
    faces(patch.faces, color, alpha, pen::kDark, hatchAlpha);
    drawChains(patch.border, outline, 1.5);
    points(patch.loose, outline, 4, 1);
  };
  marked(patches_[groups], pen::kLight, 0.35, 0.6, pen::kGrey);  // not connected
  marked(patches_.back(), pen::kAnchor, session.motion() ? 0.35 : 0.6, 0.35, pen::kAnchor);
  glDepthRange(0, 1);
  glDisableClientState(GL_VERTEX_ARRAY);
}

void SurfacePicture::drawRegion(const DragSession& session, Colours colours) {
  const bool moving = session.motion() != nullptr;
  glDepthRange(0, 1);
  glEnable(GL_POLYGON_OFFSET_FILL);
  if (colours == Colours::Stretch) {
    drawHeat(session);
  } else if (colours != Colours::None) {
    // During a motion the tint is paler, so that the surface is easier to see. Large regions have none, since
    // frames are faster without.
    if (!moving || free_.faces.size() <= 3 * kMostMovingFaces) {
      tint(free_.faces, pen::kFree, moving ? 0.15 : 0.42);
    }
    tint(band_.faces, pen::kAnchor, moving ? 0.2 : 0.45);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDepthRange(0, pen::kAbove);
  drawChains(free_.border, pen::kAnchor, 1.5, 0.8, false);
  drawChains(rim_, pen::kDark, 3.5, 0.7, false);
  if (session.preparation().running) {
    beginDashes();
  }
  drawChains(rim_, pen::kLight, 1.5, 0.95, false);
  glDisable(GL_LINE_STIPPLE);
}

void SurfacePicture::drawHeat(const DragSession& session) {
  const Region& region = *session.shown().region();
  if (!stretch_) {
    stretch_ = std::make_unique<VertexStretch>(region, session.original().vertices);
    heat_.resize(4 * static_cast<std::size_t>(region.size()));
  }
  const std::vector<float>& stretch = stretch_->of(session.shown().pose());
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    const pen::Color color = stretchColor(stretch[i]);
    std::copy(color.begin(), color.end(), &heat_[4 * i]);
    // Vertices without stretch are nearly transparent.
    heat_[4 * i + 3] = static_cast<unsigned char>(70 + 120 * std::min(std::abs(stretch[i]), 1.0F));
  }
  glEnableClientState(GL_COLOR_ARRAY);
  glColorPointer(4, GL_UNSIGNED_BYTE, 0, heat_.data());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(region.faces.size()), GL_UNSIGNED_INT, region.faces.data());
  glDisableClientState(GL_COLOR_ARRAY);
  drawFolds(session);
}

/// Draws folded triangles, also through the surface.
void SurfacePicture::drawFolds(const DragSession& session) {
  const auto report = session.figures().report;
  std::vector<unsigned> folds;
  for (const auto& fold : report ? report->causes.folds : std::vector<std::array<int, 3>>()) {
    const Region* const region = session.shown().region().get();
    const unsigned corners[] = {number(region, fold[0]), number(region, fold[1]), number(region, fold[2])};
    if (std::find(corners, corners + 3, kNone) == corners + 3) {
      folds.insert(folds.end(), corners, corners + 3);
    }
  }
  tint(folds, pen::kRed, 1);
  glDisable(GL_DEPTH_TEST);
  tint(folds, pen::kRed, 0.5);
  glEnable(GL_DEPTH_TEST);
}

/// Draws a handle group: with a bright outline if it moves, hatched if it holds.
void SurfacePicture::drawGroup(const DragSession& session, std::size_t group, bool hovered, Colours colours) {
  const Patch& patch = patches_[group];
  const int given = session.group_of_image(static_cast<int>(group));
  const pen::Color color = pen::groupColor(static_cast<std::size_t>(given));
  const bool active = session.selection().moves(given);
  const bool moving = session.motion() != nullptr;
  // Without a pose, draw the group at its target.
  const bool ahead = session.selection().moves(static_cast<int>(group)) && moving &&
                     (!session.shown().region() || !session.preparation().has_preview);
  if (ahead) {
    Eigen::Matrix4d map = Eigen::Matrix4d::Identity();
    map.topRows<3>() = session.active_map().matrix();
    glPushMatrix();
    glMultMatrixd(map.data());
    glDisable(GL_DEPTH_TEST);
  }
  if (colours != Colours::None) {
    faces(patch.faces, color, (active && !moving ? 0.5 : 0.25) + (hovered ? 0.2 : 0), color,
          active   ? 0
          : moving ? 0.45
                   : 0.7);
  }
  glDepthRange(0, pen::kAbove);
  // Loose vertices next to faces of the group get no mark of their own.
  const bool alone = patch.faces.empty();
  const double size = !alone ? 4 : patch.loose.size() == 1 ? 9 : 6;
  const auto outline = [&](double width, double alpha) {
    const auto line = [&](double pixels, const pen::Color& drawn, double opacity) {
      drawChains(patch.border, drawn, pixels, opacity * alpha, alpha == 1 && active);
    };
    line(width + 2, pen::kDark, 0.85);
    const bool bright = active || hovered;
    if (!bright || (session.preparation().running && !session.shown().region())) {
      beginDashes();
    }
    line(width, bright ? pen::kLight : color, 1);
    glDisable(GL_LINE_STIPPLE);
    if (bright) {
      line(width - 2, color, 1);
    }
  };
  const double width = active || hovered ? 4 : 1.5;
  if (active) {  // visible through the surface
    glDisable(GL_DEPTH_TEST);
    outline(width, 0.25);
    points(patch.loose, color, size, 0.25, alone);
  }
  if (!ahead) {
    glEnable(GL_DEPTH_TEST);
  }
  outline(width, 1);
  points(patch.loose, color, size, 1, alone);
  points(patch.points, color, 9, 1);
  if (ahead) {
    glEnable(GL_DEPTH_TEST);
    glPopMatrix();
  }
}
