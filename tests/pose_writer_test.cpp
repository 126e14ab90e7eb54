// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/pose_writer.h"

#include <gtest/gtest.h>
