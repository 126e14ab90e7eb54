// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

/// Names of files are bytes, mostly UTF-8. After this call Qt treats them so, and represents bytes that are no UTF-8 as
/// lone surrogates, U+DC80 to U+DCFF, which become bytes again when a file is opened.
void takeFileNamesAsBytes();

/// Returns the absolute path of a name. ".." after a link to a folder is relative to the folder, not to the link.
QString fullPath(const QString& name);

/// Returns whether a name is UTF-8; MeshLab's plugins can open only such names.
bool isUtf8(const QString& name);
