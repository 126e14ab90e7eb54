// SPDX-License-Identifier: GPL-3.0-or-later
#include "lists/job_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <QFile>
#include <QFileInfo>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "failure.h"
#include "files/file_writer.h"
#include "files/input_file.h"

using lapedit::host::quotedPath;

namespace {

constexpr char kVersion[] = "laplacian_edit_job";
constexpr char kSizes[] = "out_bytes";
constexpr QLatin1String kStateKeys[] = {QLatin1String("in_bytes"), QLatin1String("in_modified"),
                                        QLatin1String("edit_bytes"), QLatin1String("edit_modified")};

[[noreturn]] void refuse(const QString& path, ExitCode code, const std::string& why) {
  throw Failure(code, "The job log " + quotedPath(path) + " cannot be written: " + why + ".");
}

/// Returns size and time of a file, empty if it does not exist.
std::pair<QByteArray, QByteArray> stateOf(const QString& path) {
  struct stat state = {};
  if (::stat(QFile::encodeName(path).constData(), &state) != 0) {
    return {};
  }
  return {QByteArray::number(static_cast<qint64>(state.st_size)),
          QByteArray::number(static_cast<qint64>(state.st_mtim.tv_sec)) + "." +
              QByteArray::number(static_cast<qint64>(state.st_mtim.tv_nsec)).rightJustified(9, '0')};
}

/// Returns the options of a job as for a call of its own.
QJsonArray optionsAsGiven(const Options& job) {
  QJsonArray options;
  const auto add = [&](const char* name, const QString& value) {
    options.append(QString(name));
    if (!value.isEmpty()) {
      options.append(value);
    }
  };
  if (!job.isScript) {
    QStringList fractions;
    for (const double fraction : job.fractions) {
      fractions << QString::number(fraction, 'g', 17);
    }
    add(job.numbered ? "--fractions" : "--fraction", fractions.join(','));
  }
  if (!job.report.isEmpty()) {
    add("--report", job.report);
  }
  if (job.quality) {
    add("--quality", {});
  }
  if (job.strict) {
    add("--strict", {});
  }
  if (job.kept.normals || job.kept.selection) {
    add("--also", job.kept.normals && job.kept.selection ? "normals,selection"
                  : job.kept.normals                     ? "normals"
                                                         : "selection");
  }
  if (!job.plugins.isEmpty()) {
    add("--plugins", job.plugins);
  }
  return options;
}

/// Returns the key by which jobs are equal.
QByteArray keyOf(const QJsonObject& entry) {
  return QJsonDocument(QJsonArray{entry["in"], entry["out"], entry["edit"], entry["options"]})
      .toJson(QJsonDocument::Compact);
}

/// Returns the sizes of the outputs in their order, and of the report if there is one; null for missing files.
QJsonArray outputSizes(const Options& job) {
  QJsonArray sizes;
  for (const QString& path : job.outputs() + QStringList(job.report)) {
    const QFileInfo file(path);
    if (!path.isEmpty()) {
      sizes.append(file.isFile() ? QJsonValue(file.size()) : QJsonValue());
    }
  }
  return sizes;
}

/// Returns whether a line is a part of an entry, as after a power failure.
bool isCutShort(const QByteArray& text) {
  static const QByteArray kBegin = R"({"began":)";
  return kBegin.startsWith(text) || text.startsWith(kBegin) || text.count('\0') == text.size();
}

QJsonObject entryOf(const Options& job) {
  return {{"in", job.input}, {"out", job.output}, {"edit", job.edit}, {"options", optionsAsGiven(job)}};
}

}  // namespace

InputState inputState(const Options& job) {
  const auto input = stateOf(job.input), edit = stateOf(job.edit);
  return {input.first, input.second, edit.first, edit.second};
}

