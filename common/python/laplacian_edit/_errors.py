# SPDX-License-Identifier: GPL-3.0-or-later
"""The exception of this package."""
from __future__ import annotations

from typing import Any, Optional


class EditRefused(ValueError):
    """An edit was refused. The text says what is wrong, where, and what to do. Nothing was changed.

    Attributes:
        key: the key or argument at fault, such as "steps[0].handles[1].vertices"; None if the text is about none.
        cause: the kind of error, such as "BadIndex", "NotFinite", "BadParameter" or "MeshMismatch".
        vertex: the vertex that the text is about, or None.
    """

    key: Optional[str]
    cause: str
    vertex: Optional[int]

    def __init__(self, message: str, cause: str = "BadParameter", vertex: int = -1) -> None:
        super().__init__(message)
        self.key = None
        self.cause = cause
        self.vertex = vertex if vertex >= 0 else None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.cause, -1 if self.vertex is None else self.vertex), {"key": self.key}


def refused(key: str, sentence: str, cause: str = "BadParameter") -> EditRefused:
    """Returns the refusal of a key or argument."""
    refusal = EditRefused(f"{key}: {sentence}", cause)
    refusal.key = key
    return refusal
