// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/system.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#ifdef _WIN32
#include <io.h>
#else
#include <sys/file.h>
#include <unistd.h>
#endif

namespace lapedit::system {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(int error = errno) {
  throw std::system_error(error, std::generic_category());
}

/// Returns the beginning of the names of new files, with the machine, since locks may be local to one machine.
std::string beginning() {
  char machine[256] = {};
#ifndef _WIN32
  gethostname(machine, sizeof machine - 1);
#endif
  std::string name = machine;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char letter) { return std::isalnum(letter) == 0; }, '_');
  return ".laplacian-edit-" + name + "-";
}

std::atomic<int> requested{0};  // the signal that asks to end the program; 0: none

constexpr std::size_t kDigits = 16;  // of a random number and its check

/// Returns eight digits and a check of them, by which sweep() distinguishes the program's files from others.
std::string checked(std::uint32_t number) {
  char text[kDigits + 1];
  std::snprintf(text, sizeof text, "%08x%08x", static_cast<unsigned>(number),
                static_cast<unsigned>((number ^ number >> 16 ^ 0x54a3c91d) * 2654435761U));
  return text;
}

/// Returns whether a text consists of a beginning and the digits of a checked number.
bool isChecked(const std::string& text, std::size_t begin) {
  const std::string digits = text.substr(std::min(begin, text.size()));
  return digits.size() == kDigits &&
         digits == checked(static_cast<std::uint32_t>(std::strtoul(digits.substr(0, 8).c_str(), nullptr, 16)));
}

#ifdef _WIN32

constexpr int kCreate = O_WRONLY | O_CREAT | O_EXCL | O_BINARY;

int fsync(int file) {
  return _commit(file);
}

/// Needs no lock, since Windows does not remove open files.
bool lock(int, const fs::path&) {
  return true;
}

/// Removes a first file unless it is open. @return whether it is gone
bool removeAbandoned(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  return !error;
}

void takeOver(const fs::path&, const fs::path&) {}

constexpr int kRequests[] = {SIGINT, SIGTERM};

/// Has no effect, since the next call removes the files.
void watchRequests() {}

#else

constexpr int kRequests[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU};

extern "C" void remember(int request) {
  requested = request;
}

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

/// Locks a file. @return false if another process has it or removed it before the lock, or if it is another user's or
/// no regular file
bool lock(int file, const fs::path& path) {
  struct stat opened = {}, named = {};
  return (::flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) && ::fstat(file, &opened) == 0 &&
         ::lstat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino && opened.st_dev == named.st_dev &&
         opened.st_uid == ::geteuid() && S_ISREG(opened.st_mode);
}

/// Removes a first file unless another process has locked it. @return whether it is gone
bool removeAbandoned(const fs::path& path) {
  const int file = ::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) {
    return errno == ENOENT;
  }
  // Without locks it is unknown whether the file is abandoned.
  const bool isGone = lock(file, path) && ::flock(file, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0;
  ::close(file);
  return isGone;
}

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

/// Creates and locks a file. @return null if a file of this name exists, or another process removed it at once
std::FILE* create(const fs::path& path) {
  const int file = ::open(path.string().c_str(), kCreate, 0600);
  if (file >= 0 && !lock(file, path)) {
    ::close(file);
    errno = EEXIST;
    return nullptr;
  }
  std::FILE* const stream = file < 0 ? nullptr : ::fdopen(file, "wb");
  if (file >= 0 && stream == nullptr) {
    std::remove(path.string().c_str());
    ::close(file);
    errno = ENOMEM;
  }
  return stream;
}

/// Removes the files that killed calls left in a folder.
void sweep(const fs::path& folder, const std::string& begin) {
  std::error_code error, ignored;
  const std::size_t end = begin.size() + kDigits;
  for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error)) {
    const std::string name = entry->path().filename().string(), first = name.substr(0, end);
    const bool isFirst = name.size() == first.size();
    if (name.compare(0, begin.size(), begin) == 0 && isChecked(first, begin.size()) &&
        (isFirst || (name[end] == '-' && isChecked(name, end + 1))) &&
        fs::is_regular_file(entry->symlink_status(ignored)) && removeAbandoned(folder / first) && !isFirst) {
      fs::remove(entry->path(), ignored);
    }
  }
}

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

NewFile::NewFile(const fs::path& folder, const NewFile* first) : is_first_(first == nullptr) {
  const std::string begin = is_first_ ? beginning() : first->path_.filename().string() + "-";
  if (is_first_) {
    watchRequests();
    sweep(folder, begin);
  }
  for (int tries = 0; file_ == nullptr; ++tries) {
    path_ = folder / (begin + checked(std::random_device()()));
    file_ = create(path_);
    if (file_ == nullptr && (errno != EEXIST || tries > 99)) {
      fail();
    }
  }
}

NewFile::~NewFile() {
  std::error_code ignored;
#ifdef _WIN32
  close();  // Windows removes closed files only
#endif
  if (!path_.empty()) {
    fs::remove(path_, ignored);
  }
  close();
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
  if (!is_first_) {
    close();  // since there may be thousands of files
  }
}

void NewFile::replace(const fs::path& target) {
#ifdef _WIN32
  close();
#endif
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
