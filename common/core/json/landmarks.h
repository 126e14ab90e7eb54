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
  std::string name;  ///< for messages
  std::vector<Landmark> landmarks;
  std::string system;  ///< "RAS" or "LPS", empty where the format does not say it
};

/// Reads landmarks from text: MeshLab's picked points (.pp; those that are active), .csv and .tsv (name, x, y, z, or
/// x, y, z, which are named by their number from 1; with or without a header; 3D Slicer's tables, whose header names
/// the coordinate system, as in label, r, a, s), 3D Slicer's .fcsv and .mrk.json. Undefined points are skipped.
/// @param name  of the file: its suffix tells the format
/// @throws EditError (BadScript) that names line or landmark: not of the format, no landmark, a coordinate that is no
///         finite number, a name that is there twice
LandmarkFile read_landmarks(const std::string& text, const std::string& name);

/// Makes one handle group of the landmarks of two files: its points, names and targets, and their coordinate systems.
/// They are paired by name. @throws EditError (BadScript) for names that are in one file only
HandleGroup pair_landmarks(const LandmarkFile& from, const LandmarkFile& to);

/// The same for two files. @throws EditError (BadScript) also as read_text_file() and read_landmarks()
HandleGroup load_landmarks(const std::string& from, const std::string& to);

/// Returns an edit that fits the components of a group to its targets. Its settings suit landmarks all over a surface:
/// the displacements of neighbouring landmarks are blended smoothly.
Edit fit_landmarks(HandleGroup group);

/// Returns an edit that fits the whole mesh to a scan. @param to  its file; @param landmarks  without points: none
Edit fit_scan(std::string to, HandleGroup landmarks = {});

/// Reads a text file. @param otherwise  end of the message if the path is not that of a file; the message adds its
/// folder
/// @throws EditError (BadScript) if it does not exist, cannot be read, or is larger than kLargestJson
std::string read_text_file(const std::string& path, const char* otherwise = "is not the path of a file");

}  // namespace lapedit
