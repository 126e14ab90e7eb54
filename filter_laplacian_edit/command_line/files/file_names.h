// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

/// Names of files are bytes, mostly UTF-8. From here on all of Qt takes them so, and keeps bytes that are no UTF-8 as
/// lone surrogates, U+DC80 to U+DCFF, out of which they are made again where a file is opened.
void takeFileNamesAsBytes();

/// The path of a name from the root. What follows a link to a folder and ".." is beside the folder, not beside the
/// link.
QString fullPath(const QString& name);

/// Whether a name is UTF-8: only then can the host's plugins, with ways of their own, have it.
bool isUtf8(const QString& name);
