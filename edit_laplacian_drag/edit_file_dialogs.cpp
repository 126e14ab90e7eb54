// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_file_dialogs.h"

#include <QFileDialog>
#include <QSaveFile>
#include <QXmlStreamWriter>

#include "lapedit/json/edit_script.h"

namespace {

const char* const kFiles = "Laplacian edits (*.json)";

void writeParameter(QXmlStreamWriter& xml, const char* type, const char* name, const QString& value) {
  xml.writeEmptyElement("Param");
  xml.writeAttribute("type", type);
  xml.writeAttribute("name", name);
  xml.writeAttribute("value", value);
}

}  // namespace

std::string saveEdit(QWidget* parent, const lapedit::Edit& edit) {
  const QByteArray json = QByteArray::fromStdString(lapedit::write_edit(edit));
  QFileDialog dialog(parent, "Save edit", QString(), kFiles);
  dialog.setAcceptMode(QFileDialog::AcceptSave);
  dialog.setDefaultSuffix("json");
  if (dialog.exec() != QDialog::Accepted) {
    return {};
  }
  const QString path = dialog.selectedFiles().constFirst();
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(json) != json.size() || !file.commit()) {
    return "The edit could not be written to " + path.toStdString() + ": " + file.errorString().toStdString() + ".";
  }
  return "The edit was saved as " + path.toStdString() + ".";
}

std::optional<lapedit::Edit> loadEdit(QWidget* parent) {
  const QString path = QFileDialog::getOpenFileName(parent, "Load edit", QString(), kFiles);
  if (path.isEmpty()) {
    return std::nullopt;
  }
  return lapedit::load_edit(path.toStdString());
}

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
