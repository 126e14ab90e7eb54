// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_laplacian_edit.h"

QString aboutTheMethod() {
  return "<br>See:<br><i>Y. Lipman, O. Sorkine, D. Cohen-Or, D. Levin, "
         "C. R&ouml;ssl, "
         "H.-P. Seidel</i><br><b>Differential Coordinates for Interactive Mesh Editing</b><br>Shape Modeling "
         "International 2004<br><a href=\"https://doi.org/10.1109/SMI.2004.1314505\">"
         "doi:10.1109/SMI.2004.1314505</a><br>Laplacian editing for MeshLab " LAPEDIT_VERSION;
}

FilterLaplacianEdit::FilterLaplacianEdit()
    : VertexFilterPlugin("FilterLaplacianEdit", {laplacianEdit(), laplacianEditReplay(), laplacianFit()}) {}
