// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_laplacian_edit.h"

FilterLaplacianEdit::FilterLaplacianEdit()
    : VertexFilterPlugin("FilterLaplacianEdit", {laplacianEdit(), laplacianEditReplay(), laplacianFit()}) {}
