// SPDX-License-Identifier: GPL-3.0-or-later
#include "host/read_back.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <exception>
#include <vector>

#include "lapedit/mesh/vertex_grid.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {
namespace {

ReadBack compared(const CMeshO& mesh, const CMeshO& file) {
  ReadBack result = {file.vn, file.fn, 0};
  std::vector<Vector3> found;
  for (const auto& vertex : file.vert) {
    if (!vertex.IsD() && is_finite(vertex.cP())) {
      found.push_back(to_core(vertex.cP()));
    }
  }
  Points places(static_cast<int>(found.size()), 3);
  std::vector<int> numbers(found.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    places.row(static_cast<int>(k)) = found[k].transpose();
    numbers[k] = static_cast<int>(k);
  }
  const VertexGrid grid(places, numbers);
  for (const auto& vertex : mesh.vert) {
    if (!vertex.IsD() && is_finite(vertex.cP())) {
      const Vector3 place = to_core(vertex.cP());
      const int nearest = found.empty() ? -1 : grid.nearest(place);
      result.off = nearest < 0 ? HUGE_VAL : std::max(result.off, (found[nearest] - place).norm());
    }
  }
  return result;
}

/// Runs in the other process.
[[noreturn]] void readAndTell(const CMeshO& mesh, const std::function<const CMeshO&()>& read, double seconds,
                              int answers) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const struct rlimit time = {static_cast<rlim_t>(seconds) + 1, static_cast<rlim_t>(seconds) + 1}, none = {0, 0};
  setrlimit(RLIMIT_CPU, &time);
  setrlimit(RLIMIT_CORE, &none);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nowhere, STDERR_FILENO);  // messages of a reader that fails are not used
  try {
    const ReadBack result = compared(mesh, read());
    _exit(::write(answers, &result, sizeof result) == static_cast<ssize_t>(sizeof result) ? 0 : 1);
  } catch (const std::exception&) {
    _exit(1);
  }
}

}  // namespace

std::optional<ReadBack> readBack(const CMeshO& mesh, const std::function<const CMeshO&()>& read, double seconds) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return {};
  }
  const pid_t reader = fork();
  if (reader == 0) {
    readAndTell(mesh, read, seconds, ends[1]);
  }
  ::close(ends[1]);
  ReadBack result;
  const bool told = reader > 0 && ::read(ends[0], &result, sizeof result) == static_cast<ssize_t>(sizeof result);
  ::close(ends[0]);
  if (reader > 0) {
    while (waitpid(reader, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  return told ? std::optional<ReadBack>(result) : std::nullopt;
}

}  // namespace lapedit::host
