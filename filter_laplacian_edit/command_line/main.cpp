// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <unistd.h>

#include <QApplication>
#include <QFile>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "file_names.h"
#include "job.h"
#include "lapedit/base/error.h"
#include "supervisor.h"

namespace {

/// Hosts tell their whole life there.
void keepQuiet(QtMsgType type, const QMessageLogContext&, const QString& message) {
  if (type == QtFatalMsg || type == QtCriticalMsg) {
    std::fprintf(stderr, "%s\n", message.toLocal8Bit().constData());
  }
}

/// Else the next file that is opened would be the standard output of whoever writes to it without asking.
void openStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) == -1) {
      // Whatever is written is to fail, as on a closed one.
      ::open(stream == STDOUT_FILENO ? "/dev/full" : "/dev/null", O_RDWR);
    }
  }
}

/// Some of the hosts' code prints to the standard output, which is for the reports.
std::FILE* takeStandardOutput() {
  const int output = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::close(nowhere);
  }
  std::FILE* const file = output >= 0 ? ::fdopen(output, "w") : nullptr;
  return file != nullptr ? file : stdout;
}

int work(int argc, char** argv, Notes& notes) {
  std::FILE* const output = takeStandardOutput();
  qInstallMessageHandler(keepQuiet);
  // A full disk is to be told, not to end the program.
  std::signal(SIGXFSZ, SIG_IGN);
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  // Numbers in files have points, and file names are bytes, whatever the language.
  std::setlocale(LC_NUMERIC, "C");
  takeFileNamesAsBytes();
  QStringList arguments;
  for (int k = 0; k < argc; ++k) {
    arguments << QFile::decodeName(argv[k]);
  }
  std::string text;
  if (const std::optional<Options> options = readOptions(arguments, text)) {
    runJob(*options, notes, output);
  }
  printAll(text, output, "look where it leads");
  return Done;
}

int fail(ExitCode code, const char* sentence) {
  std::fprintf(stderr, "%s\n", sentence);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  openStandardStreams();
  return supervise([argc, argv](Notes& notes) -> int {
    try {
      return work(argc, argv, notes);
    } catch (const Failure& failure) {
      return fail(failure.code(), failure.what());
    } catch (const lapedit::EditError& error) {
      return fail(Refused, error.what());
    } catch (const std::exception& error) {
      if (lackIn(std::current_exception()) != Lack::Nothing) {
        throw;
      }
      return fail(Unexpected, error.what());
    } catch (...) {
      return fail(Unexpected, "The program failed for a reason that it does not tell.");
    }
  });
}
