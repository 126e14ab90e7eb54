// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>  // __GLIBC__

#ifdef __GLIBC__  // other C libraries have no default for all threads
#define LAPEDIT_HAVE_NO_THREADS
#include <gtest/gtest.h>
#include <pthread.h>

namespace lapedit::support {

/// While this lives, no thread can be started: none has room for its stack.
class NoThreads {
 public:
  NoThreads() {
    pthread_attr_t huge;
    EXPECT_EQ(pthread_getattr_default_np(&usual_), 0);
    EXPECT_EQ(pthread_getattr_default_np(&huge), 0);
    EXPECT_EQ(pthread_attr_setstacksize(&huge, std::size_t{1} << 46), 0);
    EXPECT_EQ(pthread_setattr_default_np(&huge), 0);
  }
  ~NoThreads() { pthread_setattr_default_np(&usual_); }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;

 private:
  pthread_attr_t usual_;
};

}  // namespace lapedit::support
#endif
