// SPDX-License-Identifier: GPL-3.0-or-later
#include "lists/job_list.h"

#include <QFile>
#include <QFileInfo>
#include <QHash>
#include <QJsonDocument>
#include <QJsonObject>
#include <set>
#include <string>
#include <system_error>

#include "failure.h"
#include "files/file_names.h"
#include "files/input_file.h"
#include "files/real_files.h"
#include "lapedit/json/json_text.h"

using lapedit::host::quoted;
using lapedit::host::quotedPath;

namespace {

[[noreturn]] void refuse(const Options& common, int line, const std::string& what) {
  throw Failure(WrongUsage,
                "The list " + quotedPath(common.list.file) + ", line " + std::to_string(line) + ": " + what + ".");
}

QByteArray absolute(const QString& path) {
  return path.isEmpty() ? QByteArray() : QFile::encodeName(fullPath(path));
}

/// Finds duplicate keys, of which Qt's parser keeps the last. @return the first duplicate key, or an empty string
std::string repeatedKey(const QByteArray& text) {
  using lapedit::Json;
  std::set<std::string> keys;
  std::string repeated;
  const auto watch = [&](int, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::key && !keys.insert(value.get<std::string>()).second && repeated.empty()) {
      repeated = value.get<std::string>();
    }
    return true;
  };
  const Json ignored = Json::parse(text.begin(), text.end(), watch, false);
  return repeated;
}

ListedJob jobOfJson(const QByteArray& text, const Options& common, int line) {
  QJsonParseError error = {};
  const QJsonDocument document = QJsonDocument::fromJson(text, &error);
  if (!document.isObject()) {
    refuse(common, line, "this is no JSON object (" + error.errorString().toStdString() + ")");
  }
  if (const std::string key = repeatedKey(text); !key.empty()) {
    refuse(common, line, "the key " + lapedit::quoted_text(key) + " is given twice: keep one of the two");
  }
  ListedJob job;
  const QJsonObject object = document.object();
  for (auto member = object.begin(); member != object.end(); ++member) {
    const QString key = member.key();
    QByteArray* const path = key == "in"       ? &job.input
                             : key == "out"    ? &job.output
                             : key == "edit"   ? &job.edit
                             : key == "report" ? &job.report
                                               : nullptr;
    if (path != nullptr) {
      *path = absolute(member->toString());
      if (path->isEmpty()) {
        refuse(common, line, key.toStdString() + " must be the name of a file");
      }
    } else if (key == "fraction") {
      job.fraction = member->toDouble(-1);
      if (!(*job.fraction >= 0 && *job.fraction <= 1)) {
        refuse(common, line, "the fraction must be a number from 0 to 1");
      }
    } else {
      refuse(common, line, "unknown key " + quoted(key) + "; known keys are in, out, edit, fraction, report");
    }
  }
  if (job.input.isEmpty() || job.output.isEmpty() || job.edit.isEmpty()) {
    refuse(common, line, "a job needs the keys in, out and edit");
  }
  return job;
}

ListedJob jobOfColumns(const QByteArray& text, const Options& common, int line) {
  const QList<QByteArray> names = text.split('\t');
  if (names.size() != 3) {
    refuse(common, line,
           "there are " + std::to_string(names.size()) + " names: give IN, OUT and EDIT with tabs between");
  }
  ListedJob job;
  job.input = absolute(QFile::decodeName(names[0]));
  job.output = absolute(QFile::decodeName(names[1]));
  job.edit = absolute(QFile::decodeName(names[2]));
  if (job.input.isEmpty() || job.output.isEmpty() || job.edit.isEmpty()) {
    refuse(common, line, "a name is empty: give IN, OUT and EDIT with tabs between");
  }
  return job;
}

/// Names of files such that different names are different files.
class RealNames {
 public:
  QString of(const QString& path) {
    const QFileInfo file(path);
    if (file.isSymLink()) {
      return target(path);
    }
    const QString folder = file.path();
    auto known = folders_.find(folder);
    if (known == folders_.end()) {
      const QString canonical = QFileInfo(folder).canonicalFilePath();
      known = folders_.insert(folder, canonical.isEmpty() ? folder : canonical);
    }
    return *known + "/" + file.fileName();
  }

