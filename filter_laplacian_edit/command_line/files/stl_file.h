// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <string>

/// Compares an STL file's size with its count of triangles: MeshLab's reader writes beyond its memory for a file that
/// is shorter than its beginning, and loops over others that are no STL.
/// @return why it is none, as the end of a sentence without a full stop; empty if it may be one
/// @throws std::system_error
std::string whyNoStl(const QString& path);
