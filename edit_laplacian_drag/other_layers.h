// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <vector>

#include "lapedit/live/background_task.h"
#include "lapedit/session/snap.h"
#include "lapedit_host/tool/host_view.h"

/// The surfaces of the other visible layers, to snap to. The window's thread reads them in pieces, and another thread
/// builds their search trees, so that no event waits.
class OtherLayers {
 public:
  static constexpr std::size_t kMostAtOnce = 20000;  ///< vertices or faces that one call reads

  /// @param wake  called, on any thread, when targets() may have changed
  explicit OtherLayers(const std::function<void()>& wake) : building_(wake) {}

  /// Reads a piece if something is left to be read. Starts again if the layers' numbers of vertices or transforms have
  /// changed. It need not compare positions, since a filter that changes vertices ends the tool.
  /// @return whether to call again as soon as events have been handled
  /// @throws std::runtime_error once, if the surfaces could not be had: then there are none, until the layers change
  bool read(const std::vector<lapedit::host::Layer>& layers, int edited);
  /// Returns the surfaces; null until they are ready.
  const std::shared_ptr<const lapedit::SnapTargets>& targets() const { return targets_; }
  bool busy() const { return reading_ || building_.busy(); }
  void forget();

 private:
  struct Piece {
    CMeshO* mesh;
    lapedit::Affine toEdited;
    lapedit::TriangleMesh read = {};
    std::vector<int> number = {};  // row in `read` of each of MeshLab's vertices; -1: deleted
    std::size_t faces = 0;
    Eigen::Index vertexRows = 0, faceRows = 0;
  };
  bool readNext(const std::vector<lapedit::host::Layer>& layers, int edited);
  bool readSome(Piece& piece);
  void build();

  std::vector<double> fingerprint_;
  std::vector<Piece> pieces_;
  std::size_t next_ = 0;
  bool reading_ = false;
  std::shared_ptr<const lapedit::SnapTargets> targets_;
  lapedit::BackgroundTask<std::shared_ptr<const lapedit::SnapTargets>> building_;
};
