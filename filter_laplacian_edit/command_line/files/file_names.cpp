// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/file_names.h"

#include <QDir>
#include <QFileInfo>
#include <QTextCodec>

namespace {

constexpr ushort kFirst = 0xDC80, kLast = 0xDCFF;

bool isByte(const QString& name, int k) {
  const ushort letter = name[k].unicode();
  return letter >= kFirst && letter <= kLast && (k == 0 || !name[k - 1].isHighSurrogate());
}

QString decoded(const QByteArray& bytes) {
  QString text = QString::fromUtf8(bytes);
  if (text.toUtf8() == bytes) {
    return text;
  }
  text.clear();
  for (int k = 0; k < bytes.size();) {
    int length = 1;
    while (length <= 4 && QString::fromUtf8(bytes.mid(k, length)).toUtf8() != bytes.mid(k, length)) {
      ++length;
    }
    const bool isLetter = length <= 4;
    text += isLetter ? QString::fromUtf8(bytes.mid(k, length)) : QString(QChar(0xDC00 + static_cast<uchar>(bytes[k])));
    k += isLetter ? length : 1;
  }
  return text;
}

QByteArray encoded(const QString& name) {
  QByteArray bytes;
  int begin = 0;
  for (int k = 0; k < name.size(); ++k) {
    if (isByte(name, k)) {
      bytes += name.mid(begin, k - begin).toUtf8() + static_cast<char>(name[k].unicode() - 0xDC00);
      begin = k + 1;
    }
  }
  return bytes + name.mid(begin).toUtf8();
}

class NameCodec : public QTextCodec {
 public:
  QByteArray name() const override { return "laplacian-edit-names"; }
  int mibEnum() const override { return -4711; }  // not a registered number

 protected:
  // Names are never decoded in parts.
  QString convertToUnicode(const char* bytes, int length, ConverterState* state) const override {
    return state != nullptr ? utf8_->toUnicode(bytes, length, state) : decoded(QByteArray(bytes, length));
  }
  QByteArray convertFromUnicode(const QChar* letters, int length, ConverterState* state) const override {
    return state != nullptr ? utf8_->fromUnicode(letters, length, state) : encoded(QString(letters, length));
  }

 private:
  QTextCodec* utf8_ = QTextCodec::codecForName("UTF-8");
};

}  // namespace

void takeFileNamesAsBytes() {
  static auto* const codec = new NameCodec;  // owned by Qt from here on
  QTextCodec::setCodecForLocale(codec);
}

QString fullPath(const QString& name) {
  const QString full = name.startsWith('/') ? name : QDir::currentPath() + "/" + name;
  const int slash = full.lastIndexOf('/');
  const QString folder = full.contains("/../") ? QFileInfo(full.left(slash)).canonicalFilePath() : QString();
  return QDir::cleanPath(folder.isEmpty() ? full : folder + full.mid(slash));
}

bool isUtf8(const QString& name) {
  for (int k = 0; k < name.size(); ++k) {
    if (isByte(name, k)) {
      return false;
    }
  }
  return true;
}
