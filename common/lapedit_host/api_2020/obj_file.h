// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <common/interfaces.h>

#include <wrap/io_trimesh/import_obj.h>
#include <QFile>
#include <algorithm>
#include <stdexcept>
#include <string>

/// Replaces the check of numbers in OBJ files, in this program's copy of MeshLab 2020.09's reader. That version refuses
/// the first vertex of a file, and Debian's aborts for each face that has it. Invalid numbers are refused here.
/// @param index  in the file minus one; on return never negative
/// @param count  of the vertices, texture coordinates or normals that come before
template <>
inline bool vcg::tri::io::ImporterOBJ<CMeshO>::GoodObjIndex(int& index, const int count) {
  const int given = index;
  if (index < 0) {
    index += count + 1;
  }
  // Texture coordinates without a number have index 0, also where there are none.
  if (index < 0 || index >= std::max(1, count)) {
    throw std::runtime_error("a face names vertex, texture coordinate or normal " + std::to_string(given + 1) +
                             ", where " + std::to_string(count) + " of them come before it: correct that face");
  }
  return true;
}

namespace lapedit::host {

/// Reads an OBJ file as MeshLab 2020.09's plugin does, but see above.
/// @return the mask of what was found in the file @throws std::runtime_error
inline int read_obj(const QString& file, MeshModel& layer, vcg::CallBackPos* callback) {
  using Importer = vcg::tri::io::ImporterOBJ<CMeshO>;
  const QByteArray name = QFile::encodeName(file);
  Importer::Info info;
  info.cb = callback;
  if (!Importer::LoadMask(name.constData(), info)) {
    throw std::runtime_error("the file is empty, or it cannot be opened");
  }
  layer.Enable(info.mask);
  const int error = Importer::Open(layer.cm, name.constData(), info);
  if (Importer::ErrorCritical(error)) {
    throw std::runtime_error(Importer::ErrorMsg(error));
  }
  layer.Enable(info.mask);
  return info.mask;
}

}  // namespace lapedit::host
