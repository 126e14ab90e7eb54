// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/edit/edit_step.h"

namespace lapedit {

struct Landmark {
  std::string name;
  Vector3 point = Vector3::Zero();
};

/// The landmarks of a file.
struct LandmarkFile {
  std::vector<Landmark> landmarks;
  std::string system;  ///< "RAS" or "LPS", empty where the format does not say it
};

/// Reads landmarks from text: MeshLab's picked points (.pp; those that are active), .csv (name, x, y, z, or x, y, z,
/// which are named by their number from 1; with or without a header), 3D Slicer's .fcsv and .mrk.json.
/// @param name  of the file: its suffix tells the format
/// @throws EditError (BadScript) that names line or landmark: not of the format, no landmark, a coordinate that is no
///         finite number, a name that is there twice
LandmarkFile read_landmarks(const std::string& text, const std::string& name);

/// Reads two files and makes one handle group of them, its points, names and targets. Landmarks are paired by name.
/// @throws EditError (BadScript) as read_landmarks(); if a file cannot be read; for names that are in one file only,
/// and
///         for files in different coordinate systems
HandleGroup load_landmarks(const std::string& from, const std::string& to);

/// Reads a text file. @throws EditError (BadScript) if it is none, cannot be read, or is larger than kLargestJson
std::string read_text_file(const std::string& path);

}  // namespace lapedit
