// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any text as a filter script: it is read or refused, and with the names of our filters it runs on a small mesh, of
// which a refusal changes nothing.
#include <vector>

#include "batch_fuzz.h"
#include "filter_laplacian_edit.h"
#include "host_mesh.h"
#include "lapedit/base/error.h"

using namespace lapedit;
using namespace lapedit::fuzz;

namespace {

/// An octahedron that every run begins with.
struct Scene {
  FilterLaplacianEdit filters;
  std::unique_ptr<host::BatchHost> batch;
  std::vector<Point3m> places;

  Scene() {
    const QString file = Host::instance().write("octahedron.off",
                                                "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"
                                                "3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n"
                                                "3 0 3 5\n");
    batch = std::make_unique<host::BatchHost>(Host::instance().plugins(), Progress());
    batch->addFilters(filters);
    batch->open(file, file);
    for (const auto& vertex : batch->mesh()->vert) {
      places.push_back(vertex.cP());
    }
  }

  bool is_as_read() const {
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (std::memcmp(batch->mesh()->vert[k].cP().V(), places[k].V(), 3 * sizeof(Scalarm)) != 0) {
        return false;
      }
    }
    return true;
  }

  bool is_finite() const {
    for (const auto& vertex : batch->mesh()->vert) {
      if (!std::isfinite(vertex.cP()[0] + vertex.cP()[1] + vertex.cP()[2])) {
        return false;
      }
    }
    return true;
  }

  void restore() {
    for (std::size_t k = 0; k < places.size(); ++k) {
      batch->mesh()->vert[k].P() = places[k];
    }
  }
};

/// The document's log grows with each run.
Scene& scene() {
  constexpr int kRuns = 200;
  static std::unique_ptr<Scene> scene;
  static int runs = 0;
  if (runs++ % kRuns == 0) {
    scene.reset();
    scene = std::make_unique<Scene>();
  }
  scene->restore();
  return *scene;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Host::instance();
  try {
    const std::vector<host::ScriptFilter> script =
        host::readScript(QByteArray(reinterpret_cast<const char*>(data), static_cast<int>(size)));
    Scene& s = scene();
    s.batch->requireFilters(script);
    if (script.size() > 3) {
      return 0;
    }
    try {
      s.batch->run(
          script, [](const host::ScriptFilter&) {}, [](const QString&) {});
      require(s.is_finite(), "a result is finite");
    } catch (const EditError&) {
      require(script.size() > 1 || s.is_as_read(), "a refused filter changes nothing");
      throw;
    }
  } catch (const EditError& error) {
    require(is_sentence(error.what()), "a refusal is a sentence");
  }
  return 0;
}
