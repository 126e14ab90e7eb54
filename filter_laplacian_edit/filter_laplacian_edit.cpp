// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_laplacian_edit.h"

FilterLaplacianEdit::FilterLaplacianEdit(const lapedit::host::ReportSink& sink, int mostVertices)
    : VertexFilterPlugin("FilterLaplacianEdit",
                         {laplacianEdit(sink, mostVertices), laplacianEditReplay(sink, mostVertices)}) {}
