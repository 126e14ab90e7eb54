// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QByteArray>
#include <QString>

/// Text of an .mlx script that replays an edit with the filter Laplacian Edit Replay.
QString filterScript(const QByteArray& edit);
