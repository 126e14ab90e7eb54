// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Included before each file on ARM, so that Eigen rounds a * b + c twice there, as on other processors. Clang's header
// defines functions that Eigen uses only while the macro is defined.
#ifdef __aarch64__
#include <arm_neon.h>
#endif
#undef __ARM_FEATURE_FMA
