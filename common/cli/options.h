// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh_file.h"
#include "lapedit/base/types.h"

/// The options of the command line. Names of files are as given; "-" is a standard stream.
struct Options {
  std::string input, output, edit;
  std::string targets;                    ///< landmarks: `edit` is the file of the points, this that of their targets
  std::string scan;                       ///< --fit: the mesh is fitted to this file; `edit` may be empty
  bool symmetrise = false;                ///< likewise, to its mirror image
  MeshReader reader = readPly;            ///< for the format of input and output
  std::vector<lapedit::Vector3> nearest;  ///< not empty: prints the nearest vertices, without an edit
  bool info = false;                      ///< prints a summary of the mesh, without an edit
  std::vector<double> fractions = {1};
  bool numbered = false;  ///< one output per fraction, its number in the name
  std::string report;     ///< empty: none
  bool quiet = false;
  bool strict = false;                ///< advice on a result is an error
  bool quality = false;               ///< counts new self-intersections
  bool contact = false;               ///< all steps stop at contact
  std::vector<std::string> transfer;  ///< what the output gets from the scan
  std::optional<double> within;       ///< up to which distance

  bool asks() const { return info || !nearest.empty(); }
  std::vector<std::string> outputs() const;  ///< one name per fraction
};

/// Reads a command line. @param text  out: the text to print instead of any work
/// @return none if there is such a text
/// @throws Failure (WrongUsage)
std::optional<Options> readOptions(const std::vector<std::string>& arguments, std::string& text);

/// Returns whether --transfer can name it.
bool isTransferable(const std::string& what);

/// Returns what --transfer names of a scan, at its points nearest to others.
/// @param within  up to which distance; none: 2 % of the scan's size
/// @throws Failure (Unreadable) if the scan has no such column
Carried carriedFrom(const MeshFile& scan, const std::vector<std::string>& names, const lapedit::Points& at,
                    std::optional<double> within);

/// Refuses an output or report that is the file of another one, or that the call also reads, through links of any kind.
/// The only output may replace the mesh. @param named  files that the edit names; readOptions() calls this without them
/// @throws Failure (WrongUsage)
void refuseSameFiles(const Options& options, const std::vector<std::string>& named);