 private:
  static QString target(const QString& link) {
    try {
      return QFile::decodeName(RealFile(QFile::encodeName(link).toStdString()).path().c_str());
    } catch (const std::system_error&) {  // a circular link, which the job will report
      return link;
    }
  }

  QHash<QString, QString> folders_;
};

/// Checks that no file is written twice, and that no written file is read.
void requireApart(const std::vector<ListedJob>& jobs, const Options& common) {
  RealNames real;
  QHash<QString, int> written;  // path -> line
  constexpr int noLine = 0;
  const QString log = real.of(common.list.log);
  for (const QString& path : {common.list.file, common.list.log}) {
    if (!path.isEmpty()) {
      written.insert(real.of(path), noLine);
    }
  }
  for (const ListedJob& job : jobs) {
    const Options options = optionsOf(job, common);
    for (const QString& path : options.outputs() + QStringList(options.report)) {
      if (path.isEmpty()) {
        continue;
      }
      const QString name = real.of(path);
      const auto other = written.constFind(name);
      if (other != written.constEnd()) {
        refuse(common, job.line,
               quotedPath(path) + " is also " +
                   (*other == noLine ? "the list or the job log" : "written by line " + std::to_string(*other)) +
                   ": give another name");
      }
      written.insert(name, job.line);
    }
  }
  for (const ListedJob& job : jobs) {
    for (const QByteArray& path : {job.input, job.edit}) {
      const QString name = QFile::decodeName(path);
      const QString file = real.of(name);
      if (!common.list.log.isEmpty() && file == log) {
        refuse(common, job.line, quotedPath(name) + " is the job log: give the log another name");
      }
      const int line = written.value(file, noLine);
      if (line != noLine) {
        refuse(common, job.line,
               quotedPath(name) + " is written by " +
                   (line == job.line ? "the same line" : "line " + std::to_string(line)) +
                   ": jobs are done in any order, and some again by --resume, so give that output another name");
      }
    }
  }
}

/// Adds the job of a line, if there is one.
void addJob(QByteArray text, const Options& common, int line, std::vector<ListedJob>& jobs) {
  while (text.endsWith('\n') || text.endsWith('\r')) {
    text.chop(1);
  }
  if (line == 1 && text.startsWith("\xef\xbb\xbf")) {
    text.remove(0, 3);
  }
  if (text.trimmed().isEmpty() || text.startsWith('#')) {
    return;
  }
  ListedJob job = text.startsWith('{') ? jobOfJson(text, common, line) : jobOfColumns(text, common, line);
  job.line = line;
  const bool poses = job.fraction || common.numbered || common.fractions != std::vector<double>{1};
  if (poses && isScript(QFile::decodeName(job.edit))) {
    refuse(common, line,
           "fractions are for JSON edits: in a script, give the parameter fraction of Laplacian Edit Replay");
  }
  jobs.push_back(std::move(job));
}

}  // namespace

std::vector<ListedJob> readJobList(const Options& common) {
  std::vector<ListedJob> jobs;
  int line = 0;
  try {
    InputFile file(common.list.file);  // which may be a pipe
    for (QByteArray text = file.readLine(); !text.isEmpty(); text = file.readLine()) {
      ++line;
      addJob(text, common, line, jobs);
    }
  } catch (const std::system_error& error) {
    const std::string why = error.code() == std::errc::is_a_directory ? "it is a folder"
                            : error.code() == std::errc::message_size ? "the line is too long"
                                                                      : error.code().message();
    throw Failure(Unreadable, "The list " + quotedPath(common.list.file) + " cannot be read" +
                                  (line > 0 ? " after line " + std::to_string(line) : "") + ": " + why +
                                  "; no job was begun.");
  }
  requireApart(jobs, common);
  return jobs;
}

Options optionsOf(const ListedJob& job, const Options& common) {
  Options options = common;
  options.list = {};
  options.quiet = true;
  options.input = QFile::decodeName(job.input);
  options.output = QFile::decodeName(job.output);
  options.edit = QFile::decodeName(job.edit);
  options.report = QFile::decodeName(job.report);
  options.isScript = isScript(options.edit);
  if (job.fraction) {
    options.fractions = {*job.fraction};
    options.numbered = false;
  }
  return options;
}
