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

#include "files/file_names.h"
#include "job.h"
#include "lapedit/base/error.h"
#include "lapedit/base/thread_pool.h"
#include "lists/job_pool.h"
#include "lists/list_run.h"
#include "processes/error_stream.h"
#include "processes/supervisor.h"
#include "questions.h"

namespace {

/// MeshLab prints much there.
void keepQuiet(QtMsgType type, const QMessageLogContext&, const QString& message) {
  if (type == QtFatalMsg || type == QtCriticalMsg) {
    std::fprintf(stderr, "%s\n", message.toLocal8Bit().constData());
  }
}

/// Opens closed standard streams, since the next opened file would otherwise become the standard output.
/// @return whether the standard output was open
bool openStandardStreams() {
  const bool hasOutput = ::fcntl(STDOUT_FILENO, F_GETFD) != -1;
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) == -1) {
      ::open("/dev/null", O_RDWR);
    }
  }
  return hasOutput;
}

/// Separates the reports from the standard output, to which some of MeshLab's code prints.
/// @return null if it is closed
std::FILE* takeStandardOutput(bool isOpen) {
  if (!isOpen) {
    return nullptr;
  }
  const int output = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::close(nowhere);
  }
  std::FILE* const file = output >= 0 ? ::fdopen(output, "w") : nullptr;
  return file != nullptr ? file : stdout;
}

int fail(ExitCode code, const char* sentence) {
  std::fprintf(errorStream(), "%s\n", sentence);
  return code;
}

/// Prints the message of an error.
template <class Work>
int guarded(const Work& work) {
  try {
    return work();
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
    return fail(Unexpected, "The program failed for an unknown reason: report the command and its files.");
  }
}

int work(int argc, char** argv, bool hasOutput, Notes& notes) {
  std::FILE* const output = takeStandardOutput(hasOutput);
  qInstallMessageHandler(keepQuiet);
  // A full disk must be reported, not end the program.
  std::signal(SIGXFSZ, SIG_IGN);
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  // Numbers in files have decimal points, and file names are bytes, in every locale.
  std::setlocale(LC_NUMERIC, "C");
  takeFileNamesAsBytes();
  QStringList arguments;
  for (int k = 0; k < argc; ++k) {
    arguments << QFile::decodeName(argv[k]);
  }
  // The processors that the system grants, for example under a cluster's scheduler, not those of the machine.
  lapedit::limit_threads(processors());
  std::string text;
  if (const std::optional<Options> options = readOptions(arguments, text)) {
    const auto job = [output](const Options& one, Notes& itsNotes) {
      return guarded([&] {
        runJob(one, itsNotes, output);
        return Done;
      });
    };
    if (!options->list.file.isEmpty()) {
      return runList(*options, job, output);
    }
    if (options->info || !options->nearest.empty()) {
      printAll(answer(*options, notes), output, "open it, or redirect it to a file");
      return Done;
    }
    runJob(*options, notes, output);
  }
  printAll(text, output, "check where it is redirected");
  return Done;
}

}  // namespace

int main(int argc, char** argv) {
  const bool hasOutput = openStandardStreams();
  return supervise([&](Notes& notes) { return guarded([&] { return work(argc, argv, hasOutput, notes); }); });
}
