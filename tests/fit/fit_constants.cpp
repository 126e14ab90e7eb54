// SPDX-License-Identifier: GPL-3.0-or-later
// Fits with other constants, for `tests/scripts/fit.sh --sweep`.
//
// usage: fit_constants TEMPLATE SCAN EDIT OUT [CONSTANT=VALUE]...   meshes as core_edit reads them; OUT has the points
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "lapedit/edit/fit_step.h"
#include "lapedit/json/edit_script.h"

namespace {

using namespace lapedit;

template <class Rows>
void read(std::istream& in, Rows& rows) {
  in.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(sizeof(*rows.data()) * rows.size()));
  if (!in) {
    throw std::runtime_error("The mesh ends too early.");
  }
}

TriangleMesh read_mesh(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  Eigen::Matrix<std::int32_t, 2, 1> counts;
  read(in, counts);
  TriangleMesh mesh = {Points(counts[0], 3), Faces(counts[1], 3)};
  read(in, mesh.vertices);
  read(in, mesh.faces);
  return mesh;
}

void set(FitConstants& constants, const std::string& name, double value) {
  const std::map<std::string, std::function<void()>> numbers = {
      {"first_length", [&] { constants.first_length = value; }},
      {"unmatched_weight", [&] { constants.unmatched_weight = value; }},
      {"landmark_weight", [&] { constants.landmark_weight = value; }},
      {"momentum", [&] { constants.momentum = value; }},
      {"per_length", [&] { constants.per_length = value; }},
      {"rounds", [&] { constants.rounds = static_cast<int>(value); }},
      {"average", [&] { constants.average = value; }},
      {"membrane", [&] { constants.membrane = value; }},
      {"tangential", [&] { constants.tangential = value; }},
      {"times", [&] { constants.times = value; }},
      {"most", [&] { constants.most = value; }},
      {"cosine", [&] { constants.cosine = value; }}};
  numbers.at(name)();
}

}  // namespace

int main(int count, char** arguments) try {
  const std::vector<std::string> given(arguments + 1, arguments + count);
  const TriangleMesh mesh = read_mesh(given.at(0));
  Edit edit = load_edit(given.at(2));
  for (std::size_t k = 4; k < given.size(); ++k) {
    const std::size_t sign = given[k].find('=');
    set(edit.steps.at(0).fit.value().settings.constants, given[k].substr(0, sign),
        std::stod(given[k].substr(sign + 1)));
  }
  edit = with_scans(std::move(edit), [&](const FitStep& fit) { return ScanData{read_mesh(given[1]), {}, fit.to}; });
  const EditResult result = apply_edit(mesh, edit, 1, StoredScalar::Double);
  Points points = mesh.vertices;
  for (std::size_t k = 0; k < result.vertices.size(); ++k) {
    points.row(result.vertices[k]) = result.positions.row(static_cast<Eigen::Index>(k));
  }
  std::ofstream out(given.at(3), std::ios::binary);
  out.write(reinterpret_cast<const char*>(points.data()), static_cast<std::streamsize>(sizeof(double) * points.size()));
  return out.good() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