JobLog::JobLog(const QString& path) : path_(path) {
  if (path.isEmpty()) {
    return;
  }
  if (QFileInfo::exists(path) && !QFileInfo(path).isFile()) {
    refuse(path, Unwritable, "it is not an ordinary file");
  }
  file_ = ::open(QFile::encodeName(path).constData(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) {
    refuse(path, Unwritable, whyNotWritten(errno));
  }
  // The last jobs of a killed run may still be ending.
  constexpr int tries = 100, microseconds = 100000;
  for (int k = 0; ::flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++k) {
    if (k == tries) {
      refuse(path, Unwritable, "another run is writing it: wait for its end, or give another file");
    }
    ::usleep(microseconds);
  }
  read();
}

/// Reads the finished jobs of earlier runs. Unreadable lines, such as the last one before a power failure, are skipped;
/// a file without any valid line is not a job log.
void JobLog::read() {
  QByteArray last;
  QStringList bad;
  bool isLog = false;
  int line = 0;
  try {
    InputFile before(path_);
    for (QByteArray text = before.readLine(); !text.isEmpty(); text = before.readLine()) {
      last = text;
      ++line;
      const QJsonObject entry = QJsonDocument::fromJson(text).object();
      isLog = isLog || entry.contains(kVersion) || isCutShort(text);
      if (!entry.contains(kVersion)) {
        bad << QString::number(line);
      } else if (entry["exit"].toInt(-1) == Done) {
        Known& known = done_[keyOf(entry)];
        for (std::size_t k = 0; k < known.state.size(); ++k) {
          known.state[k] = entry[kStateKeys[k]].toString().toUtf8();
        }
        known.sizes = entry[kSizes].toArray();
      }
    }
  } catch (const std::system_error& error) {
    throw Failure(Unreadable, "The job log " + quotedPath(path_) + " cannot be read: " + error.code().message() + ".");
  }
  if (line > 0 && !isLog) {
    refuse(path_, WrongUsage, "it is not a job log: give a new file, or a job log");
  }
  if (!bad.isEmpty()) {
    constexpr int kNamed = 10;
    const bool several = bad.size() > 1;
    const std::string more =
        bad.size() > kNamed ? ", and " + std::to_string(bad.size() - kNamed) + " more" : std::string();
    complaint_ = "The job log " + quotedPath(path_) + ": " + (several ? "lines " : "line ") +
                 QStringList(bad.mid(0, kNamed)).join(", ").toStdString() + more +
                 (several ? " are no entries and are skipped; their jobs count as not done."
                          : " is no entry and is skipped; its job counts as not done.");
  }
  // A truncated line is ended first.
  if (!last.isEmpty() && !last.endsWith('\n')) {
    append("\n");
  }
}

void JobLog::append(const QByteArray& text) {
  errno = 0;
  // Writes at once, so that readers see whole lines.
  if (::write(file_, text.constData(), static_cast<std::size_t>(text.size())) != text.size()) {
    refuse(path_, Unwritable, errno != 0 ? whyNotWritten(errno) : "what arrived is not complete");
  }
}

JobLog::~JobLog() {
  if (file_ >= 0) {
    ::close(file_);
  }
}

bool JobLog::isDone(const Options& job) const {
  const auto known = done_.constFind(keyOf(entryOf(job)));
  return known != done_.constEnd() && known->state == inputState(job) && known->sizes == outputSizes(job) &&
         !known->sizes.contains(QJsonValue());
}

void JobLog::add(int line, const Options& job, const InputState& before, const JobEnd& end) {
  if (file_ < 0) {
    return;
  }
  QJsonObject entry = entryOf(job);
  entry[kVersion] = 1;
  entry["line"] = line;
  entry["exit"] = end.code;
  entry["sentence"] = QString::fromStdString(end.sentence);
  entry["began"] = end.began;
  entry["seconds"] = end.seconds;
  entry["most_memory"] = end.mostMemory;
  for (std::size_t k = 0; k < before.size(); ++k) {
    entry[kStateKeys[k]] = QString(before[k]);
  }
  entry[kSizes] = outputSizes(job);
  append(QJsonDocument(entry).toJson(QJsonDocument::Compact) + "\n");
}
