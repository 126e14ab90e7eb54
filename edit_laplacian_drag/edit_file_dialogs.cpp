// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_file_dialogs.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QSaveFile>
#include <QXmlStreamWriter>

#include "lapedit/json/edit_script.h"

namespace {

const char* const kEdits = "Laplacian edits (*.json)";
const char* const kScripts = "Filter scripts of MeshLab (*.mlx)";

void writeParameter(QXmlStreamWriter& xml, const char* type, const char* name, const QString& value) {
  xml.writeEmptyElement("Param");
  xml.writeAttribute("type", type);
  xml.writeAttribute("name", name);
  xml.writeAttribute("value", value);
}

/// Returns the text of a script that replays an edit, given as JSON, with the filter Laplacian Edit Replay.
QString filterScript(const QByteArray& edit) {
  QString text;
  QXmlStreamWriter xml(&text);
  xml.setAutoFormatting(true);
  xml.writeDTD("<!DOCTYPE FilterScript>\n");
  xml.writeStartElement("FilterScript");
  xml.writeStartElement("filter");
  xml.writeAttribute("name", "Laplacian Edit Replay");
  writeParameter(xml, "RichString", "edit", QString::fromUtf8(edit));
  writeParameter(xml, "RichFloat", "fraction", "1");
  xml.writeEndElement();
  xml.writeEndElement();
  return text + "\n";
}

QFileDialog* newDialog(QWidget* parent, const char* title, const QString& suggested) {
  auto* const dialog = new QFileDialog(parent, title, QFileInfo(suggested).path());
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  return dialog;
}

}  // namespace

QString editFileFor(const lapedit::host::Layer& layer) {
  const QFileInfo mesh(layer.file.isEmpty() ? layer.name : layer.file);
  return mesh.absoluteDir().filePath(mesh.completeBaseName() + ".laplacian.json");
}

QFileDialog* saveDialog(QWidget* parent, const QString& suggested) {
  QFileDialog* const dialog = newDialog(parent, "Save edit", suggested);
  dialog->setNameFilters({kEdits, kScripts});
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix("json");
  QObject::connect(dialog, &QFileDialog::filterSelected, dialog,
                   [dialog](const QString& filter) { dialog->setDefaultSuffix(filter == kScripts ? "mlx" : "json"); });
  dialog->selectFile(suggested);
  dialog->open();
  return dialog;
}

QFileDialog* loadDialog(QWidget* parent, const QString& suggested) {
  QFileDialog* const dialog = newDialog(parent, "Load edit", suggested);
  dialog->setNameFilter(kEdits);
  dialog->setFileMode(QFileDialog::ExistingFile);
  if (QFileInfo::exists(suggested)) {
    dialog->selectFile(suggested);
  }
  dialog->open();
  return dialog;
}

std::string saveEdit(const QString& path, const lapedit::Edit& edit) {
  const QByteArray json = QByteArray::fromStdString(lapedit::write_edit(edit));
  const QByteArray text = path.endsWith(".mlx") ? filterScript(json).toUtf8() : json;
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit()) {
    return QString("The edit could not be written to %1: %2.").arg(path, file.errorString()).toStdString();
  }
  return QString("The edit was saved as %1.").arg(path).toStdString();
}
