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

}  // namespace

QString editFileFor(const lapedit::host::Layer& layer) {
  const QFileInfo mesh(layer.file.isEmpty() ? layer.name : layer.file);
  return mesh.absoluteDir().filePath(mesh.completeBaseName() + ".laplacian.json");
}

std::string saveEdit(QWidget* parent, const lapedit::Edit& edit, const QString& suggested) {
  QFileDialog dialog(parent, "Save edit", QFileInfo(suggested).path());
  dialog.setNameFilters({kEdits, kScripts});
  dialog.setAcceptMode(QFileDialog::AcceptSave);
  dialog.setDefaultSuffix("json");
  QObject::connect(&dialog, &QFileDialog::filterSelected, &dialog,
                   [&dialog](const QString& filter) { dialog.setDefaultSuffix(filter == kScripts ? "mlx" : "json"); });
  dialog.selectFile(suggested);
  if (dialog.exec() != QDialog::Accepted) {
    return {};
  }
  const QString path = dialog.selectedFiles().constFirst();
  const QByteArray json = QByteArray::fromStdString(lapedit::write_edit(edit));
  const QByteArray text = path.endsWith(".mlx") ? filterScript(json).toUtf8() : json;
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit()) {
    return QString("The edit could not be written to %1: %2.").arg(path, file.errorString()).toStdString();
  }
  return QString("The edit was saved as %1.").arg(path).toStdString();
}

std::optional<lapedit::Edit> loadEdit(QWidget* parent, const QString& suggested, const lapedit::TriangleMesh& mesh) {
  // The dialog proposes an existing file only.
  const QString begin = QFileInfo::exists(suggested) ? suggested : QFileInfo(suggested).path();
  const QString path = QFileDialog::getOpenFileName(parent, "Load edit", begin, kEdits);
  if (path.isEmpty()) {
    return std::nullopt;
  }
  return lapedit::load_edit(path.toStdString(), &mesh);
}
