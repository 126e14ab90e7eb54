// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_file_dialogs.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QSaveFile>

#include "lapedit/json/edit_script.h"

namespace {

const char* const kEdits = "Laplacian edits (*.json)";
const char* const kScripts = "Filter scripts of MeshLab (*.mlx)";

/// Returns the text of a script that replays an edit, given as JSON, with the filter Laplacian Edit Replay.
QByteArray filterScript(const QByteArray& edit) {
  return QString(R"(<!DOCTYPE FilterScript>
<FilterScript>
    <filter name="Laplacian Edit Replay">
        <Param type="RichString" name="edit" value="%1"/>
        <Param type="RichFloat" name="fraction" value="1"/>
    </filter>
</FilterScript>
)")
      .arg(QString::fromUtf8(edit).toHtmlEscaped().replace('\n', "&#10;"))
      .toUtf8();
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
  const QByteArray text = path.endsWith(".mlx") ? filterScript(json) : json;
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(text) != text.size() || !file.commit()) {
    return QString("The edit could not be written to %1: %2.").arg(path, file.errorString()).toStdString();
  }
  return QString("The edit was saved as %1.").arg(path).toStdString();
}
