// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <functional>

#include "options.h"
#include "processes/supervisor.h"

/// Runs the jobs of a list, several at once, each in a process of its own. Opens no mesh, so its memory does not depend
/// on the meshes. A job that fails is reported on the standard error and stops no other. After a request to stop no job
/// starts; when the running ones have ended, this process ends by the same signal.
/// @param job     runs one; returns its exit code
/// @param output  for the closing line
/// @return the largest exit code of any job
/// @throws Failure if no job was started, or the job log can no longer be written
int runList(const Options& options, const std::function<int(const Options&, Notes&)>& job, std::FILE* output);
