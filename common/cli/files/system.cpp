// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/system.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <random>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

namespace lapedit::system {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(int error = errno) {
  throw std::system_error(error, std::generic_category());
}

std::atomic<int> requested{0};  // the signal that asks to end the program; 0: none

extern "C" void remember(int request) {
  requested = request;
}

#ifdef _WIN32

constexpr int kCreate = O_WRONLY | O_CREAT | O_EXCL | O_BINARY;

int fsync(int file) {
  return _commit(file);
}

void takeOver(const fs::path&, const fs::path&) {}

constexpr int kRequests[] = {SIGINT, SIGTERM};

/// Installs the handler for requests; a second request ends the program at once.
void watchRequests() {
  for (const int request : kRequests) {
    std::signal(request, remember);
  }
}

#else

constexpr int kRequests[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU};

/// Installs the handler for requests that are not ignored already, as nohup does. Calls that wait then fail (EINTR). A
/// second request ends the program at once.
void watchRequests() {
  for (const int request : kRequests) {
    struct sigaction action = {};
    if (::sigaction(request, nullptr, &action) == 0 && action.sa_handler == SIG_DFL) {
      action.sa_handler = remember;
      action.sa_flags = static_cast<int>(SA_RESETHAND);
      ::sigaction(request, &action, nullptr);
    }
  }
}

constexpr int kCreate = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC;

/// Copies owner, group and permissions of a file; a new one gets those of a file that the user creates.
void takeOver(const fs::path& from, const fs::path& to) {
  struct stat before = {};
  if (::stat(from.c_str(), &before) != 0) {
    const mode_t withheld = ::umask(0);
    ::umask(withheld);
    ::chmod(to.c_str(), 0666 & ~withheld);
    return;
  }
  mode_t mode = before.st_mode & 0777;
  if (::chown(to.c_str(), before.st_uid, before.st_gid) != 0 && ::chown(to.c_str(), -1, before.st_gid) != 0) {
    // Another group does not get the permissions of this one, but those of all users.
    mode &= ~070 | ((mode & 07) << 3);
  }
  ::chmod(to.c_str(), mode);
}

#endif

}  // namespace

bool prepareStreams() {
#ifdef _WIN32
  for (std::FILE* const stream : {stdin, stdout, stderr}) {
    _setmode(_fileno(stream), _O_BINARY);
  }
  return true;
#else
  const bool hasOutput = ::fcntl(STDOUT_FILENO, F_GETFD) != -1;
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) == -1) {
      ::open("/dev/null", O_RDWR);
    }
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  return hasOutput;
#endif
}

bool isTerminal(std::FILE* stream) {
  const char* const kind = std::getenv("TERM");
  return ::isatty(::fileno(stream)) != 0 && kind != nullptr && kind != std::string("dumb");
}

bool isRequestedToEnd() {
  return requested != 0;
}

void ignoreRequestsToEnd() {
  for (const int request : kRequests) {
    std::signal(request, SIG_IGN);
  }
  if (isRequestedToEnd()) {
    fail(EINTR);
  }
}

void endIfRequested() {
  if (isRequestedToEnd()) {
    std::signal(requested, SIG_DFL);
    std::raise(requested);
  }
}

NewFile::NewFile(const fs::path& folder) {
  constexpr int kMostTries = 100;
  static std::once_flag watched;
  std::call_once(watched, watchRequests);
  int file = -1;
  for (int tries = 0; file < 0; ++tries) {
    char name[32];
    std::snprintf(name, sizeof name, ".laplacian-edit-%08x", static_cast<unsigned>(std::random_device()()));
    path_ = folder / name;
    file = ::open(path_.string().c_str(), kCreate, 0600);
    if (file < 0 && (errno != EEXIST || tries == kMostTries)) {
      fail();
    }
  }
  file_ = ::fdopen(file, "wb");
  if (file_ == nullptr) {
    std::remove(path_.string().c_str());
    ::close(file);
    fail(ENOMEM);
  }
}

NewFile::~NewFile() {
  std::error_code ignored;
  close();  // Windows removes closed files only
  if (!path_.empty()) {
    fs::remove(path_, ignored);
  }
}

void NewFile::close() {
  if (file_ != nullptr) {
    std::fclose(file_);
    file_ = nullptr;
  }
}

void NewFile::write(const std::string& bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size() || std::fflush(file_) != 0) {
    fail();
  }
  if (fsync(::fileno(file_)) != 0 && errno != EINVAL) {  // EINVAL: the file system does not support it
    fail();
  }
  close();  // since there may be thousands of files
}

void NewFile::replace(const fs::path& target) {
  takeOver(target, path_);
  fs::rename(path_, target);
  path_.clear();
}

std::string whyNotWritten(int error) {
  switch (error) {
    case ENOSPC:
      return "the disk is full: free some space, or write to another disk";
#ifdef EDQUOT
    case EDQUOT:
      return "your share of the disk (quota) is used up: free some space, or write to another disk";
#endif
    case EFBIG:
      return "it is larger than a file may be here: raise the limit (ulimit -f), or write to another disk";
    case EROFS:
      return "the disk is read-only: write to another one";
    case ENOENT:
      return "its folder was moved or removed: run it again";
    default:
      return std::strerror(error);
  }
}

}  // namespace lapedit::system
