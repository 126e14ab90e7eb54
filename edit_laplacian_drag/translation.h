// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <string>

/// The user's language: once, a file laplacian_edit_<language>.qm is looked for beside the plugin, and in the folder
/// laplacian-edit/translations where programs keep their data (~/.local/share, /usr/share). It is for the core's
/// sentences too.
void loadTranslation();

/// A sentence of the core, marked by LAPEDIT_TEXT, in the user's language; any other text as it is.
QString core(const char* sentence);
inline QString core(const std::string& sentence) {
  return core(sentence.c_str());
}
