// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_script.h"

#include <QXmlStreamWriter>

namespace {

void writeParameter(QXmlStreamWriter& xml, const char* type, const char* name, const QString& value) {
  xml.writeEmptyElement("Param");
  xml.writeAttribute("type", type);
  xml.writeAttribute("name", name);
  xml.writeAttribute("value", value);
}

}  // namespace

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
