// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <functional>

#include "options.h"
#include "processes/supervisor.h"

/// Does the jobs of a list, several at once, each in a process of its own. Opens no mesh itself: its memory does not
/// depend on theirs. A job that fails is reported on the standard error and stops no other. After a request to stop no
/// job begins any more; when the running ones have ended, this process ends by the same signal.
/// @param job     does one; returns its exit code
/// @param output  for the closing line
/// @return the largest exit code of any job
/// @throws Failure where nothing was begun, or the job log cannot be written any more
int runList(const Options& options, const std::function<int(const Options&, Notes&)>& job, std::FILE* output);
