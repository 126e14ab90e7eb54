// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "lapedit/edit/edit.h"

/// Edits as JSON text, so that interactive and scripted edits can be replayed exactly.
///
/// Keys (o: optional, with the default of EditSettings, RegionSpec or HandleTransform; any other key is refused):
///
///     laplacian_edit     the version of this format: 1
///     mesh             o the mesh it was made for; each key is optional, what is given is compared by apply_edit()
///       vertices, faces    counts
///       connectivity       checksum of 16 digits, see connectivity_checksum()
///       places             vertices, ascending, and points, where these are: see Edit::by_place()
///     steps              list of one or more, each applied to the result of the one before
///       region           one of the following five:
///         radius           geodesic radius about the handles, model units
///         vertices         "12-40,77": single numbers and ranges, both ends included, counted from 0
///         component        true: the whole connected components of the handles
///         within           point and radius: the vertices within the radius along the surface of the one nearest
///         selected         true: what is selected
///         anchors        o with vertices only: anchors kept from an earlier step in the same region
///           vertices         as above
///           weights, depths  lists, one number from 0 to 1 per vertex
///           reach            largest handle distance then, model units
///         padding        o width of the anchor band over the radius, or over the largest handle distance; does nothing
///                          to whole components
///         held           o vertices that never move, as above
///         connect        o pieces nearer to each other than this are one, model units; 0: off
///       handles          list of one or more groups
///         vertices         as above; or one of the following four:
///         points           list of [x, y, z]: the vertex nearest to each
///         within, selected   as above
///         landmarks        from and to: files of points and of their targets, see load_landmarks()
///         weights        o list, one number from 0.000001 to 1 per vertex or point
///         targets        o in place of the four below: list of [x, y, z], one per vertex or point, in the same order
///         translation    o [x, y, z], model units
///         rotation       o
///           axis         o [x, y, z], any length but zero
///           degrees      o
///           center       o [x, y, z], of rotation and scale; absent: the group's centroid
///         scale          o
///         matrix         o in place of the three above: 16 numbers by rows, the last row 0, 0, 0, 1
///       mirror           o the plane that region and handles are mirrored across
///         point            [x, y, z], model units
///         normal           [x, y, z], any length but zero
///       method         o "default", "paper", "linear"; it gives the following keys their defaults
///       laplacian      o "umbrella", "cotangent", "mean_value"
///       order, membrane, handle_weight, anchor_weight   o
///       iterations     o with the method default only
///       normal_radius  o with the method paper only; model units; 0: automatic
///       rough          o with the method paper only: "unrotated", "falloff"
///
/// Example: the steps of a file on a mesh, half of the way.
///
///     const Edit edit = load_edit("bend.json");
///     const EditResult half = apply_edit(mesh, edit, 0.5);
///
namespace lapedit {

/// Reads UTF-8 text, with or without a byte order mark. Checks keys, types, finite numbers and vertex lists (which may
/// not be longer than the mesh that the text names). apply_edit() checks the ranges of settings.
/// @param folder  folder of relative names of landmark files; empty: the current folder
/// @throws EditError (BadScript) whose message says where ("steps[1].handles[0]", or line and column)
Edit read_edit(const std::string& json, const std::string& folder = {});

/// Reads JSON text (UTF-8) if the argument begins with "{" (after white space), else the file of that path.
/// @throws EditError (BadScript)
Edit load_edit(const std::string& text_or_path);

/// Writes keys in the order above, all settings of the method explicitly (a later change of defaults does not change an
/// old file) and numbers such that read_edit() gives the same doubles (only a zero's sign is lost). Vertices keep their
/// order. With targets the transform, and with a matrix its other members are not written.
/// @throws EditError (NotFinite, BadScript) if read_edit() could not read the result
std::string write_edit(const Edit& edit);

}  // namespace lapedit
